"""What the fast engine of generated modules is made of.

Its functions take bytes and values that are in order. From anything else they raise, and the
reference (construct, and the machine of `machine.py`) decides and says what is wrong.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal, Protocol, TypeVar

from protogen.runtime.enums import Flags, OpenEnum
from protogen.runtime.events import UnknownEvent
from protogen.runtime.message import Message
from protogen.runtime.number import ByteOrder, Number
from protogen.runtime.sender import SenderSpec

AnyT = TypeVar("AnyT")


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


INTEGERS = frozenset((int,))
"""What the types of all elements of an array of integers are."""


@dataclass(frozen=True, slots=True)
class SenderWriters:
    """What makes the frames of one sender: a function for the frame, and one for each payload."""

    sender: str
    frame: Callable[..., bytes]
    writers: Mapping[type[Message], Callable[[Any], bytes]]


Encoders = dict[
    tuple[type[Message], str | None],
    tuple[Callable[[Any], bytes], Callable[..., bytes], tuple[int, ...]],
]
"""What makes a payload and a frame, and the identity, by message and sender; None: the only one."""


def encoders(*senders: SenderWriters) -> Encoders:
    """The table that `encode` looks up."""
    table: Encoders = {}
    for sender in senders:
        for message, write in sender.writers.items():
            entry = (write, sender.frame, message.IDENTITY)
            table[message, sender.sender] = entry
            if len(message.SENDERS) == 1:
                table[message, None] = entry
    return table


class Unclear(Exception):  # noqa: N818 - it is no error: the reference decides
    """These bytes or values are not plainly in order."""


# --- named values -------------------------------------------------------------------------------

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


# --- integers of two bytes of 7 bits ------------------------------------------------------------


class Pairs(dict[int, int]):
    """The integer for two bytes of 7 bits each, which `struct` reads as one of 16 bits."""

    def __init__(self, bits: int, signed: bool, order: ByteOrder) -> None:
        super().__init__()
        self._number = Number(bits, signed, order, seven_bit=True)

    def __missing__(self, code: int) -> int:
        self[code] = value = self._number.decode(code.to_bytes(2, self._number.order))
        return value


class PairCodes(dict[int, int]):
    """The other way: what `struct` writes as 16 bits for an integer."""

    def __init__(self, bits: int, signed: bool, order: ByteOrder) -> None:
        super().__init__()
        self._number = Number(bits, signed, order, seven_bit=True)

    def __missing__(self, value: int) -> int:
        self[value] = code = int.from_bytes(self._number.encode(value), self._number.order)
        return code


@lru_cache(256)
def _lanes(pattern: int, count: int) -> int:
    """A pattern of 16 bits, `count` times."""
    return int.from_bytes(pattern.to_bytes(2, "little") * count, "little")


@dataclass(frozen=True, slots=True)
class PairLists:
    """Lists of such integers, all of them at once: each has 16 bits of one great integer."""

    bits: int
    signed: bool
    order: ByteOrder

    def decode(self, data: bytes) -> list[int]:
        """The integers of an even number of bytes. Raises Unclear."""
        count = len(data) // 2
        great = self._in_order(data)
        lanes = great & _lanes(0x007F, count) | great >> 1 & _lanes(0x3F80, count)
        if great & _lanes(0x8080, count) or lanes & _lanes(0x3FFF >> self.bits << self.bits, count):
            raise Unclear
        if self.signed:
            # The sign bit is copied into all bits above it.
            sign = 1 << self.bits - 1
            lanes += (lanes & _lanes(sign, count)) * ((0x10000 >> self.bits - 1) - 2)
        plain = lanes.to_bytes(2 * count, "little")
        return list(struct.unpack(f"<{count}{'h' if self.signed else 'H'}", plain))

    def encode(self, values: Sequence[int]) -> bytes:
        """The bytes of integers. Raises Unclear, or struct.error."""
        if not set(map(type, values)) <= INTEGERS:
            raise Unclear
        count = len(values)
        plain = struct.pack(f"<{count}{'h' if self.signed else 'H'}", *values)
        lanes = int.from_bytes(plain, "little")
        above = 0xFFFF >> self.bits << self.bits
        if self.signed:
            # All bits from the sign bit on are alike.
            beside = (lanes ^ lanes << 1) & _lanes(above, count)
            lanes &= _lanes(0xFFFF ^ above, count)
        else:
            beside = lanes & _lanes(above, count)
        if beside:
            raise Unclear
        great = lanes & _lanes(0x007F, count) | (lanes & _lanes(0x3F80, count)) << 1
        return self._in_order(great.to_bytes(2 * count, "little")).to_bytes(2 * count, "little")

    def _in_order(self, data: bytes) -> int:
        """The great integer whose lanes have the lower 7 bits in their lower byte; and back."""
        if self.order == "little":
            return int.from_bytes(data, "little")
        swapped = bytearray(data)
        swapped[0::2], swapped[1::2] = data[1::2], data[0::2]
        return int.from_bytes(swapped, "little")


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
