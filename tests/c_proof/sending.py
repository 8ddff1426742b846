"""Programs for EVA that send every message, whatever its fields hold.

They are made from the text of the C alone: a message's `encode`, `frame` and `send` take a struct
of any bytes. Buffers have what the function asks for, or less, and end where memory does; those for
great messages have room for the greatest.
"""

from __future__ import annotations

import re

from c_proof.drivers import HEAD, STATES, Driver, program
from protogen.copying import replace
from protogen.model.protocol import Protocol

GREATEST = 64
"""Greater payloads take minutes if EVA follows each of their sizes: buffers for these have room for
the greatest, and all sizes are looked at together unless they are stuffed."""
STUFFED = 300
"""More bytes than are stuffed in any frame."""
_ENCODERS = re.compile(
    r"(?:enum \w+|size_t) ((\w+)_(encode|frame|send))"
    r"\( ?(?:const struct (\w+) \*message, )?([^)]*)\)(?:;| \{)"
)
_COPY = re.compile(r"(uint8_t frame\[\w+_FRAME_ROOM\]);")
"""Where `send` has a frame as a whole."""
_ROOM = re.compile(r"#define (\w+_(?:PAYLOAD_MAX|FRAME_ROOM)) (\d+)[uU]")
_STRUCT = re.compile(r"^struct (\w+) \{\n((?:.*\n)*?)\};\n", re.MULTILINE)
_TRUTH = re.compile(r"^ +bool (\w+);", re.MULTILINE)
_PART = re.compile(r"(\w+) (\w+)")
_BODY = r"^[^\n;]*\b{name}\([^;{{]*\{{\n(?:.*\n)*?\}}\n"
_ASKS = re.compile(r"if \(capacity < (.*)\) \{")
_VALUE = re.compile(r"message->([\w.]+)")
_SWITCH = re.compile(r"switch \(message->(\w+)\) \{\n((?:.*\n)*?)    \}\n")
_CASE = re.compile(r"case (\d+)U:")
_WRAP = re.compile(r"^( +)for \(; from < stuffed; from\+\+\) \{\n", re.MULTILINE)
_BUFFER = """
static void prove_{function}_into(bool fits) {{
    uint8_t bytes[{room} + 1]; /* C has no empty arrays. */
{values}    size_t size = 0;
    const size_t payload = {payload};
    const size_t needed = payload;
    const size_t asked = {asks};
    const size_t most = payload <= {greatest} && asked <= {room} ? asked : {room};
    const size_t capacity = fits || most == 0 ? most : Frama_C_unsigned_long_interval(0, most - 1);
    (void)needed;
    /* It ends where the array does, so that no byte behind it can be written. */
    {call};
    //@ assert size <= capacity;
}}

static void prove_{function}(void) {{
    prove_{function}_into(true);
    prove_{function}_into(false);
}}
"""
_GREAT = """
static void prove_{function}(void) {{
    uint8_t bytes[{room}];
{values}    size_t size = 0;
    Frama_C_make_unknown((char *)bytes, sizeof bytes); /* EVA does not follow how it is filled. */
    {call};
    //@ assert size <= {room};
}}
"""
_CALLS = {
    "encode": "(void){function}({given}{parts}{buffer}, &size)",
    "frame": "size = {function}({given}{parts}{buffer})",
}
"""Calls that fill a buffer; `size` stays 0 where there is nothing."""
_STREAM = """
static void prove_{function}(void) {{
{values}    uint8_t last = 0;
    (void){function}({given}{parts}put, &last);
}}
"""
_PUT = """
static void put(void *user, uint8_t byte) {
    *(uint8_t *)user = byte;
}
"""


