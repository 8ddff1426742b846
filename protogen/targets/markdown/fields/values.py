"""Raw values and what they mean, in a few words."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache

import msgspec

from protogen.model.meanings import Enum, Flags, NamedBit, NamedValue
from protogen.model.origin import NOTHING, About
from protogen.model.types import Constant, Field, NumberType
from protogen.targets.escape import markdown
from protogen.targets.markdown.fields.paths import Path
from protogen.targets.markdown.text.words import (
    bounds,
    code,
    hex_bytes,
    number,
    plural,
    short_number,
)

_FEW = 4
"""So many names, without anything to add, are listed where they are used."""


Named = Sequence[NamedValue] | Sequence[NamedBit]


class Anchors(msgspec.Struct, frozen=True):
    """Anchors of the tables of values: with their message, or once for all that share them."""

    prefix: str
    shared: frozenset[str] = frozenset()

    def of_type(self, path: Path, type_: NumberType) -> str:
        """Return the anchor for the values of the field at `path`."""
        named = type_.enum or type_.flags
        if named is not None and named.name in self.shared:
            return type_anchor(named)
        return f"{self.prefix}{path.anchor}"

    def of_special(self, path: Path) -> str:
        """Return the anchor for the special values of the field at `path`."""
        return f"{self.prefix}{path.anchor}--special"


def type_anchor(named: Enum | Flags) -> str:
    """Return the anchor of a named type's table."""
    return f"type-{named.name}"


def range_text(field: Field, path: Path, anchors: Anchors) -> str:
    """Say which raw values the field at `path` takes, with links to the tables of its values."""
    integer = field.integer
    texts = (
        _named_text(field, path, anchors)
        if field.const is None
        else f"always {constant(field.const, integer)}",
        _bounds_text(field),
        "" if field.default is None else f"default {constant(field.default, integer)}",
        values_text(field.special, anchors.of_special(path), "special value"),
    )
    return "; ".join(text for text in texts if text)


def constant(value: Constant, type_: NumberType | None) -> str:
    """Print a raw value as a schema may give it for a constant or a default."""
    if isinstance(value, tuple):
        return ", ".join(constant(item, type_) for item in value)
    if isinstance(value, bytes):
        return code(hex_bytes(value)) if value else "no bytes"
    if isinstance(value, str):
        return markdown(f"'{value}'")
    if type_ is None or isinstance(value, bool | float):
        return code(value)
    return raw_text(int(value), type_)


def raw_text(value: int, type_: NumberType) -> str:
    """Print a raw value: a character as one, its name behind it where it has one."""
    shown = character(value) if type_.role == "char" else ""
    name = _enum_name(value, type_.enum)
    return " ".join(filter(None, (shown, code(short_number(value)), name)))


def character(value: int) -> str:
    """Print a character code as the character, if it can be seen."""
    return markdown(f"'{chr(value)}'") if 0x20 < value < 0x7F else ""


def _name_of(value: int, values: Sequence[NamedValue]) -> str:
    """Return the name of a raw value; empty if it has none."""
    return next((item.name for item in values if item.value == value), "")


def _enum_name(value: int, enum: Enum | None) -> str:
    return _name_of(value, enum.values) if enum else ""


def _named_text(field: Field, path: Path, anchors: Anchors) -> str:
    integer = field.integer
    if integer is None:
        return ""
    anchor = anchors.of_type(path, integer)
    if integer.enum:
        return values_text(integer.enum.values, anchor)
    if integer.flags:
        bits = integer.flags.bits
        return _linked([f"bit {item.bit} {item.name}" for item in bits], bits, "flag", anchor)
    return f"[bit ranges](#{anchor})" if integer.bit_fields else ""


def values_text(values: Sequence[NamedValue], anchor: str, noun: str = "value") -> str:
    """List named values if they are few; link to their table where that tells more."""
    if not values:
        return ""
    names = [f"{code(short_number(item.value))} {item.name}" for item in values]
    return _linked(names, values, noun, anchor)


def _linked(names: Sequence[str], items: Named, noun: str, anchor: str) -> str:
    text = ", ".join(names) if len(names) <= _FEW else plural(len(names), noun)
    return f"[{text}](#{anchor})" if tells_more(items) else text


def _bounds_text(field: Field) -> str:
    """Print the range, unless names or a constant say more than the type's own bounds."""
    integer = field.integer
    named = integer and (integer.enum or integer.flags or integer.bit_fields)
    if field.least is None and field.greatest is None:
        return ""
    is_plain = integer is not None and integer.role in ("char", "bool")
    if not field.ranged and (named or field.const is not None or is_plain):
        return ""
    if integer is not None and not field.ranged:
        raw = _own_bounds(integer.least, integer.greatest)
    else:
        raw = bounds(field.least, field.greatest)
    return f"{raw} ({_physical_bounds(field)})" if field.scaled else raw


@lru_cache(maxsize=256)
def _own_bounds(least: int, greatest: int) -> str:
    """Print what the bits of an integer can hold."""
    return bounds(Fraction(least), Fraction(greatest))


def _physical_bounds(field: Field) -> str:
    ends = [None if end is None else physical(end, field) for end in (field.least, field.greatest)]
    low, high = ends if field.scale > 0 else reversed(ends)
    unit = f" {markdown(field.unit)}" if field.unit else ""
    return f"{bounds(low, high)}{unit}"


def physical(raw: Fraction, field: Field) -> Fraction:
    """Return the physical value of a raw value."""
    return raw * field.scale + field.offset


def unit_text(field: Field) -> str:
    """Say how the physical value follows from the raw value, and its unit."""
    unit = markdown(field.unit or "")
    if not field.scaled:
        return unit
    return f"{unit}, {_formula(field)}" if unit else _formula(field)


def _formula(field: Field) -> str:
    text = "raw"
    if field.scale.numerator == 1 and field.scale.denominator > 1:
        text = f"raw / {field.scale.denominator}"
    elif field.scale != 1:
        text = f"raw x {number(field.scale)}"
    sign = "-" if field.offset < 0 else "+"
    return f"{text} {sign} {number(abs(field.offset))}" if field.offset else text


def tells_more(items: Named) -> bool:
    """True if a table has more to show than a list in a cell."""
    return len(items) > _FEW or any(_is_explained(item.about) for item in items)


def _is_explained(about: About) -> bool:
    return about is not NOTHING and about != NOTHING


def value_meaning(value: int, field: Field, type_: NumberType) -> str:
    """Say what a raw value means: its names, else its physical value, else what the field is."""
    special = _name_of(value, field.special)
    named = code(special) if special else _names(value, type_)
    if named:
        return named
    if field.unit or field.scaled:
        unit = markdown(field.unit or "")
        return f"{number(physical(Fraction(value), field))} {unit}".strip()
    return markdown(field.about.doc)


def _names(value: int, type_: NumberType) -> str:
    if type_.enum:
        name = _enum_name(value, type_.enum)
        return code(name) if name else "no name"
    if type_.flags:
        names = [code(item.name) for item in type_.flags.bits if value >> item.bit & 1]
        return ", ".join(names) or "no flag"
    runs = ((bits, (value & bits.mask) >> bits.low) for bits in type_.bit_fields)
    return ", ".join(
        f"{code(bits.name)} {run} {_enum_name(run, bits.enum)}".strip() for bits, run in runs
    )
