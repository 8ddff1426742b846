"""Named types: enums, flags and structs, each under a name of its own.

Every named type is registered under its name. A declared type has one layout: where two uses leave
it different room, the type takes the greater bounds, whatever a single use could hold: the frame
bounds what the schema does not.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from protogen.copying import replace
from protogen.model.meanings import Enum, Flags
from protogen.model.nesting import inner_types, is_composite, with_structs
from protogen.model.sizes import SizeSet
from protogen.model.types import (
    Array,
    Between,
    Case,
    Counted,
    Extent,
    Field,
    Fill,
    Fixed,
    Marked,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
    Until,
)
from protogen.passes.context import Context, Loc

Named = Enum | Flags | Struct
NamedT = TypeVar("NamedT", Enum, Flags, Struct)


class NamedTypes:
    """The enums, flags and structs of a protocol by name, in the order of their first use."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._types: dict[str, Named] = {}
        self._settled: dict[str, Struct] = {}
        self.places = context.places

    @property
    def enums(self) -> tuple[Enum, ...]:
        """All enums."""
        return tuple(item for item in self._types.values() if isinstance(item, Enum))

    @property
    def flags(self) -> tuple[Flags, ...]:
        """All sets of flags."""
        return tuple(item for item in self._types.values() if isinstance(item, Flags))

    @property
    def structs(self) -> tuple[Struct, ...]:
        """All structs, inner ones first."""
        structs = (item for item in self._types.values() if isinstance(item, Struct))
        return tuple(self._struct(item) for item in structs)

    # -- registering --------------------------------------------------------------------------

    def register(self, item: NamedT, loc: Loc, *, declared: bool) -> NamedT:
        """The enum, flags or struct under its name; `loc` is the field that has it.

        What a field holds is called after message and field. Where that is the name of something
        else, it gets `_` behind it.
        """
        while not declared and self._is_of_another(item, loc):
            item = replace(item, name=f"{item.name}_")
        known = self._types.get(item.name)
        self.places.setdefault(item.name, loc)
        joined = item if known is None else _joined(known, item)
        if joined is not None:
            self._types[item.name] = joined
            return item
        self._context.error_at_key(
            "PG107",
            loc,
            f"two different types would be called `{item.name}`",
            "declare a type for each of the two uses; if it is one struct with two byte orders, "
            "state the byte order in the type",
        )
        return item

    def _is_of_another(self, item: Named, loc: Loc) -> bool:
        """True if a message, a declared type or a type in another place is called so."""
        syntax = self._context.syntax
        if item.name in syntax.messages or item.name in syntax.types:
            return True
        known = self._types.get(item.name)
        is_elsewhere = known is not None and self.places[item.name] != loc
        return is_elsewhere and known is not None and _joined(known, item) is None

    # -- settling -----------------------------------------------------------------------------

    def settled(self, fields: tuple[Field, ...]) -> tuple[Field, ...]:
        """The fields with all structs as they came to be. To be asked when all are registered."""
        if not any(_holds_struct(field.type) for field in fields):
            return fields
        return _placed(
            replace(field, type=with_structs(field.type, self._struct)) for field in fields
        )

    def _struct(self, struct: Struct) -> Struct:
        if struct.name not in self._settled:
            latest = self._types.get(struct.name)
            struct = latest if isinstance(latest, Struct) else struct
            fields = self.settled(struct.fields)
            placed = fields if struct.packed else _placed(fields)
            self._settled[struct.name] = replace(struct, fields=placed)
        return self._settled[struct.name]


def _placed(fields: Iterable[Field]) -> tuple[Field, ...]:
    """The fields with their positions, behind each other."""
    found: list[Field] = []
    behind = SizeSet.exactly(0)
    for field in fields:
        found.append(replace(field, position=behind.fixed))
        behind += field.sizes_in_front
    return tuple(found)


def _joined(known: Named, other: Named) -> Named | None:
    """Two registrations as one type, or None; what people read about it may differ."""
    if isinstance(known, Struct) and isinstance(other, Struct):
        return joined_struct(known, other)
    return known if replace(other, about=known.about) == known else None


def _holds_struct(type_: Type) -> bool:
    return is_composite(type_) or any(map(_holds_struct, inner_types(type_)))


def joined_struct(one: Struct, other: Struct) -> Struct | None:
    """The struct that holds what either can; None where they differ in more than bounds.

    Structs inside of them are joined under their own names, not here.
    """
    if len(one.fields) != len(other.fields) or one.packed != other.packed:
        return None
    fields = [_field(*both) for both in zip(one.fields, other.fields, strict=True)]
    found = tuple(field for field in fields if field is not None)
    return replace(one, fields=found) if len(found) == len(fields) else None


def _field(one: Field, other: Field) -> Field | None:
    type_, region = _type(one.type, other.type), one.region
    if region is not None and other.region is not None:
        joined = _extent(region, other.region)
        region = joined if isinstance(joined, Fixed | Counted) else None
        other = replace(other, region=one.region) if region is not None else other
    if type_ is None or replace(other, type=one.type, position=one.position) != one:
        return None
    return replace(one, type=type_, region=region)


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
            if element is None or one.packed != other.packed:
                return None
            return _with_extent(replace(one, element=element), other)
        case Switch(), Switch():
            return _switch(one, other)
    return one if one == other else None


def _with_extent(one: Text | Octets | Array, other: Text | Octets | Array) -> Type | None:
    extent = _extent(one.extent, other.extent)
    return None if extent is None else replace(one, extent=extent)


def _extent(one: Extent, other: Extent) -> Extent | None:
    match one, other:
        case Counted(), Counted() if one.by == other.by:
            return Counted(
                by=one.by,
                least=min(one.least, other.least),
                greatest=max(one.greatest, other.greatest),
                stated=one.stated and other.stated,
            )
        case Fill(), Fill() if (one.tail, one.stated) == (other.tail, other.stated):
            return replace(one, greatest=max(one.greatest, other.greatest))
        case Marked(), Marked() if (one.mark, one.stated) == (other.mark, other.stated):
            return replace(one, greatest=max(one.greatest, other.greatest))
        case Until(), Until() if (one.byte, one.stated) == (other.byte, other.stated):
            return replace(one, greatest=max(one.greatest, other.greatest))
        case Between(), Between() if replace(one, greatest=other.greatest) == other:
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
