"""Names of raw values, of single bits and of runs of bits."""

from __future__ import annotations

from dataclasses import dataclass

from protogen.model.origin import NOTHING, About


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedValue:
    """A name for a raw value."""

    name: str
    value: int
    about: About = NOTHING


@dataclass(frozen=True, slots=True, kw_only=True)
class Enum:
    """Names of raw values. Unknown values are kept unless the enum is closed."""

    name: str
    """Snake-case name, unique in the protocol."""
    values: tuple[NamedValue, ...]
    closed: bool = False
    about: About = NOTHING


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedBit:
    """A name for one bit, counted from the least significant bit 0."""

    name: str
    bit: int
    about: About = NOTHING


@dataclass(frozen=True, slots=True, kw_only=True)
class Flags:
    """Names of single bits of one integer. Unknown bits are kept."""

    name: str
    bits: tuple[NamedBit, ...]
    about: About = NOTHING


@dataclass(frozen=True, slots=True, kw_only=True)
class BitField:
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
