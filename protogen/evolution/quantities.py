"""Quantities that numbers stand for, whatever the unit: 0.1 m is 100 mm."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from protogen.model.types import Field

_BASES = frozenset(["m", "s", "g", "V", "A", "W", "J", "N", "Pa", "Hz", "Ohm", "F", "T", "rad"])
_PREFIXES = {
    "G": Fraction(10**9),
    "M": Fraction(10**6),
    "k": Fraction(10**3),
    "d": Fraction(1, 10),
    "c": Fraction(1, 100),
    "m": Fraction(1, 10**3),
    "u": Fraction(1, 10**6),
    "µ": Fraction(1, 10**6),
    "n": Fraction(1, 10**9),
}


class Meaning(NamedTuple):
    """Meaning of a raw value: `raw * scale + offset` of the unit."""

    scale: Fraction
    offset: Fraction
    unit: str
    """Without a prefix where it is known to have one: `m/s` for `mm/s`."""


def meaning_of(field: Field) -> Meaning:
    """Meaning of the raw values of a number."""
    factor, unit = _without_prefix(field.unit or "")
    return Meaning(field.scale * factor, field.offset * factor, unit)


def quantity(field: Field, raw: int | float) -> tuple[Fraction, str] | None:
    """The quantity that a raw value stands for; None for what is no finite number."""
    if isinstance(raw, float) and raw - raw != 0:
        return None
    meaning = meaning_of(field)
    return Fraction(raw) * meaning.scale + meaning.offset, meaning.unit


def _without_prefix(unit: str) -> tuple[Fraction, str]:
    first, slash, rest = unit.partition("/")
    factor = _PREFIXES.get(first[:1])
    if first in _BASES or factor is None or first[1:] not in _BASES:
        return Fraction(1), unit
    return factor, f"{first[1:]}{slash}{rest}"
