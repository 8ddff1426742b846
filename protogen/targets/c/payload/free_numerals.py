"""Integers as text of as many digits as they need: functions that check, read and write them."""

from __future__ import annotations

import msgspec

from protogen.c_language.numbers import constant, hexadecimal, integer_type, unsigned
from protogen.model.numbers import FreeNumeral
from protogen.model.types import Integer, storage_bits
from protogen.targets.c.payload.helpers import Helpers

_TEXT = ("const uint8_t *at", "size_t size")
_ROOM = 21
"""Bytes of the longest number of all: 18 digits, a sign and a point, and some to spare."""

_CHECK_DECIMAL = """\
{held} value = 0U;
size_t digits = 0U;
uint8_t left = fraction;
bool is_behind = false;
for (size_t i = 0; i < size; i++) {{
    const uint8_t digit = at[i];
    if (digit == 0x2EU && fraction > 0U && !is_behind) {{
        is_behind = true;
        continue;
    }}
    if (digit < 0x30U || digit > 0x39U) {{
        return false;
    }}
    digits++;
    if (is_behind && left == 0U) {{
        if (digit != 0x30U) {{
            return false;
        }}
        continue;
    }}
    if (is_behind) {{
        left--;
    }}
    if (value > tenth) {{
        return false;
    }}
    value = ({held})(value * 10U + (uint8_t)(digit - 0x30U));
}}
for (; left > 0U; left--) {{
    if (value > tenth) {{
        return false;
    }}
    value = ({held})(value * 10U);
}}
return digits > 0U;
"""
_READ_DECIMAL = """\
{held} value = 0U;
uint8_t left = fraction;
bool is_behind = false;
for (size_t i = 0; i < size; i++) {{
    if (at[i] == 0x2EU) {{
        is_behind = true;
        continue;
    }}
    if (!is_behind || left > 0U) {{
        if (is_behind) {{
            left--;
        }}
        value = ({held})(value * 10U + (uint8_t)(at[i] - 0x30U));
    }}
}}
for (; left > 0U; left--) {{
    value = ({held})(value * 10U);
}}
return value;
"""
_CHECK_HEXADECIMAL = """\
{held} value = 0U;
for (size_t i = 0; i < size; i++) {{
    const uint8_t digit = at[i];
    const uint8_t letter = (uint8_t)(digit | 0x20U);
    if ((digit < 0x30U || digit > 0x39U) && (letter < 0x61U || letter > 0x66U)) {{
        return false;
    }}
    if (value > tenth) {{
        return false;
    }}
    value = ({held})((value << 4) | (uint8_t)(digit <= 0x39U ? digit - 0x30U : letter - 0x57U));
}}
return size > 0U;
"""
_READ_HEXADECIMAL = """\
{held} value = 0U;
for (size_t i = 0; i < size; i++) {{
    const uint8_t digit = at[i];
    const uint8_t letter = (uint8_t)(digit | 0x20U);
    value = ({held})((value << 4) | (uint8_t)(digit <= 0x39U ? digit - 0x30U : letter - 0x57U));
}}
return value;
"""
_SIZE = """\
size_t size = 0U;
do {{
    size++;
    value = ({held})(value {rest});
}} while (value > 0U);
return size < least ? least : size;
"""
_STORE_DECIMAL = """\
const size_t size = {sized}(value, least) + (fraction > 0U ? 1U : 0U);
for (size_t i = size; i > 0U; i--) {{
    if (fraction > 0U && size - i == fraction) {{
        at[i - 1U] = 0x2EU;
    }} else {{
        at[i - 1U] = (uint8_t)(value % 10U + 0x30U);
        value = ({held})(value / 10U);
    }}
}}
return size;
"""
_STORE_HEXADECIMAL = """\
const size_t size = {sized}(value, least);
for (size_t i = size; i > 0U; i--) {{
    const uint8_t digit = (uint8_t)(value & 0x0FU);
    at[i - 1U] = (uint8_t)(digit < 10U ? digit + 0x30U : digit + {letter});
    value = ({held})(value >> 4);
}}
return size;
"""
_WITHOUT_SIGN = """\
if (size > 0U && (at[0] == 0x2BU || at[0] == 0x2DU)) {{
    return {plain}(&at[1], size - 1U, fraction, tenth);
}}
return {plain}(at, size, fraction, tenth);
"""
_WITH_SIGN = """\
if (at[0] == 0x2DU) {{
    return ({kind})(0U - {plain}(&at[1], size - 1U, fraction));
}}
if (at[0] == 0x2BU) {{
    return ({kind}){plain}(&at[1], size - 1U, fraction);
}}
return ({kind}){plain}(at, size, fraction);
"""
_STORE_SIGN = """\
if (value < 0) {{
    at[0] = 0x2DU;
    return 1U + {plain}(&at[1], ({held})(0U - ({held})value), least, fraction);
}}
return {plain}(at, ({held})value, least, fraction);
"""
_SIZE_SIGN = """\
if (value < 0) {{
    return 1U + {plain}(({held})(0U - ({held})value), least);
}}
return {plain}(({held})value, least);
"""


