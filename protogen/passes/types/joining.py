"""Joining of a struct that is used in several places.

The frame bounds what the schema does not: how many elements a count or a fill can mean depends on
the room that is left. A type is one type wherever it is used, so it takes the greatest bounds.
"""

from __future__ import annotations

from collections.abc import Iterable

from protogen.copying import replace
from protogen.model.types import (
    Array,
    Case,
    Counted,
    Extent,
    Field,
    Fill,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)


def joined_struct(one: Struct, other: Struct) -> Struct | None:
    """The struct that holds what either can; None where they differ in more than bounds.

    Structs inside of them are joined under their own names, not here.
    """
    if len(one.fields) != len(other.fields):
        return None
    fields = [_field(*both) for both in zip(one.fields, other.fields, strict=True)]
    found = tuple(field for field in fields if field is not None)
    return replace(one, fields=found) if len(found) == len(fields) else None


def _field(one: Field, other: Field) -> Field | None:
    type_ = _type(one.type, other.type)
    if type_ is None or replace(other, type=one.type, position=one.position) != one:
        return None
    return replace(one, type=type_)


def _type(one: Type, other: Type) -> Type | None:
    match one, other:
        case Struct(), Struct():
            return one if one.name == other.name else None
        case Text(), Text():
            return _with_extent(one, other)
        case Octets(), Octets():
            return _with_extent(one, other)
        case Array(), Array():
            element = _type(one.element, other.element)
            return None if element is None else _with_extent(replace(one, element=element), other)
        case Switch(), Switch():
            return _switch(one, other)
    return one if one == other else None


def _with_extent(one: Text | Octets | Array, other: Text | Octets | Array) -> Type | None:
    extent = _extent(one.extent, other.extent)
    return None if extent is None else replace(one, extent=extent)


def _extent(one: Extent, other: Extent) -> Extent | None:
    match one, other:
        case Counted(), Counted() if one.field == other.field:
            return Counted(
                field=one.field,
                least=min(one.least, other.least),
                greatest=max(one.greatest, other.greatest),
                stated=one.stated and other.stated,
            )
        case Fill(), Fill() if one.stated == other.stated:
            return replace(one, greatest=max(one.greatest, other.greatest))
    return one if one == other else None


def _switch(one: Switch, other: Switch) -> Switch | None:
    """A rest in one place only was reported where it was found."""
    cases = tuple(_cases(one.cases, other.cases))
    if one.selector != other.selector or len(cases) != max(len(one.cases), len(other.cases)):
        return None
    ends = one.rest is not None and other.rest is not None
    rest = max(one.rest or 0, other.rest or 0) if ends else None
    return replace(one, cases=cases, rest=rest)


def _cases(some: Iterable[Case], others: Iterable[Case]) -> Iterable[Case]:
    for one, other in zip(some, others, strict=False):
        type_ = _type(one.type, other.type)
        if type_ is not None and (one.value, one.name) == (other.value, other.name):
            yield replace(one, type=type_)
