"""The C source that fills the tables of one sender: the generated decoder, and a driver."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from protogen.capture.schema import CaptureSchema, TableSchema
from protogen.model.protocol import Protocol, Sender
from protogen.targets.c.decoders.decoder import DecoderView
from protogen.targets.c.emit import Unit, c_environment, texts, unit_of
from protogen.targets.c.frame.fill import Fill
from protogen.targets.c.options import COptions
from protogen.targets.c.payload.messages import MessageView

_SMALL = 64
"""Clearing so many bytes costs no more than finding the few between the members."""


class _Table(msgspec.Struct, frozen=True):
    view: MessageView
    clears: bool
    """True if the row is cleared before it is filled."""
    holes: tuple[range, ...]
    """Else, the bytes that lie between its members."""
    loads: bool

    @property
    def loaded(self) -> str:
        """Arguments of the function that reads a payload."""
        size = ", event->payload_size" if self.view.fixed is None else ""
        return f"&row->message, event->payload{size}"


class _Spelling(msgspec.Struct, frozen=True):
    """The function that makes the frame of a message again."""

    number: int
    """Of its table."""
    function: str
    room: str
    parts: tuple[str, ...]

    @property
    def call(self) -> str:
        """The call that makes the frame of a row."""
        return f"{self.function}(&row->message{_of_row(self.parts)}, frame, {self.room}, &size)"


def rows_source(
    protocol: Protocol, sender: Sender, schema: CaptureSchema, layout: Sequence[str]
) -> str:
    """The source: the decoder of what `sender` sends, and a driver around it.

    `layout` are expressions that the library tells the values of.
    """
    options = COptions(style="single", senders=(sender.name,))
    fill = Fill(
        deliver="protogen_take",
        messages={name: f"protogen_fill_{i}" for i, name in enumerate(schema.messages)},
        storage="PROTOGEN_INLINE",
    )
    header, source = texts(protocol, options, fill=fill)
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
            source=source,
            tables=tables,
            spellings=spellings,
            wrapped=_wrapped(unit, decoder) if spellings else "",
            layout=layout,
        )
    )


def _spellings(unit: Unit, tables: list[str]) -> list[_Spelling]:
    return [
        _Spelling(
            tables.index(item.message.name),
            item.called.function,
            item.called.room,
            tuple(argument.part for argument in item.arguments),
        )
        for item in unit.framing.messages
        if item.message.name in tables
    ]


def _wrapped(unit: Unit, decoder: DecoderView) -> str:
    """The arguments of the parts that go into a frame beside the payload."""
    frame = next(it.frame for it in unit.framing.messages if it.frame.decoder is decoder)
    return _of_row([argument.part for argument in (*frame.identity, *frame.arguments)])


def _of_row(parts: Sequence[str]) -> str:
    """Arguments behind others: the values that a row has of these parts."""
    return "".join(f", row->part_{part}" for part in parts)


def _table(view: MessageView, table: TableSchema) -> _Table:
    holes = table.holes
    clears = holes is None or table.row.size <= _SMALL
    return _Table(view, clears, () if clears else holes or (), bool(table.fields))
