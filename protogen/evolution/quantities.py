"""Quantities that numbers stand for, whatever the unit: 0.1 m is 100 mm."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from protogen.model.types import Field

_BASES = frozenset(
    ["m", "s", "g", "V", "A", "W", "J", "N", "Pa", "Hz", "Ohm", "Ω", "F", "H", "T", "C", "S", "K"]
) | {"L", "l", "rad", "deg", "bar", "eV", "Wh", "Ah", "VA", "lm", "lx", "bit", "Bd"}
"""Units that take prefixes."""
_OTHERS = {
    "min": (Fraction(60), "s"),
    "h": (Fraction(3600), "s"),
    "d": (Fraction(86400), "s"),
    "t": (Fraction(10**6), "g"),
    "l": (Fraction(1), "L"),
    "Ω": (Fraction(1), "Ohm"),
    "ohm": (Fraction(1), "Ohm"),
    "%": (Fraction(1, 100), ""),
    "percent": (Fraction(1, 100), ""),
    "°": (Fraction(1), "deg"),
    "degrees": (Fraction(1), "deg"),
    "inch": (Fraction(254, 10**4), "m"),
    "ft": (Fraction(3048, 10**4), "m"),
}
"""Units that are a multiple of another one."""
_PREFIXES = {
    "T": Fraction(10**12),
    "G": Fraction(10**9),
    "M": Fraction(10**6),
    "k": Fraction(10**3),
    "d": Fraction(1, 10),
    "c": Fraction(1, 100),
    "h": Fraction(100),
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
    """The unit in units without prefixes, and the factor that leads there."""
    first, *below = unit.split("/")
    factor, words = _simple(first)
    for item in below:
        divisor, name = _simple(item)
        factor, words = factor / divisor, f"{words}/{name}"
    return factor, words


def _simple(unit: str) -> tuple[Fraction, str]:
    if unit in _OTHERS:
        return _OTHERS[unit]
    factor = _PREFIXES.get(unit[:1])
    if unit in _BASES or factor is None or unit[1:] not in _BASES:
        return Fraction(1), unit
    other, name = _OTHERS.get(unit[1:], (Fraction(1), unit[1:]))
    return factor * other, name
