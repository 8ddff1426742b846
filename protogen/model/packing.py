"""Packed numbers: their bits follow each other without byte boundaries."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import msgspec

from protogen.runtime.payload.bits import BitOrder


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
    def byte_order(self) -> Literal["little", "big"]:
        """The order of bytes in which the run is one integer."""
        return "little" if self.order == "lsb_first" else "big"

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
