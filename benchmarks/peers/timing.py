"""CPU time of many programs by turns, so that whatever else the machine does befalls them alike."""

from __future__ import annotations

import gc
from collections.abc import Callable, Hashable, Mapping
from statistics import median
from time import process_time_ns
from typing import TypeVar

LEAST = 20_000_000
"""Nanoseconds of one measurement, at least."""

KeyT = TypeVar("KeyT", bound=Hashable)


def measure(runs: Mapping[KeyT, Callable[[], object]], rounds: int) -> dict[KeyT, list[float]]:
    """Nanoseconds of CPU time that each takes, in each of the rounds.

    What there is before is kept out of the garbage collector's sight: a full collection would go
    through the modules of all programs, and take several times as long as what it falls upon.
    """
    for run in runs.values():
        run()
    gc.collect()
    gc.freeze()
    try:
        return _by_turns(runs, rounds)
    finally:
        gc.unfreeze()


def _by_turns(runs: Mapping[KeyT, Callable[[], object]], rounds: int) -> dict[KeyT, list[float]]:
    times = {key: _calibrated(run) for key, run in runs.items()}
    found: dict[KeyT, list[float]] = {key: [] for key in runs}
    for number in range(rounds):
        order = list(runs) if number % 2 == 0 else [*reversed(list(runs))]
        for key in order:
            runs[key]()  # In the processor's caches is what the one before had.
            gc.collect()
            found[key].append(_timed(runs[key], times[key]) / times[key])
    return found


def _calibrated(run: Callable[[], object]) -> int:
    """Number of runs that take long enough."""
    gc.collect()
    times = 1
    while (taken := _timed(run, times)) < LEAST:
        times = max(times + 1, int(times * 1.2 * LEAST / max(taken, LEAST // 100, 1)))
    return times


def _timed(run: Callable[[], object], times: int) -> int:
    start = process_time_ns()
    for _ in range(times):
        run()
    return process_time_ns() - start


def ratio(own: list[float], other: list[float]) -> float:
    """The median of the rounds' ratios."""
    return median(mine / theirs for mine, theirs in zip(own, other, strict=True))
