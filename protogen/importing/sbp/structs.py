"""Types that fields refer to: how large they are, and how a schema calls them."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from protogen.importing.remarks import DefinitionError
from protogen.importing.sbp.packages import Packages
from protogen.importing.sbp.spec import Definition, FieldSpec
from protogen.importing.sbp.texts import ends_inside
from protogen.problems import hint_for

Place = tuple[str, str]
"""File and name of a struct."""

NUMBERS = {
    **{f"u{bits}": f"uint{bits}" for bits in (8, 16, 32, 64)},
    **{f"s{bits}": f"sint{bits}" for bits in (8, 16, 32, 64)},
    "float": "float32",
    "double": "float64",
}
"""Names of numbers, and those that a schema has for them."""

OPEN_ELEMENTS = "an array whose elements take all that is left"
SERIES = ("array", "string", "bytes")
"""Types of several elements or characters."""


class Extent(msgspec.Struct, frozen=True):
    """Bytes that something takes: at least so many, and all that are left if it is open."""

    least: int
    is_open: bool = False


class Structs:
    """Structs of packages."""

    def __init__(self, packages: Packages, names: Mapping[Place, str]) -> None:
        self._packages = packages
        self._names = names
        self._extents: dict[Place, Extent | None] = {}

    def find(self, file: str, name: str, field: FieldSpec) -> tuple[str, Definition]:
        """Return the struct that a field of a file refers to. Raises DefinitionError."""
        found = self._packages.find_struct(file, name)
        if found is None or (found[0], found[1].name) not in self._names:
            hint = self._packages.hint(file, name) if found is None else "it is no part of messages"
            raise DefinitionError(field.type_span, f"there is no type `{name}`", hint)
        return found

    def name_of(self, file: str, name: str, field: FieldSpec) -> str:
        """Return how a schema calls a type. Raises DefinitionError if there is none."""
        if name in NUMBERS:
            return NUMBERS[name]
        owner, struct = self.find(file, name, field)
        return self._names[owner, struct.name]

    def extent_of_type(self, file: str, name: str, field: FieldSpec) -> Extent:
        """Return the bytes of one element of a type."""
        if name in NUMBERS:
            return Extent(width(name) // 8)
        owner, struct = self.find(file, name, field)
        place = (owner, struct.name)
        if place not in self._extents:
            self._extents[place] = None
            self._extents[place] = self.extent(owner, struct)
        extent = self._extents[place]
        if extent is None:
            raise DefinitionError(field.type_span, f"`{name}` is inside of itself")
        return extent

    def extent(self, file: str, definition: Definition) -> Extent:
        """Return the bytes of a message or struct."""
        extents = [
            self.extent_of(file, field, is_last=field is definition.fields[-1])
            for field in definition.fields
        ]
        is_open = any(item.is_open for item in extents) or any(
            self.uncountable(file, definition, field) is not None
            for field in definition.fields
            if field.size_fn is not None
        )
        return Extent(sum(item.least for item in extents), is_open)

    def extent_of(self, file: str, field: FieldSpec, *, is_last: bool) -> Extent:
        """Return the bytes of a field."""
        if field.type not in SERIES:
            return self.extent_of_type(file, field.type, field)
        if field.size_fn is not None:
            return Extent(0)
        if field.type == "string" and ends_inside(field, is_last=is_last):
            return Extent(1)
        if field.size is None:
            return Extent(0, is_open=True)
        element = self.extent_of_type(file, element_type(field), field)
        return Extent(field.size * element.least, element.is_open)

    def has_open_elements(self, file: str, field: FieldSpec) -> bool:
        """True if a field has elements of which each takes all bytes that are left."""
        is_series = field.type in SERIES
        return is_series and self.extent_of_type(file, element_type(field), field).is_open

    def uncountable(self, file: str, definition: Definition, field: FieldSpec) -> str | None:
        """Return why another field of a definition can't count a field, or None if it can.

        Raises DefinitionError if there is no such field, or it is no integer.
        """
        fields = {other.name: other for other in definition.fields}
        counter = fields.get(field.size_fn or "")
        if counter is None:
            message = f"there is no field `{field.size_fn}` that counts `{field.name}`"
            raise DefinitionError(field.span, message, hint_for(str(field.size_fn), fields))
        if counter.type not in NUMBERS or counter.type in ("float", "double"):
            raise DefinitionError(counter.span, f"`{counter.name}` counts, and is no integer")
        if definition.fields.index(counter) >= definition.fields.index(field):
            return f"`{counter.name}` counts it and stands behind it"
        if counter.type.startswith("s"):
            return f"`{counter.name}` counts it and is signed"
        return OPEN_ELEMENTS if self.has_open_elements(file, field) else None


def element_type(field: FieldSpec) -> str:
    """Return the type of what a field consists of."""
    if field.type == "array":
        if field.fill is None:
            raise DefinitionError(field.span, f"the array `{field.name}` has no `fill`")
        return field.fill
    return "u8" if field.type in SERIES else field.type


def width(number: str) -> int:
    """Return the bits of a number."""
    return {"float": 32, "double": 64}.get(number) or int(number[1:])
