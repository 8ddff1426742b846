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
    """A named run of bits, `low` to `high`, both included; or several, with gaps between them."""

    name: str
    low: int
    high: int
    gaps: int = 0
    """The bits in between that are none of it, in place. They are 0 in its value."""
    enum: Enum | None = None
    about: About = NOTHING

    @property
    def mask(self) -> int:
        """The bits of this run, in place."""
        return _mask(self.low, self.high) & ~self.gaps

    @property
    def runs(self) -> tuple[tuple[int, int], ...]:
        """The lowest and the highest bit of each run."""
        found: list[tuple[int, int]] = []
        for bit in range(self.low, self.high + 1):
            if not self.mask >> bit & 1:
                continue
            if found and found[-1][1] == bit - 1:
                found[-1] = (found[-1][0], bit)
            else:
                found.append((bit, bit))
        return tuple(found)

    @property
    def words(self) -> str:
        """Its bits, such as `bit 4`, or `bits 0 to 3 and 5 to 7`."""
        if self.low == self.high:
            return f"bit {self.low}"
        shown = (str(low) if low == high else f"{low} to {high}" for low, high in self.runs)
        return f"bits {' and '.join(shown)}"


def _mask(low: int, high: int) -> int:
    return ((1 << (high - low + 1)) - 1) << low
