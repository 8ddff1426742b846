"""Integers of two bytes of 7 bits each, by look-up and in bulk."""

from __future__ import annotations

import struct
import sys
from array import array
from collections.abc import Sequence
from functools import lru_cache

from protogen.runtime.errors import NeedsReference
from protogen.runtime.payload.number import ByteOrder, Number


class Pairs(dict[int, int]):
    """The integer for two bytes of 7 bits each, which `struct` reads as one of 16 bits."""

    def __init__(self, bits: int, signed: bool, order: ByteOrder) -> None:
        super().__init__()
        self._number = Number(bits, signed, order, seven_bit=True)

    def __missing__(self, code: int) -> int:
        self[code] = value = self._number.decode(code.to_bytes(2, self._number.order))
        return value


@lru_cache(16)
def pair_values(bits: int, signed: bool) -> tuple[int | None, ...]:
    """The integer for each 16 bits of two bytes with clear top bits; None where there is none."""
    great, sign = 1 << bits, 1 << bits - 1
    values: list[int | None] = [*range(great)]
    if signed:
        values[sign:] = range(-sign, 0)
    values += [None] * ((1 << 14) - great)
    found: list[int | None] = []
    for first in range(0, 1 << 14, 128):
        found += values[first : first + 128]
        found += [None] * 128  # The top bit of the lower byte is set.
    return tuple(found)


@lru_cache(16)
def pair_codes(bits: int) -> tuple[int, ...]:
    """The 16 bits of two bytes of 7 bits for each number of so many, as they are on the wire."""
    return tuple(raw + (raw & 0x3F80) for raw in range(1 << bits))


@lru_cache(64)
def _lanes(bits: int, count: int) -> tuple[int, int, int, int]:
    """Bits of a great integer that has `count` numbers of so many, each in 16 bits.

    The lower 7 of each number, the upper 7, those above a number's own, and that of its sign.
    """
    above = 0xFFFF >> bits << bits
    patterns = (0x007F, 0x3F80, above, 1 << bits - 1)
    low, high, above, sign = (
        int.from_bytes(pattern.to_bytes(2, "little") * count, "little") for pattern in patterns
    )
    return low, high, above, sign


_IS_SWAPPED = sys.byteorder == "big"


def _exchanged(data: bytes) -> bytes:
    """The bytes of numbers of 16 bits in the other order."""
    exchanged = bytearray(data)
    exchanged[0::2], exchanged[1::2] = data[1::2], data[0::2]
    return bytes(exchanged)


class PairLists:
    """Lists of such integers, all of them at once: each has 16 bits of one great integer."""

    def __init__(self, bits: int, signed: bool, order: ByteOrder) -> None:
        self.bits = bits
        self.signed = signed
        self.order = order

    def decode(self, data: bytes) -> list[int]:
        """The integers of an even number of bytes. Raises NeedsReference."""
        if not data.isascii():
            raise NeedsReference
        count = len(data) // 2
        low, _, above, sign = _lanes(self.bits, count)
        great = int.from_bytes(data if self.order == "little" else _exchanged(data), "little")
        lanes = great + (great & low) >> 1  # Twice the lower 7 bits, and 256 times the upper.
        if self.bits < 14 and lanes & above:
            raise NeedsReference
        if self.signed:
            # The sign bit is copied into all bits above it.
            lanes += (lanes & sign) * ((0x10000 >> self.bits - 1) - 2)
        plain = lanes.to_bytes(2 * count, "little")
        # An array makes a list at once, `struct` a tuple first.
        values = array("h" if self.signed else "H", plain)
        if _IS_SWAPPED:
            values.byteswap()
        return values.tolist()

    def encode(self, values: Sequence[int]) -> bytes:
        """The bytes of integers. Raises NeedsReference, or struct.error."""
        count = len(values)
        plain = struct.pack(f"<{count}{'h' if self.signed else 'H'}", *values)
        _, high, above, _ = _lanes(self.bits, count)
        lanes = int.from_bytes(plain, "little")
        if self.signed:
            # All bits from the sign bit on are alike.
            beside = (lanes ^ lanes << 1) & above
            lanes -= lanes & above
        else:
            beside = lanes & above
        if beside:
            raise NeedsReference
        great = lanes + (lanes & high)  # The upper 7 bits once more.
        data = great.to_bytes(2 * count, "little")
        return data if self.order == "little" else _exchanged(data)
