"""The raw value for a physical one that is to be read back as a physical value again."""

from __future__ import annotations

from collections.abc import Collection
from fractions import Fraction


def nearest_reading(
    exact: Fraction, special: Collection[int], least: int, greatest: int
) -> int | None:
    """The whole number in `least`..`greatest` nearest to `exact` that is not special.

    Ties go to the even one. None where every number in the bounds is special.
    """
    start = min(max(round(exact), least), greatest)
    # Of so many neighbours on each side at least one is left, unless the bounds come first.
    first, last = max(least, start - len(special)), min(greatest, start + len(special))
    free = [raw for raw in range(first, last + 1) if raw not in special]
    return min(free, key=lambda raw: (abs(raw - exact), raw % 2), default=None)
