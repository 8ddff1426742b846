"""Fields: a type, where it lies, and what its values mean."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from protogen.model.origin import NOTHING, About
from protogen.model.types import NamedValue, Type

Constant = int | float | str | bytes | tuple[int, ...]
"""A raw value: a number, a text, bytes, or the numbers of an array."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """One field of a message or struct.

    For integers `least` and `greatest` are the raw bounds that an encoder allows: the range, else
    what the bits can hold; for floats they are the range or None; for arrays they bound each
    element. The same holds for `special`, `scale`, `offset` and `unit`.
    """

    name: str
    type: Type
    position: int | None
    """Byte offset in the message or struct; None where it varies."""
    const: Constant | None = None
    default: Constant | None = None
    least: Fraction | None = None
    greatest: Fraction | None = None
    ranged: bool = False
    """Whether the schema states the range."""
    scale: Fraction = Fraction(1)
    offset: Fraction = Fraction(0)
    unit: str | None = None
    special: tuple[NamedValue, ...] = ()
    unknown: bool = False
    about: About = NOTHING

    @property
    def scaled(self) -> bool:
        """Whether the physical value differs from the raw value."""
        return self.scale != 1 or self.offset != 0

    @property
    def size(self) -> int | None:
        """Wire bytes, where they do not vary."""
        return self.type.sizes.fixed
