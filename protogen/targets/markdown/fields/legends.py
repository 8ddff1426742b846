"""Tables of what values mean: enums, flags, bit ranges and special values."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

import msgspec

from protogen.model.meanings import BitField, Enum, Flags, NamedValue
from protogen.model.types import Field, Integer
from protogen.targets.markdown.fields.values import Anchors, character, tells_more, values_text
from protogen.targets.markdown.text.origin import about_line
from protogen.targets.markdown.text.path import Path
from protogen.targets.markdown.text.table import Table, table
from protogen.targets.markdown.text.words import bounds, code, hex_number


class Legend(msgspec.Struct, frozen=True):
    """A table of what the values of a field, or of a named type, mean."""

    anchor: str
    title: str
    note: str
    table: Table


def legends(field: Field, path: Path, anchors: Anchors) -> Iterable[Legend]:
    """Yield the tables of a field's own values that `range_text` links to."""
    integer = field.integer
    if integer is None:
        return
    anchor = anchors.of_type(path, integer)
    if not anchor.startswith("type-"):
        yield from type_legends(integer, code(path.shown), anchor)
    if tells_more(field.special):
        special = _value_table(field.special, integer)
        yield Legend(anchors.of_special(path), f"{code(path.shown)}, special values", "", special)


def type_legends(integer: Integer, title: str, anchor: str) -> Iterable[Legend]:
    """Yield the tables of a type's values."""
    if integer.enum and tells_more(integer.enum.values):
        yield _enum_legend(integer.enum, integer, title, anchor)
    elif integer.flags and tells_more(integer.flags.bits):
        yield Legend(anchor, title, _spare(integer), _flags_table(integer.flags, integer))
    elif integer.bit_fields:
        yield Legend(anchor, title, "", _bits_table(integer, anchor))
        yield from _bit_enum_legends(integer, title, anchor)


def _enum_legend(enum: Enum, integer: Integer, title: str, anchor: str) -> Legend:
    note = "Any other value is invalid." if enum.closed else ""
    return Legend(anchor, title, note, _value_table(enum.values, integer))


def _bit_enum_legends(integer: Integer, title: str, anchor: str) -> Iterable[Legend]:
    for bits in integer.bit_fields:
        if bits.enum and tells_more(bits.enum.values):
            name = f"{title}, {bits.name}"
            yield _enum_legend(bits.enum, _bits_integer(bits), name, f"{anchor}-{bits.name}")


def _bits_integer(bits: BitField) -> Integer:
    return Integer(bits=bits.high - bits.low + 1, enum=bits.enum)


def _spare(integer: Integer) -> str:
    assert integer.flags is not None
    spare = integer.bits - len({bit.bit for bit in integer.flags.bits})
    return "Bits without a name are kept as they are." if spare else ""


def _value_table(values: Sequence[NamedValue], integer: Integer) -> Table:
    return table(
        ("Raw", "Hex", "", "Name", "Meaning"),
        (
            (
                code(item.value),
                code(hex_number(item.value, integer.bits)),
                character(item.value) if integer.role == "char" else "",
                code(item.name),
                about_line(item.about),
            )
            for item in values
        ),
    )


def _flags_table(flags: Flags, integer: Integer) -> Table:
    return table(
        ("Bit", "Mask", "Name", "Meaning"),
        (
            (
                code(item.bit),
                code(hex_number(1 << item.bit, integer.bits)),
                code(item.name),
                about_line(item.about),
            )
            for item in flags.bits
        ),
    )


def _bits_table(integer: Integer, anchor: str) -> Table:
    return table(
        ("Bits", "Mask", "Name", "Values", "Meaning"),
        (
            (
                code(item.low if item.low == item.high else f"{item.high}..{item.low}"),
                code(hex_number(item.mask, integer.bits)),
                code(item.name),
                _bit_values(item, f"{anchor}-{item.name}"),
                about_line(item.about),
            )
            for item in integer.bit_fields
        ),
    )


def _bit_values(bits: BitField, anchor: str) -> str:
    if bits.enum is not None:
        return values_text(bits.enum.values, anchor)
    return bounds(Fraction(0), Fraction((1 << (bits.high - bits.low + 1)) - 1))
