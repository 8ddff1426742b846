"""Programs for EVA that give generated functions every possible input.

They are made from what a user sees of the generated code, its header; only which bytes of a payload
decide on the layout of others is asked of the model.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from c_proof.received import events, reads
from protogen.copying import replace
from protogen.model.expressions import names_in
from protogen.model.messages import Message
from protogen.model.protocol import Protocol
from protogen.model.types import Array, Counted, Field, Integer, Octets, Struct, Switch, Text, Type
from protogen.targets.c.protocol_names import names_of

FIRST = 3
"""Bytes behind those of a smallest frame: of its payload, or of the next one."""
STATES = "-eva-slevel=1200"
"""A payload's checks are followed for each size and element alone."""
PATHS = 20000
"""States that are followed alone at one place."""
_DECODE = re.compile(
    r"enum \w+ (\w+)_decode\( ?(?:struct (\w+) \*message, )?const uint8_t \*payload, "
    r"size_t size((?:, \w+ \w+)*)\);"
)
_GREATEST = re.compile(r"#define (\w+)_PAYLOAD_MAX (\d+)[uU]")
_ARRAY = re.compile(r"\[(\d+)\];")
_PUSH = re.compile(r"(?:void|enum \w+) (\w+)_decoder_push\(")
_LIMIT = re.compile(r"struct (\w+)_decoder \{[^}]* limit;")
_TELLS = re.compile(
    r"(?:void|bool) ((\w+)_decoder_tell_\w+)\(\s*struct \w+ \*decoder,\s*(uint\d+_t) \w+\);"
)
"""What tells a decoder a part that is not sent."""
_POLLS = re.compile(r"void (\w+)_decoder_init\(\s*struct \w+ \*decoder\);")
"""A decoder whose `push` returns which message is complete, and takes no handler."""

_STATES = re.compile(r"struct (\w+)_decoder \{[^}]* state;")
"""One with states, which bounds what events show by itself: its ways need not be followed apart."""

