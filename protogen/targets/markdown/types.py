"""Types in words."""

from __future__ import annotations

from protogen.model.types import (
    Array,
    Counted,
    Extent,
    Fill,
    Fixed,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)
from protogen.targets.markdown.words import code, plural

_ORDERS = {"little": "LE", "big": "BE"}


def integer_of(kind: Type) -> Integer | None:
    """Return the integer that a field holds, or of which it is an array."""
    while isinstance(kind, Array):
        kind = kind.element
    return kind if isinstance(kind, Integer) else None


def type_text(kind: Type) -> str:
    """Print a type with its byte order: ``uint16 LE``."""
    match kind:
        case Integer() | Float():
            return _number_text(kind)
        case Text():
            return _extended(code("ascii"), kind.extent, "byte")
        case Octets():
            return _extended(code("bytes"), kind.extent, "byte")
        case Array():
            return _extended(type_text(kind.element), kind.extent, "element")
        case Switch():
            return f"depends on {code(kind.selector)}"
        case Struct():
            return "struct"


def number_name(kind: Integer | Float) -> str:
    """Return the name that a schema gives to a number's type."""
    if isinstance(kind, Float):
        return f"float{kind.bits}"
    if kind.role != "number":
        return kind.role
    return f"{'sint' if kind.signed else 'uint'}{kind.bits}"


def _number_text(kind: Integer | Float) -> str:
    name = code(number_name(kind))
    return f"{name} {_ORDERS[kind.byte_order]}" if kind.size > 1 else name


def _extended(element: str, extent: Extent, noun: str) -> str:
    match extent:
        case Fixed():
            return element if noun == "byte" else f"{element} x {extent.count}"
        case Counted():
            return f"{element} x {code(extent.field)}"
        case Fill():
            return f"{element} to the end, at most {plural(extent.greatest, noun)}"
