"""Sets of possible sizes, kept as an arithmetic progression."""

from __future__ import annotations

from functools import lru_cache
from math import gcd

import msgspec


class SizeSet(msgspec.Struct, frozen=True):
    """Sizes in bytes: `least`, `least + step`, ... up to `greatest`.

    Unions widen to the finest progression that holds both sides, so a set may hold more than can
    occur, never less. `step` is 0 exactly where there is one size.
    """

    least: int
    greatest: int
    step: int = 0

    @classmethod
    def exactly(cls, size: int) -> SizeSet:
        """One size."""
        return _exactly(size)

    @classmethod
    def between(cls, least: int, greatest: int, step: int = 1) -> SizeSet:
        """`least` to `greatest` in steps; `greatest` is rounded down to a step."""
        if step == 0 or greatest - least < step:
            return cls.exactly(least)
        return cls(least, least + (greatest - least) // step * step, step)

    @property
    def fixed(self) -> int | None:
        """The size, where there is only one."""
        return self.least if self.least == self.greatest else None

    def __contains__(self, size: int) -> bool:
        if not self.least <= size <= self.greatest:
            return False
        return size == self.least if self.step == 0 else (size - self.least) % self.step == 0

    def __add__(self, other: SizeSet) -> SizeSet:
        return SizeSet.between(
            self.least + other.least, self.greatest + other.greatest, gcd(self.step, other.step)
        )

    def __or__(self, other: SizeSet) -> SizeSet:
        least = min(self.least, other.least)
        step = gcd(self.step, other.step, abs(self.least - other.least))
        return SizeSet.between(least, max(self.greatest, other.greatest), step)

    def times(self, count: SizeSet) -> SizeSet:
        """Sizes of `count` elements of this size."""
        least, greatest = self.least * count.least, self.greatest * count.greatest
        if self.fixed is not None:
            return SizeSet.between(least, greatest, self.least * count.step)
        return SizeSet.between(least, greatest, 1)

    def holds(self, other: SizeSet) -> bool:
        """True if every size of the other set is in this one."""
        if other.least not in self or other.greatest not in self:
            return False
        return self.step == 0 or other.step % self.step == 0

    def meets(self, other: SizeSet) -> bool:
        """True if some size is in both sets."""
        step, stride = self.step or 1, other.step or 1
        common = gcd(step, stride)
        apart = other.least - self.least
        if apart % common:
            return False
        # So many steps, modulo what repeats, lead to a size that both progressions have.
        turns = apart // common * pow(step // common, -1, stride // common) % (stride // common)
        period = step // common * stride
        low = max(self.least, other.least)
        first = low + (self.least + turns * step - low) % period
        return first <= min(self.greatest, other.greatest)

    def within(self, low: int, high: int) -> SizeSet | None:
        """The sizes from `low` to `high`, both included; None where there are none."""
        members = self.members(low, high)
        return SizeSet.between(members[0], members[-1], self.step) if members else None

    def members(self, low: int, high: int) -> range:
        """The sizes from `low` to `high`, both included."""
        step = self.step or 1
        first = (
            self.least if low <= self.least else self.least + -(-(low - self.least) // step) * step
        )
        return range(first, min(high, self.greatest) + 1, step)

    def __str__(self) -> str:
        if self.fixed is not None:
            return str(self.least)
        text = f"{self.least}..{self.greatest}"
        return text if self.step == 1 else f"{text} in steps of {self.step}"


@lru_cache(maxsize=4096)
def _exactly(size: int) -> SizeSet:
    # A large schema asks for the same few sizes some hundred thousand times.
    return SizeSet(size, size)
