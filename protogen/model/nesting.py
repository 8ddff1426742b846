"""Types inside of types: one walk for everybody who asks about all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from protogen.copying import replace
from protogen.model.types import (
    Array,
    Between,
    Field,
    Fill,
    Integer,
    Struct,
    Switch,
    Type,
    is_integer,
)


def inner_types(type_: Type) -> tuple[Type, ...]:
    """Types directly inside: of fields, of elements, of cases."""
    match type_:
        case Struct():
            return tuple(field.type for field in type_.fields)
        case Array():
            return (type_.element,)
        case Switch():
            return tuple(case.type for case in type_.cases)
    return ()


def fields_inside(type_: Type) -> Iterator[Field]:
    """Yield the fields of a struct, of the elements of an array, of the cases of a switch."""
    if isinstance(type_, Struct):
        yield from type_.fields
        return
    for inner in inner_types(type_):
        yield from fields_inside(inner)


def structs_in(type_: Type) -> Iterator[Struct]:
    """Yield the structs that a value has directly inside, or is."""
    if isinstance(type_, Struct):
        yield type_
        return
    for inner in inner_types(type_):
        yield from structs_in(inner)


def is_composite(type_: Type) -> bool:
    """True if the type is fields, or a choice between types."""
    return isinstance(type_, Struct | Switch)


def holds_whole_bytes(type_: Type) -> bool:
    """True if a value can hold bytes of eight bits, whatever a payload byte carries."""
    if is_integer(type_):
        return type_.role == "byte"
    return any(map(holds_whole_bytes, inner_types(type_)))


def takes_rest(type_: Type) -> bool:
    """True if a value takes all that the payload has left."""
    match type_:
        case Struct():
            return any(map(fills, type_.fields))
        case Switch():
            return type_.rest is not None or any(map(takes_rest, inner_types(type_)))
        case Integer():
            return type_.takes_rest
    extent = type_.extent
    return extent.takes_rest if isinstance(extent, Between) else isinstance(extent, Fill)


def fills(field: Field) -> bool:
    """True if a field takes all that the payload has left, and not just what its region has."""
    return field.region is None and takes_rest(field.type)


def always_fills(field: Field) -> bool:
    """True if a field takes all that the payload has left, whatever is chosen in it."""
    return field.region is None and field.when is None and _always_takes_rest(field.type)


def _always_takes_rest(type_: Type) -> bool:
    match type_:
        case Struct():
            return any(map(always_fills, type_.fields))
        case Switch():
            is_rest = type_.rest is not None or type_.otherwise is not None
            return is_rest and all(map(_always_takes_rest, inner_types(type_)))
    return takes_rest(type_)


def can_count(type_: Type) -> bool:
    """True if a value can say how many elements or bytes another field has."""
    if not is_integer(type_) or type_.signed or type_.role == "bool":
        return False
    return type_.flags is None and not type_.bit_fields


def with_structs(type_: Type, settle: Callable[[Struct], Struct]) -> Type:
    """The type with the structs inside of it as `settle` makes them."""
    match type_:
        case Struct():
            return settle(type_)
        case Array():
            return replace(type_, element=with_structs(type_.element, settle))
        case Switch():
            cases = (replace(case, type=with_structs(case.type, settle)) for case in type_.cases)
            return replace(type_, cases=tuple(cases))
    return type_
