"""Changed copies of structs and dataclasses, as `copy.replace` of Python 3.13 makes them."""

from __future__ import annotations

import dataclasses
from typing import Any, TypeVar

import msgspec

ItemT = TypeVar("ItemT")


def replace(item: ItemT, /, **changes: Any) -> ItemT:
    """The same object with other values of some fields."""
    if isinstance(item, msgspec.Struct):
        return msgspec.structs.replace(item, **changes)
    changed: ItemT = dataclasses.replace(item, **changes)  # type: ignore[type-var]
    return changed


def is_record(kind: type[Any]) -> bool:
    """True for structs and dataclasses."""
    return issubclass(kind, msgspec.Struct) or dataclasses.is_dataclass(kind)


def field_names(kind: type[Any]) -> tuple[str, ...]:
    """The names of all fields of a class, in order; none for a class of another kind."""
    if issubclass(kind, msgspec.Struct):
        return kind.__struct_fields__
    if dataclasses.is_dataclass(kind):
        return tuple(item.name for item in dataclasses.fields(kind))
    return ()


def defaults_of(kind: type[Any]) -> dict[str, Any]:
    """The fields that make an object, with their defaults: `NODEFAULT` where there is none."""
    if issubclass(kind, msgspec.Struct):
        names, given = kind.__struct_fields__, kind.__struct_defaults__
        missing = (msgspec.NODEFAULT,) * (len(names) - len(given))
        return dict(zip(names, missing + given, strict=True))
    if not dataclasses.is_dataclass(kind):
        return {}
    return {
        item.name: msgspec.NODEFAULT if item.default is dataclasses.MISSING else item.default
        for item in dataclasses.fields(kind)
        if item.init
    }