HEAD = """#define {upper}_FAST_FEED 0 /* memcpy, which only `feed` needs; fuzzed against `push` */
#include "{name}.c"
#include "__fc_builtin.h"
#include <stddef.h>

static volatile int any;
static volatile uint8_t sink;
"""
SUMMED = 300
"""Bytes that functions of checksums are followed over."""
_SUM = """
static void prove_{function}(void) {{
    uint8_t bytes[{most}];
    Frama_C_make_unknown((char *)bytes, sizeof bytes);
    sink = (uint8_t){function}((uint8_t)any, bytes, (size_t)Frama_C_interval(0, {most}));
}}
"""
_TAKE = """
static void take_{prefix}(void *user, const struct {prefix}_event *event) {{
    (void)user;
{dispatch}{reads}}}

{step}"""
_ENDLESS = """static void prove_{prefix}_push(void) {{
    struct {prefix}_decoder decoder;
    static const struct {prefix}_decoder zeros;
    if (any) {{
        Frama_C_make_unknown((char *)&decoder, sizeof decoder);
        {prefix}_decoder_init({init});
    }} else {{
        decoder = zeros;
{handler}    }}
    //@ widen_hints global:"all", {bounds};
{apart}    while (any) {{
        if (any) {{
            {push}
{tells}{feed}{next}        }} else {{
            {flush}
        }}
    }}
}}
"""
_TELL = """        }} else if (any) {{
            (void){function}(&decoder, ({type})Frama_C_unsigned_int_interval(0, 0xFFFFFFFFU));
"""
_FEED = """        }} else if (any) {{
            uint8_t bytes[{count}];
            Frama_C_make_unknown((char *)bytes, sizeof bytes);
            {prefix}_decoder_feed(&decoder, bytes, Frama_C_interval(0, {count}));
"""
_POLLED_FEED = """        }} else if (any) {{
            uint8_t bytes[{count}];
            struct {prefix}_event event;
            Frama_C_make_unknown((char *)bytes, sizeof bytes);
            {prefix}_decoder_feed(&decoder, bytes, Frama_C_interval(0, {count}), &event);
            if (event.message != {upper}_NO_MESSAGE) {{
                take_{prefix}(NULL, &event);
            }}
"""
FED = 40
"""Bytes that are fed at once, at most; again and again."""
_DISPATCH = "    {prefix}_dispatch(NULL, event);\n"
_ENDS = """    if (event->payload_size > 0) {
        /* EVA has to show that these two bytes are there. `decode` is shown to read no others. */
        sink = event->payload[0];
        sink = event->payload[event->payload_size - 1];
    }
"""
_FIRST_BYTE = """    if (event->payload_size > 0) {
        sink = event->payload[0];
    }
"""
_EACH = """    for (size_t i = 0; i < event->payload_size; i++) {
        sink = event->payload[i]; /* EVA has to show that it was received. */
    }
"""
_FIRST = """static void prove_{prefix}_first(void) {{
    struct {prefix}_decoder decoder; /* Nothing is in its buffer but what it puts there. */
    Frama_C_make_unknown((char *)&decoder, offsetof(struct {prefix}_decoder, buffer));
    {prefix}_decoder_init({init});
    //@ loop unroll {count};
    for (int i = 0; i < {count}; i++) {{
        {push}
    }}
    {flush}
}}
"""
_SPLITS = "-eva-interprocedural-splits"
"""A `feed` that has filled an event stays apart from one that has not, also behind its call."""
_IDLE = """    /* Until a frame's size is known the limit is nought, which is no size of a frame. */
    //@ dynamic_split decoder.limit == 0;
"""
_CALLS = {
    "step": "",
    "init": "&decoder, take_{prefix}, NULL",
    "handler": "        decoder.handler = take_{prefix};\n",
    "push": "{prefix}_decoder_push(&decoder, Frama_C_unsigned_char_interval(0, 255));",
    "next": "",
    "flush": "{prefix}_decoder_flush(&decoder);",
}
_POLLED = {
    "step": """static void show_{prefix}(
    struct {prefix}_decoder *decoder, enum {lower}_message message) {{
    if (message != {upper}_NO_MESSAGE) {{
        struct {prefix}_event event;
        {prefix}_decoder_event(decoder, message, &event);
        take_{prefix}(NULL, &event);
    }}
}}

static void step_{prefix}(struct {prefix}_decoder *decoder) {{
    const uint8_t byte = Frama_C_unsigned_char_interval(0, 255);
    const enum {lower}_message message = {prefix}_decoder_push(decoder, byte);
    show_{prefix}(decoder, message);
}}

""",
    "init": "&decoder",
    "handler": "",
    "push": "step_{prefix}(&decoder);",
    "next": """        }} else if (any) {{
            show_{prefix}(&decoder, {prefix}_decoder_next(&decoder));
""",
    "flush": "show_{prefix}(&decoder, {prefix}_decoder_flush(&decoder));",
}
_PAYLOAD = """
static void prove_{prefix}_decode_of(size_t size) {{
    uint8_t bytes[{room}];
    /* The payload ends where the array does, so that no byte behind it can be read. */
    const uint8_t *const payload = &bytes[sizeof bytes - size];
    {message}
    Frama_C_make_unknown((char *)bytes, sizeof bytes);
{splits}    const bool taken = {prefix}_decode({given}payload, size{held}) == 0;
    if (taken) {{
{reads}    }}
{events}}}

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
_HELD = """    const {type} held_{index} = ({type}){any};
    //@ split held_{index};
    ;
