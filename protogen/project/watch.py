"""Notices that files change.

Times and sizes are polled: that works on every system and on network drives, needs no library, and
a few hundred files take a few milliseconds. Editors write in several steps, so a change counts when
it has settled.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

POLL = 0.25
"""Seconds between two looks."""
SETTLE = 0.1
"""Seconds without a further change after which the files are taken as complete."""

State = tuple[int, int, int] | None
"""Time, size and number of a file; None where there is none."""

States = Mapping[Path, State]


def states(paths: Iterable[Path]) -> States:
    """Return how files are now."""
    return {path: _state(path) for path in paths}


def settled(now: States, begin: int) -> States:
    """The states without those that may have come after `begin`, in nanoseconds of the clock."""
    return {path: state for path, state in now.items() if state is None or state[0] < begin}


def wait_for_change(
    before: States,
    paths: Callable[[], Iterable[Path]],
    sleep: Callable[[float], object] = time.sleep,
) -> tuple[Path, ...]:
    """Wait until something is not as it was before, and nothing changes any more.

    `paths` gives the files at each look, since some may come and go. Returns what has changed.
    """
    while (now := states(paths())) == before:
        sleep(POLL)
    while True:
        sleep(SETTLE)
        later = states(paths())
        if later == now:
            return changes(before, now)
        now = later


def changes(before: States, now: States) -> tuple[Path, ...]:
    """Return the files that are not as they were, in order."""
    return tuple(sorted(path for path in {*before, *now} if before.get(path) != now.get(path)))


def _state(path: Path) -> State:
    try:
        status = path.stat()
    except (OSError, ValueError):
        return None
    return status.st_mtime_ns, status.st_size, status.st_ino
