"""Runs of bits: numbers that follow each other without byte boundaries.

`lsb_first`: bit k of the run is bit k % 8 of byte k // 8, and each number begins with its least
significant bit. `msb_first`: bit k is bit 7 - k % 8 of that byte, and each number begins with its
most significant bit. So a run is one great integer, of little-endian or of big-endian bytes.
"""

from __future__ import annotations

from typing import Literal

from protogen.runtime.errors import ByteError

BitOrder = Literal["lsb_first", "msb_first"]


class BitReader:
    """Takes numbers out of a run, one behind another."""

    def __init__(self, data: bytes, order: BitOrder) -> None:
        self._run = int.from_bytes(data, "little" if order == "lsb_first" else "big")
        self._left = 8 * len(data)
        self._from_least = order == "lsb_first"
        self.position = 0
        """Bits that were taken."""

    def take(self, bits: int) -> int:
        """The next number of so many bits, which have to be there."""
        self.position += bits
        self._left -= bits
        if self._from_least:
            value = self._run & ((1 << bits) - 1)
            self._run >>= bits
            return value
        value = self._run >> self._left
        self._run &= (1 << self._left) - 1
        return value

    def finish(self) -> None:
        """Raise ByteError if a bit behind the last number is set."""
        if self._run:
            raise ByteError("value", "the bits behind the last number have to be zero")


class BitWriter:
    """Puts numbers into a run, one behind another."""

    def __init__(self, order: BitOrder) -> None:
        self._run = 0
        self._from_least = order == "lsb_first"
        self.position = 0
        """Bits that were put."""

    def put(self, bits: int, value: int) -> None:
        """Put the lowest so many bits of a number behind the others."""
        raw = value & ((1 << bits) - 1)
        self._run = (
            self._run | raw << self.position if self._from_least else self._run << bits | raw
        )
        self.position += bits

    def finish(self) -> bytes:
        """The bytes of the run; bits that are left at the end of the last one are zero."""
        size = -(-self.position // 8)
        if self._from_least:
            return self._run.to_bytes(size, "little")
        return (self._run << 8 * size - self.position).to_bytes(size, "big")
