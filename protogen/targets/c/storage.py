"""What a C struct holds of a message's or struct's fields.

Constants need no room: an encoder writes them, and a decoder takes nothing else. What fills the
payload has a second member, which says how much it is. C has no empty structs, so what holds
nothing has no member at all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from protogen.model.fields import Field
from protogen.model.types import (
    Array,
    Case,
    Extent,
    Fill,
    Fixed,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)
from protogen.targets.c.spelling import free_name


def is_stored(field: Field) -> bool:
    """Whether the field has a member."""
    return field.const is None and holds_values(field.type)


def holds_values(type_: Type) -> bool:
    """Whether there is anything to store of a type."""
    match type_:
        case Struct(fields=fields):
            return any(is_stored(field) or fills(field) for field in fields)
        case Array(element=element):
            return holds_values(element)
        case Switch(cases=cases, rest=rest):
            return rest is not None or any(holds_values(case.type) for case in cases)
        case _:
            return True


def fills(field: Field) -> bool:
    """Whether a member says how many elements or bytes the field has."""
    return field.const is None and isinstance(extent_of(field.type), Fill)


def extent_of(type_: Type) -> Extent | None:
    """How many elements or bytes there are; None where the type is no array, text or bytes."""
    return type_.extent if isinstance(type_, Array | Text | Octets) else None


def count_member(fields: Sequence[Field], field: Field) -> str:
    """The member that says how many elements or bytes of `field` there are."""
    word = "count" if isinstance(field.type, Array) else "size"
    return free_name(f"{field.name}_{word}", frozenset(item.name for item in fields))


def rest_member(switch: Switch) -> str:
    """The member of a switch's union that holds the bytes of a value without a case."""
    return free_name("other", frozenset(case.name for case in switch.cases))


def room(extent: Extent) -> int:
    """The greatest number of elements or bytes."""
    return extent.count if isinstance(extent, Fixed) else extent.greatest


# --- what counts and selects --------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Number:
    """A number that was read, or is in a member."""

    expression: str
    type: Integer

    @property
    def count(self) -> str:
        """The number as one of elements or bytes."""
        return f"(size_t){self.expression}" if self.type.bits > 16 else self.expression

    @property
    def selector(self) -> str:
        """The number as what a switch is over."""
        return f"(uint8_t){self.expression}" if self.type.role == "bool" else self.expression


Scope = dict[str, "int | Number"]
"""The numbers in front, some of which are constants."""


def needed_by(fields: Sequence[Field]) -> frozenset[str]:
    """The names of the numbers in front of some fields that count or select in them."""
    needed: frozenset[str] = frozenset()
    for field in reversed(fields):
        needed = (needed - {field.name}) | needed_names(field.type)
    return needed


def needed_names(type_: Type) -> frozenset[str]:
    """The names of the numbers that count or select something inside of a type."""
    match type_:
        case Struct(fields=fields):
            return needed_by(fields)
        case Array(element=element):
            return _needed(type_.extent) | needed_names(element)
        case Text(extent=extent) | Octets(extent=extent):
            return _needed(extent)
        case Switch(selector=selector, cases=cases):
            inside: frozenset[str] = frozenset().union(*(needed_names(c.type) for c in cases))
            return inside | {selector}
        case _:
            return frozenset()


def _needed(extent: Extent) -> frozenset[str]:
    return frozenset() if isinstance(extent, Fixed | Fill) else frozenset({extent.field})


def constant_number(field: Field) -> int | None:
    """The value of a field that is a constant integer."""
    if isinstance(field.type, Integer) and isinstance(field.const, int):
        return int(field.const)
    return None


def chosen_case(switch: Switch, value: int) -> Case | None:
    """The case of a value."""
    return next((case for case in switch.cases if case.value == value), None)
