"""Integers that are written as text."""

from __future__ import annotations

from protogen.copying import replace
from protogen.model.numbers import ALPHABETS, Numeral
from protogen.model.types import Integer, NumberType, is_integer
from protogen.passes.context import Context
from protogen.passes.types.declared import Effective

_KEYS = ("digits", "code", "chars")
_GREATEST = 1 << 64
"""No digits may stand for this number or a greater one."""


def says_text(item: Effective) -> bool:
    """True if a field says how it is written as text, rightly or not."""
    return any(getattr(item.syntax, key) is not None for key in _KEYS)


def with_text(context: Context, found: NumberType, item: Effective) -> NumberType:
    """The number with the text form that its field states."""
    stated = [key for key in _KEYS if getattr(item.syntax, key) is not None]
    if not stated:
        return found
    return _Form(context, item, stated[0]).of(found)


class _Form:
    """The text form of one field; what is wrong with it is reported, and then there is none."""

    def __init__(self, context: Context, item: Effective, key: str) -> None:
        self._context = context
        self._item = item
        self._syntax = item.syntax
        self._key = key

    def of(self, found: NumberType) -> NumberType:
        """The number in its text form."""
        if not is_integer(found) or found.role != "number":
            return self._misplaced(found, f"`{self._key}` is for integers such as uint16")
        if self._item.setting.layout.packed is not None:
            return self._misplaced(found, "integers that are packed are no text")
        if self._item.setting.layout.byte_bits != 8:
            return self._misplaced(found, "numbers are no text where `byte_bits` is 7")
        if (self._syntax.digits is None) == (self._syntax.code is None):
            both = self._syntax.code is not None
            text = "has one of `digits` and `code`" if both else "says how: `digits` or `code`"
            return self._misplaced(found, f"an integer that is written as text {text}")
        if self._syntax.byte_order is not None:
            text = "digits have no byte order: the highest one always comes first"
            self._context.error(
                "PG222", self._item.at("byte_order"), text, "leave `byte_order` out"
            )
        numeral = self._numeral(found)
        return found if numeral is None else replace(found, text=numeral, byte_order="little")

    def _misplaced(self, found: NumberType, text: str) -> NumberType:
        self._context.error_at_key("PG224", self._item.at(self._key), text)
        return found

    def _numeral(self, found: Integer) -> Numeral | None:
        alphabet = self._alphabet()
        if alphabet is None:
            return None
        is_power = len(alphabet) & (len(alphabet) - 1) == 0
        if found.signed and not is_power:
            text = f"{found.name} can't be written in digits base10: there is none for a minus"
            hint = "write it as `decimal`, or in digits base16-upper"
            self._context.error("PG225", self._item.at("digits"), text, hint)
            return None
        needed = _digits_of((1 << found.bits) - 1, len(alphabet))
        size = self._syntax.chars or needed
        if len(alphabet) ** size > _GREATEST:
            text = f"{size} digits can stand for numbers of more than 64 bits"
            self._context.error("PG225", self._place("chars"), text)
            return None
        if found.signed and size < needed:
            text = f"the bits of {found.name} need {needed} characters, not {size}"
            self._context.error("PG225", self._place("chars"), text)
            return None
        return Numeral(alphabet=alphabet, size=size)

    def _alphabet(self) -> bytes | None:
        """The characters of the digits."""
        code = self._syntax.code
        if code is None:
            return ALPHABETS[self._syntax.digits or "base10"]
        last = code.add + (1 << code.bits) - 1
        if last > 0xFF:
            text = f"characters would go up to {last}, and a byte goes up to 255"
            self._context.error("PG225", (*self._item.at("code"), "add"), text)
            return None
        return bytes(range(code.add, last + 1))

    def _place(self, key: str) -> tuple[str | int, ...]:
        return self._item.at(key if getattr(self._syntax, key) is not None else self._key)


def _digits_of(value: int, base: int) -> int:
    """How many digits a number has."""
    count = 1
    while value >= base:
        value //= base
        count += 1
    return count
