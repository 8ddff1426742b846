"""Values as JavaScript writes them."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Mapping
from typing import Any

from protogen.targets.module_names import pascal

_NAME = re.compile(r"[A-Za-z_$][A-Za-z0-9_$]*")

GREATEST_BITS = 53
"""Bits of the greatest integer that is a number; one with more is a `bigint`."""


class Code(str):
    """JavaScript, which is printed as it is."""

    __slots__ = ()


Data = Any
"""A truth value, number, text, bytes, or JavaScript; None, which is `null`; or such in iterables or
mappings from names."""


def literal(value: Data) -> Code:
    """The expression of a value."""
    match value:
        case Code():
            return value
        case None | bool() | str():
            return Code(json.dumps(value))
        case float():
            return Code(_real(value))
        case bytes():
            return Code(f'rt.hex("{value.hex()}")')
        case Mapping():
            inside = ", ".join(members(value))
            return Code(f"{{ {inside} }}" if inside else "{}")
        case Iterable():
            return Code(f"[{', '.join(map(literal, value))}]")
    return Code(value)


def members(items: Mapping[str, Data]) -> Iterable[str]:
    """The members of an object."""
    for name, value in items.items():
        found = literal(value)
        yield name if name == found else f"{key(name)}: {found}"


def lines(value: Data, indent: str = "") -> Code:
    """An object or array with each of its members in a line of its own."""
    ends, inside = "{}", members(value) if isinstance(value, Mapping) else map(literal, value)
    if not isinstance(value, Mapping):
        ends = "[]"
    found = "".join(f"\n{indent}  {item}," for item in inside)
    return Code(f"{ends[0]}{found}\n{indent}{ends[1]}" if found else ends)


def call(name: str, *arguments: Data) -> Code:
    """A call; arguments that are None, which have to be the last ones, are left out."""
    return Code(f"{name}({', '.join(literal(item) for item in arguments if item is not None)})")


def told(thing: object, names: str) -> dict[str, Data]:
    """Some of what a thing says of itself, by the same names in JavaScript."""
    return {camel(name): getattr(thing, name) for name in names.split()}


def given(**items: Data) -> dict[str, Data]:
    """The items that are there."""
    return {name: value for name, value in items.items() if value is not None}


def characters(data: bytes) -> str:
    """A string of which each character is a byte."""
    return data.decode("latin-1")


def is_big(bits: int) -> bool:
    """True if an integer of so many bits is a `bigint`."""
    return bits > GREATEST_BITS


def integer(value: int, *, big: bool = True) -> Code:
    """An integer, as a number or as a `bigint`."""
    return Code(f"{value}n" if big else value)


def _real(value: float) -> str:
    if math.isnan(value):
        return "NaN"
    return repr(value).replace("inf", "Infinity")


def key(name: str) -> str:
    """A key of an object; JavaScript gives `__proto__` another meaning."""
    return name if _NAME.fullmatch(name) and name != "__proto__" else f"[{json.dumps(name)}]"


def member(holder: str, name: str) -> Code:
    """A member of an object."""
    own = key(name)
    return Code(f"{holder}{own}" if own.startswith("[") else f"{holder}.{own}")


def camel(name: str) -> str:
    """`move_manual` is `moveManual`."""
    found = pascal(name)
    return found[:1].lower() + found[1:]
