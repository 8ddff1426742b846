"""Rules: what the values of a field mean, which of them can be sent, and how JSON shows them.

A rule stands between the attribute of a message and the value that its `FORMAT` builds and parses:
`FORMAT` knows bytes, rules know values. Strict encoding refuses what `violations` calls forbidden;
with `strict=False` only what does not fit the wire is refused.
"""

from __future__ import annotations

from collections import ChainMap
from typing import Any, Generic, NamedTuple, TypeVar

from protogen.runtime.errors import EncodeError, join_path
from protogen.runtime.payload.formula import Formula, number_of

ConstT = TypeVar("ConstT")

Scope = ChainMap[str, Any]
"""Raw values of the fields in front, of this struct and of those around it."""


class Violation(NamedTuple):
    """A value that the schema does not foresee.

    `forbidden`: strict encoding refuses it. Otherwise it has no name in the schema, but it may be
    sent.
    """

    path: str
    problem: str
    forbidden: bool = True

    def inside(self, outer: str) -> Violation:
        """The same violation as seen by what holds the field."""
        return self._replace(path=join_path(outer, self.path))

    def __str__(self) -> str:
        return f"{self.path}: {self.problem}" if self.path else self.problem


class Rule:
    """Base of all rules. `scope` holds the raw values of the fields in front."""

    def chosen(self, scope: Scope) -> Rule:
        """The rule that holds here. Raises EncodeError if there is none."""
        return self

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> Any:
        """The value that FORMAT builds. Raises EncodeError."""
        raise NotImplementedError

    def from_wire(self, raw: Any, scope: Scope) -> Any:
        """The attribute's value for what FORMAT parsed."""
        return raw

    def violations(self, value: Any, scope: Scope) -> list[Violation]:
        """Violations of the schema by a value that fits the wire."""
        return []

    def to_json(self, value: Any, scope: Scope) -> Any:
        """The value as JSON shows it."""
        return value

    def from_json(self, data: Any, scope: Scope) -> Any:
        """The value of what JSON shows. Raises EncodeError where it is of another kind."""
        return data


def refuse(violations: list[Violation]) -> None:
    """Raise EncodeError for the first forbidden value."""
    for violation in violations:
        if violation.forbidden:
            raise EncodeError(violation.path, violation.problem)


class SeveralRule(Rule, Generic[ConstT]):
    """Base of rules for values of which there may be several: `size`, or as earlier fields say.

    None: to the end of the payload, or in front of the byte `until`, `least` to `greatest`.
    """

    def __init__(
        self,
        size: int | str | Formula | None = None,
        greatest: int | None = None,
        const: ConstT | None = None,
        least: int = 0,
        until: int | None = None,
    ) -> None:
        self.size = size
        self.until = until
        self.least = least
        self.greatest = greatest
        self.const = const

    def _check_count(self, count: int, scope: Scope, what: str) -> None:
        exactly, says = self.size, ""
        if isinstance(exactly, str | Formula):
            exactly, says = number_of(exactly, scope.__getitem__), f", as {self.size} says"
        if exactly is not None and exactly < 0:
            raise EncodeError("", f"has {count} {what}, and {self.size} is no number of them")
        if exactly is not None and count != exactly:
            raise EncodeError("", f"needs exactly {exactly} {what}{says}, not {count}")
        _check_most(count, self.greatest, what)
        if count < self.least:
            raise EncodeError("", f"has {count} {what}, at least {self.least} are needed")

    def _check_end(self, data: bytes) -> None:
        """Refuse bytes of which one would end them."""
        if self.until is not None and self.until in data:
            place = f"byte {data.index(self.until) + 1} of {len(data)}"
            raise EncodeError("", f"has {self.until:02X}, which would end it, as {place}")


def _check_most(count: int, greatest: int | None, what: str) -> None:
    if greatest is not None and count > greatest:
        raise EncodeError("", f"has {count} {what}, at most {greatest} are allowed")


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

    `size` is a number: the text has at most so many characters, and NUL pads it. It is what earlier
    fields say: exactly as many. None: `least` to `greatest`. With `until` none of the characters
    is that byte, which ends the text; with `characters` all are among those.
    """

    def __init__(
        self,
        size: int | str | Formula | None = None,
        greatest: int | None = None,
        const: str | None = None,
        least: int = 0,
        until: int | None = None,
        characters: bytes = b"",
    ) -> None:
        super().__init__(size, greatest, const, least, until)
        self.characters = characters

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> str:
        """The text."""
        text = self.from_json(value, scope)
        if strict:
            refuse(self.violations(text, scope))
        if any(character > "\xff" for character in text):
            raise EncodeError("", f"must be text of characters up to U+00FF, not {text!r}")
        if isinstance(self.size, int):
            _check_most(len(text), self.size, "characters")
            text = text.rstrip("\0")  # The padding is the same bytes.
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
        """A NUL at the end that padding hides; what ASCII does not have, as code pages differ."""
        if isinstance(self.size, int) and value.endswith("\0"):
            return [Violation("", "ends with NUL, which a receiver takes for padding")]
        if value.isascii():
            return []
        index = next(index for index, character in enumerate(value) if character > "\x7f")
        place = f"{value[index]!r}, character {index + 1} of {len(value)}, is none"
        return [Violation("", f"must be ASCII, characters up to U+007F; {place}")]

    def from_json(self, data: Any, scope: Scope) -> str:
        """The text."""
        if not isinstance(data, str):
            raise EncodeError("", f"must be text, not {data!r}")
        return data
