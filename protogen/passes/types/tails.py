"""Fields behind an array that takes what is left of the payload."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.copying import replace
from protogen.model.numbers import FreeNumeral
from protogen.model.types import (
    Array,
    Between,
    Field,
    Fill,
    Fixed,
    Integer,
    Struct,
    Switch,
    Tail,
    Text,
    Type,
)
from protogen.passes.context import Context, Loc
from protogen.passes.types.setting import Setting


def can_be_followed(field: Field) -> bool:
    """True for an array whose elements end where what stands behind it begins."""
    is_open = isinstance(field.type, Array) and isinstance(field.type.extent, Fill)
    return is_open and field.region is None and not field.may_be_absent and field.const is None


def in_front_of_tail(
    context: Context, fields: Sequence[Field], name: str, loc: Loc, setting: Setting
) -> Field:
    """The array of this name with what stands behind it, if anything does."""
    index = next(place for place, item in enumerate(fields) if item.name == name)
    array, behind = fields[index], fields[index + 1 :]
    if not behind:
        return array
    separator = setting.layout.separator
    what = "bytes" if separator is None else "fields"
    assert isinstance(array.type, Array)
    element = _units(array.type.element, separator) or 0
    least = greatest = 0
    for item in behind:
        found = _units_of(item, separator)
        if found is None or not element:
            whose = f"an element of `{name}`" if not element else f"`{item.name}`"
            text = f"{whose} has no fixed number of {what}, so nothing says where `{name}` ends"
            hint = f"move `{name}` to the end, or count its elements"
            context.error_at_key("PG297", (*loc, item.name), text, hint)
            return array
        least += 0 if item.optional else found
        greatest += found
    if greatest - least >= element:
        text = (
            f"the optional fields behind `{name}` can have {greatest - least} {what}, and an "
            f"element has {element}: nothing tells them from one"
        )
        hint = "let fewer be optional, or count the elements"
        context.error_at_key("PG297", (*loc, behind[-1].name), text, hint)
    if not greatest:
        text = f"nothing can follow `{name}`, which fills the payload to its end"
        context.error_at_key("PG111", (*loc, behind[0].name), text, "leave out what has no bytes")
    assert isinstance(array.type.extent, Fill)
    tail = Tail(separator=separator, element=element, least=least)
    extent = replace(array.type.extent, tail=tail)
    return replace(array, type=replace(array.type, extent=extent))


def _units_of(field: Field, separator: int | None) -> int | None:
    """The same of a field, where it is there."""
    if field.when is not None:
        return None
    if field.region is not None:
        return field.sizes_there.fixed if separator is None else None
    return _units(field.type, separator)


def _units(type_: Type, separator: int | None) -> int | None:
    """Bytes of a value, or fields with a separator in front; None where their number varies."""
    if separator is None:
        return type_.sizes.fixed
    match type_:
        case Integer(text=FreeNumeral(leads=leads)):
            return 1 if leads else None
        case Text(extent=Between(leads=leads) as extent):
            return 1 if leads and not extent.takes_rest else None
        case Array(extent=Fixed(count=count)):
            inner = _units(type_.element, separator)
            return None if inner is None else count * inner
        case Struct():
            return _sum([_units_of(item, separator) for item in type_.fields])
        case Switch():
            cases = {_units(case.type, separator) for case in type_.cases}
            return cases.pop() if len(cases) == 1 and type_.rest is None else None
    return None


def _sum(numbers: Sequence[int | None]) -> int | None:
    known = [number for number in numbers if number is not None]
    return sum(known) if len(known) == len(numbers) else None
