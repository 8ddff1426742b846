"""What the fast engine of generated modules is made of.

Its functions take bytes and values that are in order. From anything else they raise, and the
reference (construct, and the machine of `machine.py`) decides and says what is wrong.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable
from typing import Any, Literal, Protocol, TypeVar

from protogen.runtime.dataclass import dataclass
from protogen.runtime.enums import Flags, OpenEnum
from protogen.runtime.events import UnknownEvent
from protogen.runtime.late import frame_formats
from protogen.runtime.number import ByteOrder, Number
from protogen.runtime.pairs import INTEGERS, PairCodes, PairLists, Pairs, Unclear, pair_values
from protogen.runtime.sender import Cutter, SenderSpec

AnyT = TypeVar("AnyT")


__all__ = [
    "ANYTHING",
    "BYTES",
    "INTEGERS",
    "Members",
    "PairCodes",
    "PairLists",
    "Pairs",
    "SevenBitFloat",
    "Tables",
    "Unclear",
    "checked",
    "closed",
    "frame_formats",
    "new",
    "seven_bit_float",
    "unknown",
]


class _New(Protocol):
    def __call__(self, cls: type[AnyT], /) -> AnyT: ...


new: _New = object.__new__
"""An object without the attributes that its class's `__init__` would set."""

ANYTHING = Exception
"""What a function of the fast engine may raise; a message may be called like the exception."""

BYTES = tuple(bytes((byte,)) for byte in range(256))
"""Each byte by its value."""


def unknown(
    sender: SenderSpec[Any, Any], offset: int, raw: bytes, numbers: tuple[int, ...], payload: bytes
) -> UnknownEvent[Any]:
    """The event of a valid frame whose identity belongs to no message."""
    return UnknownEvent(offset, raw, sender.name, sender.parts(*numbers), payload, sender)


def checked(wire: bytes, payload: bytes, cut: Cutter) -> bytes:
    """The frame, if a decoder takes exactly these bytes for it. Raises Unclear."""
    events: list[Any] = []
    if cut(wire, 0, 0, events) != len(wire) or [event.payload for event in events] != [payload]:
        raise Unclear
    return wire


# --- named values -------------------------------------------------------------------------------


class Tables:
    """Lists that readers look values up in, filled when a decoder first needs them."""

    def __init__(self) -> None:
        self.are_filled = False
        self._fillings: list[tuple[list[Any], Callable[[], Iterable[Any]]]] = []

    def fill(self) -> None:
        """Fill all lists, in place."""
        while self._fillings:
            table, values = self._fillings.pop()
            table += values()
        self.are_filled = True

    def _table(self, values: Callable[[], Iterable[Any]]) -> list[Any]:
        table: list[Any] = []
        self._fillings.append((table, values))
        return table

    def members(self, named: type[OpenEnum | Flags], bits: int) -> list[Any]:
        """The member of an enum or a set of flags for each value of so many bits."""
        return self._table(lambda: map(named, range(1 << bits)))

    def pairs(self, bits: int, signed: bool) -> list[Any]:
        """The integer of two bytes of 7 bits, by the 16 bits that `struct` reads.

        Only for bytes whose top bits are clear; padding bits that are set give None.
        """
        return self._table(lambda: pair_values(bits, signed))


_KEPT_MEMBERS = 4096
"""Members without a name that are kept; what comes off a wire must not fill the memory."""


class Members(dict[int, Any]):
    """The member of an enum or a set of flags for each raw value."""

    def __init__(self, named: type[OpenEnum | Flags]) -> None:
        super().__init__()
        self._named: Any = named

    def __missing__(self, raw: int) -> Any:
        member = self._named(raw)
        if len(self) < _KEPT_MEMBERS:
            self[raw] = member
        return member


def closed(named: type[OpenEnum]) -> dict[int, Any]:
    """The members of a closed enum by raw value."""
    return {int(member): member for member in named}


# --- floats of 7 bits a byte --------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class SevenBitFloat:
    """An IEEE 754 number whose bits are those of an unsigned integer, 7 bits a byte."""

    number: Number
    layout: struct.Struct

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
