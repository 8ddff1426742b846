"""The C source that fills the tables of one sender: the generated decoder, and a driver."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

import msgspec

from protogen.capture.schema import CaptureSchema, TableSchema
from protogen.model.protocol import Protocol, Sender
from protogen.targets.c.decoders.decoder import DecoderView
from protogen.targets.c.emit import Unit, c_environment, texts, unit_of
from protogen.targets.c.frame.fill import Fill
from protogen.targets.c.frame.numbers import PartView, ToldView
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
        return f"&row->message, event->payload{size}{self.view.given('event->parts.')}"


class _Spelling(msgspec.Struct, frozen=True):
    """The function that makes the frame of a message again."""

    number: int
    """Of its table."""
    function: str
    room: str
    message: str
    """The row's message; empty where there is none."""
    parts: str

    @property
    def call(self) -> str:
        """The call that makes the frame of a row."""
        given = f"{self.message}{self.parts}, frame, {self.room}"
        return f"{self.function}({given.removeprefix(', ')})"


class _Part(msgspec.Struct, frozen=True):
    """A part of the frame as a row has it: a text as characters, not as a number."""

    view: ToldView | PartView

    @property
    def declared(self) -> str:
        """Its declaration."""
        size = f"[{self._size}]" if self._is_text else ""
        return f"{'char' if self._is_text else self.view.type} {self._name}{size}"

    @property
    def fill(self) -> tuple[str, ...]:
        """The statements that fill it."""
        member, value = f"row->{self._name}", f"event->parts.{self.view.member}"
        if not self._is_text:
            return (f"{member} = {value};",)
        return tuple(
            f"{member}[{index}] = (char)({value} >> {shift} & {self._mask});"
            for index, shift in self._characters
        )

    @property
    def value(self) -> str:
        """Its number, out of the row."""
        member = f"row->{self._name}"
        if not self._is_text:
            return member
        each = (
            f"({self.view.type})(uint8_t){member}[{index}] << {shift}"
            for index, shift in self._characters
        )
        return f"({self.view.type})({' | '.join(each)})"

    @property
    def _name(self) -> str:
        return f"part_{self.view.name}"

    @property
    def _is_text(self) -> bool:
        return self.view.part.type.is_text

    @property
    def _size(self) -> int:
        return self.view.part.type.size

    @property
    def _mask(self) -> str:
        return "0x7FU" if self.view.part.type.byte_bits == 7 else "0xFFU"

    @property
    def _characters(self) -> Iterator[tuple[int, int]]:
        """The place of each character in the text and in the number."""
        bits = self.view.part.type.byte_bits
        return ((index, bits * (self._size - 1 - index)) for index in range(self._size))


_Parts = Mapping[str, _Part]


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
        strict=False,
    )
    header, source = texts(protocol, options, fill=fill)
    unit = unit_of(protocol, options)
    decoder = next(item for item in unit.framing.decoders if item.name == sender.name)
    tables = tuple(
        _table(unit.module.message(name), table) for name, table in schema.messages.items()
    )
    parts = {view.name: _Part(view) for view in decoder.parts}
    spellings = []
    if not sender.plan.has_one_spelling:
        spellings = _spellings(unit, list(schema.messages), parts)
    return (
        c_environment()
        .get_template("rows/driver.c.j2")
        .render(
            p=decoder.prefix,
            upper=unit.module.upper,
            whole=decoder.whole,
            parts=tuple(parts.values()),
            header=header,
            source=source,
            tables=tables,
            spellings=spellings,
            wrapped=_wrapped(unit, decoder, parts) if spellings else "",
            layout=layout,
        )
    )


def _spellings(unit: Unit, tables: list[str], parts: _Parts) -> list[_Spelling]:
    return [
        _Spelling(
            tables.index(item.message.name),
            item.called.function,
            item.called.room,
            "&row->message" if item.view.struct else "",
            _of_row([argument.part for argument in item.arguments], parts),
        )
        for item in unit.framing.messages
        if item.message.name in tables
    ]


def _wrapped(unit: Unit, decoder: DecoderView, parts: _Parts) -> str:
    """The arguments of the parts that go into a frame of unknown identity beside the payload.

    What is not sent has its default there. Without one there are no such frames, as none of them
    can be verified.
    """
    frame = next(it.frame for it in unit.framing.messages if it.frame.decoder is decoder)
    identity = _of_row([argument.part for argument in frame.identity], parts)
    virtual = "".join(f", {item.default or item.constant or '0'}" for item in decoder.virtual)
    return identity + virtual + _of_row([it.part for it in frame.arguments], parts)


def _of_row(names: Iterable[str], parts: _Parts) -> str:
    """Arguments behind others: the values that a row has of these parts."""
    return "".join(f", {parts[name].value}" for name in names)


def _table(view: MessageView, table: TableSchema) -> _Table:
    holes = table.holes
    clears = holes is None or table.row.size <= _SMALL
    return _Table(view, clears, () if clears else holes or (), bool(table.fields))
