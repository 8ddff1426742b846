"""Bytes on ports at the pace of a line, with the times at which they went in and came out.

A pseudo-terminal has no rate of its own: who writes keeps to the schedule.
"""

from __future__ import annotations

import os
import select
import time
import tty
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

MEGABAUD = 100_000
"""Bytes in a second of 1 Mbaud, with a start bit and a stop bit around 8 bits."""
STEP = 0.001
"""Seconds between writes: as often as USB asks an adapter for bytes."""
_PATIENCE = 120.0
_MOST = 1 << 16


@dataclass
class Way:
    """One direction: where bytes go in, and where they come out, unless another program reads."""

    entry: int
    exit: int | None
    data: bytes
    sent: int = 0
    got: bytearray = field(default_factory=bytearray)
    written: list[tuple[int, int]] = field(default_factory=list)
    """How many bytes had gone in at which time, in ns of the monotonic clock."""
    came: list[tuple[int, int]] = field(default_factory=list)

    @property
    def is_done(self) -> bool:
        """True if all bytes went in and, where they come out here, have come out."""
        return (self.sent if self.exit is None else len(self.got)) >= len(self.data)

    def write(self, due: int) -> None:
        """Put in what is due by now, as far as there is room."""
        piece = self.data[self.sent : due]
        if piece:
            try:
                self.sent += os.write(self.entry, piece)
            except BlockingIOError:
                return
            self.written.append((self.sent, time.perf_counter_ns()))

    def read(self) -> None:
        """Take out what has come."""
        assert self.exit is not None
        try:
            self.got += os.read(self.exit, _MOST)
        except BlockingIOError:
            return
        self.came.append((len(self.got), time.perf_counter_ns()))

    def latencies(self) -> list[float]:
        """Milliseconds from write to read of the last byte of each piece that came out."""
        return delays(self.written, self.came)


@contextmanager
def device() -> Iterator[tuple[int, str]]:
    """Our end of a pseudo-terminal, and the name of the other one."""
    own, other = os.openpty()
    tty.setraw(other)
    try:
        yield own, os.ttyname(other)
    finally:
        os.close(own)
        os.close(other)


def delays(written: Sequence[tuple[int, int]], came: Sequence[tuple[int, int]]) -> list[float]:
    """Milliseconds from when so many bytes were written to when they had come."""
    ends = [end for end, _ in written]
    return [(when - written[bisect_left(ends, end)][1]) / 1e6 for end, when in came]


def carry(ways: Sequence[Way], rate: float = MEGABAUD, most: int | None = None) -> float:
    """Carry all bytes of all ways at so many bytes a second, or at 0 as fast as they are taken.

    Ends when `most` bytes have come out of all together. Returns the seconds that it took. Raises
    TimeoutError where nothing moves any more.
    """
    for way in ways:
        os.set_blocking(way.entry, False)
    exits = {way.exit: way for way in ways if way.exit is not None}
    begin = moved = time.perf_counter()
    step = begin
    while not all(way.is_done for way in ways):
        if most is not None and sum(len(way.got) for way in ways) >= most:
            break
        now = time.perf_counter()
        entries = {way.entry: way for way in ways if not rate and way.sent < len(way.data)}
        if rate and now >= step:
            for way in ways:
                way.write(int((now - begin) * rate))
            step = now + STEP
        wait = max(0.0, step - time.perf_counter()) if rate else 1.0
        came, room, _ = select.select(exits, entries, [], wait)
        for port in room:
            entries[port].write(entries[port].sent + _MOST)
        for port in came:
            exits[port].read()
        if came or room or not exits:
            moved = now
        if now - moved > _PATIENCE:
            raise TimeoutError(f"{[len(way.got) for way in ways]} bytes came out, and no more")
    return time.perf_counter() - begin
