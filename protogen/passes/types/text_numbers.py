"""Integers that are written as text."""

from __future__ import annotations

from typing import Literal

from protogen.copying import replace
from protogen.model.numbers import FreeNumeral
from protogen.model.types import Integer, NumberType, is_integer
from protogen.passes.context import Context
from protogen.passes.types.declared import Effective
from protogen.passes.types.fixed_digits import (
    NOT_IN_SEVEN_BITS,
    FixedDigits,
    digits_of,
    has_no_order,
)
from protogen.passes.types.type_names import UNKNOWN_TYPE
from protogen.schema.syntax.digits import DigitCount

_KEYS = ("digits", "code", "chars", "fraction", "case")
_MOST_DIGITS = {10: 18, 16: 16}
"""So many digits always fit 64 bits, a sign with them."""
_USUAL_DIGITS = {10: 9, 16: 8}
"""Digits in all where neither `range` nor `digits` bounds them: they fit 32 bits."""


def says_text(item: Effective) -> bool:
    """True if a field says how it is written as text, rightly or not."""
    return any(getattr(item.syntax, key) is not None for key in _KEYS)


def with_text(context: Context, found: NumberType, item: Effective) -> NumberType:
    """The number with the text form that its field states."""
    stated = [key for key in _KEYS if getattr(item.syntax, key) is not None]
    if not stated:
        return found
    form = _Form(context, item, stated[0])
    return form.of(found) if form.is_of_integers() else found


def text_number(context: Context, item: Effective) -> Integer | None:
    """The integer that a field of the type `decimal` or `hexadecimal` is; None for others."""
    if item.syntax.type not in ("decimal", "hexadecimal"):
        return None
    return _Form(context, item, "type").free()


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
        if not self._is_in_bytes():
            return found
        fixed = FixedDigits(self._context, self._syntax, self._item.at)
        if not fixed.is_one_kind():
            return found
        self._has_no_order()
        numeral = fixed.of(found)
        return found if numeral is None else replace(found, text=numeral, byte_order="little")

    def is_of_integers(self) -> bool:
        """Report keys of `decimal` and `hexadecimal` on another type."""
        for key in ("fraction", "case"):
            if getattr(self._syntax, key) is not None:
                kind = "decimal" if key == "fraction" else "hexadecimal"
                text = f"`{key}` is for the type {kind}"
                self._context.error_at_key("PG224", self._item.at(key), text)
                return False
        if isinstance(self._syntax.digits, int | DigitCount):
            text = "`digits` of an integer are base10, base16-upper or base16-lower"
            hint = "their number is `chars`; as many as the number needs has the type `decimal`"
            self._context.error("PG224", self._item.at("digits"), text, hint)
            return False
        return True

    def _misplaced(self, found: NumberType, text: str) -> NumberType:
        self._context.error_at_key("PG224", self._item.at(self._key), text)
        return found

    def _is_in_bytes(self) -> bool:
        """True if characters can stand here: neither packed bits nor bytes of 7 bits."""
        layout = self._item.setting.layout
        text = NOT_IN_SEVEN_BITS if layout.byte_bits != 8 else ""
        if layout.packed is not None:
            text = "integers that are packed are no text"
        if text:
            self._context.error_at_key("PG224", self._item.at(self._key), text)
        return not text

    def _has_no_order(self) -> None:
        has_no_order(self._context, self._syntax.byte_order, self._item.at("byte_order"))

    # --- as many digits as the number needs -----------------------------------------------------

    def free(self) -> Integer:
        """An integer that takes all that is left."""
        base: Literal[10, 16] = 10 if self._syntax.type == "decimal" else 16
        self._only_keys(base)
        self._has_no_order()
        if not self._is_in_bytes():
            return UNKNOWN_TYPE
        if not self._item.setting.delimited:
            text = "the frame does not say where the payload ends, so nothing says where this does"
            hint = (
                "give a length part to the frame, or write it as `{type: uint16, digits: base10}`"
            )
            self._context.error("PG118", self._item.at("type"), text, hint)
        fraction = (self._syntax.fraction or 0) if base == 10 else 0
        padded, front = self._front(base, fraction)
        form = FreeNumeral(
            base=base,
            front=front,
            padded=padded,
            fraction=fraction,
            upper=self._syntax.case != "lower",
            separator=self._item.setting.layout.separator,
            leads=self._item.setting.layout.separator is not None and self._item.setting.leads,
            empty=self._syntax.empty is not None,
        )
        low = self._syntax.range[0] if self._syntax.range is not None else -1
        signed = base == 10 and low < 0
        return Integer(bits=form.top.bit_length() + signed, signed=signed, text=form)

    def _only_keys(self, base: int) -> None:
        """Report keys that mean nothing for such numbers."""
        others = ("code", "chars", "case" if base == 10 else "fraction", "const")
        for key in others:
            if getattr(self._syntax, key) is not None:
                text = f"`{key}` is not for the type {self._syntax.type}"
                hint = "a text that is always the same is `ascii`" if key == "const" else None
                self._context.error_at_key("PG224", self._item.at(key), text, hint)
        if isinstance(self._syntax.digits, str):
            text = f"`digits` of the type {self._syntax.type} are a number"
            self._context.error("PG224", self._item.at("digits"), text)

    def _front(self, base: int, fraction: int) -> tuple[int, int]:
        """The least and the greatest number of digits in front of the point."""
        digits = self._syntax.digits
        least = digits if isinstance(digits, int) else None
        most = None
        if isinstance(digits, DigitCount):
            least, most = digits.min, digits.max
        if most is None:
            most = max(least or 1, self._usual(base, fraction))
        greatest = _MOST_DIGITS[base] - (base == 16 and self._syntax.empty is not None)
        if most + fraction > greatest or (least or 1) > most:
            count = f"more than {greatest} digits may not fit 64 bits"
            text = f"at least {least} digits and at most {most}" if (least or 1) > most else count
            key = "digits" if digits is not None else "fraction"
            self._context.error("PG225", self._item.at(key), text)
            return 1, 1
        return least or 1, most

    def _usual(self, base: int, fraction: int) -> int:
        """Digits in front where nothing says how many there are at most."""
        if self._syntax.range is None:
            return max(1, _USUAL_DIGITS[base] - fraction)
        ends = (abs(int(end)) for end in self._syntax.range)
        needed = max(digits_of(end // int(base**fraction), base) for end in ends)
        return min(needed, max(1, _MOST_DIGITS[base] - fraction))
