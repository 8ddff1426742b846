"""Bounds of floats, as C compares with them."""

from __future__ import annotations

import struct
from fractions import Fraction
from math import copysign, isfinite

from protogen.model.floats import float_within


def float_literal(bound: Fraction, *, up: bool) -> str:
    """The number that a float is compared with.

    The cast makes it a float also where constants have more digits than their type.
    """
    value = float_within(bound, 32, up=up)
    if not isfinite(value):
        value = copysign((2 - 2**-23) * 2.0**127, value)
    text = f"{value:.9g}"
    return f"(float){text}f" if "." in text or "e" in text else f"(float){text}.0f"


def float_order(value: float) -> int:
    """The place of a float among all of them."""
    bits: int = struct.unpack("<Q", struct.pack("<d", value))[0]
    return bits ^ ((1 << 64) - 1) if bits >> 63 else bits | 1 << 63
