"""Tables of what values mean: enums, flags, bit ranges and special values."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

import msgspec

from protogen.model.meanings import BitField, Enum, Flags, NamedValue
from protogen.model.types import Field, NumberType
from protogen.targets.markdown.fields.paths import Path
from protogen.targets.markdown.fields.values import Anchors, character, tells_more, values_text
from protogen.targets.markdown.text.origin import about_line
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
        special = _value_table(field.special, integer.bits, shown=integer.role == "char")
        yield Legend(anchors.of_special(path), f"{code(path.shown)}, special values", "", special)


def type_legends(type_: NumberType, title: str, anchor: str) -> Iterable[Legend]:
    """Yield the tables of a type's values."""
    if type_.enum and tells_more(type_.enum.values):
        shown = type_.role == "char"
        yield _enum_legend(type_.enum, type_.bits, title, anchor, shown=shown)
    elif type_.flags and tells_more(type_.flags.bits):
        note = _spare(type_.flags, type_.bits)
        yield Legend(anchor, title, note, _flags_table(type_.flags, type_.bits))
    elif type_.bit_fields:
        yield Legend(anchor, title, "", _bits_table(type_, anchor))
        for run in type_.bit_fields:
            if run.enum and tells_more(run.enum.values):
                name, bits = f"{title}, {run.name}", run.high - run.low + 1
                yield _enum_legend(run.enum, bits, name, f"{anchor}-{run.name}")


def _enum_legend(enum: Enum, bits: int, title: str, anchor: str, *, shown: bool = False) -> Legend:
    note = "Any other value is invalid." if enum.closed else ""
    return Legend(anchor, title, note, _value_table(enum.values, bits, shown=shown))


def _spare(flags: Flags, bits: int) -> str:
    spare = bits - len({bit.bit for bit in flags.bits})
    return "Bits without a name are kept as they are." if spare else ""


def _value_table(values: Sequence[NamedValue], bits: int, *, shown: bool) -> Table:
    """Print named values of so many bits; with `shown` as the characters that they are."""
    return table(
        ("Raw", "Hex", "", "Name", "Meaning"),
        (
            (
                code(item.value),
                code(hex_number(item.value, bits)),
                character(item.value) if shown else "",
                code(item.name),
                about_line(item.about),
            )
            for item in values
        ),
    )


def _flags_table(flags: Flags, bits: int) -> Table:
    return table(
        ("Bit", "Mask", "Name", "Meaning"),
        (
            (
                code(item.bit),
                code(hex_number(1 << item.bit, bits)),
                code(item.name),
                about_line(item.about),
            )
            for item in flags.bits
        ),
    )


def _bits_table(type_: NumberType, anchor: str) -> Table:
    return table(
        ("Bits", "Mask", "Name", "Values", "Meaning"),
        (
            (
                code(_places(item)),
                code(hex_number(item.mask, type_.bits)),
                code(item.name),
                _bit_values(item, f"{anchor}-{item.name}"),
                about_line(item.about),
            )
            for item in type_.bit_fields
        ),
    )


def _places(bits: BitField) -> str:
    """Print the runs of bits, the highest one first."""
    runs = (str(low) if low == high else f"{high}..{low}" for low, high in reversed(bits.runs))
    return ", ".join(runs)


def _bit_values(bits: BitField, anchor: str) -> str:
    if bits.enum is not None:
        return values_text(bits.enum.values, anchor)
    return bounds(Fraction(0), Fraction((1 << (bits.high - bits.low + 1)) - 1))
