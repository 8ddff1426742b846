"""The built-in type names, and what they say about layout."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache
from typing import Literal

import msgspec

from protogen.copying import replace
from protogen.model.types import BitOrder, ByteOrder, Float, Integer
from protogen.problems import hint_for

_INTEGER = re.compile(r"[us]int(0|[1-9][0-9]{0,5})")

GREATEST_WIDTH = 64
"""Bits of the widest integer."""

PLAIN_NAMES = (
    "byte", "char", "bool", "float32", "float64", "ascii", "bytes", "decimal", "hexadecimal",
)  # fmt: skip
"""Built-in types that carry no width in their name."""

COMMON_NAMES = (
    *PLAIN_NAMES,
    *(f"{sign}int{bits}" for bits in range(1, 65) for sign in "us"),
)
"""Everything that a type may be called before a schema declares its own."""


UNKNOWN_TYPE = Integer(bits=8)
"""Stand-in for a type that could not be resolved, so that the other fields are still checked."""

_OTHER_WORDS = {
    "string": "ascii", "str": "ascii", "text": "ascii", "float": "float32", "single": "float32",
    "f32": "float32", "double": "float64", "f64": "float64", "boolean": "bool", "blob": "bytes",
}  # fmt: skip
"""Names of other languages for the built-in types."""
_OTHER_INTEGER = re.compile(r"(u|uint|unsigned|i|s|int|sint|signed)([0-9]{0,3})(_t)?")


class Layout(msgspec.Struct, frozen=True):
    """Layout of numbers in the payload or frame at hand. `byte_order` None: nobody has said."""

    byte_bits: Literal[7, 8]
    byte_order: ByteOrder | None
    packed: BitOrder | None = None
    """Order of the bits where numbers follow each other without byte boundaries."""
    separator: int | None = None
    """The byte between fields that are text."""


def integer_width(name: str) -> int | None:
    """N of `uintN` or `sintN`, whatever it is; None for other names."""
    match = _INTEGER.fullmatch(name)
    return int(match[1]) if match else None


def has_width(name: str) -> bool:
    """True if the name is no integer's, or that of one that exists: of 1 to 64 bits."""
    width = integer_width(name)
    return width is None or 1 <= width <= GREATEST_WIDTH


_ARRAY = re.compile(r"(\w+)\[(\w+)\]")
_OTHER_FORMS = {
    "enum": "write the integer's type, such as `uint8`, and `values: {NAME: NUMBER}` beside it",
    "strz": "write `type: ascii`, and `until: 0` beside it",
    "cstring": "write `type: ascii`, and `until: 0` beside it",
    "flags": "write the integer's type, such as `uint8`, and `flags: {NAME: BIT}` beside it",
    "struct": "leave out `type`, and write `fields:`",
    "union": "leave out `type`, and write `switch:` and `cases:`",
    "array": "write the type of an element, and `count:` beside it",
}
"""What stands in the place of a type in other languages."""


def type_hint(name: str, declared: Iterable[str] = ()) -> str | None:
    """Type that was probably meant: by its name in another language, or a slip of one here."""
    word = name.casefold().replace(" ", "")
    array = _ARRAY.fullmatch(word)
    if array is not None:
        key = "size" if array[1] in ("ascii", "bytes") else "count"
        return f"write `{{type: {array[1]}, {key}: {array[2]}}}`"
    if word in _OTHER_FORMS:
        return _OTHER_FORMS[word]
    integers = _OTHER_INTEGER.fullmatch(word)
    if integers is None:
        known = (*declared, *COMMON_NAMES)
        return hint_for(_OTHER_WORDS.get(word, name), known)
    sign = "u" if word[0] == "u" else "s"
    if not integers[2]:
        return f"give it a width: `{sign}int8`"
    meant = f"{sign}int{int(integers[2])}"
    return f"did you mean `{meant}`?" if has_width(meant) else None


def is_builtin(name: str) -> bool:
    """True if a schema may not declare a type of this name."""
    return name in PLAIN_NAMES or integer_width(name) is not None


@lru_cache(maxsize=1024)
def integer(name: str, layout: Layout) -> Integer | None:
    """The integer type that a built-in name stands for, or None if it is no integer.

    Fields of one type share it. The byte order of a number of one byte is `little`, and so it is of
    packed ones; of others the layout's, `little` where the layout has none (the caller reports
    that).
    """
    if layout.packed is not None:
        found = integer(name, Layout(8, None))
        return None if found is None else replace(found, packed=True)
    width = integer_width(name)
    if width is not None and has_width(name):
        plain = Integer(bits=width, signed=name[0] == "s", byte_bits=layout.byte_bits)
        order = layout.byte_order if plain.size > 1 else None
        return plain if order is None else replace(plain, byte_order=order)
    if name == "byte":
        return Integer(bits=8, byte_bits=8, role="byte")
    if name == "char":
        return Integer(bits=layout.byte_bits, byte_bits=layout.byte_bits, role="char")
    if name == "bool":
        return Integer(bits=1, byte_bits=layout.byte_bits, role="bool")
    return None


@lru_cache(maxsize=64)
def float_type(name: str, layout: Layout) -> Float | None:
    """The float type that a built-in name stands for, or None if it is no float."""
    if name not in ("float32", "float64"):
        return None
    bits: Literal[32, 64] = 32 if name == "float32" else 64
    return Float(bits=bits, byte_bits=layout.byte_bits, byte_order=layout.byte_order or "little")
