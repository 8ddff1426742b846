"""The C source that fills the tables of one sender: the generated decoder, and a driver."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from jinja2 import Environment

from protogen.capture.layout import capture_schema, message_record
from protogen.capture.schema import CaptureSchema, Choice, Column, Record, TableSchema
from protogen.model.protocol import Protocol, Sender
from protogen.targets.c.decoder import DecoderView, GroupView
from protogen.targets.c.emit import Unit, texts, unit_of
from protogen.targets.c.options import COptions
from protogen.targets.c.payload.messages import MessageView
from protogen.targets.printing import environment

_CALL = "decoder->handler(decoder->user, &event)"
_DIRECT = "protogen_take(decoder->user, &event)"
"""The decoder calls the driver by its name, so that the compiler can put it in its place."""

_SMALL = 64
"""Clearing so many bytes costs no more than finding the few between the members."""


@dataclass(frozen=True, slots=True)
class _Table:
    view: MessageView
    clears: bool
    """Whether the row is cleared before it is filled."""
    holes: tuple[range, ...]
    """Else, the bytes that lie between its members."""
    loads: bool


@dataclass(frozen=True, slots=True)
class _Direct:
    """A message whose frame is one byte that tells all, and a payload of 7-bit bytes."""

    key: str
    fixed: int
    checks: str
    number: int
    """Of its table."""


@dataclass(frozen=True, slots=True)
class _Spelling:
    """What makes the frame of a message again."""

    number: int
    """Of its table."""
    function: str
    room: str
    parts: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Driver:
    """A source to compile, and what is expected of the library."""

    protocol: str
    sender: str
    text: str
    schema: CaptureSchema
    layout: tuple[int, ...]
    """What the library's `protogen_layout` has to say of rows."""
    spells: bool
    """Whether the library has `protogen_spell`."""


_KEPT: dict[tuple[int, str], tuple[Protocol, Driver]] = {}
"""By the identity of the model, which stays what it is as long as it is kept here."""
_MOST_KEPT = 16


def driver_of(protocol: Protocol, sender: Sender) -> Driver:
    """The driver of what one endpoint sends. It is printed once for a model."""
    key = id(protocol), sender.name
    if key not in _KEPT:
        while len(_KEPT) >= _MOST_KEPT:
            del _KEPT[next(iter(_KEPT))]
        _KEPT[key] = protocol, _driver(protocol, sender)
    return _KEPT[key][1]


def _driver(protocol: Protocol, sender: Sender) -> Driver:
    options = COptions(style="single", senders=(sender.name,))
    header, source = texts(protocol, options)
    unit = unit_of(protocol, options)
    decoder = next(item for item in unit.framing.decoders if item.name == sender.name)
    schema = capture_schema(protocol, sender)
    tables = tuple(
        _table(unit.module.message(name), table) for name, table in schema.messages.items()
    )
    layout = list(_layout(schema))
    spellings = [] if has_one_spelling(sender) else _spellings(unit, list(schema.messages))
    text = (
        _environment()
        .get_template("driver.c.j2")
        .render(
            p=decoder.prefix,
            upper=unit.module.upper,
            whole=decoder.whole,
            parts=decoder.parts,
            header=header,
            source=source.replace(_CALL, _DIRECT),
            module=unit.module.name,
            direct=_direct(decoder, list(schema.messages)),
            d=decoder,
            stuffed=_stuffed(decoder),
            names=list(schema.messages),
            tables=tables,
            spellings=spellings,
            wrapped=_wrapped(unit, decoder) if spellings else (),
            layout=[expression for expression, _ in layout],
        )
    )
    sizes = tuple(size for _, size in layout)
    return Driver(protocol.name, sender.name, text, schema, sizes, bool(spellings))


def has_one_spelling(sender: Sender) -> bool:
    """Whether a frame can only have the bytes that an encoder makes of what is in it."""
    transparency = sender.frame.transparency
    if transparency is not None and transparency.lenient:
        return False
    start, end = sender.framing.start, sender.framing.end
    shared = end is not None and getattr(start, "bytes", None) == end.bytes
    return not (sender.framing.cut_ambiguous or shared)


