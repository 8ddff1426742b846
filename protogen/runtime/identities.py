"""Several identities of one message."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from protogen.runtime.values import Frozen

Identity = tuple[int, ...]
"""The values of a frame's identity parts, in wire order."""

Runs = tuple[tuple[int, int], ...]
"""Runs of values, each from the first to the last."""


class Identities(Frozen):
    """All that some values of each identity part make up together.

    `runs` has those of each part, in wire order: from the first to the last of each run.
    """

    __slots__ = ("runs",)

    runs: tuple[Runs, ...]

    def __init__(self, runs: tuple[Runs, ...]) -> None:
        self._set(runs)

    def __contains__(self, identity: Identity) -> bool:
        return all(map(self.holds, range(len(self.runs)), identity))

    def holds(self, index: int, value: int) -> bool:
        """True if the part of this index can have the value."""
        return any(first <= value <= last for first, last in self.runs[index])

    @property
    def count(self) -> int:
        """Number of identities."""
        found = 1
        for runs in self.runs:
            found *= sum(last - first + 1 for first, last in runs)
        return found

    def __iter__(self) -> Iterator[Identity]:
        """All of them; there can be very many."""
        values = [
            [value for first, last in runs for value in range(first, last + 1)]
            for runs in self.runs
        ]
        return product(*values)
