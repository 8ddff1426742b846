"""Units of MAVLink -> a scale and a unit of a schema."""

from __future__ import annotations

from fractions import Fraction

from protogen.importing.units import Unit, written_scale

_PARTS = {
    "c%": (Fraction(1, 100), "%"),
    "cA": (Fraction(1, 100), "A"),
    "cV": (Fraction(1, 100), "V"),
    "cdeg": (Fraction(1, 100), "deg"),
    "cdeg/s": (Fraction(1, 100), "deg/s"),
    "cdegC": (Fraction(1, 100), "degC"),
    "cs": (Fraction(1, 100), "s"),
    "d%": (Fraction(1, 10), "%"),
    "dam": (Fraction(10), "m"),
    "ddeg/s": (Fraction(1, 10), "deg/s"),
    "deg/2": (Fraction(2), "deg"),
    "degE5": (Fraction(1, 10**5), "deg"),
    "degE7": (Fraction(1, 10**7), "deg"),
    "dm": (Fraction(1, 10), "m"),
    "dm/s": (Fraction(1, 10), "m/s"),
    "dpix": (Fraction(1, 10), "pix"),
    "ds": (Fraction(1, 10), "s"),
    "hJ": (Fraction(100), "J"),
    "m/s*5": (Fraction(1, 5), "m/s"),
}
"""Units that are a part or a multiple of one, in a spelling of their own."""
_SAME = {"l": "L", "m/s/s": "m/s^2"}


def read_unit(text: str, multiplier: Fraction) -> Unit:
    """Return what a text says of a unit; the value on the wire times `multiplier` is in it.

    `mm`, `mV`, `hPa` and their like stay as they are: everybody knows them.
    """
    text = text.strip()
    part, unit = _PARTS.get(text, (Fraction(1), _SAME.get(text, text)))
    return Unit(unit or None, written_scale(part * multiplier))
