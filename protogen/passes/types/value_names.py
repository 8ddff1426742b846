"""Names of the values and bits of an integer."""

from __future__ import annotations

from collections.abc import Mapping

from protogen.model.meanings import BitField, Enum, Flags, NamedBit, NamedValue
from protogen.model.types import Integer
from protogen.passes.context import Context, Loc, about
from protogen.passes.types.declared import Effective
from protogen.schema.syntax.fields import NamedBits
from protogen.schema.syntax.fields import NamedValue as NamedValueSyntax


def enum_of(context: Context, type_: Integer, item: Effective) -> Enum:
    """The enum that `values` make of an integer."""
    values = _values(context, type_, item.syntax.values or {}, item.at("values"))
    doc = about(item.origin.doc, item.origin.source)
    return Enum(name=item.owner, values=values, closed=item.syntax.closed, about=doc)


def _values(
    context: Context, type_: Integer, entries: Mapping[str, NamedValueSyntax], loc: Loc
) -> tuple[NamedValue, ...]:
    values: dict[int, NamedValue] = {}
    for name, entry in entries.items():
        if not type_.holds(entry.value):
            words = f"{name} = {entry.value} does not fit: {type_.least} to {type_.greatest}"
            context.error("PG114", (*loc, name), words)
        if entry.value in values:
            words = f"`{name}` and `{values[entry.value].name}` are both {entry.value}"
            context.error("PG120", (*loc, name), words)
            continue
        where = context.find_key((*loc, name))
        text = about(entry.doc, entry.source, where)
        values[entry.value] = NamedValue(name=name, value=entry.value, about=text)
    return tuple(values.values())


def flags_of(context: Context, type_: Integer, item: Effective) -> Flags:
    """The flags of an integer."""
    bits: dict[int, NamedBit] = {}
    for name, entry in (item.syntax.flags or {}).items():
        here = (*item.at("flags"), name)
        if entry.bit >= type_.bits:
            words = f"bit {entry.bit} is beyond the {type_.bits} bits of {item.syntax.type}"
            context.error("PG113", here, words)
        if entry.bit in bits:
            words = f"`{name}` and `{bits[entry.bit].name}` are both bit {entry.bit}"
            context.error("PG120", here, words)
        text = about(entry.doc, entry.source, context.find_key(here))
        named = NamedBit(name=name, bit=entry.bit, about=text)
        bits.setdefault(entry.bit, named)
    doc = about(item.origin.doc, item.origin.source)
    return Flags(name=item.owner, bits=tuple(bits.values()), about=doc)


def bit_fields_of(context: Context, type_: Integer, item: Effective) -> tuple[BitField, ...]:
    """The bit ranges of an integer; those that it does not have are left out."""
    ranges: list[BitField] = []
    for name, entry in (item.syntax.bits or {}).items():
        here = (*item.at("bits"), name)
        if not _is_run(context, type_, entry, here):
            continue
        found = _bit_field(context, f"{item.owner}_{name}", name, entry, here)
        for other in ranges:
            if found.mask & other.mask:
                text = f"the bits of `{name}` overlap those of `{other.name}`"
                context.error("PG112", here, text)
        ranges.append(found)
    return tuple(ranges)


def _is_run(context: Context, type_: Integer, entry: NamedBits, loc: Loc) -> bool:
    low, high = entry.bits
    if low <= high < type_.bits:
        return True
    text = f"bits {low}..{high} are not a run within the {type_.bits} bits of the integer"
    context.error("PG113", loc, text, f"bits go from 0 to {type_.bits - 1}")
    return False


def _bit_field(context: Context, type_name: str, name: str, entry: NamedBits, loc: Loc) -> BitField:
    low, high = entry.bits
    text = about(entry.doc, entry.source, context.find_key(loc))
    enum = None
    if entry.values is not None:
        values = _values(context, Integer(bits=high - low + 1), entry.values, (*loc, "values"))
        enum = Enum(name=type_name, values=values, about=text)
    return BitField(name=name, low=low, high=high, enum=enum, about=text)
