"""Integers as text of a fixed number of digits: functions that check, read and write them."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from protogen.c_language.numbers import hexadecimal, integer_type, unsigned, unsigned_type
from protogen.model.numbers import Numeral
from protogen.model.types import Integer
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.number_bytes import is_whole


class Digits(msgspec.Struct, frozen=True):
    """The digits of one integer type, and what C calls them."""

    type: Integer
    form: Numeral

    @classmethod
    def of(cls, type_: Integer) -> Digits:
        """The digits of a type that has some."""
        assert isinstance(type_.text, Numeral)
        return cls(type_, type_.text)

    @property
    def _words(self) -> str:
        """The set of digits, as part of a function's name."""
        if self.form.known:
            return self.form.known.replace("-", "_")
        return f"base{self.form.base}_from_{self.form.alphabet[0]:02x}"

    @property
    def _held(self) -> str:
        """The unsigned type of whatever the digits can stand for."""
        return unsigned_type(self.form.greatest.bit_length())

    # --- what steps print -----------------------------------------------------------------------

    def value(self, helpers: Helpers, address: str) -> str:
        """The number that lies there."""
        body = self._read()
        name = f"read_{self._words}_{self.form.size}"
        number = f"{helpers.helper(name, self._held, ('const uint8_t *at',), body)}({address})"
        target = unsigned_type(self.type.bits)
        if target != self._held:
            number = f"({target}){number}"
        if not self.type.signed:
            return number
        if is_whole(self.type):
            return f"({integer_type(self.type)}){number}"
        return helpers.extended(self.type, number)

    def faults(self, helpers: Helpers, address: str) -> Iterator[str]:
        """Conditions under which there is no such number."""
        arguments = ("const uint8_t *at", "size_t size")
        known = helpers.helper(f"is_{self._words}", "bool", arguments, self._check())
        yield f"!{known}({address}, {self.form.size}U)"
        greatest = (1 << self.type.bits) - 1
        if self.form.greatest > greatest:
            name = f"read_{self._words}_{self.form.size}"
            read = helpers.helper(name, self._held, ("const uint8_t *at",), self._read())
            yield f"{read}({address}) > {unsigned(greatest)}"

    def store(self, helpers: Helpers) -> str:
        """The function that writes the digits of what `raw` gives."""
        arguments = ("uint8_t *at", f"{self._held} value")
        name = f"store_{self._words}_{self.form.size}"
        return helpers.helper(name, "size_t", arguments, self._store())

    def write(self, helpers: Helpers) -> str:
        """The function that hands these digits to a writer."""
        name, parameters = f"write_{self._words}_{self.form.size}", (f"{self._held} value",)
        store = self.store(helpers)
        return helpers.buffered(name, store, parameters, "value", self.form.size)

    def raw(self, value: str) -> str:
        """The unsigned number whose digits are those of a value."""
        if not self.type.signed:
            is_wider = unsigned_type(self.type.bits) != self._held
            return f"({self._held}){value}" if is_wider else value
        own = f"({unsigned_type(self.type.bits)}){value}"
        if is_whole(self.type):
            return own
        return f"({self._held})({own} & {hexadecimal((1 << self.type.bits) - 1)})"

    def characters(self, helpers: Helpers, value: str) -> tuple[str, ...]:
        """The characters of an unsigned value of the type, each by itself, in wire order."""
        places = range(self.form.size - 1, -1, -1)
        return tuple(self._character_at(helpers, value, place) for place in places)

    def _character_at(self, helpers: Helpers, value: str, place: int) -> str:
        """The character of a digit; `place` counts from the lowest one."""
        bits, base = self._bits, self.form.base
        unit = base**place
        if unit > self.type.greatest:
            return hexadecimal(self.form.alphabet[0])
        if bits:
            moved = f"{value} >> {bits * place}" if place else value
            digit = f"{moved} & {hexadecimal((1 << bits) - 1)}"
        else:
            moved = f"{value} / {unsigned(unit)}" if place else value
            digit = f"{moved} % {unsigned(base)}"
        if len(self._runs()) == 1:
            first = hexadecimal(self.form.alphabet[0])
            return f"(uint8_t)(({digit}) + {first})" if bits else f"(uint8_t)({digit} + {first})"
        body = f"return (uint8_t)({self._character()});"
        name = helpers.helper(f"digit_{self._words}", "uint8_t", ("uint8_t digit",), body)
        return f"{name}((uint8_t)({digit}))"

    # --- bodies ---------------------------------------------------------------------------------

    @property
    def _bits(self) -> int:
        """Bits that each digit stands for; 0 where it is no whole number of them."""
        base = self.form.base
        return base.bit_length() - 1 if base & (base - 1) == 0 else 0

    def _check(self) -> list[str]:
        tests = list(map(_between, self._runs()))
        condition = " || ".join(f"({test})" for test in tests) if len(tests) > 1 else tests[0]
        return [
            "for (size_t i = 0; i < size; i++) {",
            "    const uint8_t digit = at[i];",
            f"    if (!({condition})) {{",
            "        return false;",
            "    }",
            "}",
            "return true;",
        ]

    def _read(self) -> list[str]:
        held, bits = self._held, self._bits
        moved = f"(value << {bits}) |" if bits else f"value * {unsigned(self.form.base)} +"
        return [
            f"{held} value = 0U;",
            f"for (size_t i = 0; i < {self.form.size}U; i++) {{",
            "    const uint8_t digit = at[i];",
            f"    value = ({held})({moved} (uint8_t)({self._value()}));",
            "}",
            "return value;",
        ]

    def _store(self) -> list[str]:
        bits = self._bits
        mask, base = hexadecimal((1 << bits) - 1), unsigned(self.form.base)
        return [
            f"for (size_t i = {self.form.size}U; i > 0U; i--) {{",
            f"    const uint8_t digit = (uint8_t)(value {f'& {mask}' if bits else f'% {base}'});",
            f"    at[i - 1U] = (uint8_t)({self._character()});",
            f"    value = ({self._held})(value {f'>> {bits}' if bits else f'/ {base}'});",
            "}",
            f"return {self.form.size}U;",
        ]

    def _runs(self) -> list[tuple[int, int, int]]:
        """Characters in a row: the first, the last, and the digit that the first is."""
        found: list[tuple[int, int, int]] = []
        for value, character in enumerate(self.form.alphabet):
            if found and character == found[-1][1] + 1:
                found[-1] = (found[-1][0], character, found[-1][2])
            else:
                found.append((character, character, value))
        return found

    def _value(self) -> str:
        """The value of the character `digit`."""
        (first, last, _), *others = self._runs()
        own = f"digit - {hexadecimal(first)}"
        if not others:
            return own
        ((other, _, value),) = others
        return f"digit <= {hexadecimal(last)} ? {own} : digit - {hexadecimal(other - value)}"

    def _character(self) -> str:
        """The character of the number `digit`."""
        (first, _, _), *others = self._runs()
        own = f"digit + {hexadecimal(first)}"
        if not others:
            return own
        ((other, _, value),) = others
        return f"digit < {unsigned(value)} ? {own} : digit + {hexadecimal(other - value)}"


def _between(run: tuple[int, int, int]) -> str:
    """The condition that `digit` is one of these characters; nothing is below 0 or above 255."""
    first, last, _ = run
    tests = [f"digit >= {hexadecimal(first)}"] if first > 0 else []
    tests += [f"digit <= {hexadecimal(last)}"] if last < 0xFF else []
    return " && ".join(tests)