def _spellings(unit: Unit, tables: list[str]) -> list[_Spelling]:
    return [
        _Spelling(
            tables.index(item.name),
            item.function,
            f"{item.upper}_FRAME_ROOM",
            tuple(argument.part for argument in item.frame.arguments),
        )
        for item in unit.framing.messages
        if item.name in tables
    ]


def _wrapped(unit: Unit, decoder: DecoderView) -> tuple[str, ...]:
    """The parts that go into a frame beside the payload, as they follow each other in C."""
    frame = next(it.frame for it in unit.framing.messages if it.frame.decoder is decoder)
    return tuple(argument.part for argument in (*frame.identity, *frame.arguments))


def _direct(decoder: DecoderView, tables: list[str]) -> list[_Direct]:
    """The messages that the driver takes by itself: there is nothing to verify but bits."""
    is_bare = (
        decoder.whole
        and decoder.stuffing is None
        and decoder.seven_bit
        and decoder.known_by_identity
        and decoder.start == "set"
        and (decoder.head_size, decoder.tail_size, decoder.end_size) == (1, 0, 0)
        and not any(item.seven_bit or item.padding for item in decoder.head_numbers)
    )
    if not is_bare:
        return []
    return [
        _Direct(group.key, group.fixed, group.messages[0].checks, tables.index(message.name))
        for group in decoder.groups
        for message in group.messages
        if group.fixed and len(group.messages) == 1
    ]


def _stuffed(decoder: DecoderView) -> list[GroupView]:
    """The messages whose frames are taken sixteen bytes at a time; the rest is the decoder's."""
    if not decoder.whole or decoder.stuffing is None or decoder.seven_bit:
        return []
    return [group for group in decoder.groups if len(group.messages) == 1]


def _table(view: MessageView, table: TableSchema) -> _Table:
    holes = table.holes
    clears = holes is None or table.row.size <= _SMALL
    return _Table(view, clears, () if clears else holes or (), bool(table.fields))


@cache
def _environment() -> Environment:
    return environment("protogen.native")


# --- layout ---------------------------------------------------------------------------------------


def _layout(schema: CaptureSchema) -> Iterator[tuple[str, int]]:
    """Expressions of C, and what they should be."""
    rows = {
        **{str(number): table for number, table in enumerate(schema.messages.values())},
        "invalid": schema.invalid,
        "unknown": schema.unknown,
    }
    for name, table in rows.items():
        yield f"sizeof(struct protogen_row_{name})", table.row.size
    for name, table in rows.items():
        for path, position in _members(table):
            yield f"offsetof(struct protogen_row_{name}, {path})", position


def _members(table: TableSchema) -> Iterator[tuple[str, int]]:
    for column in table.columns:
        if column.role == "part":
            yield f"part_{column.source}", column.position
        elif column.role not in ("field", "count"):
            yield column.source, column.position
    if table.message is None or not table.fields:
        return
    # The struct's members have the names that the schema gives them.
    inner = message_record(table.message)
    base = table.fields[0].position - inner.columns[0].position
    for path, position in _inside(inner):
        yield f"message.{path}", base + position


def _inside(record: Record) -> Iterator[tuple[str, int]]:
    for column in record.columns:
        yield from _within(column, column.name, column.position)


def _within(column: Column, path: str, position: int) -> Iterator[tuple[str, int]]:
    yield path, position
    path += "[0]" * len(column.counts)
    if isinstance(column.shape, Record):
        for inner, place in _inside(column.shape):
            yield f"{path}.{inner}", position + place
    elif isinstance(column.shape, Choice):
        cases = [case for _, case in column.shape.cases]
        cases += [] if column.shape.rest is None else [column.shape.rest]
        for case in cases:
            for inner, place in _within(case, case.name, 0):
                yield f"{path}.{inner}", position + place
