"""What programs of harness/cycles.c tell while they run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

END = 0xFF
"""The mark behind everything."""


@dataclass(frozen=True)
class Event:
    """A mark or a byte, and the cycle at which it was told."""

    cycle: int
    mark: int | None = None
    said: int | None = None


def spans(told: Sequence[Event], mark: int) -> list[int]:
    """Cycles between each such mark and the next one, which is one more."""
    cycles, begin = [], 0
    for event in told:
        if event.mark == mark:
            begin = event.cycle
        elif event.mark == mark + 1:
            cycles.append(event.cycle - begin)
    return cycles


def said(told: Sequence[Event]) -> list[int]:
    """The bytes that were said."""
    return [event.said for event in told if event.said is not None]
