"""Names of the values and bits of an integer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import cast

from protogen.copying import replace
from protogen.model.meanings import BitField, Enum, Flags, NamedBit, NamedValue
from protogen.model.types import NumberType, is_integer
from protogen.passes.context import Context, Loc, about
from protogen.passes.types.declared import VALUE_NAMES, Effective
from protogen.schema.syntax.fields import NamedBits
from protogen.schema.syntax.fields import NamedValue as NamedValueSyntax

_Bounds = tuple[int, int]
"""The least and the greatest raw value."""


def with_names(context: Context, type_: NumberType, item: Effective) -> NumberType:
    """The number with the enum, flags or bit ranges that the field gives it."""
    kinds = [key for key in VALUE_NAMES if getattr(item.syntax, key) is not None]
    if not kinds:
        return type_
    kind = kinds[0]
    if not is_integer(type_) or type_.role == "bool":
        text = f"{kind} are for integers, not for {item.syntax.type}"
        context.error_at_key("PG110", item.at(kind), text)
        return type_
    if len(kinds) > 1:
        text = f"an integer has only one of these: {', '.join(kinds)}"
        context.error_at_key("PG110", item.at(kinds[1]), text)
    if type_.signed and kind != "values":
        text = f"{kind} name bits of an unsigned integer; {item.syntax.type} is signed"
        context.error_at_key("PG110", item.at(kind), text)
    if kind == "values":
        return replace(type_, enum=_enum(context, (type_.least, type_.greatest), item))
    if kind == "flags":
        return replace(type_, flags=_flags(context, type_.bits, item))
    return replace(type_, bit_fields=_bit_fields(context, type_.bits, item))


def _enum(context: Context, bounds: _Bounds, item: Effective) -> Enum:
    values = named_values(context, bounds, item.syntax.values or {}, item.at("values"))
    doc = about(item.origin.doc, item.origin.source)
    return Enum(name=item.owner, values=values, closed=item.syntax.closed, about=doc)


def named_values(
    context: Context,
    bounds: _Bounds,
    entries: Mapping[str, NamedValueSyntax],
    loc: Loc,
    type_name: str | None = None,
) -> tuple[NamedValue, ...]:
    """The names of raw values; problems name the type, or else its bounds."""
    least, greatest = bounds
    values: dict[int, NamedValue] = {}
    for name, entry in entries.items():
        if not least <= entry.value <= greatest:
            fits = f": {least} to {greatest}" if type_name is None else f" {type_name}"
            words = f"{name} = {entry.value} does not fit{fits}"
            context.error("PG114", (*loc, name), words)
        if entry.value in values:
            words = f"`{name}` and `{values[entry.value].name}` are both {entry.value}"
            context.error("PG120", (*loc, name), words)
            continue
        where = context.find_key((*loc, name))
        text = about(entry.doc, entry.source, where)
        values[entry.value] = NamedValue(name=name, value=entry.value, about=text)
    return tuple(values.values())


def _flags(context: Context, width: int, item: Effective) -> Flags:
    bits: dict[int, NamedBit] = {}
    for name, entry in (item.syntax.flags or {}).items():
        here = (*item.at("flags"), name)
        if entry.bit >= width:
            words = f"bit {entry.bit} is beyond the {width} bits of {item.syntax.type}"
            context.error("PG113", here, words)
        if entry.bit in bits:
            words = f"`{name}` and `{bits[entry.bit].name}` are both bit {entry.bit}"
            context.error("PG120", here, words)
        text = about(entry.doc, entry.source, context.find_key(here))
        named = NamedBit(name=name, bit=entry.bit, about=text)
        bits.setdefault(entry.bit, named)
    doc = about(item.origin.doc, item.origin.source)
    return Flags(name=item.owner, bits=tuple(bits.values()), about=doc)


def _bit_fields(context: Context, width: int, item: Effective) -> tuple[BitField, ...]:
    """The bit ranges of an integer; those that it does not have are left out."""
    ranges: list[BitField] = []
    alone: list[BitField] = []  # Whose bits have no other name.
    for name, entry in (item.syntax.bits or {}).items():
        here = (*item.at("bits"), name)
        if not _is_run(context, width, entry, here):
            continue
        found = _bit_field(context, f"{item.owner}_{name}", name, entry, here)
        is_alone = not _is_list(entry)
        for other in alone if is_alone else ():
            if found.mask & other.mask:
                text = f"the bits of `{name}` overlap those of `{other.name}`"
                context.error("PG112", here, text)
        ranges.append(found)
        alone += [found] if is_alone else []
    return tuple(ranges)


def _is_list(entry: NamedBits) -> bool:
    return isinstance(entry.bits[0], tuple)


def _runs_of(entry: NamedBits) -> list[tuple[int, int]]:
    runs = [run for run in entry.bits if isinstance(run, tuple)]
    return runs or [cast("tuple[int, int]", entry.bits)]


def _is_run(context: Context, width: int, entry: NamedBits, loc: Loc) -> bool:
    for low, high in _runs_of(entry):
        if not low <= high < width:
            text = f"bits {low}..{high} are not a run within the {width} bits of the integer"
            context.error("PG113", loc, text, f"bits go from 0 to {width - 1}")
            return False
    for (_, before), (low, _) in pairwise(_runs_of(entry)):
        if low <= before + 1:
            text = f"bit {low} does not lie behind bit {before} with others between them"
            hint = "list the runs from the lowest bit on; bits beside each other are one run"
            context.error("PG296", (*loc, "bits"), text, hint)
            return False
    return True


def _bit_field(context: Context, type_name: str, name: str, entry: NamedBits, loc: Loc) -> BitField:
    runs = _runs_of(entry)
    low, high = runs[0][0], runs[-1][1]
    gaps = sum((1 << after) - (1 << before + 1) for (_, before), (after, _) in pairwise(runs))
    text = about(entry.doc, entry.source, context.find_key(loc))
    enum = None
    if entry.values is not None:
        bounds = (0, (1 << high - low + 1) - 1)
        values = named_values(context, bounds, entry.values, (*loc, "values"))
        _are_outside(context, values, gaps >> low, loc)
        enum = Enum(name=type_name, values=values, about=text)
    return BitField(name=name, low=low, high=high, gaps=gaps, enum=enum, about=text)


def _are_outside(context: Context, values: Sequence[NamedValue], gaps: int, loc: Loc) -> None:
    """Report values with bits between the runs."""
    for item in values:
        if item.value & gaps:
            text = f"{item.name} = {item.value:#x} has bits between the runs, which are not named"
            hint = f"that is {item.value & ~gaps:#x} without them"
            context.error("PG296", (*loc, "values", item.name), text, hint)
