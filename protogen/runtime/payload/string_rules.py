"""Rules of bytes and texts."""

from __future__ import annotations

from typing import Any

from protogen.runtime.errors import EncodeError
from protogen.runtime.payload.formula import Formula
from protogen.runtime.payload.rules import Scope, SeveralRule, Violation, check_most, refuse
from protogen.runtime.payload.texts import PaddedText


class OctetsRule(SeveralRule[bytes]):
    """Bytes: `size` of them, or as many as earlier fields say; None: `least` to `greatest`.

    With `until` none of them is that byte, which ends them.
    """

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> bytes:
        """The bytes."""
        if not isinstance(value, bytes | bytearray | memoryview):
            raise EncodeError("", f"must be bytes, not {value!r}")
        data = bytes(value)  # What a view counts may have several bytes.
        self._check_count(len(data), scope, "bytes")
        self._check_end(data)
        if self.const is not None and data != self.const:
            raise EncodeError("", f"must be {self.const.hex(' ')}")
        return data

    def to_json(self, value: bytes, scope: Scope) -> str:
        """Two hexadecimal digits a byte."""
        return bytes(value).hex()

    def from_json(self, data: Any, scope: Scope) -> bytes:
        """Bytes of a text of hexadecimal digits; blanks are ignored."""
        try:
            return bytes.fromhex(data)
        except (TypeError, ValueError):
            raise EncodeError("", f"must be hexadecimal digits, not {data!r}") from None


class TextRule(SeveralRule[str]):
    """Text of one byte a character, which is ASCII; a decoder keeps whatever byte there is.

    `size` is a number: the text has at most so many characters, and NUL pads it, or what `form`
    says. It is what earlier fields say: exactly as many. None: `least` to `greatest`. With `until`
    none of the characters is that byte, which ends the text; with `characters` all are among those.
    """

    def __init__(
        self,
        size: int | str | Formula | None = None,
        greatest: int | None = None,
        const: str | None = None,
        least: int = 0,
        until: int | None = None,
        form: PaddedText | None = None,
        characters: bytes = b"",
    ) -> None:
        super().__init__(size, greatest, const, least, until)
        self.characters = characters
        self.form = PaddedText(size) if form is None and isinstance(size, int) else form

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> str:
        """The text."""
        text = self.from_json(value, scope)
        if strict:
            refuse(self.violations(text, scope))
        if any(character > "\xff" for character in text):
            raise EncodeError("", f"must be text of characters up to U+00FF, not {text!r}")
        if self.form is not None:
            check_most(len(text), self.form.size, "characters")
            text = text.rstrip(chr(self.form.padding))  # The padding is the same bytes.
            if fault := self.form.foreign_in(text):
                raise EncodeError("", fault)
        else:
            self._check_count(len(text), scope, "characters")
            self._check_end(text.encode("latin-1"))
            self._check_characters(text)
        if self.const is not None and text != self.const:
            raise EncodeError("", f"must be {self.const!r}")
        return text

    def _check_characters(self, text: str) -> None:
        """Refuse a character that can't stand between separators."""
        wrong = next((it for it in text if self.characters and ord(it) not in self.characters), "")
        if wrong:
            raise EncodeError("", f"has {wrong!r}, which can't stand between separators here")

    def violations(self, value: str, scope: Scope) -> list[Violation]:
        """Padding at the end, which is lost; what ASCII does not have, as code pages differ."""
        if value.isascii():
            fault = "" if self.form is None else self.form.fault_of(value)
            return [Violation("", fault)] if fault else []
        index = next(index for index, character in enumerate(value) if character > "\x7f")
        place = f"{value[index]!r}, character {index + 1} of {len(value)}, is none"
        return [Violation("", f"must be ASCII, characters up to U+007F; {place}")]

    def from_json(self, data: Any, scope: Scope) -> str:
        """The text."""
        if not isinstance(data, str):
            raise EncodeError("", f"must be text, not {data!r}")
        return data
