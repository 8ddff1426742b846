"""Parts of the generated modules' engine.

Its functions take bytes and values that are in order. From anything else they raise, and the
reference (construct, and the machine of `machine.py`) decides and says what is wrong.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Literal, Protocol, TypeVar

from protogen.runtime.bulk_cut import BulkCutter
from protogen.runtime.decoder import octets
from protogen.runtime.errors import ANYTHING, NeedsReference
from protogen.runtime.events import UnknownEvent
from protogen.runtime.formats import frame_formats
from protogen.runtime.framing.extraction import payload_of
from protogen.runtime.framing.frame import ValuePart
from protogen.runtime.framing.sender import Cutter, SenderSpec
from protogen.runtime.payload.enums import KEPT, Flags, OpenEnum
from protogen.runtime.payload.message import Message
from protogen.runtime.payload.number import BYTES, ByteOrder, Characters, GivenValue, Number
from protogen.runtime.payload.pairs import (
    PairLists,
    Pairs,
    pair_codes,
    pair_values,
)
from protogen.runtime.values import Frozen

AnyT = TypeVar("AnyT")
KeyT = TypeVar("KeyT")


__all__ = [
    "ANYTHING",
    "BYTES",
    "BulkCutter",
    "Heads",
    "Members",
    "NeedsReference",
    "Packers",
    "PairLists",
    "Pairs",
    "SevenBitFloat",
    "Tables",
    "add_encoders",
    "add_readers",
    "add_writers",
    "checked",
    "closed",
    "decoder",
    "frame_formats",
    "new",
    "octets",
    "seven_bit_float",
    "text",
    "unknown",
]


def text(characters: Characters) -> Callable[[Any], int]:
    """Reader of the number of some characters, which raises where the reference has to decide."""

    def number(value: Any) -> int:
        if type(value) is not str or not value.isascii():
            raise NeedsReference
        found = characters.number(value)
        if not characters.holds(found):
            raise NeedsReference
        return found

    return number


class _New(Protocol):
    def __call__(self, cls: type[AnyT], /) -> AnyT: ...


new: _New = object.__new__
"""An object without the attributes that its class's `__init__` would set."""


def unknown(
    sender: SenderSpec[Any, Any], offset: int, raw: bytes, numbers: tuple[int, ...], payload: bytes
) -> UnknownEvent[Any]:
    """The event of a valid frame whose identity belongs to no message."""
    return UnknownEvent(offset, raw, sender.name, sender.show(numbers), payload, sender)


def checked(wire: bytes, cut: Cutter) -> bytes:
    """The frame, if a decoder takes exactly these bytes for it. Raises NeedsReference.

    Then it finds the same payload in them, for all other parts have their sizes.
    """
    events: list[Any] = []
    if cut(wire, 0, 0, events) != len(wire) or len(events) != 1:
        raise NeedsReference
    return wire


def decoder(cut: Cutter, start: bytes = b"") -> Callable[[bytes], Any]:
    """Reader of the message of exactly one frame, which is cut as in a stream.

    `start` is what the frame has to begin with where the end of the one before could be its start.
    The reader raises NeedsReference where the bytes are not plainly one frame of a message.
    """

    def decode(frame: bytes) -> Any:
        if type(frame) is not bytes or not frame.startswith(start):
            raise NeedsReference
        events: list[Any] = []
        if cut(frame, 0, 0, events) != len(frame) or len(events) != 1:
            raise NeedsReference
        return events[0].message  # Events of unknown frames have none.

    return decode


def add_encoders(encoders: Mapping[type[Message], Callable[..., bytes]]) -> None:
    """Give each message of a module its encoder as a method: the shortest way from one to it."""
    for message, encoder in encoders.items():
        message.__encode__ = encoder  # type: ignore[method-assign]


def add_readers(
    readers: Mapping[type[Message], Callable[[bytes], Any]],
    tables: Tables | None = None,
    *,
    around: tuple[int, int] = (0, 0),
    seven_bit: bool = False,
) -> None:
    """Let messages read their payloads: `readers` want so many bytes `around` them.

    With `seven_bit`, they rely on every byte having its top bit clear.
    """
    front, behind = map(bytes, around)
    for message, read in readers.items():
        message.__read__ = _reader(message, read, tables, front, behind, seven_bit)


def _reader(
    message: type[Message],
    read: Callable[[bytes], Any],
    tables: Tables | None,
    front: bytes,
    behind: bytes,
    is_ascii: bool,
) -> Callable[[bytes], Any]:
    """The reader of one message's payloads alone."""
    sizes = message.SIZES

    def read_payload(payload: bytes) -> Any:
        if len(payload) not in sizes or (is_ascii and not payload.isascii()):
            raise NeedsReference
        if tables is not None and not tables.are_filled:
            tables.fill()
        return read(front + payload + behind)

    return read_payload


def add_writers(
    senders: Iterable[SenderSpec[Any, Any]],
    encoders: Mapping[type[Message], Callable[..., bytes]],
    arguments: tuple[str, ...] = (),
    tables: Tables | None = None,
) -> None:
    """Let messages write their payloads: what their encoders put into a frame.

    `arguments` are the names of the parts that callers of the encoders give.
    """
    for sender in senders:
        for message in (*sender.messages, *sender.encode_only):
            if message in encoders and message.__write__ is None:
                message.__write__ = _writer(sender, encoders, arguments, tables)


