"""Named types: enums, flags and structs, each under a name of its own.

Every named type is registered under its name. A declared type has one layout: where two uses leave
it different room, the type takes the greater bounds, whatever a single use could hold.
"""

from __future__ import annotations

from collections.abc import Iterable

from protogen.copying import replace
from protogen.model.meanings import Enum, Flags
from protogen.model.nesting import inner_types, is_composite, with_structs
from protogen.model.sizes import SizeSet
from protogen.model.types import Field, Struct, Type
from protogen.passes.context import Context, Loc
from protogen.passes.types.joining import joined_struct

Named = Enum | Flags | Struct


class NamedTypes:
    """The enums, flags and structs of a protocol by name, in the order of their first use."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._types: dict[str, Named] = {}
        self._settled: dict[str, Struct] = {}
        self.places: dict[str, Loc] = {}
        """First use of each name."""

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

    def register(self, item: Named, loc: Loc) -> None:
        """Take an enum, flags or a struct under its name; `loc` is the field that has it."""
        known = self._types.get(item.name)
        self.places.setdefault(item.name, loc)
        joined = item if known is None else _joined(known, item)
        if joined is not None:
            self._types[item.name] = joined
            return
        self._context.error_at_key(
            "PG107",
            loc,
            f"two different types would be called `{item.name}`",
            "rename the field or the declared type; if it is one struct with two byte orders, "
            "state the byte order in the type",
        )

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
            self._settled[struct.name] = replace(struct, fields=_placed(fields))
        return self._settled[struct.name]


def _placed(fields: Iterable[Field]) -> tuple[Field, ...]:
    """The fields with their positions, behind each other."""
    found: list[Field] = []
    behind = SizeSet.exactly(0)
    for field in fields:
        found.append(replace(field, position=behind.fixed))
        behind += field.type.sizes
    return tuple(found)


def _joined(known: Named, other: Named) -> Named | None:
    """Two registrations as one type, or None; what people read about it may differ."""
    if isinstance(known, Struct) and isinstance(other, Struct):
        return joined_struct(known, other)
    return known if replace(other, about=known.about) == known else None


def _holds_struct(type_: Type) -> bool:
    return is_composite(type_) or any(map(_holds_struct, inner_types(type_)))
