"""Texts of units, such as `2 cm` or `cycles / 256`, to a scale and a unit."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

import msgspec

from protogen.importing.schema_text import Number
from protogen.schema.text.scalars import exact_number

_NUMBER = r"\d+(?:\.\d+)?(?:[eE][-+]?\d+)?"
_POWER = rf"\(?\s*({_NUMBER})\s*\^\s*(-?\d+)\s*\)?"
_WHOLE = re.compile(rf"(?:({_NUMBER})|{_POWER})")
_IN_FRONT = re.compile(rf"({_NUMBER})(?:\s*/\s*({_NUMBER}))?(?:\s*\*)?\s+(\D.*)")
_BEHIND = re.compile(rf"(.*\S)\s*([*/])\s*(?:({_NUMBER})|{_POWER})")
_REMARK = re.compile(r"(.*[^\s*/])\s+(\([a-z]+ [^()]*\))")
_LARGEST_EXPONENT = 64

_SAME = {
    "degrees": "deg",
    "degrees C": "degC",
    "hours": "h",
    "hz": "Hz",
    "microseconds": "us",
    "milliseconds": "ms",
    "minutes": "min",
    "nanoseconds": "ns",
    "percent": "%",
    "seconds": "s",
}
_PARTS = {
    "deciseconds": (Fraction(1, 10), "s"),
    "deci-seconds": (Fraction(1, 10), "s"),
    "mdeg": (Fraction(1, 1000), "deg"),
    "microdegrees": (Fraction(1, 10**6), "deg"),
    "microdegrees/s": (Fraction(1, 10**6), "deg/s"),
    "microteslas": (Fraction(1), "uT"),
    "udeg": (Fraction(1, 10**6), "deg"),
}
_NONE = frozenset({"", "N/A", "n/a", "none", "boolean", "1"})


class Unit(msgspec.Struct, frozen=True):
    """Unit of a field, and the scale that leads from the raw value to it."""

    unit: str | None = None
    scale: str | None = None
    """Exact number as a schema has it; None is 1."""
    remark: str = ""
    """What stands behind the unit in brackets, which is for people."""

    @property
    def keys(self) -> dict[str, Any]:
        """The keys of a field that say it."""
        data: dict[str, Any] = {}
        if self.scale is not None:
            data["scale"] = Number(self.scale)
        if self.unit is not None:
            data["unit"] = self.unit
        return data


def read_unit(text: str) -> Unit:
    """Return what a text says of a unit.

    Only a number in front, a divisor or a factor behind is a scale. A power of ten behind `*` is
    none: `m*10` may mean that the value was multiplied or that it has to be. Such a text stays.
    """
    text = " ".join(text.split())
    found = _REMARK.fullmatch(text)
    if found is not None:
        return _scaled(found[1], found[2])
    return _scaled(text, "")


def _scaled(text: str, remark: str) -> Unit:
    if text in _NONE:
        return Unit(remark=remark)
    factor, unit = _split(text)
    part, unit = _PARTS.get(unit, (Fraction(1), _SAME.get(unit, unit)))
    scale = factor * part
    return Unit(_bare(unit) or None, written_scale(scale), remark)


def _split(text: str) -> tuple[Fraction, str]:
    """Return the factor in a text and the unit that is left of it."""
    if found := _WHOLE.fullmatch(text):
        factor = _number(*found.groups())
        return (Fraction(1), text) if factor is None else (factor, "")
    if found := _IN_FRONT.fullmatch(text):
        factor, divisor = _number(found[1]), _number(found[2] or "1")
        if factor and divisor:
            return factor / divisor, found[3]
    if found := _BEHIND.fullmatch(text):
        factor = _number(*found.groups()[2:])
        if factor and found[2] == "/":
            return 1 / factor, found[1]
        if factor and not _is_power_of_ten(factor):
            return factor, found[1]
    return Fraction(1), text


def _number(
    plain: str | None, base: str | None = None, exponent: str | None = None
) -> Fraction | None:
    if plain is not None:
        return exact_number(plain)
    number = exact_number(base or "")
    power = int(exponent or "0")
    if not number or abs(power) > _LARGEST_EXPONENT:
        return None
    return number**power


def _is_power_of_ten(number: Fraction) -> bool:
    return number > 1 and number.denominator == 1 and str(number).rstrip("0") == "1"


def _bare(unit: str) -> str:
    """Return a unit without brackets around all of it, and without spaces around `/`."""
    if unit.startswith("(") and unit.endswith(")") and unit.count("(") == 1:
        unit = unit[1:-1]
    return re.sub(r"\s*/\s*", "/", unit)


def written_scale(scale: Fraction) -> str | None:
    """Return a scale as a schema has it: a decimal number if that is short, else a fraction."""
    if scale == 1:
        return None
    decimal = f"{float(scale):.6f}".rstrip("0").rstrip(".")
    return decimal if Fraction(decimal) == scale else str(scale)
