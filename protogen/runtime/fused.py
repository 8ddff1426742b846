"""A struct of fixed layout as one item of Python's `struct`: construct's result without its way.

construct looks at each field anew for every payload. Where sizes are fixed, all fields are read
and written together here; bytes and values that are not in order are left to construct.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

from protogen.runtime.pairs import Unclear

UNFUSED = (struct.error, ValueError, LookupError, TypeError, ArithmeticError, Unclear)
"""What is raised where construct has to decide."""

Convert = Callable[[Any], Any]


@dataclass(frozen=True, slots=True)
class Item:
    """One value: its code for `struct`, the order of its bytes, and how it is converted.

    `order` is empty where it does not matter. `decode` and `encode` may raise anything where
    construct has to decide.
    """

    code: str
    order: str = ""
    decode: Convert | None = None
    encode: Convert | None = None


class Fused:
    """All fields of a struct at once."""

    def __init__(self, names: tuple[str, ...], items: tuple[Item, ...]) -> None:
        """`items` are those of the fields called `names`, of one order of bytes."""
        order = next((item.order for item in items if item.order), "<")
        layout = struct.Struct(order + "".join(item.code for item in items))
        self.names = names
        self.count = len(names)
        self.unpack = layout.unpack_from
        self.pack = layout.pack
        self.values_of: Callable[[Any], tuple[Any, ...]] = _getter(names)
        self.decodes = tuple((i, item.decode) for i, item in enumerate(items) if item.decode)
        self.encodes = tuple((i, item.encode) for i, item in enumerate(items) if item.encode)

    def values(self, data: bytes) -> Iterable[Any]:
        """The values of a payload's first bytes. Raises where construct has to decide."""
        values = self.unpack(data)
        if not self.decodes:
            return values
        converted = list(values)
        for index, decode in self.decodes:
            converted[index] = decode(converted[index])
        return converted

    def data(self, values: tuple[Any, ...]) -> bytes:
        """The bytes of values. Raises where construct has to decide."""
        if not self.encodes:
            return self.pack(*values)
        converted = list(values)
        for index, encode in self.encodes:
            converted[index] = encode(converted[index])
        return self.pack(*converted)


def _getter(names: tuple[str, ...]) -> Callable[[Any], tuple[Any, ...]]:
    if len(names) > 1:
        return itemgetter(*names)
    return lambda values: tuple(values[name] for name in names)


def fuse(fields: Iterable[tuple[str | None, Item | None]]) -> Fused | None:
    """The fields of a struct as one; None where they do not go together."""
    names: list[str] = []
    items: list[Item] = []
    for name, item in fields:
        if not name or item is None:
            return None
        names.append(name)
        items.append(item)
    orders = {item.order for item in items if item.order}
    return Fused(tuple(names), tuple(items)) if names and len(orders) < 2 else None
