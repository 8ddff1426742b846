"""Numbers of many frames at once: arrays whose last axis are the bytes of one number on the wire.

Each function gives the values and which of them are wrong: bytes that no value has.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from protogen.capture.arrays import numpy
from protogen.model.types import Float, Integer

if TYPE_CHECKING:
    from protogen.capture.tables import Rows

Values = tuple["Rows", "Rows | None"]
"""Values, and which of them are wrong; None: nothing is."""

_NATIVE = (1, 2, 4, 8)
"""Bytes of an integer that NumPy reads by itself."""


def integers(octets: Rows, type_: Integer) -> Values:
    """Integers, or truth values."""
    if type_.role == "bool":
        found = octets[..., 0]
        return found == 1, seen(found > 1)
    values, wrong = _unsigned(octets, type_)
    if type_.signed and values.dtype.kind == "u":
        values = _signed(values, type_.bits)
    if type_.enum is not None and type_.enum.closed:
        known = [item.value for item in type_.enum.values]
        strange = ~numpy().isin(values, numpy().array(known, values.dtype))
        wrong = either(wrong, seen(strange))
    return values, wrong


def floats(octets: Rows, type_: Float) -> Values:
    """IEEE 754 numbers."""
    if type_.byte_bits == 8:
        values, wrong = octets.view(f"{_order(type_)}f{type_.size}")[..., 0], None
    else:
        bits = Integer(bits=type_.bits, byte_bits=7, byte_order=type_.byte_order)
        numbers, wrong = _unsigned(octets, bits)
        values = numbers.astype(f"u{type_.bits // 8}").view(f"f{type_.bits // 8}")
    return (_quiet(values) if type_.bits == 32 else values), wrong


def seen(mask: Rows) -> Rows | None:
    """The mask, if anything in it is set."""
    return mask if mask.any() else None


def either(one: Rows | None, other: Rows | None) -> Rows | None:
    """What is set in one of the masks."""
    if one is None or other is None:
        return other if one is None else one
    found: Rows = one | other
    return found


def _order(type_: Integer | Float) -> str:
    return "<" if type_.byte_order == "little" else ">"


def _unsigned(octets: Rows, type_: Integer) -> Values:
    """Integers of such bytes; only those of native size and 8-bit bytes have their sign."""
    size = type_.size
    if type_.byte_bits == 8 and type_.bits == 8 * size and size in _NATIVE:
        code = f"{_order(type_)}{'i' if type_.signed else 'u'}{size}"
        return octets.view(code)[..., 0], None
    if type_.byte_bits == 7 and size == 2:
        return _pairs(octets, type_)
    return _joined(octets, type_)


def _pairs(octets: Rows, type_: Integer) -> Values:
    """Two bytes of 7 bits."""
    words = octets.view(f"{_order(type_)}u2")[..., 0]
    # The greatest array there is: a turn of a lidar has 360 of them.
    values = words & 0x7F
    values |= (words >> 1) & 0x3F80
    unused = 0x8080 | (0x7F00 & ~((1 << type_.bits - 7) - 1 << 8))
    return values.astype("u2", copy=False), _with_bits(words, unused)


def _with_bits(words: Rows, bits: int) -> Rows | None:
    """Which have one of the bits."""
    if not int(numpy().bitwise_or.reduce(words, axis=None)) & bits:
        return None
    found: Rows = (words & bits) != 0
    return found


def _joined(octets: Rows, type_: Integer) -> Values:
    """Any other number, byte by byte from the least on."""
    size, width = type_.size, type_.byte_bits
    places = range(size) if type_.byte_order == "little" else range(size - 1, -1, -1)
    code = next(f"u{size}" for size in _NATIVE if type_.bits <= 8 * size)
    values = numpy().zeros(octets.shape[:-1], code)
    wrong = None
    for index, place in enumerate(places):
        byte = octets[..., place]
        # All bits that are not used lie in the last byte.
        carried = min(width, type_.bits - width * index)
        if carried < 8:
            wrong = either(wrong, seen(byte >> carried != 0))
        values |= byte.astype(code) << numpy().array(width * index, code)
    return values, wrong


def _signed(values: Rows, bits: int) -> Rows:
    """The numbers whose two's complement in so many bits that is."""
    wide = values.astype("u8").view("i8") if bits > 31 else values.astype("i4")
    if bits == 64:
        return wide
    sign = 1 << (bits - 1)
    found: Rows = (wide ^ sign) - sign
    return found


def _quiet(values: Rows) -> Rows:
    """Signalling NaNs as Python reads them: quiet."""
    strange = numpy().isnan(values)
    if not strange.any():
        return values
    bits = values.view(values.dtype.str.replace("f", "u")).astype("u4")
    bits[strange] |= 1 << 22
    found: Rows = bits.view("f4")
    return found
