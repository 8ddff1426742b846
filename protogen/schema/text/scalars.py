"""Meaning of a plain scalar: the core schema of YAML 1.2.

`on`, `off`, `yes` and `no` are texts, `010` is ten, and there are no sexagesimals, no underscores
in numbers and no dates.
"""

from __future__ import annotations

import re
from fractions import Fraction

Scalar = str | int | float | bool | None
"""The value of a scalar."""

_GREATEST_NUMBER = 400
"""Characters of a number. No protocol needs more, and reading a longer one takes its time."""

_WORDS: dict[str, bool | None] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}
_DECIMAL = re.compile(r"[-+]?[0-9]+")
_OCTAL = re.compile(r"0o([0-7]+)")
_HEXADECIMAL = re.compile(r"0x([0-9a-fA-F]+)")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"([-+]?)\.(inf|Inf|INF)")
_NOT_A_NUMBER = frozenset((".nan", ".NaN", ".NAN"))
_NUMBER_START = frozenset("+-.0123456789")
_RATIONAL = re.compile(
    r"[-+]?([0-9]+/0*[1-9][0-9]*|([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]{1,3})?)"
)


class SourceInt(int):
    """An integer that remembers how it was written."""

    text: str

    @classmethod
    def of(cls, value: int, text: str) -> SourceInt:
        """Return ``value`` with the ``text`` that it was written as."""
        number = cls(value)
        number.text = text
        return number


class SourceFloat(float):
    """A floating-point number that remembers how it was written, which may be more exact."""

    text: str

    @classmethod
    def of(cls, value: float, text: str) -> SourceFloat:
        """Return ``value`` with the ``text`` that it was written as."""
        number = cls(value)
        number.text = text
        return number


def exact_number(text: str) -> Fraction | None:
    """Return the number that ``text`` is, such as `0.01`, `1/16` or `-3e-5`; None if it is none.

    A schema and a command line ask here, so that both bound what is written, exponents included.
    """
    if len(text) > _GREATEST_NUMBER or not _RATIONAL.fullmatch(text):
        return None
    return Fraction(text)


def resolve(text: str) -> Scalar:
    """Return the value of the plain scalar ``text``; one too long for a number is a text."""
    if text in _WORDS:
        return _WORDS[text]
    if text[0] not in _NUMBER_START or len(text) > _GREATEST_NUMBER:
        return text
    return _number(text)


def _number(text: str) -> Scalar:
    if _DECIMAL.fullmatch(text):
        return int(text)
    if match := _HEXADECIMAL.fullmatch(text):
        return int(match[1], 16)
    if match := _OCTAL.fullmatch(text):
        return int(match[1], 8)
    if _FLOAT.fullmatch(text):
        return float(text)
    if match := _INFINITE.fullmatch(text):
        return float(f"{match[1]}inf")
    return float("nan") if text in _NOT_A_NUMBER else text
