"""Identities of a message: one, or several."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from protogen.model.parts import IdentityPart

Identity = tuple[int, ...]
"""Raw value of each identity part, in wire order."""

Runs = tuple[tuple[int, int], ...]
"""Runs of values, each from the first to the last. The first value of all is the default."""


class Identities(msgspec.Struct, frozen=True):
    """Several identities: all that the values of the parts make up together."""

    runs: tuple[Runs, ...]
    """Values of each identity part, in wire order."""

    @classmethod
    def only(cls, identity: Identity) -> Identities:
        """One identity."""
        return cls(tuple(((value, value),) for value in identity))

    @property
    def first(self) -> Identity:
        """The identity that an encoder writes where it is given none."""
        return tuple(runs[0][0] for runs in self.runs)

    @property
    def count(self) -> int:
        """Number of identities."""
        found = 1
        for index in range(len(self.runs)):
            found *= self.values(index)
        return found

    def values(self, index: int) -> int:
        """Number of values that a part has."""
        return sum(last - first + 1 for first, last in self.runs[index])

    def __contains__(self, identity: Identity) -> bool:
        return all(
            any(first <= value <= last for first, last in runs)
            for runs, value in zip(self.runs, identity, strict=True)
        )

    def meet(self, other: Identities) -> Identity | None:
        """An identity of both; None if there is none, or if they have not as many parts."""
        if len(self.runs) != len(other.runs):
            return None
        found = []
        for runs, others in zip(self.runs, other.runs, strict=True):
            both = (max(one[0], item[0]) for one, item in product(runs, others) if _meet(one, item))
            value = min(both, default=None)
            if value is None:
                return None
            found.append(value)
        return tuple(found)

    def covers(self, other: Identities) -> bool:
        """True if all identities of the other are among these."""
        if len(self.runs) != len(other.runs):
            return False
        pairs = zip(self.runs, other.runs, strict=True)
        return all(_are_within(others, runs) for runs, others in pairs)

    def each_run(self) -> Iterator[Identities]:
        """Yield them in pieces, of one run for each part."""
        for runs in product(*self.runs):
            yield Identities(tuple((run,) for run in runs))

    def shown(self, parts: Sequence[IdentityPart]) -> str:
        """These identities of parts, in words: a text as such, numbers in hex."""
        each = zip(parts, self.runs, strict=True)
        return " ".join(", ".join(_run(part, *run) for run in runs) for part, runs in each)

    def __iter__(self) -> Iterator[Identity]:
        """All of them; there can be very many."""
        ranges = [
            [value for first, last in runs for value in range(first, last + 1)]
            for runs in self.runs
        ]
        return product(*ranges)


def _are_within(runs: Runs, others: Runs) -> bool:
    """True if each value of some runs is one of the others."""
    joined: list[tuple[int, int]] = []
    for first, last in sorted(others):
        if joined and first <= joined[-1][1] + 1:
            joined[-1] = (joined[-1][0], max(last, joined[-1][1]))
        else:
            joined.append((first, last))
    return all(any(first <= run[0] and run[1] <= last for first, last in joined) for run in runs)


def _run(part: IdentityPart, first: int, last: int) -> str:
    if part.type.is_text:
        return f'"{part.shown(first)}"'  # Texts have no ranges.
    return f"0x{first:02X}" if first == last else f"0x{first:02X}..0x{last:02X}"


def _meet(one: tuple[int, int], other: tuple[int, int]) -> bool:
    return one[0] <= other[1] and other[0] <= one[1]
