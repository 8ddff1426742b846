"""The members of C structs and their types, for what prints them and what adds up their sizes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from protogen.model.types import (
    Array,
    Extent,
    Field,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
    count_name,
)
from protogen.targets.c.spelling import counting_type, integer_type


@dataclass(frozen=True, slots=True)
class Member:
    """A member of a struct or a union."""

    name: str
    type: str | Float | Struct | Union | tuple[Member, ...]
    """An integer or character as C spells it, a struct of the schema, or one without a name."""
    counts: tuple[int, ...] = ()
    """Elements of an array, and of the arrays in it."""


@dataclass(frozen=True, slots=True)
class Union:
    """The cases of a switch that hold anything, and what holds the bytes of other values."""

    selector: str
    cases: tuple[Member, ...]
    rest: Member | None


UNUSED = Member("unused", "uint8_t")
"""What a struct has where there is nothing to hold: C has no empty structs."""


def members_of(fields: Sequence[Field]) -> tuple[Member, ...]:
    """All members of a struct with these fields."""
    found = tuple(member for field in fields for member in _of_field(fields, field))
    return found or (UNUSED,)


def _of_field(fields: Sequence[Field], field: Field) -> Iterator[Member]:
    for member in (counter_of(fields, field), value_of(field)):
        if member is not None:
            yield member


def counter_of(fields: Sequence[Field], field: Field) -> Member | None:
    """What says how many elements or bytes of `field` there are, where it fills the payload."""
    extent = field.type.extent
    if extent is None or not field.fills:
        return None
    return Member(count_name(fields, field), counting_type(extent.room))


def value_of(field: Field) -> Member | None:
    """What holds the field's value."""
    return _member(field.type, field.name) if field.is_stored else None


def _member(type_: Type, name: str, counts: tuple[int, ...] = ()) -> Member:
    match type_:
        case Integer():
            return Member(name, integer_type(type_), counts)
        case Float() | Struct():
            return Member(name, type_, counts)
        case Text(extent=extent):
            return Member(name, "char", (*counts, _places(extent)))
        case Octets(extent=extent):
            return Member(name, "uint8_t", (*counts, _places(extent)))
        case Array(element=element, extent=extent):
            return _member(element, name, (*counts, _places(extent)))
        case Switch():
            return Member(name, _union(type_), counts)


def _places(extent: Extent) -> int:
    """C has no empty arrays."""
    return max(1, extent.room)


def _union(type_: Switch) -> Union:
    cases = tuple(_member(case.type, case.name) for case in type_.cases if case.type.holds_values)
    return Union(type_.selector, cases, _rest(type_))


def _rest(type_: Switch) -> Member | None:
    if type_.rest is None:
        return None
    size = Member("size", counting_type(type_.rest))
    return Member(type_.rest_name, (size, Member("bytes", "uint8_t", (max(1, type_.rest),))))
