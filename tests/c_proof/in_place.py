"""Programs for EVA that write messages field by field where they stand in their frames.

They are made from the header alone. A buffer suffices for a frame, or none of it is touched;
elements have any index, and values any that their types have.
"""

from __future__ import annotations

import re

from c_proof.drivers import HEAD, STATES, Driver, program
from protogen.copying import replace
from protogen.model.protocol import Protocol

_BEGIN = re.compile(r"uint8_t \*((\w+)_begin)\( ?uint8_t \*frame, size_t capacity\);")
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
    size = {prefix}_end({parts}frame);
    //@ assert size <= {room};
}}
"""
_CALL = """        if (any != 0) {{
            {declared}(void){name}(payload, {given});
        }}
"""


def in_place_driver(protocol: Protocol, header: str) -> Driver:
    """Each message that is written in place, with any values, in any order, as often as may be."""
    flat = re.sub(r"\s+", " ", header)
    rooms = dict(_ROOM.findall(flat))
    ends = dict(_END.findall(flat))
    parts, proofs = [HEAD.format(name=protocol.name, upper=protocol.name.upper())], []
    for begin, prefix in _BEGIN.findall(flat):
        own = [found for found in _SET.findall(flat) if found[0].startswith(f"{prefix}_")]
        reads = [name for name in _GET.findall(flat) if name.startswith(f"{prefix}_")]
        sets = [_call(name, arguments.split(", ")) for name, arguments in own]
        sets += [f"        sink = {name}(payload) != 0;\n" for name in reads]
        given = re.sub(r"(\w+) \w+,", r"(\1)any,", ends[prefix])
        room = rooms[f"{prefix.upper()}_FRAME_ROOM"]
        parts.append(
            _WRITE.format(begin=begin, prefix=prefix, room=room, sets="".join(sets), parts=given)
        )
        proofs.append(begin)
    return replace(program(parts, proofs), options=(STATES,))


def _call(name: str, arguments: list[str]) -> str:
    """The call of a function that sets a field, or an element of one."""
    index = "(size_t)Frama_C_unsigned_int_interval(0, 0xFFFFFFFFU), "
    kind = arguments[-1].rpartition(" ")[0]
    declared, value = "", f"({kind})Frama_C_unsigned_int_interval(0, 0xFFFFFFFFU)"
    if arguments[-1].startswith("const "):
        kind = arguments[-1].removeprefix("const ").rpartition(" ")[0]
        size = "" if kind.startswith("struct") else "[256]"
        declared = f"{kind} value{size}; Frama_C_make_unknown((char *)&value, sizeof value); "
        value = "value" if size else "&value"
    given = f"{index if len(arguments) > 1 else ''}{value}"
    return _CALL.format(declared=declared, name=name, given=given)
