"""Texts whose characters lie in a code in their bytes, or that have another padding than NUL.

A struct has the text itself, with NUL behind it, whatever the padding on the wire is.
"""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from protogen.c_language.numbers import hexadecimal
from protogen.model.types import Text, TextForm
from protogen.targets.c.payload.helpers import Helpers

_IS_SOUND = """\
for (size_t i = 0; i < size; i++) {{
    const unsigned int code = (unsigned int)at[i]{less};
    if ({wrong}) {{
        return false;
    }}
}}
return true;
"""
_LENGTH = """\
const uint8_t *source = (const uint8_t *)from;
size_t length = size;
while (length > 0U && source[length - 1U] == 0U) {
    length--;
}
"""
_IS_FIT = """\
if (length > 0U && source[length - 1U] == {padding}) {{
    return false;
}}
for (size_t i = 0; i < length; i++) {{
    if (source[i] == 0U) {{
        return false;
    }}
}}
return true;
"""
_LOAD = """\
uint8_t *target = (uint8_t *)to;
bool is_padding = true;
while (size > 0U) {{
    size--;
    const uint8_t character = {character};
    is_padding = is_padding && character == {padding};
    target[size] = is_padding ? 0U : character;
}}
"""
_LOAD_BARE = """\
uint8_t *target = (uint8_t *)to;
while (size > 0U) {{
    size--;
    target[size] = {character};
}}
"""
_STORE = """\
while (size > 0U) {{
    size--;
    const unsigned int character = size < length ? source[size] : {padding};
    at[size] = {byte};
}}
"""
_WRITE = """\
for (size_t i = 0; i < size; i++) {{
    const unsigned int character = i < length ? source[i] : {padding};
    {prefix}_write({writing}, {byte});
}}
"""


class PaddedText(msgspec.Struct, frozen=True):
    """The functions for such texts of one form."""

    form: TextForm

    @staticmethod
    def of(type_: object) -> PaddedText | None:
        """The functions for a type; None where its bytes are the text as it is."""
        return (
            PaddedText(type_.form) if isinstance(type_, Text) and not type_.form.is_plain else None
        )

    def is_sound(self, helpers: Helpers) -> str:
        """The function that says whether all bytes stand for characters."""
        less = f" - {hexadecimal(self.form.add)}" if self.form.add else ""
        body = _IS_SOUND.format(less=less, wrong=" || ".join(self._wrong()))
        arguments = ("const uint8_t *at", "size_t size")
        return helpers.helper(f"is_text{self._key}", "bool", arguments, body)

    def _wrong(self) -> Iterator[str]:
        """Conditions of a byte, less what was added, that stands for no character.

        A byte that is less than that makes the difference great, or odd where it is shifted.
        """
        form = self.form
        if form.shift:
            yield f"(code & {hexadecimal((1 << form.shift) - 1)}) != 0U"
        elif form.bits < 8:
            yield f"code > {hexadecimal((1 << form.bits) - 1)}"
        if form.padding:
            yield "code == 0U"

    def is_fit(self, helpers: Helpers) -> str:
        """The function that says whether a struct's text is read again as it is.

        Empty where each one is. NUL ends the text, and padding in front of it would be lost.
        """
        if not self.form.padding:
            return ""
        body = _LENGTH + _IS_FIT.format(padding=self._padding)
        arguments = ("const void *from", "size_t size")
        return helpers.helper(f"is_padded_by_{self.form.padding:02x}", "bool", arguments, body)

    def load(self, helpers: Helpers) -> str:
        """The function that reads a text."""
        shape = _LOAD if self.form.padding else _LOAD_BARE
        body = shape.format(character=self._character, padding=self._padding)
        arguments = ("void *to", "const uint8_t *at", "size_t size")
        return helpers.helper(f"load_text{self._key}", "void", arguments, body)

    def store(self, helpers: Helpers) -> str:
        """The function that puts a text into memory."""
        body = _LENGTH + _STORE.format(padding=self._padding, byte=self._byte)
        arguments = ("uint8_t *at", "const void *from", "size_t size")
        return helpers.helper(f"store_text{self._key}", "void", arguments, body)

    def write(self, helpers: Helpers, prefix: str, writing: str) -> str:
        """The function that hands a text to a writer."""
        text = _WRITE.format(padding=self._padding, byte=self._byte, prefix=prefix, writing=writing)
        arguments = (helpers.writer, "const void *from", "size_t size")
        return helpers.helper(f"write_text{self._key}", "void", arguments, _LENGTH + text)

    @property
    def _key(self) -> str:
        """The form, as a part of names."""
        form = self.form
        code = f"_{form.bits}_{form.shift}_{form.add}" if form.bits < 8 else ""
        return f"{code}_of_{form.padding:02x}"

    @property
    def _padding(self) -> str:
        return hexadecimal(self.form.padding)

    @property
    def _character(self) -> str:
        """The character of a byte."""
        less = f"at[size] - {hexadecimal(self.form.add)}" if self.form.add else "at[size]"
        if self.form.shift:
            less = (
                f"({less}) >> {self.form.shift}"
                if self.form.add
                else f"{less} >> {self.form.shift}"
            )
        return less if less == "at[size]" else f"(uint8_t)({less})"

    @property
    def _byte(self) -> str:
        """The byte of a character."""
        code = f"character << {self.form.shift}" if self.form.shift else "character"
        if self.form.add:
            code = f"({code}) + {hexadecimal(self.form.add)}"
        return f"(uint8_t)({code})" if code != "character" else "(uint8_t)character"
