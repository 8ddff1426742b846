"""Size on the wire of some bytes and of the checksum of them, at most or at least.

A checksum follows from what it covers, so that both may never be at their longest, or at their
shortest, at once. Bytes and checksums are *worth* something here: their bytes on the wire, or less
than nothing where the least size is asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby

import msgspec

_REGISTERS = 256
_MOST_STEPS = 1 << 18


class Place(msgspec.Struct, frozen=True):
    """One byte: what it is worth at most, and its values by how much less they are worth."""

    top: int
    options: Mapping[int, Sequence[int]]

    @classmethod
    def of(cls, values: frozenset[int], worth: Callable[[int], int]) -> Place:
        """A byte that has one of these values."""
        top = max(map(worth, values))
        options: dict[int, list[int]] = {}
        for value in sorted(values):
            options.setdefault(top - worth(value), []).append(value)
        return cls(top, dict(sorted(options.items())))


Sum = Callable[[int, int], int]
"""One step of a checksum whose register is a byte: register and byte to register."""


def most_summed(
    places: Sequence[Place], step: Sum, worths: Sequence[int], register: int
) -> int | None:
    """The most that the bytes and a checksum of one byte are worth; None: too many to follow.

    `worths` says what the checksum is worth that comes of each register; before the first byte
    that is `register`.
    """
    reached: list[set[int]] = [set() for _ in range(max(worths) - min(worths) + 1)]
    reached[0].add(register)
    top = sum(place.top for place in places)
    steps = 0
    for _, group in groupby(places, key=id):
        alike = list(group)
        before: list[set[int]] = []
        while alike and steps <= _MOST_STEPS:
            found, taken = _stepped(reached, alike.pop(), step)
            steps += taken
            if found in (before, reached):
                # One or two more places alike change nothing, as is usual with exclusive ors.
                del alike[len(alike) % 2 if found == before else 0 :]
            before, reached = reached, found
    if steps > _MOST_STEPS:
        return None
    return top + max(
        max(worths[value] for value in registers) - loss
        for loss, registers in enumerate(reached)
        if registers
    )


def _stepped(reached: Sequence[set[int]], place: Place, step: Sum) -> tuple[list[set[int]], int]:
    """The registers behind one more byte, by what was lost until there, and the steps it took.

    To lose more than there is between the checksums that are worth most and least is of no use.
    """
    found: list[set[int]] = [set() for _ in reached]
    steps = len(found)
    for loss, registers in reversed(list(enumerate(reached))):
        for own, values in place.options.items():
            if not registers or loss + own >= len(found):
                continue
            if len(registers) == _REGISTERS:
                found[loss + own] = registers  # A step takes all registers to all.
            steps += _add_steps(found[loss + own], registers, values, step)
    return found, steps


def _add_steps(found: set[int], registers: set[int], values: Sequence[int], step: Sum) -> int:
    """Add what comes of these registers and values."""
    for done, value in enumerate(values):
        if len(found) == _REGISTERS:
            return done * len(registers)
        found.update([step(register, value) for register in registers])
    return len(values) * len(registers)


def most_tried(
    places: Sequence[Place], checksum: Callable[[bytes], int], bound: int, tries: int
) -> int:
    """The most that the bytes and their checksum are worth, by trying.

    `checksum` says what that of given bytes is worth, which is never more than `bound`. After so
    many `tries` the answer may be more than what there is, never less.
    """
    top = sum(place.top for place in places)
    losses = _greatest_losses(places)
    best: int | None = None
    for loss in range(losses[0] + 1):
        ceiling = top - loss + bound
        if best is not None and best >= ceiling:
            return best
        for data in _losing(places, losses, 0, loss):
            if tries == 0:
                return ceiling
            tries -= 1
            found = top - loss + checksum(bytes(data))
            best = found if best is None else max(best, found)
            if best == ceiling:
                return best
    return top + bound if best is None else best


def _greatest_losses(places: Sequence[Place]) -> list[int]:
    """Greatest loss of all places from each one on."""
    losses = [0]
    for place in reversed(places):
        losses.append(losses[-1] + max(place.options))
    return losses[::-1]


def _losing(
    places: Sequence[Place], losses: Sequence[int], index: int, loss: int
) -> Iterator[tuple[int, ...]]:
    """All contents from a place on that are worth so much less than the best ones."""
    if index == len(places):
        if loss == 0:
            yield ()
        return
    for own, values in places[index].options.items():
        if loss - losses[index + 1] <= own <= loss:
            for tail in _losing(places, losses, index + 1, loss - own):
                for value in values:
                    yield (value, *tail)