def _least(part: ValuePart) -> int | str:
    """The least value of a part, as callers give it."""
    number = part.number
    return number.text(part.least) if isinstance(number, Characters) else part.least


def _writer(
    sender: SenderSpec[Any, Any],
    encoders: Mapping[type[Message], Callable[..., bytes]],
    arguments: tuple[str, ...],
    tables: Tables | None,
) -> Callable[[Any], bytes]:
    """Function that gives the payloads of a sender's messages."""
    parts: list[GivenValue] | None = None

    def write_payload(message: Message) -> bytes:
        nonlocal parts
        if parts is None:
            least = {part.name: _least(part) for part in sender.layout.values}
            parts = [least.get(name) for name in arguments]
        if tables is not None and not tables.are_filled:
            tables.fill()
        payload = payload_of(sender, message.__encode__(encoders, sender.name, *parts))
        return sender.layout.payload.fitted(payload, message.__known__())

    return write_payload


# --- named values -------------------------------------------------------------------------------


class Tables:
    """Tables that readers or writers look values up in, filled when the first of them is called."""

    def __init__(self) -> None:
        self.are_filled = False
        self._fillings: list[Callable[[], object]] = []

    def fill(self) -> None:
        """Fill all tables, in place.

        Several threads may do so at once, and one may be interrupted: whoever comes through has
        filled all of them.
        """
        for filling in self._fillings:
            filling()
        self.are_filled = True

    def _list(self, values: Callable[[], Iterable[Any]]) -> list[Any]:
        table: list[Any] = []

        def filling() -> None:
            made = [*values()]  # Before it is known how long the table is.
            table[:] = made

        self._fillings.append(filling)
        return table

    def members(self, named: type[OpenEnum | Flags], bits: int) -> list[Any]:
        """The member of an enum or a set of flags for each value of so many bits."""
        return self._list(lambda: map(named, range(1 << bits)))

    def pairs(self, bits: int, signed: bool) -> list[Any]:
        """The integer of two bytes of 7 bits, by the 16 bits that `struct` reads.

        Only for bytes whose top bits are clear; padding bits that are set give None.
        """
        return self._list(lambda: pair_values(bits, signed))

    def narrow(self, bits: int) -> list[Any]:
        """The byte of each integer of fewer than 8 bits.

        Negative ones are at the end, where Python looks for them.
        """
        return self._list(lambda: range(1 << bits))

    def codes(self, bits: int) -> list[Any]:
        """The 16 bits that `struct` writes for each integer of two bytes of 7 bits.

        Negative ones are at the end, where Python looks for them.
        """
        return self._list(lambda: pair_codes(bits))


class _Remembered(dict[KeyT, Any]):
    """Results of a function, kept by key.

    Not all is kept: what a wire gives must not fill the memory.
    """

    def __init__(self, find: Callable[[KeyT], Any]) -> None:
        super().__init__()
        self._find = find

    def __missing__(self, key: KeyT) -> Any:
        found = self._find(key)
        if len(self) < KEPT:
            self[key] = found
        return found


class Heads(_Remembered[bytes]):
    """Numbers and readers of frames that begin alike, by bytes at their start."""


class Members(_Remembered[int]):
    """The member of an enum or a set of flags for each raw value."""


def closed(named: type[OpenEnum]) -> dict[int, Any]:
    """The members of a closed enum by raw value."""
    return {int(member): member for member in named}


# --- records in bulk ----------------------------------------------------------------------------


_PACKED = 1 << 16
"""A `struct` takes 32 bytes for each value: those of so many values are kept."""


class Packers(dict[int, Callable[..., bytes]]):
    """Packers of some values and so many records behind them, by the number of records.

    Where records come in very many numbers, not all are kept: together they would take memory that
    grows with the square of the greatest number.
    """

    def __init__(self, front: str, record: str) -> None:
        """`front` begins with the order of bytes; both are codes of `struct`."""
        super().__init__()
        self._front, self._record = front, record
        self._left = _PACKED

    def __missing__(self, count: int) -> Callable[..., bytes]:
        values = len(self._front) + len(self._record) * count
        if values > self._left:
            self.clear()
            self._left = _PACKED
        self._left -= values
        self[count] = pack = struct.Struct(self._front + self._record * count).pack
        return pack


# --- floats of 7 bits a byte --------------------------------------------------------------------


class SevenBitFloat(Frozen):
    """An IEEE 754 number whose bits are those of an unsigned integer, 7 bits a byte."""

    __slots__ = ("layout", "number")

    number: Number
    layout: struct.Struct

    def __init__(self, number: Number, layout: struct.Struct) -> None:
        self._set(number, layout)

    def decode(self, data: bytes) -> float:
        """The number of these bytes. Raises ByteError."""
        plain = self.number.decode(data).to_bytes(self.layout.size, "little")
        return float(self.layout.unpack(plain)[0])

    def encode(self, value: float) -> bytes:
        """The bytes of a number. Raises OverflowError."""
        return self.number.encode(int.from_bytes(self.layout.pack(value), "little"))


def seven_bit_float(bits: Literal[32, 64], order: ByteOrder) -> SevenBitFloat:
    """A float of 32 or 64 bits."""
    layout = struct.Struct("<f" if bits == 32 else "<d")
    return SevenBitFloat(Number(bits, order=order, seven_bit=True), layout)
