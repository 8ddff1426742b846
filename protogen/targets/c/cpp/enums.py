"""Enums and flags as scoped enums, which have the type of the fields that they are for."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import msgspec

from protogen.c_language.numbers import integer_type, unsigned_type
from protogen.model.meanings import Enum, Flags
from protogen.model.messages import Message
from protogen.model.payload_plan import IntegerStep, every_step
from protogen.model.types import Integer
from protogen.targets.c.cpp.names import CppNames
from protogen.targets.c.named import EnumView, enum_view, flags_view
from protogen.targets.c.spelling import Names
from protogen.targets.naming import named_type


class CppValue(msgspec.Struct, frozen=True):
    """A value of an enum."""

    name: str
    constant: str
    """What C calls it."""
    doc: tuple[str, ...]


class CppEnum(msgspec.Struct, frozen=True):
    """A scoped enum."""

    name: str
    doc: tuple[str, ...]
    type: str
    """The type that holds each value that a field can have."""
    values: tuple[CppValue, ...]
    is_flags: bool
    name_of: str
    """The function of C that says the name of a value; of an enum alone."""
    number: str
    """The type that this function takes."""


def cpp_enums(
    items: Iterable[Enum | Flags], messages: Iterable[Message], names: Names, cpp: CppNames
) -> tuple[CppEnum, ...]:
    """The enums and flags among these that some messages use."""
    used = _types(messages)
    return tuple(_view(item, used[item.name], names, cpp) for item in items if item.name in used)


def _view(item: Enum | Flags, type_: str, names: Names, cpp: CppNames) -> CppEnum:
    view: EnumView = enum_view(item, names) if isinstance(item, Enum) else flags_view(item, names)
    values = zip(cpp.values(item), view.values, strict=True)
    return CppEnum(
        name=cpp.of(named_type(item.name), item.name),
        doc=view.doc,
        type=type_,
        values=tuple(CppValue(name, value.name, value.doc) for name, value in values),
        is_flags=isinstance(item, Flags),
        name_of=view.name_of,
        number=view.number,
    )


def _types(messages: Iterable[Message]) -> dict[str, str]:
    """The type of each enum: the widest of the members that have its values."""
    found: dict[str, str] = {}
    for step in every_step(step for message in messages for step in message.plan.steps):
        if isinstance(step, IntegerStep):
            for name, type_ in _uses(step.type):
                found[name] = _wider(found.get(name, type_), type_)
    return found


def _uses(type_: Integer) -> Iterator[tuple[str, str]]:
    """The enums of an integer, and the type in which each of them comes."""
    own = integer_type(type_)
    for item in type_.named_types:
        is_run = item not in (type_.enum, type_.flags)
        yield item.name, unsigned_type(type_.bits) if is_run else own


def _wider(one: str, other: str) -> str:
    """A type of numbers that holds those of both."""
    bits = max(_bits(one), _bits(other))
    is_mixed = one.startswith("u") != other.startswith("u")
    if not is_mixed:
        return f"{'u' if one.startswith('u') else ''}int{bits}_t"
    widest_unsigned = max(_bits(it) for it in (one, other) if it.startswith("u"))
    return f"int{min(64, max(bits, 2 * widest_unsigned))}_t"


def _bits(type_: str) -> int:
    return int(type_.removeprefix("u").removeprefix("int").removesuffix("_t"))
