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
_ALL_REGISTERS = (1 << _REGISTERS) - 1
_EVEN_RUNS = [(1 << bit, _ALL_REGISTERS // ((1 << (1 << bit)) + 1)) for bit in range(8)]
"""Each bit of a byte, and the set of registers in which it is 0."""
_MOST_STEPS = 1 << 18


class Place(msgspec.Struct, frozen=True):
    """One byte: what it is worth at most, and its values by how much less they are worth."""

    top: int
    options: Mapping[int, Sequence[int]]
    sets: Mapping[int, int]
    """The same values, as numbers with a bit for each."""

    @classmethod
    def of(cls, values: frozenset[int], worth: Callable[[int], int]) -> Place:
        """A byte that has one of these values."""
        top = max(map(worth, values))
        options: dict[int, list[int]] = {}
        for value in sorted(values):
            options.setdefault(top - worth(value), []).append(value)
        sets = {loss: sum(1 << value for value in each) for loss, each in options.items()}
        return cls(top, dict(sorted(options.items())), sets)


Sum = Callable[[int, int], int]
"""One step of a checksum whose register is a byte: set of registers and byte to set of registers.

A set is a number with a bit for each register that is in it.
"""


def added(registers: int, byte: int) -> int:
    """Add a byte to each register of a set."""
    moved = registers << byte
    return (moved | moved >> _REGISTERS) & _ALL_REGISTERS


def exclusive_or(registers: int, byte: int) -> int:
    """Take the exclusive or of a byte and each register of a set."""
    for bit, even in _EVEN_RUNS:
        if byte & bit:
            registers = (registers & even) << bit | registers >> bit & even
    return registers


def most_summed(
    places: Sequence[Place], step: Sum, worths: Sequence[int], register: int
) -> int | None:
    """The most that the bytes and a checksum of one byte are worth; None: too many to follow.

    `worths` says what the checksum is worth that comes of each register; before the first byte
    that is `register`.
    """
    reached = [1 << register, *[0] * (max(worths) - min(worths))]
    top = sum(place.top for place in places)
    steps = 0
    for _, group in groupby(places, key=id):
        alike = list(group)
        before: list[int] = []
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
        max(worth for value, worth in enumerate(worths) if registers >> value & 1) - loss
        for loss, registers in enumerate(reached)
        if registers
    )


def _stepped(reached: Sequence[int], place: Place, step: Sum) -> tuple[list[int], int]:
    """The registers behind one more byte, by what was lost until there, and the steps it took.

    To lose more than there is between the checksums that are worth most and least is of no use.
    """
    found = [0] * len(reached)
    steps = len(found)
    for loss, registers in enumerate(reached):
        for own, values in place.sets.items():
            if registers and loss + own < len(found):
                found[loss + own] |= _all_sums(registers, values, step)
                steps += min(registers.bit_count(), values.bit_count())
    return found, steps


def _all_sums(registers: int, values: int, step: Sum) -> int:
    """The registers that come of any of these registers and any of these values."""
    if registers.bit_count() + values.bit_count() > _REGISTERS:
        return _ALL_REGISTERS  # Each register comes of at least one of so many.
    few, many = sorted((registers, values), key=int.bit_count)
    found = 0
    while few:
        found |= step(many, few.bit_length() - 1)
        few ^= 1 << few.bit_length() - 1
    return found


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