class FreeDigits(msgspec.Struct, frozen=True):
    """The digits of one integer type, and the functions that C has for them.

    Numbers of 16, 32 and 64 bits have functions of their own, which fields share.
    """

    type: Integer
    form: FreeNumeral

    @classmethod
    def of(cls, type_: Integer) -> FreeDigits:
        """The digits of a type that has some."""
        assert isinstance(type_.text, FreeNumeral)
        return cls(type_, type_.text)

    @property
    def longest(self) -> int:
        """Bytes of the longest number."""
        return self.form.longest(signed=self.type.signed)

    @property
    def leads(self) -> str:
        """The separator in front, as a number; empty where none stands there."""
        return hexadecimal(self.form.separator or 0) if self.form.leads else ""

    @property
    def is_single(self) -> bool:
        """True if the text is always one character."""
        return self.form.base == 256 and not self.form.empty

    @property
    def is_digit(self) -> bool:
        """True if the text is always one digit."""
        return self.longest == 1 and not self.form.empty

    @property
    def absent(self) -> str:
        """What having no text stands for; empty where there always is some."""
        return constant(self.form.absent, self.type) if self.form.empty else ""

    # --- what steps print -----------------------------------------------------------------------

    def text_size(self, helpers: Helpers, address: str, left: str) -> str:
        """The bytes in front of the next separator, of so many that are left."""
        separator = hexadecimal(self.form.separator or 0)
        return f"{helpers.text_size()}({address}, {left}, {separator})"

    def misfit(self, size: str) -> str:
        """The condition that a text has too many bytes or too few."""
        above = f"{size} > {unsigned(self.longest)}"
        if self.is_single:
            return f"{size} != 1U"
        return above if self.form.empty else f"{size} < 1U || {above}"

    def fault(self, helpers: Helpers, address: str, size: str) -> str:
        """The condition that these bytes, as many as a text can have, stand for nothing.

        Empty where all of them stand for something.
        """
        wrong = self._fault(helpers, address, size)
        return f"{size} > 0U && {wrong}" if self.form.empty and wrong else wrong

    def _fault(self, helpers: Helpers, address: str, size: str) -> str:
        if self.form.base == 256:
            return f"*({address}) == 0U" if self.form.empty else ""
        check = self._check(helpers)
        tenth = unsigned(self.form.greatest // self.form.base)
        return f"!{check}({', '.join((address, size, *self._fraction, tenth))})"

    def value(self, helpers: Helpers, address: str, size: str) -> str:
        """The number that lies there."""
        number = self.present(helpers, address, size)
        return f"{size} > 0U ? {number} : {self.absent}" if self.form.empty else number

    def present(self, helpers: Helpers, address: str, size: str) -> str:
        """The number of a text that there is."""
        member = integer_type(self.type)
        if self.form.base == 256:
            number = f"*({address})" if "+" in address else f"*{address}"
        else:
            number = f"{self._read(helpers)}({', '.join((address, size, *self._fraction))})"
            number = number if member == self._kind else f"({member}){number}"
        return number

    def stored(self, helpers: Helpers, address: str, value: str) -> str:
        """The call that writes a number; it gives the bytes that it has."""
        return f"{self._store(helpers)}({', '.join((address, value, *self._form))})"

    def written(self, helpers: Helpers, writing: str, value: str) -> str:
        """The call that hands a number to a writer."""
        store = self._store(helpers)
        name = self._named(f"write_{'signed_' if self.type.signed else ''}{self._case}")
        parameters = (f"{self._kind} value", *self._form_parameters)
        passed = ", ".join(item.rsplit(maxsplit=1)[1] for item in parameters)
        write = helpers.buffered(name, store, parameters, passed, _ROOM)
        return f"{write}({', '.join((writing, value, *self._form))})"

    def size(self, helpers: Helpers, value: str) -> str:
        """The bytes that a number has, without the separator in front; there is some text."""
        if self.form.base == 256:
            return "1U"
        least = unsigned(self.form.padded + self.form.fraction)
        counted = f"{self._size(helpers)}({value}, {least})"
        return f"{counted} + 1U" if self.form.fraction else counted

    # --- names and types ------------------------------------------------------------------------

    @property
    def _width(self) -> int:
        return max(16, storage_bits(self.type.bits))

    @property
    def _held(self) -> str:
        """The type of a number without its sign."""
        return f"uint{self._width}_t"

    @property
    def _kind(self) -> str:
        """The type of a number."""
        return f"int{self._width}_t" if self.type.signed else self._held

    @property
    def _case(self) -> str:
        """What numbers are called that are written alike."""
        return self.form.name if self.form.upper else f"lower_{self.form.name}"

    def _named(self, words: str) -> str:
        return f"{words}_{self._width}"

    @property
    def _fraction(self) -> tuple[str, ...]:
        """The argument that says how many digits stand behind the point."""
        return (unsigned(self.form.fraction),) if self.form.base == 10 else ()

    @property
    def _fraction_parameter(self) -> tuple[str, ...]:
        return ("uint8_t fraction",) if self.form.base == 10 else ()

    @property
    def _form(self) -> tuple[str, ...]:
        """The arguments that say how a number is written."""
        return (unsigned(self.form.padded + self.form.fraction), *self._fraction)

    @property
    def _form_parameters(self) -> tuple[str, ...]:
        return ("size_t least", *self._fraction_parameter)

    # --- functions ------------------------------------------------------------------------------

    def _check(self, helpers: Helpers) -> str:
        parameters = (*_TEXT, *self._fraction_parameter, f"{self._held} tenth")
        body = (_CHECK_DECIMAL if self.form.base == 10 else _CHECK_HEXADECIMAL).format(
            held=self._held
        )
        name = helpers.helper(self._named(f"is_{self.form.name}"), "bool", parameters, body)
        if not self.type.signed:
            return name
        body = _WITHOUT_SIGN.format(plain=name)
        return helpers.helper(self._named("is_signed_decimal"), "bool", parameters, body)

    def _read(self, helpers: Helpers) -> str:
        parameters = (*_TEXT, *self._fraction_parameter)
        body = (_READ_DECIMAL if self.form.base == 10 else _READ_HEXADECIMAL).format(
            held=self._held
        )
        name = helpers.helper(self._named(f"read_{self.form.name}"), self._held, parameters, body)
        if not self.type.signed:
            return name
        body = _WITH_SIGN.format(plain=name, kind=self._kind)
        return helpers.helper(self._named("read_signed_decimal"), self._kind, parameters, body)

    def _plain_size(self, helpers: Helpers) -> str:
        rest = "/ 10U" if self.form.base == 10 else ">> 4"
        parameters = (f"{self._held} value", "size_t least")
        body = _SIZE.format(held=self._held, rest=rest)
        name = self._named(f"size_of_{self.form.name}")
        return helpers.helper(name, "size_t", parameters, body)

    def _size(self, helpers: Helpers) -> str:
        plain = self._plain_size(helpers)
        if not self.type.signed:
            return plain
        body = _SIZE_SIGN.format(plain=plain, held=self._held)
        parameters = (f"{self._kind} value", "size_t least")
        name = self._named("size_of_signed_decimal")
        return helpers.helper(name, "size_t", parameters, body)

    def _store(self, helpers: Helpers) -> str:
        sized, held = self._plain_size(helpers), self._held
        if self.form.base == 10:
            body = _STORE_DECIMAL.format(sized=sized, held=held)
        else:
            letter = "0x37U" if self.form.upper else "0x57U"
            body = _STORE_HEXADECIMAL.format(sized=sized, held=held, letter=letter)
        parameters = ("uint8_t *at", f"{held} value", *self._form_parameters)
        name = helpers.helper(self._named(f"store_{self._case}"), "size_t", parameters, body)
        if not self.type.signed:
            return name
        body = _STORE_SIGN.format(plain=name, held=held)
        parameters = ("uint8_t *at", f"{self._kind} value", *self._form_parameters)
        return helpers.helper(self._named("store_signed_decimal"), "size_t", parameters, body)
