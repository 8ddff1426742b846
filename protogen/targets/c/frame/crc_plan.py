"""How a CRC takes bytes: which shifts of a byte, or which tables, make up for its eight bits.

All of it follows from width, polynomial and bit order. A byte that enters is xored with the byte of
the register that is shifted out. What this leaves behind is the remainder of a division by the
polynomial, which is linear: the xor of those of the byte's halves, or of shifts of the byte.
"""

from __future__ import annotations

from functools import reduce
from operator import xor

import msgspec

from protogen.model.checksums import ChecksumSpec
from protogen.model.types import storage_bits
from protogen.runtime.checksum import reversed_bits

BLOCK = 4
"""Bytes that hosts take at once."""
_MAX_SHIFTS = 4
"""Shifts of a byte that cost a machine with registers of one byte less than its tables."""
_MAX_SHIFTED_BITS = 16
"""Widest register that is put together of shifted bytes."""


class Register(msgspec.Struct, frozen=True):
    """A CRC's register as it is kept.

    Where bytes enter most significant bit first it lies in the upper bits: no width needs a mask.
    """

    bits: int
    """Bits of the number that holds it."""
    poly: int
    """What it is xored with where a one is shifted out."""
    init: int
    reflected: bool
    """True if it is shifted right, and bytes enter least significant bit first."""
    spare: int
    """Bits below the lowest one of the CRC."""

    def after(self, byte: int, count: int) -> int:
        """The register after that byte and so many bits in all, if it was zero before."""
        value = byte if self.reflected else byte << (self.bits - 8)
        for _ in range(count):
            value = self._shifted(value)
        return value

    def _shifted(self, value: int) -> int:
        if self.reflected:
            return (value >> 1) ^ (self.poly if value & 1 else 0)
        top = value >> (self.bits - 1)
        return ((value << 1) & ((1 << self.bits) - 1)) ^ (self.poly if top else 0)

    @property
    def terms(self) -> tuple[int, ...]:
        """Powers of the polynomial but the greatest, which is the number of `bits`."""
        poly = reversed_bits(self.poly, self.bits) if self.reflected else self.poly
        return tuple(place for place in range(self.bits) if poly >> place & 1)


class Shifts(msgspec.Struct, frozen=True):
    """The remainder of a byte as the xor of shifts; those to the right are negative.

    `quotient` are shifts of the byte, and `product` shifts of their xor into the register.
    """

    quotient: tuple[int, ...]
    product: tuple[int, ...]

    @property
    def count(self) -> int:
        """Shifts that are no copies."""
        return sum(shift % 8 != 0 for shift in (*self.quotient, *self.product))


class CrcPlan(msgspec.Struct, frozen=True):
    """How a CRC is stepped."""

    register: Register
    shifts: Shifts | None
    """None where the table takes less."""
    table: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]
    """For bytes with 0 to 3 more behind them: the remainders of lower halves, and of upper ones."""


def crc_plan(spec: ChecksumSpec) -> CrcPlan:
    """The plan of a CRC."""
    register = register_of(spec)
    shifts = _shifts(register)
    affordable = register.bits <= _MAX_SHIFTED_BITS and shifts.count <= _MAX_SHIFTS
    table = tuple(_halves(register, 8 * more + 8) for more in range(BLOCK))
    return CrcPlan(register, shifts if affordable else None, table)


def register_of(spec: ChecksumSpec) -> Register:
    """The register of a CRC."""
    bits, width = storage_bits(spec.width), spec.width
    if spec.refin:
        return Register(
            bits, reversed_bits(spec.poly, width), reversed_bits(spec.init, width), True, 0
        )
    spare = bits - width
    return Register(bits, spec.poly << spare, spec.init << spare, False, spare)


def _halves(register: Register, count: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
    low = tuple(register.after(half, count) for half in range(16))
    high = tuple(register.after(half << 4, count) for half in range(16))
    return low, high


def _shifts(register: Register) -> Shifts:
    """The shifts by which bytes are divided, and the quotient is multiplied.

    Each bit of the quotient is the byte's, xored with those bits of the quotient above it that the
    polynomial's terms bring down. That treats all bits alike, so that it is a set of shifts.
    """
    downs = [register.bits - term for term in register.terms]
    quotient: list[int] = []
    for shift in range(8):
        if reduce(xor, (shift - down in quotient for down in downs), shift == 0):
            quotient.append(shift)
    if register.reflected:  # The same in a mirror, where the byte lies at the other end.
        product = tuple(register.bits - 8 - term for term in register.terms)
        return Shifts(tuple(quotient), product)
    return Shifts(tuple(-shift for shift in quotient), register.terms)
