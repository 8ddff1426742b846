"""Floats as bounds: the one that is nearest to a number, and not beyond it."""

from __future__ import annotations

import struct
from ctypes import c_float
from fractions import Fraction
from math import copysign, inf, isfinite, nextafter


def float_within(bound: Fraction, bits: int, *, up: bool) -> float:
    """The float that is nearest to a bound, but not beyond it."""
    value = float(bound) if bits == 64 else c_float(float(bound)).value
    while isfinite(value) and (value < bound if up else value > bound):
        value = _next(value, bits, inf if up else -inf)
    return value


def _next(value: float, bits: int, towards: float) -> float:
    if bits == 64:
        return nextafter(value, towards)
    if value == 0:
        return copysign(2.0**-149, towards)
    pattern = struct.unpack("<i", struct.pack("<f", value))[0]
    pattern += 1 if (value > 0) == (towards > 0) else -1
    found: float = struct.unpack("<f", struct.pack("<i", pattern))[0]
    return found
