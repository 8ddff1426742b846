"""Names that are imported, and attributes that are made, when they are first used.

Frames and values that are in order need neither construct nor the rules of values, and importing
those takes longer than all the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from typing import Any, TypeVar, cast

AnyT = TypeVar("AnyT")


def importer(namespace: dict[str, Any], names: Mapping[str, Iterable[str]]) -> Callable[[str], Any]:
    """The `__getattr__` of a module that imports names when they are asked for.

    `names` are those of each module that is imported from, which may be a neighbour as in
    `.frame`. What was asked for once is kept in `namespace`.
    """
    homes = {name: home for home, found in names.items() for name in found}

    def get(name: str) -> Any:
        home = homes.get(name)
        if home is None:
            raise AttributeError(f"module {namespace['__name__']!r} has no attribute {name!r}")
        value = getattr(import_module(home, namespace["__package__"]), name)
        namespace[name] = value
        return value

    return get


class _Lazily:
    """An attribute of a class that is made when it is first read, and then stands in the class."""

    def __init__(self, make: Callable[[], Any]) -> None:
        self._make = make

    def __set_name__(self, owner: type[Any], name: str) -> None:
        self._owner = owner
        self._name = name

    def __get__(self, instance: object | None, owner: type[Any]) -> Any:
        value = self._make()
        setattr(self._owner, self._name, value)
        return value


def lazily(make: Callable[[], AnyT]) -> AnyT:
    """For the body of a class: an attribute that `make` gives when it is first read."""
    return cast(AnyT, _Lazily(make))
