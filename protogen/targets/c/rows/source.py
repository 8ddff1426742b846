"""The C source that fills the tables of one sender: the generated decoder, and a driver."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from protogen.capture.schema import CaptureSchema, TableSchema
from protogen.model.frame_plan import StartRule
from protogen.model.protocol import Protocol, Sender
from protogen.targets.c.emit import Unit, c_environment, texts, unit_of
from protogen.targets.c.frame.decoder import DecoderView
from protogen.targets.c.frame.groups import GroupView
from protogen.targets.c.options import COptions
from protogen.targets.c.payload.messages import MessageView

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


def rows_source(
    protocol: Protocol, sender: Sender, schema: CaptureSchema, layout: Sequence[str]
) -> str:
    """The source: the decoder of what `sender` sends, and a driver around it.

    `layout` are expressions that the library tells the values of.
    """
    options = COptions(style="single", senders=(sender.name,))
    header, source = texts(protocol, options)
    unit = unit_of(protocol, options)
    decoder = next(item for item in unit.framing.decoders if item.name == sender.name)
    tables = tuple(
        _table(unit.module.message(name), table) for name, table in schema.messages.items()
    )
    spellings = [] if sender.plan.has_one_spelling else _spellings(unit, list(schema.messages))
    return (
        c_environment()
        .get_template("rows/driver.c.j2")
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
            layout=layout,
        )
    )


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
        and decoder.start is StartRule.SET
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
