"""Finds the word that was probably meant."""

from __future__ import annotations

from collections.abc import Iterable


def did_you_mean(word: str, candidates: Iterable[str]) -> str | None:
    """Return the candidate that ``word`` is probably a slip of, or None if none is close.

    Differences of case and of separators count as nothing; otherwise a word of 3 letters may
    differ by one slip, of 6 by two and of 10 by three. Of equally close ones the first wins.
    """
    folded = _fold(word)
    closest, least = None, _tolerance(folded) + 1
    for candidate in candidates:
        distance = _distance(folded, _fold(candidate), least)
        if distance < least:
            closest, least = candidate, distance
    return closest


def hint_for(word: str, candidates: Iterable[str]) -> str | None:
    """Return the hint ``did you mean `...`?``, or None if nothing is close."""
    suggestion = did_you_mean(word, candidates)
    return None if suggestion is None else f"did you mean `{suggestion}`?"


def _fold(word: str) -> str:
    return word.casefold().replace("-", "").replace("_", "").replace(" ", "")


def _tolerance(word: str) -> int:
    return sum(len(word) >= length for length in (3, 6, 10))


def _distance(left: str, right: str, limit: int) -> int:
    """Count the insertions, deletions, replacements and swaps of neighbours between two words.

    Words whose lengths already differ by ``limit`` are not looked at any closer.
    """
    if abs(len(left) - len(right)) >= limit:
        return limit
    before: list[int] = []
    previous = list(range(len(right) + 1))
    for row, letter in enumerate(left, start=1):
        current = [row]
        for column, other in enumerate(right, start=1):
            cost = min(
                previous[column] + 1,
                current[column - 1] + 1,
                previous[column - 1] + (letter != other),
            )
            if row > 1 and column > 1 and letter == right[column - 2] and left[row - 2] == other:
                cost = min(cost, before[column - 2] + 1)
            current.append(cost)
        before, previous = previous, current
    return previous[-1]
