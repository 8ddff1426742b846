"""Names of raw values, of single bits and of runs of bits."""

from __future__ import annotations

import msgspec

from protogen.model.origin import NOTHING, About


class NamedValue(msgspec.Struct, frozen=True, kw_only=True):
    """A name for a raw value."""

    name: str
    value: int
    about: About = NOTHING


class Enum(msgspec.Struct, frozen=True, kw_only=True):
    """Names of raw values. Unknown values are kept unless the enum is closed."""

    name: str
    """Snake-case name, unique in the protocol."""
    values: tuple[NamedValue, ...]
    closed: bool = False
    about: About = NOTHING

    @property
    def characters(self) -> frozenset[int]:
        """Its values that are bytes: one that no character has may stand in a bad schema."""
        return frozenset(item.value for item in self.values if 0 <= item.value <= 0xFF)


class NamedBit(msgspec.Struct, frozen=True, kw_only=True):
    """A name for one bit, counted from the least significant bit 0."""

    name: str
    bit: int
    about: About = NOTHING


class Flags(msgspec.Struct, frozen=True, kw_only=True):
    """Names of single bits of one integer. Unknown bits are kept."""

    name: str
    bits: tuple[NamedBit, ...]
    about: About = NOTHING


class BitField(msgspec.Struct, frozen=True, kw_only=True):
    """A named run of bits, `low` to `high`, both included."""

    name: str
    low: int
    high: int
    enum: Enum | None = None
    about: About = NOTHING

    @property
    def mask(self) -> int:
        """The bits of this run, in place."""
        return ((1 << (self.high - self.low + 1)) - 1) << self.low
