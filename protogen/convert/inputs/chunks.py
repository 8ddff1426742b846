"""Bytes of a capture with the times at which they came."""

from __future__ import annotations

from bisect import bisect_left
from collections import deque
from collections.abc import Iterable, Iterator, Sequence

import msgspec

PIECE = 1 << 20
"""About so many bytes are decoded at once."""


class Chunk(msgspec.Struct, frozen=True):
    """Some bytes of the line, and when they came.

    `times` has the nanoseconds of each run of bytes that came together, `ends` where the run ends,
    counted from the start of the chunk. Both are empty where the capture has no times.
    """

    data: bytes
    ends: Sequence[int] = ()
    times: Sequence[int] = ()


def joined(pieces: Iterable[tuple[bytes, int]]) -> Iterator[Chunk]:
    """Join pieces with their times to chunks of a useful size."""
    data, ends, times = bytearray(), list[int](), list[int]()
    for piece, when in pieces:
        if not piece:
            continue  # No byte came with it. A million of them would fill no chunk.
        data += piece
        ends.append(len(data))
        times.append(when)
        if len(data) >= PIECE:
            yield Chunk(bytes(data), ends, times)
            data, ends, times = bytearray(), [], []
    if ends:
        yield Chunk(bytes(data), ends, times)


class Clock:
    """Tells when a byte of the line came, as far back as one may still ask."""

    def __init__(self) -> None:
        self._ends: deque[int] = deque()
        self._times: deque[int] = deque()
        self._end = 0

    def take(self, chunk: Chunk) -> None:
        """Take the times of the next chunk."""
        self._ends.extend(self._end + end for end in chunk.ends)
        self._times.extend(chunk.times)
        self._end += len(chunk.data)

    def at(self, lasts: Sequence[int]) -> list[int | None]:
        """Times of the bytes at these offsets, which ascend; None where nothing is known."""
        if not self._ends:
            return [None] * len(lasts)
        ends, times = list(self._ends), list(self._times)
        places = (bisect_left(ends, last + 1) for last in lasts)
        return [times[place] if place < len(times) else None for place in places]

    def forget(self, offset: int) -> None:
        """Nobody will ask about bytes in front of `offset` any more."""
        while self._ends and self._ends[0] <= offset:
            self._ends.popleft()
            self._times.popleft()