def send_driver(protocol: Protocol, header: str, source: str, *, stuffs_great: bool) -> Driver:
    """Each message with any values of its fields, into buffers that suffice or do not, and away.

    Where it `stuffs_great`, frames of great messages are stuffed, too: a quarter of a minute each.
    """
    is_stuffed = bool(_WRAP.search(source))
    flat = re.sub(r"\s+", " ", header)
    rooms = {name: int(size) for name, size in _ROOM.findall(flat)}
    truths = {name: _TRUTH.findall(members) for name, members in _STRUCT.findall(header)}
    parts, proofs = [HEAD.format(name=protocol.name, upper=protocol.name.upper()), _PUT], []
    for function, prefix, kind, struct, arguments in _ENCODERS.findall(flat):
        measure = _body(source, f"{prefix}_measure")
        greatest = rooms[f"{prefix.upper()}_PAYLOAD_MAX"]
        stuffs = kind == "frame" and is_stuffed
        if greatest > GREATEST and stuffs and not stuffs_great:
            continue
        values = [f"struct {struct} message;"] if struct else []
        values += ["Frama_C_make_unknown((char *)&message, sizeof message);"] if struct else []
        values += [f"message.{name} = any != 0;" for name in truths.get(struct, ())]
        if greatest <= GREATEST or stuffs:
            for value in _apart(measure, greatest):
                values += [f"//@ split {value};", ";"]
        given = {
            "function": function,
            "given": "&message, " if struct else "",
            "parts": "".join(f"({type_})any, " for type_ in _parts_of(arguments)),
            "values": "".join(f"    {value}\n" for value in values),
        }
        if kind == "send":
            parts.append(_STREAM.format(**given))
        else:
            room = greatest if kind == "encode" else rooms[f"{prefix.upper()}_FRAME_ROOM"]
            [asks] = _ASKS.findall(_body(source, function)) or [str(room)]
            payload = f"{prefix}_measure(&message)" if measure else str(greatest)
            sizes = {"room": room, "greatest": greatest, "asks": asks, "payload": payload}
            is_great = greatest > GREATEST
            given["buffer"] = (
                "bytes, sizeof bytes" if is_great else "&bytes[sizeof bytes - capacity], capacity"
            )
            call = _CALLS[kind].format(**given)
            text = _GREAT if is_great else _BUFFER
            parts.append(text.format(call=call, **sizes, **given))
        proofs.append(function)
    # Each byte that is stuffed can take either way: states are kept apart by its place alone.
    wraps = re.findall(r"^static size_t (\w+_wrap)\(", source, re.MULTILINE)
    depths = ",".join(f"{name}:0" for name in wraps)
    options = (STATES, "-eva-split-return=full", f"-eva-slevel-function={depths}")
    return replace(program(parts, proofs), options=options)


def unrolled(source: str) -> str:
    """Generated C with comments that have EVA go over stuffed bytes one by one."""
    return _WRAP.sub(lambda loop: f"{loop[1]}//@ loop unroll {STUFFED};\n{loop.group()}", source)


def filled(header: str) -> str:
    """The header with zeros in copies of frames at first: EVA does not follow what fills them."""
    return _COPY.sub(r"\1 = {0};", header)


def _apart(measure: str, greatest: int) -> list[str]:
    """What a size depends on: counts, or the case of a switch and then what that one depends on."""
    values: dict[str, None] = {}
    cases = dict(_SWITCH.findall(measure))
    for path in sorted(set(_VALUE.findall(measure)), key=lambda path: (path.count("."), path)):
        bounds = {
            int(case) - below for case in _CASE.findall(cases.get(path, "")) for below in (0, 1)
        }
        if "." in path:
            bounds = set(range(greatest + 1))
        found = [f"message.{path} <= {bound}" for bound in sorted(bounds)]
        values.update(dict.fromkeys(found or [f"message.{path}"]))
    return list(values)


def _body(source: str, name: str) -> str:
    found = re.search(_BODY.format(name=name), source, re.MULTILINE)
    return found.group() if found else ""


def _parts_of(arguments: str) -> list[str]:
    """Types of the parts that are given, in front of the buffer or of what takes the bytes."""
    found: list[str] = []
    for argument in arguments.split(", "):
        part = _PART.fullmatch(argument)
        if part is None or part[2] == "put":
            break
        found.append(part[1])
    return found
