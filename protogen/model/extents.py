"""Extents: the number of elements or bytes of a field."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field as dataclass_field
from typing import ClassVar

import msgspec

from protogen.model.expressions import Expression, Operand, names_in
from protogen.model.sizes import SizeSet

_NO_NAMES: frozenset[str] = frozenset()


class Fixed(msgspec.Struct, frozen=True, kw_only=True):
    """A number of elements (or bytes) that never changes."""

    count: int
    stated: ClassVar[bool] = True
    needs: ClassVar[frozenset[str]] = _NO_NAMES

    @property
    def label(self) -> str:
        """The number in the words of the schema language."""
        return str(self.count)

    @property
    def counts(self) -> SizeSet:
        """Possible numbers of elements."""
        return SizeSet.exactly(self.count)


@dataclass(frozen=True, slots=True, kw_only=True)
class Counted:
    """As many as earlier fields of the same struct or message, or of those around it, say."""

    by: Expression
    least: int
    greatest: int
    stated: bool = dataclass_field(default=False, compare=False)
    """True if the schema bounds the number; else `greatest` is what the fields or frame can take,
    in a declared type wherever it has the most room."""

    @property
    def needs(self) -> frozenset[str]:
        """The names of the fields that count."""
        return names_in(self.by)

    @property
    def label(self) -> str:
        """The number in the words of the schema language."""
        return self.by.text

    @property
    def counts(self) -> SizeSet:
        """Possible numbers of elements."""
        return SizeSet.between(self.least, self.greatest)


@dataclass(frozen=True, slots=True, kw_only=True)
class Delimited:
    """As many as there are, `least` to `greatest`; no number says how many."""

    least: int = 0
    greatest: int
    stated: bool = dataclass_field(default=False, compare=False)
    """True if the schema bounds the number; else `greatest` is what the frame can take, in a
    declared type wherever it has the most room."""
    needs: ClassVar[frozenset[str]] = _NO_NAMES

    @property
    def counts(self) -> SizeSet:
        """Possible numbers of elements, or of bytes without what ends them."""
        return SizeSet.between(self.least, self.greatest)


class Tail(msgspec.Struct, frozen=True, kw_only=True):
    """What stands behind an array that takes what is left, in bytes or in fields."""

    separator: int | None
    """The byte in front of each field, where fields are counted; None: bytes are."""
    element: int
    """Bytes or fields of an element."""
    least: int
    """Bytes or fields that are always behind the array; optional ones are fewer than an element."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Fill(Delimited):
    """As many as the payload has left."""

    tail: Tail | None = None
    """What stands behind, if anything does: the elements end where less than one is left to it."""

    @property
    def label(self) -> str:
        """The number in the words of the schema language."""
        return "fill"


@dataclass(frozen=True, slots=True, kw_only=True)
class Until(Delimited):
    """As many as stand in front of a terminator."""

    byte: int
    """The terminator, which is no part of the value."""

    @property
    def label(self) -> str:
        """The number in the words of the schema language."""
        return f"until 0x{self.byte:02X}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Marked(Delimited):
    """As many elements as there are up to the first whose mark is not 0."""

    mark: Operand
    """The field of the element, or the bits of one, that says that it is the last."""
    least: int = 1

    @property
    def label(self) -> str:
        """The number in the words of the schema language."""
        return f"until {self.mark.label}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Between(Delimited):
    """As many characters as stand in front of the next separator, or of the payload's end."""

    separator: int
    leads: bool
    """True if the separator also stands in front."""
    characters: bytes
    """Those that a text can have; with the separator, it goes to the payload's end."""

    @property
    def takes_rest(self) -> bool:
        """True if the text goes to the payload's end, separators included."""
        return self.separator in self.characters

    @property
    def alphabet(self) -> bytes:
        """The bytes that it can have on the wire."""
        return bytes(sorted({*self.characters, self.separator}))

    @property
    def label(self) -> str:
        """The number in the words of the schema language."""
        place = f" behind {self.separator:02X}" if self.leads else ""
        return f"{'fill' if self.takes_rest else f'{self.least}..{self.greatest}'}{place}"


Extent = Fixed | Counted | Fill | Until | Marked | Between
