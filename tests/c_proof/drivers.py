"""Programs for EVA that give generated functions every possible input.

They are made from what a user sees of the generated code, its header; only which bytes of a payload
decide on the layout of others is asked of the model.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from protogen.model.fields import Field
from protogen.model.messages import Message
from protogen.model.protocol import Protocol
from protogen.model.types import Array, Counted, Integer, Octets, Struct, Switch, Text, Type

_DECODE = re.compile(
    r"enum \w+ (\w+)_decode\( ?struct (\w+) \*message, const uint8_t \*payload, size_t size\);"
)
_GREATEST = re.compile(r"#define (\w+)_PAYLOAD_MAX (\d+)[uU]")
_ARRAY = re.compile(r"\[(\d+)\];")
_PUSH = re.compile(r"void (\w+)_decoder_push\(")

_HEAD = """#define {upper}_FAST_FEED 0 /* memcpy, which only `feed` needs; fuzzed against `push` */
#include "{name}.c"
#include "__fc_builtin.h"

static volatile int any;
static volatile uint8_t sink;
"""
_DECODER = """
static void take_{prefix}(void *user, const struct {prefix}_event *event) {{
    (void)user;
    if (event->payload_size > 0) {{
        /* EVA has to show that these two bytes are there. `decode` is shown to read no others. */
        sink = event->payload[0];
        sink = event->payload[event->payload_size - 1];
    }}
}}

static void prove_{prefix}_push(void) {{
    struct {prefix}_decoder decoder;
    Frama_C_make_unknown((char *)&decoder, sizeof decoder);
    {prefix}_decoder_init(&decoder, take_{prefix}, NULL);
    //@ widen_hints global:"all", {bounds};
    while (any) {{
        if (any) {{
            {prefix}_decoder_push(&decoder, Frama_C_unsigned_char_interval(0, 255));
        }} else {{
            {prefix}_decoder_flush(&decoder);
        }}
    }}
}}
"""
_PAYLOAD = """
static void prove_{prefix}_decode_of(size_t size) {{
    uint8_t bytes[{room}];
    /* The payload ends where the array does, so that no byte behind it can be read. */
    const uint8_t *const payload = &bytes[sizeof bytes - size];
    struct {struct} message;
    Frama_C_make_unknown((char *)bytes, sizeof bytes);
{splits}    (void){prefix}_decode(&message, payload, size);
}}

static void prove_{prefix}_decode(void) {{
    //@ loop unroll {steps};
    for (size_t size = 0; size <= {room}; size++) {{
        prove_{prefix}_decode_of(size);
    }}
}}
"""
_SPLIT = """    if (size > {offset}) {{
        //@ split payload[{offset}];
        ;
    }}
"""


@dataclass(frozen=True)
class Driver:
    """A program that calls some functions with every input."""

    text: str
    proves: tuple[str, ...]
    """The functions that it calls."""


def decode_driver(protocol: Protocol, header: str) -> Driver:
    """Every payload of up to a byte more than the greatest, for each message's `decode`."""
    flat = re.sub(r"\s+", " ", header)
    greatest = {name: int(size) for name, size in _GREATEST.findall(flat)}
    messages = {f"{protocol.name}_{message.name}": message for message in protocol.messages}
    parts, proofs = [_HEAD.format(name=protocol.name, upper=protocol.name.upper())], []
    for prefix, struct in _DECODE.findall(flat):
        room = greatest[prefix.upper()] + 1
        offsets = _deciding(messages[prefix]) if prefix in messages else ()
        splits = "".join(_SPLIT.format(offset=offset) for offset in offsets)
        given = {"prefix": prefix, "struct": struct, "room": room, "steps": room + 2}
        parts.append(_PAYLOAD.format(splits=splits, **given))
        proofs.append(f"{prefix}_decode")
    return _driver(parts, proofs)


def push_driver(protocol: Protocol, header: str) -> Driver:
    """Any number of bytes and ends of input, for each sender's decoder.

    The handler reads payloads. The decoder's memory holds anything before it is initialised.
    """
    proofs = [f"{prefix}_push" for prefix in _PUSH.findall(header)]
    bounds = _bounds(header)
    parts = [_DECODER.format(prefix=p.removesuffix("_push"), bounds=bounds) for p in proofs]
    return _driver([_HEAD.format(name=protocol.name, upper=protocol.name.upper()), *parts], proofs)


def _bounds(header: str) -> str:
    """The sizes of arrays and numbers next to them: what the bounds of counters may be.

    EVA tries them before it gives up on bounding what a loop changes.
    """
    sizes = {int(size) for size in _ARRAY.findall(header)}
    near = {bound for size in sizes for bound in range(max(1, size - 8), size + 2)}
    return ", ".join(map(str, sorted(near)))


def _driver(parts: Sequence[str], proofs: Sequence[str]) -> Driver:
    assert proofs
    calls = "".join(f"    prove_{proof}();\n" for proof in proofs)
    main = f"\nint main(void) {{\n{calls}    return 0;\n}}\n"
    return Driver("".join([*parts, main]), tuple(proofs))


def _deciding(message: Message) -> tuple[int, ...]:
    """The offsets of bytes that count or select: EVA looks at each of their values alone."""
    names = set(_names(field.type for field in message.fields))
    return tuple(offset for field in message.fields for offset in _bytes_of(field, names))


def _bytes_of(field: Field, names: set[str]) -> range:
    if field.name in names and isinstance(field.type, Integer) and field.position is not None:
        return range(field.position, field.position + field.type.size)
    return range(0)


def _names(types: Iterator[Type]) -> Iterator[str]:
    for type_ in types:
        match type_:
            case Text(extent=Counted(field=name)) | Octets(extent=Counted(field=name)):
                yield name
            case Array(element=element, extent=extent):
                if isinstance(extent, Counted):
                    yield extent.field
                yield from _names(iter((element,)))
            case Struct(fields=fields):
                yield from _names(field.type for field in fields)
            case Switch(selector=name, cases=cases):
                yield name
                yield from _names(case.type for case in cases)
