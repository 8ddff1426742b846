"""Digits of integers that have as many each time: fields, and parts of frames."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from protogen.model.numbers import ALPHABETS, Numeral
from protogen.model.types import Integer
from protogen.passes.context import Context, Loc
from protogen.schema.syntax.digits import CharacterCode, DigitCount

NOT_IN_SEVEN_BITS = "numbers are no text where `byte_bits` is 7"
_GREATEST = 1 << 64
"""No digits may stand for this number or a greater one."""


class Written(Protocol):
    """Syntax of what may be written as digits."""

    @property
    def digits(self) -> str | int | DigitCount | None:
        """The kind of digits."""

    @property
    def code(self) -> CharacterCode | None:
        """The bits of each character."""

    @property
    def chars(self) -> int | None:
        """The number of characters."""


class FixedDigits:
    """Digits as a field or a part states them; what is wrong with them is reported."""

    def __init__(self, context: Context, syntax: Written, at: Callable[[str], Loc]) -> None:
        """`at` gives the place of a key."""
        self._context = context
        self._syntax = syntax
        self._at = at
        keys = ("digits", "code", "chars")
        self.key = next((key for key in keys if getattr(syntax, key) is not None), "digits")
        """The key that says that there are some."""

    def is_one_kind(self) -> bool:
        """True if there is one of `digits` and `code`."""
        is_told = self._syntax.digits is not None
        if is_told != (self._syntax.code is not None):
            return True
        text = "has one of `digits` and `code`" if is_told else "says how: `digits` or `code`"
        text = f"an integer that is written as text {text}"
        self._context.error_at_key("PG224", self._at(self.key), text)
        return False

    def of(self, type_: Integer) -> Numeral | None:
        """The digits of an integer; None where it can't have them."""
        alphabet = self._alphabet()
        if alphabet is None:
            return None
        is_power = len(alphabet) & (len(alphabet) - 1) == 0
        if type_.signed and not is_power:
            text = f"{type_.name} can't be written in digits base10: there is none for a minus"
            hint = "write it as `decimal`, or in digits base16-upper"
            self._context.error("PG225", self._at("digits"), text, hint)
            return None
        needed = digits_of((1 << type_.bits) - 1, len(alphabet))
        size = self._syntax.chars or needed
        if len(alphabet) ** size > _GREATEST:
            text = f"{size} digits can stand for numbers of more than 64 bits"
            self._context.error("PG225", self._place("chars"), text)
            return None
        if type_.signed and size < needed:
            self.too_few(type_.name, needed, size)
            return None
        return Numeral(alphabet=alphabet, size=size)

    def too_few(self, what: str, needed: int, size: int) -> None:
        """Report that the bits of something need more characters than there are."""
        text = f"the bits of {what} need {needed} characters, not {size}"
        self._context.error("PG225", self._place("chars"), text)

    def _alphabet(self) -> bytes | None:
        """The characters of the digits."""
        code = self._syntax.code
        if code is not None and code.shift:
            text = "`shift` is for the characters of a text, not for the digits of an integer"
            self._context.error("PG294", (*self._at("code"), "shift"), text)
        if code is None:
            digits = self._syntax.digits
            return ALPHABETS[digits if isinstance(digits, str) else "base10"]
        last = code.add + (1 << code.bits) - 1
        if last > 0xFF:
            text = f"characters would go up to {last}, and a byte goes up to 255"
            self._context.error("PG225", (*self._at("code"), "add"), text)
            return None
        return bytes(range(code.add, last + 1))

    def _place(self, key: str) -> Loc:
        return self._at(key if getattr(self._syntax, key) is not None else self.key)


def has_no_order(context: Context, byte_order: str | None, loc: Loc) -> None:
    """Report a byte order of digits."""
    if byte_order is not None:
        text = "digits have no byte order: the highest one always comes first"
        context.error("PG222", loc, text, "leave `byte_order` out")


def digits_of(value: int, base: int) -> int:
    """How many digits a number has."""
    count = 1
    while value >= base:
        value //= base
        count += 1
    return count
