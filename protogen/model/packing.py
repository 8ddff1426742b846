"""Packed numbers: their bits follow each other without byte boundaries."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import msgspec

from protogen.model.sizes import SizeSet
from protogen.runtime.payload.bits import BitOrder

ByteOrder = Literal["little", "big"]
_BYTE_ORDERS: dict[BitOrder, ByteOrder] = {"lsb_first": "little", "msb_first": "big"}


class BytePart(msgspec.Struct, frozen=True):
    """Bits of a number that lie in one byte."""

    byte: int
    """The byte, counted from the first of the run."""
    at: int
    """Bit of the byte where they begin, counted from its least significant one."""
    low: int
    """Bit of the number where they begin."""
    bits: int
    """How many there are."""

    @property
    def ends_byte(self) -> bool:
        """True if no bits of the byte are above them."""
        return self.at + self.bits == 8


class Packing(msgspec.Struct, frozen=True):
    """A run of so many bits. Those that are left in its last byte are zero.

    As an integer of these bytes in `byte_order`, the run has each number at `shift`.
    """

    order: BitOrder
    bits: int

    @property
    def size(self) -> int:
        """Wire bytes."""
        return -(-self.bits // 8)

    @property
    def sizes(self) -> SizeSet:
        """Wire bytes, as the only size that there is."""
        return SizeSet.exactly(self.size)

    @property
    def byte_order(self) -> ByteOrder:
        """The order of bytes in which the run is one integer."""
        return _BYTE_ORDERS[self.order]

    @property
    def padding(self) -> int:
        """Mask of the bits of the last byte that belong to no number."""
        left = 8 * self.size - self.bits
        mask = (1 << left) - 1
        return mask << 8 - left if self.order == "lsb_first" else mask

    def shift(self, first: int, bits: int) -> int:
        """Place of the least significant bit of the number whose bits begin at `first`."""
        return first if self.order == "lsb_first" else 8 * self.size - first - bits

    def parts(self, first: int, bits: int) -> Iterator[BytePart]:
        """Where the bits of a number lie, the least significant ones first."""
        low = self.shift(first, bits)
        for place in range(low // 8, (low + bits - 1) // 8 + 1):
            start, end = max(low, 8 * place), min(low + bits, 8 * place + 8)
            byte = place if self.order == "lsb_first" else self.size - 1 - place
            yield BytePart(byte, start - 8 * place, start - low, end - start)


class FilledPacking(msgspec.Struct, frozen=True):
    """Runs of as many numbers of `width` bits, 8 or more, as their bytes hold.

    The number of bytes tells that of the numbers: fewer than 8 bits are left in the last byte, and
    are zero.
    """

    order: BitOrder
    width: int

    @property
    def byte_order(self) -> ByteOrder:
        """The order of bytes in which a run is one integer."""
        return _BYTE_ORDERS[self.order]

    def size_of(self, count: int) -> int:
        """Wire bytes of so many numbers."""
        return -(-count * self.width // 8)

    def sizes_of(self, counts: SizeSet) -> SizeSet:
        """Wire bytes of any of these numbers of numbers."""
        step = 1 if self.width % 8 else self.width // 8 * counts.step
        return SizeSet.between(self.size_of(counts.least), self.size_of(counts.greatest), step)

    def run_of(self, count: int) -> Packing:
        """The run of so many numbers."""
        return Packing(self.order, count * self.width)