"""
_ANY = {
    "bool": "Frama_C_interval(0, 1)",
    "uint8_t": "Frama_C_interval(0, 255)",
    "uint16_t": "Frama_C_interval(0, 65535)",
    "uint32_t": "Frama_C_unsigned_int_interval(0, 0xFFFFFFFFU)",
}
"""Any number of a type."""


def known_in(source: str, options: Sequence[str]) -> tuple[str, ...]:
    """The options without functions that the source does not have, about which EVA complains."""

    def known(option: str) -> str:
        name, found, values = option.partition("-function=")
        is_there = (item for item in values.split(",") if f"{item.partition(':')[0]}(" in source)
        return f"{name}{found}{','.join(is_there)}" if found else option

    return tuple(known(option) for option in options)


@dataclass(frozen=True)
class Driver:
    """A program that calls some functions with every input."""

    text: str
    proves: tuple[str, ...]
    """The functions that it calls."""
    options: tuple[str, ...] = ()
    """Statements that EVA has to be told."""


def decode_driver(protocol: Protocol, header: str, source: str, asked: Mapping[str, str]) -> Driver:
    """Every payload of up to a byte more than the greatest, for each message's `decode`.

    Elements of those that it takes are read. Those are dispatched of which no more is `asked`; of
    messages of which nothing is known those that it takes.
    """
    flat = re.sub(r"\s+", " ", header)
    greatest = {name: int(size) for name, size in _GREATEST.findall(flat)}
    messages = {f"{protocol.name}_{message.name}": message for message in protocol.messages}
    parts, proofs = [HEAD.format(name=protocol.name, upper=protocol.name.upper())], []
    for prefix, struct, held in _DECODE.findall(flat):
        types = re.findall(r"(\w+) \w+", held)
        room = greatest[prefix.upper()] + 1
        offsets = _deciding(messages[prefix]) if prefix in messages else ()
        splits = "".join(_SPLIT.format(offset=offset) for offset in offsets)
        splits += "".join(
            _HELD.format(type=type_, index=index, any=_ANY[type_])
            for index, type_ in enumerate(types)
        )
        given = {"prefix": prefix, "room": room, "steps": room + 2}
        is_read = struct and prefix in messages
        given["reads"] = reads(protocol, messages[prefix], prefix, flat) if is_read else ""
        given["events"] = ""
        if is_read:
            message = messages[prefix]
            given["events"] = events(protocol, message, flat, asked.get(message.name))
        given["held"] = "".join(f", held_{index}" for index in range(len(types)))
        given["message"] = f"struct {struct} message;" if struct else ""
        given["given"] = "&message, " if struct else ""
        parts.append(_PAYLOAD.format(splits=splits, **given))
        proofs.append(f"{prefix}_decode")
    # Bytes that are copied are all alike: to follow each of them takes most of the time.
    copy = f"{protocol.name}_copy"
    options = (
        STATES,
        "-eva-split-return=full",
        *((f"-eva-slevel-function={copy}:0",) if f"{copy}(" in source else ()),
    )
    return replace(program(parts, proofs), options=options)


def sums_driver(protocol: Protocol, functions: Sequence[str]) -> Driver:
    """Functions of checksums, over any bytes of any number up to `SUMMED`."""
    head = HEAD.format(name=protocol.name, upper=protocol.name.upper())
    parts = [_SUM.format(function=function, most=SUMMED) for function in functions]
    return program([head, *parts], functions)


def push_driver(
    protocol: Protocol,
    header: str,
    *,
    reads_ends: bool = True,
    feeds: bool = False,
    loads: bool = False,
) -> Driver:
    """Any number of bytes and ends of input, for each sender's decoder.

    The handler reads payloads: both ends, or the first byte alone. The decoder's memory holds
    anything before it is initialised, or it is not, and its memory holds zeros. Where it
    `feeds`, bytes also come several at a time; where it `loads`, each event is dispatched.
    """
    prefixes, polled = _PUSH.findall(header), set(_POLLS.findall(header))
    flat = sorted(polled - stateful_in(header))
    limited = limited_in(header)
    given = {"bounds": _bounds(header), "reads": _ENDS if reads_ends else _FIRST_BYTE}
    upper = protocol.name.upper()
    tells: dict[str, str] = {}
    for function, prefix, type_ in _TELLS.findall(header):
        tells[prefix] = tells.get(prefix, "") + _TELL.format(function=function, type=type_)
    parts = [
        _decoder(
            _ENDLESS,
            prefix,
            upper,
            polls=prefix in polled,
            apart=_IDLE if prefix in limited else "",
            tells=tells.get(prefix, ""),
            feed=_feed_of(prefix, upper, polls=prefix in polled) if feeds else "",
            dispatch=_DISPATCH.format(prefix=prefix) if loads else "",
            **given,
        )
        for prefix in prefixes
    ]
    head = HEAD.format(name=protocol.name, upper=upper)
    driver = program([head, *parts], [f"{prefix}_push" for prefix in prefixes])
    options = _apart(flat, feeds=feeds)
    if feeds and polled and not options:
        options = (_SPLITS,)
    return replace(driver, options=options)


def stateful_in(header: str) -> set[str]:
    """Decoders with states."""
    return set(_STATES.findall(header))


def limited_in(header: str) -> set[str]:
    """Decoders without states that keep how many bytes a frame has."""
    return set(_LIMIT.findall(header)) - stateful_in(header)


def _feed_of(prefix: str, upper: str, *, polls: bool) -> str:
    call = _POLLED_FEED if polls else _FEED
    return call.format(prefix=prefix, upper=upper, count=FED)


def first_driver(protocol: Protocol, header: str) -> Driver:
    """The first bytes that a decoder gets, any of them: a smallest frame, and a few more.

    Its buffer holds nothing but what was put there, so that EVA sees where an event has more
    payload than was received. In `push_driver`, where any number of bytes came before, it can't.
    """
    polled = set(_POLLS.findall(header))
    upper = protocol.name.upper()
    parts = [HEAD.format(name=protocol.name, upper=upper)]
    proofs, names = [], names_of(protocol)
    for sender in protocol.senders:
        prefix = names.senders[sender.name]
        count = sender.framing.least + FIRST
        given = {"polls": prefix in polled, "count": count, "reads": _EACH, "dispatch": ""}
        parts.append(_decoder(_FIRST, prefix, upper, **given))
        proofs.append(f"{prefix}_first")
    driver = program(parts, proofs)
    apart = _apart(sorted(polled - stateful_in(header)))
    return replace(driver, options=(*apart, f"-eva-slevel={PATHS}"))


def _apart(prefixes: Sequence[str], *, feeds: bool = False) -> tuple[str, ...]:
    """Split by the message that `push` returns: only with one the event is filled."""
    if not prefixes:
        return ()
    ways = ("decoder_push", "complete", *(["decoder_feed"] if feeds else []))
    steps = [f"step_{p}" for p in prefixes] + [f"{p}_{way}" for p in prefixes for way in ways]
    depths = ",".join(f"{name}:64" for name in steps)
    splits = (_SPLITS,) if feeds else ()
    return ("-eva-split-return=full", f"-eva-slevel-function={depths}", *splits)


def _decoder(proof: str, prefix: str, upper: str, *, polls: object, **given: object) -> str:
    calls = _POLLED if polls else _CALLS
    words = {
        name: text.format(prefix=prefix, upper=upper, lower=upper.lower())
        for name, text in calls.items()
    }
    return f"{_TAKE}{proof}".format(prefix=prefix, **words, **given)


def _bounds(header: str) -> str:
    """The sizes of arrays and numbers next to them: what the bounds of counters may be.

    EVA tries them before it gives up on bounding what a loop changes.
    """
    sizes = {int(size) for size in _ARRAY.findall(header)}
    near = {bound for size in sizes for bound in range(max(1, size - 8), size + 2)}
    return ", ".join(map(str, sorted(near)))


def program(parts: Sequence[str], proofs: Sequence[str]) -> Driver:
    assert proofs
    calls = "".join(f"    prove_{proof}();\n" for proof in proofs)
    main = f"\nint main(void) {{\n{calls}    return 0;\n}}\n"
    return Driver("".join([*parts, main]), tuple(proofs))


def _deciding(message: Message) -> tuple[int, ...]:
    """The offsets of bytes that count or select: EVA looks at each of their values alone."""
    names = set(_names(field.type for field in message.fields))
    return tuple(offset for field in message.fields for offset in _bytes_of(field, names))


def _bytes_of(field: Field, names: set[str]) -> range:
    is_told = field.name in names and not field.part
    if is_told and isinstance(field.type, Integer) and field.position is not None:
        return range(field.position, field.position + field.type.size)
    return range(0)


def _names(types: Iterator[Type]) -> Iterator[str]:
    for type_ in types:
        match type_:
            case Text(extent=Counted(by=by)) | Octets(extent=Counted(by=by)):
                yield from names_in(by)
            case Array(element=element, extent=extent):
                if isinstance(extent, Counted):
                    yield from names_in(extent.by)
                yield from _names(iter((element,)))
            case Struct(fields=fields):
                yield from _names(field.type for field in fields)
            case Switch(selector=selector, cases=cases):
                yield from names_in(selector)
                yield from _names(case.type for case in cases)
