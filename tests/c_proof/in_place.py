"""Programs for EVA that write messages field by field where they stand in their frames.

They are made from the header alone. A buffer suffices for a frame, or none of it is touched;
elements have any index, values any that their types have, and there are any number of elements.
"""

from __future__ import annotations

import re

from c_proof.drivers import HEAD, STATES, Driver, program
from protogen.copying import replace
from protogen.model.protocol import Protocol

_BEGIN = re.compile(
    r"uint8_t \*((\w+)_begin)\( ?((?:\w+ \w+, )*)uint8_t \*frame, size_t capacity\);"
)
_END = re.compile(r"size_t (\w+)_end\( ?((?:\w+ \w+, )*)uint8_t \*frame\);")
_SET = re.compile(r"static inline bool (\w+_set(?:_at)?)\( ?uint8_t \*payload, ([^)]*)\) \{")
_GET = re.compile(r"static inline (?!void)\w+ (\w+_get)\( ?const uint8_t \*payload\) \{")
_ROOM = re.compile(r"#define (\w+_FRAME_ROOM) (\d+)[uU]")
_WRITE = """
static void prove_{begin}(void) {{
    uint8_t frame[{room}];
    size_t size;
    uint8_t *payload = {begin}(&frame[{room} - 1], Frama_C_unsigned_int_interval(0, {room} - 1));
    //@ assert payload == \\null;
    Frama_C_make_unknown((char *)frame, sizeof frame); /* EVA does not follow how it is filled. */
    payload = {begin}(frame, {room});
    while (any != 0) {{
{sets}    }}
{numbers}    size = {prefix}_end({parts}frame);
    //@ assert size <= {room};
}}
"""
_WRITE_FIRST = """
static void prove_{begin}(void) {{
    uint8_t frame[{room}];
    size_t size = Frama_C_unsigned_int_interval(0, {room});
    uint8_t *payload;
{first}    //@ split size;
    payload = {begin}({given}&frame[{room} - size], size);
    //@ merge size;
    payload = {begin}({given}frame, {room});
    if (payload != NULL) {{
        while (any != 0) {{
{sets}        }}
{numbers}        size = {prefix}_end({parts}frame);
        //@ assert size <= {room};
    }}
}}
"""
"""Numbers that are given first stay what they are."""
_NUMBER = """    {type} {name} = ({type})any;
    if ({name} <= {followed}) {{
        //@ split {name};
        ;
    }}
"""
"""Numbers of elements that are given, of which EVA follows each alone."""
_FOLLOWED = 8
"""The greatest of them."""
_CALL = """        if (any != 0) {{
            {declared}(void){name}(payload, {given});
        }}
"""
_PIECE = """        if (any != 0) {{
            size_t index = (size_t)Frama_C_unsigned_int_interval(0, 0xFFFFFFFFU);
            {declared}if (index <= {followed}) {{
                //@ split index;
                ;
            }}
            (void){name}(payload, index, {given});
            //@ merge index;
            ;
        }}
"""


def in_place_driver(protocol: Protocol, header: str) -> Driver:
    """Each message that is written in place, with any values, in any order, as often as may be."""
    flat = re.sub(r"\s+", " ", header)
    rooms = dict(_ROOM.findall(flat))
    ends = dict(_END.findall(flat))
    parts, proofs = [HEAD.format(name=protocol.name, upper=protocol.name.upper())], []
    for begin, prefix, first in _BEGIN.findall(flat):
        own = [found for found in _SET.findall(flat) if found[0].startswith(f"{prefix}_")]
        reads = [name for name in _GET.findall(flat) if name.startswith(f"{prefix}_")]
        sets = [_call(name, arguments.split(", ")) for name, arguments in own]
        sets += [f"        sink = {name}(payload) != 0;\n" for name in reads]
        parts.append(
            (_WRITE_FIRST if first else _WRITE).format(
                begin=begin,
                prefix=prefix,
                room=rooms[f"{prefix.upper()}_FRAME_ROOM"],
                sets="".join(sets),
                first=_numbers(first),
                given=_names(first),
                numbers=_numbers(ends[prefix]),
                parts=_names(ends[prefix]),
            )
        )
        proofs.append(begin)
    # Where numbers are given first, states are kept apart by these alone.
    depths = ",".join(f"prove_{begin}:0" for begin, _, first in _BEGIN.findall(flat) if first)
    options = (STATES, *[f"-eva-slevel-function={depths}"] * bool(depths))
    return replace(program(parts, proofs), options=options)


def _numbers(parameters: str) -> str:
    """Any values for parameters that are numbers."""
    found = re.findall(r"(\w+) (\w+),", parameters)
    return "".join(_NUMBER.format(type=kind, name=name, followed=_FOLLOWED) for kind, name in found)


def _names(parameters: str) -> str:
    """Parameters as arguments in front of others."""
    return "".join(f"{name}, " for _, name in re.findall(r"(\w+) (\w+),", parameters))


def _call(name: str, arguments: list[str]) -> str:
    """The call of a function that sets a field, an element of one, or several of its bytes."""
    number = "(size_t)Frama_C_unsigned_int_interval(0, 0xFFFFFFFFU)"
    is_piece = arguments[-1] == "size_t size"
    if is_piece:
        arguments = arguments[:-1]
    kind = arguments[-1].rpartition(" ")[0]
    declared, value = "", f"({kind})Frama_C_unsigned_int_interval(0, 0xFFFFFFFFU)"
    if arguments[-1].startswith("const "):
        kind = arguments[-1].removeprefix("const ").rpartition(" ")[0]
        size = "" if kind.startswith("struct") else "[256]"
        declared = f"{kind} value{size}; Frama_C_make_unknown((char *)&value, sizeof value); "
        value = "value" if size else "&value"
    if is_piece:
        given = f"{value}, {number}"
        return _PIECE.format(declared=declared, name=name, given=given, followed=_FOLLOWED)
    given = f"{number}, {value}" if len(arguments) > 1 else value
    return _CALL.format(declared=declared, name=name, given=given)
