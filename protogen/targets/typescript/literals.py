"""Values as JavaScript writes them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping

_NAME = re.compile(r"[A-Za-z_$][A-Za-z0-9_$]*")

GREATEST_BITS = 53
"""Bits of the greatest integer that is a number; one with more is a `bigint`."""


def text(value: str) -> str:
    """A string."""
    return json.dumps(value)


def characters(data: bytes) -> str:
    """A string of which each character is a byte."""
    return text(data.decode("latin-1"))


def octets(data: bytes) -> str:
    """Bytes."""
    return f'rt.hex("{data.hex()}")'


def boolean(value: bool) -> str:
    """A truth value."""
    return "true" if value else "false"


def is_big(bits: int) -> bool:
    """True if an integer of so many bits is a `bigint`."""
    return bits > GREATEST_BITS


def integer(value: int, *, big: bool = False) -> str:
    """An integer, as a number or as a `bigint`."""
    return f"{value}n" if big else str(value)


def real(value: float) -> str:
    """A float."""
    if value != value:
        return "NaN"
    if value in (float("inf"), float("-inf")):
        return "Infinity" if value > 0 else "-Infinity"
    return repr(value)


def listed(items: Iterable[str]) -> str:
    """An array."""
    return f"[{', '.join(items)}]"


def key(name: str) -> str:
    """A key of an object; JavaScript gives `__proto__` another meaning."""
    return name if _NAME.fullmatch(name) and name != "__proto__" else f"[{text(name)}]"


def mapping(items: Mapping[str, str | None]) -> str:
    """An object; what is None is left out."""
    inside = ", ".join(
        name if name == value else f"{key(name)}: {value}"
        for name, value in items.items()
        if value is not None
    )
    return f"{{ {inside} }}" if inside else "{}"


def call(name: str, *arguments: str | None) -> str:
    """A call; arguments that are None, which have to be the last ones, are left out."""
    return f"{name}({', '.join(item for item in arguments if item is not None)})"
