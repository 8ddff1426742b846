"""Can a delimiter occur in a frame where it must not? Worked out apart from the compiler.

A frame is a chain of stretches; each is walked as a small automaton. A literal occurs if some walk
spells it, from any state, other than along a delimiter's own place.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

_Own = tuple[int, int]
"""A delimiter's place, and the byte of it that comes next."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """Words one after another: one, at most one, or any number. `own`: a delimiter's place."""

    words: frozenset[bytes]
    optional: bool = False
    repeated: bool = False
    own: bool = False
    inserted: bytes = b""
    """A sequence and the byte that is put in behind it, also where words side by side make it."""


class Delimited:
    """The bytes that a frame can have on the wire."""

    def __init__(self, stretches: Iterable[Stretch]) -> None:
        self._edges: list[dict[int, set[tuple[int, _Own | None]]]] = [{}]
        self._free: list[set[int]] = [set()]
        self._own_sizes: list[int] = []
        state = 0
        seen: dict[int, int] = {}
        for stretch in _joined(stretches):
            if stretch.inserted:
                seen = self._append_inserted(stretch, seen or {0: state})
                continue
            state, seen = self._left(seen, state), {}
            state = self._append(stretch, state)
        self._left(seen, state)

    def holds(self, literal: bytes) -> bool:
        """True if the literal can occur outside of the delimiters' own places."""
        # A walk that has left a delimiter's own place, or did not begin at it, is None there.
        walks: set[tuple[int, _Own | None]] = set()
        for state in range(len(self._edges)):
            walks |= self._step(state, literal[0], begin=True)
        for byte in literal[1:]:
            walks = {step for walk in walks for step in self._go_on(walk, byte)}
        return any(own is None or not self._is_whole(own, literal) for _, own in walks)

    def _is_whole(self, own: _Own, literal: bytes) -> bool:
        place, taken = own
        return taken == self._own_sizes[place] == len(literal)

    def _go_on(self, walk: tuple[int, _Own | None], byte: int) -> set[tuple[int, _Own | None]]:
        state, own = walk
        found = self._step(state, byte, begin=False)
        return {
            (target, (place[0], place[1] + 1) if place is not None and place == own else None)
            for target, place in found
        }

    def _step(self, state: int, byte: int, *, begin: bool) -> set[tuple[int, _Own | None]]:
        """Next place for a byte; when a walk begins, only a place's first byte is its own."""
        found: set[tuple[int, _Own | None]] = set()
        for reached in self._without_bytes(state):
            found |= self._edges[reached].get(byte, set())
        if not begin:
            return found
        return {
            (target, (own[0], 1) if own is not None and own[1] == 0 else None)
            for target, own in found
        }

    def _without_bytes(self, state: int) -> set[int]:
        reached = {state}
        waiting = [state]
        while waiting:
            for target in self._free[waiting.pop()] - reached:
                reached.add(target)
                waiting.append(target)
        return reached

    # -- the automaton -----------------------------------------------------------------------

    def _append(self, stretch: Stretch, start: int) -> int:
        if stretch.repeated:
            loop = self._new()
            self._free[start].add(loop)
            start = loop
        end = start if stretch.repeated else self._new()
        place = len(self._own_sizes) if stretch.own else None
        states = {b"": start}
        for word in stretch.words:
            self._walk(word, states, end, place)
        if place is not None:
            self._own_sizes.append(len(next(iter(stretch.words))))
        if stretch.optional:
            self._free[start].add(end)
        return end

    def _left(self, seen: dict[int, int], state: int) -> int:
        """The state behind a region, whatever was seen of a sequence at its end."""
        if not seen:
            return state
        end = self._new()
        for reached in seen.values():
            self._free[reached].add(end)
        return end

    def _append_inserted(self, stretch: Stretch, seen: dict[int, int]) -> dict[int, int]:
        """Add words; states by how much of the sequence was seen."""
        sequence, byte = stretch.inserted[:-1], stretch.inserted[-1]
        ends = {size: self._new() for size in range(len(sequence))}
        if stretch.repeated or stretch.optional:
            for size, state in seen.items():
                self._free[state].add(ends[size])
        starts = ends if stretch.repeated else seen
        for size, state in starts.items():
            for word in stretch.words:
                self._walk_inserted(word, sequence, byte, size, state, ends)
        return ends

    def _walk_inserted(
        self, word: bytes, sequence: bytes, byte: int, size: int, state: int, ends: dict[int, int]
    ) -> None:
        for index, value in enumerate(word):
            spelled = sequence[:size] + bytes((value,))
            size = max(n for n in range(len(spelled) + 1) if spelled.endswith(sequence[:n]))
            is_last = index == len(word) - 1
            is_whole = size == len(sequence)
            target = ends[size] if is_last and not is_whole else self._new()
            self._edges[state].setdefault(value, set()).add((target, None))
            state = target
            if is_whole:
                size = 0
                target = ends[0] if is_last else self._new()
                self._edges[state].setdefault(byte, set()).add((target, None))
                state = target
        if not word:
            self._free[state].add(ends[size])

    def _walk(self, word: bytes, states: dict[bytes, int], end: int, place: int | None) -> None:
        """Add a word; words with the same beginning share its states."""
        for index, byte in enumerate(word):
            state = states[word[:index]]
            whole = index == len(word) - 1
            target = end if whole else states.setdefault(word[: index + 1], -1)
            if target < 0:
                target = states[word[: index + 1]] = self._new()
            own = None if place is None else (place, index)
            self._edges[state].setdefault(byte, set()).add((target, own))

    def _new(self) -> int:
        self._edges.append({})
        self._free.append(set())
        return len(self._edges) - 1


def _joined(stretches: Iterable[Stretch]) -> Sequence[Stretch]:
    """Delimiters that stand side by side are one."""
    found: list[Stretch] = []
    for stretch in stretches:
        if stretch.own and found and found[-1].own:
            (before,), (word,) = found[-1].words, stretch.words
            found[-1] = Stretch(frozenset({before + word}), own=True)
        else:
            found.append(stretch)
    return found
