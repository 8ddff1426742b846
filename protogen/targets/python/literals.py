"""Values as Python expressions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import lru_cache


def bracketed(expression: str) -> str:
    """An expression that an operator may stand beside: a call or an index is one as it is."""
    return f"({expression})" if _has_operator(expression) else expression


def _has_operator(expression: str) -> bool:
    """True if blanks stand outside of all brackets, where an operator is between them."""
    depth = 0
    for character in expression:
        depth += (character in "([") - (character in ")]")
        if character == " " and not depth:
            return True
    return False


def number(value: Fraction | int) -> str:
    """An exact number, as short as Python has it."""
    exact = Fraction(value)
    if exact.denominator == 1:
        return str(exact.numerator)
    return f"_rt.Fraction({exact.numerator}, {exact.denominator})"


def octets(value: bytes) -> str:
    """Bytes, as hex digits where they are no printable text."""
    if value.isascii() and value.decode("ascii").isprintable():
        return "b" + text(value.decode("ascii"))
    return f'bytes.fromhex("{value.hex(" ").upper()}")' if value else 'b""'


def octets_in_class(value: bytes) -> str:
    """Bytes for the body of a class, where a field may be called `bytes`."""
    return 'b"' + "".join(f"\\x{byte:02x}" for byte in value) + '"'


@lru_cache(4096)
def text(value: str) -> str:
    """A string in double quotes."""
    escaped = value.encode("unicode_escape").decode("ascii")
    return '"' + escaped.replace('"', '\\"') + '"'


def tuple_of(items: Iterable[str]) -> str:
    """A tuple of expressions."""
    listed = list(items)
    return f"({', '.join(listed)}{',' if len(listed) == 1 else ''})"


def mapping(items: Mapping[str, str]) -> str:
    """A dictionary of expressions."""
    return "{" + ", ".join(f"{key}: {value}" for key, value in items.items()) + "}"


def call(function: str, *arguments: str, **named: str | None) -> str:
    """A call; named arguments that are None are left out."""
    given = [f"{name}={value}" for name, value in named.items() if value is not None]
    return f"{function}({', '.join([*arguments, *given])})"
