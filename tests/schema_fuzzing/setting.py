"""The setting that a field is drawn in, and the outcome.

Sizes are worked out here independently of the compiler: a drawn schema is valid because of how it
was made, not because the compiler was asked.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from protogen.copying import replace


@dataclass(frozen=True, slots=True)
class Size:
    """Least and greatest number of bytes (or elements)."""

    least: int
    greatest: int

    @property
    def fixed(self) -> bool:
        return self.least == self.greatest

    def __add__(self, other: Size) -> Size:
        return Size(self.least + other.least, self.greatest + other.greatest)

    def __or__(self, other: Size) -> Size:
        return Size(min(self.least, other.least), max(self.greatest, other.greatest))

    def __mul__(self, count: Size) -> Size:
        return Size(self.least * count.least, self.greatest * count.greatest)


NOTHING = Size(0, 0)


@dataclass(frozen=True, slots=True)
class Named(Size):
    """Bounds of a number of which some values have names."""

    names: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Selector:
    """An integer that a switch may be chosen by: how its values are written as keys of cases.

    The last key may be that of all other values, where there are some.
    """

    name: str
    keys: tuple[Any, ...]


ELSE = "else"
"""Key of the case of all values that no other case has."""


@dataclass(frozen=True, slots=True)
class Built:
    """A drawn field. `counts`: the bounds of its value, where it may count something.

    `operands`: the bounds of what the bits of its numbers hold, by what stands behind its name:
    nothing, `.bits`, `.member.bits`.
    """

    data: Any
    size: Size
    counts: Size | None = None
    keys: tuple[Any, ...] = ()
    fills: bool = False
    operands: Mapping[str, Size] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Declared:
    """A declared type. `chooses`: there is a switch in it."""

    name: str
    built: Built
    is_struct: bool
    chooses: bool


@dataclass(frozen=True, slots=True)
class Setting:
    """Place of a field."""

    byte_bits: int
    ordered: bool
    """True if a byte order is in force."""
    whole_bytes: bool
    """True if the type `byte` is allowed, which in 7-bit payloads may hold delimiters."""
    budget: int
    """Bytes that may still be used."""
    room: int | None
    """The room that the compiler takes for left; None where no length part bounds it."""
    delimited: bool
    last: bool
    exact: bool = True
    """True if everything in front has one size, so that `room` is what is really left."""
    depth: int = 0
    counters: Mapping[str, Size] = field(default_factory=dict)
    operands: Mapping[str, Size] = field(default_factory=dict)
    selectors: tuple[Selector, ...] = ()
    types: tuple[Declared, ...] = ()

    def behind(self, size: Size) -> Setting:
        """The setting of what follows something of this size."""
        return replace(
            self,
            budget=self.budget - size.greatest,
            room=None if self.room is None else max(0, self.room - size.least),
            exact=self.exact and size.fixed,
        )

    def inside(self, *, last: bool) -> Setting:
        """The setting one struct deeper."""
        return replace(self, depth=self.depth + 1, last=self.last and last)

    def bytes_of(self, bits: int) -> int:
        """Wire bytes of a number."""
        return -(-bits // self.byte_bits)

    @property
    def may_fill(self) -> bool:
        """True if something may stand here that takes the rest of the payload."""
        return self.last and self.delimited
