"""Hands runs of frames to the decoder, as the cutter that is generated hands it events."""

from __future__ import annotations

from bisect import bisect_left
from typing import TYPE_CHECKING, Any

from protogen.capture.arrays import numpy
from protogen.capture.bulk.stretch import Bulk, Run, Stretch

if TYPE_CHECKING:
    from protogen.runtime.sender import Cutter, SenderSpec

LEAST = 1 << 12
"""Bytes that are worth it."""
_PIECE = 1 << 13
"""Bytes that the generated cutter is given at a time at least."""


class BulkCutter:
    """A `Cutter` whose events are `Run`s wherever frames are in order.

    All bytes are looked at when the first of them are asked for. Where the decoder asks for a frame
    that was not found, the generated cutter takes what is in front of the next one that was.
    """

    def __init__(self, bulk: Bulk, spec: SenderSpec[Any, Any], least: int = LEAST) -> None:
        """Fewer bytes than `least` are left to the generated cutter."""
        assert spec.cut is not None
        self._bulk = bulk
        self._cut: Cutter = spec.cut
        self._least = least
        self._smallest = spec.frame.least
        self._piece = max(_PIECE, 2 * spec.frame.greatest)
        self._slack = 1 + len(spec.layout.start) + len(spec.layout.end)
        self.forget()

    def forget(self) -> None:
        """Let go of the bytes that were looked at."""
        self._data: bytes | None = None
        self._stretch: Stretch | None = None
        self._at: list[int] = []
        self._breaks: list[int] = []

    def __call__(self, data: bytes, at: int, base: int, events: list[Any]) -> int:
        """Take frames from `at` on; the place of the first byte that was not taken."""
        if data is not self._data:
            if len(data) - at < self._least:
                return self._cut(data, at, base, events)
            self._look_at(data, at, base)
        while True:
            index = bisect_left(self._at, at)
            if index < len(self._at) and self._at[index] == at:
                at = self._take(index, events)
                continue
            end = self._take_other(data, at, base, events)
            if end == at:
                return at
            at = end

    def _look_at(self, data: bytes, at: int, base: int) -> None:
        self._data = data
        self._stretch = self._bulk.stretch(data, at, base)
        frames = self._stretch.frames
        self._at = frames.at.tolist()
        gaps = numpy().flatnonzero(frames.at[1:] != frames.end[:-1]) + 1
        self._breaks = [*gaps.tolist(), len(self._at)]

    def _take(self, index: int, events: list[Any]) -> int:
        """Take a frame and all that follow it without a gap."""
        assert self._stretch is not None
        stop = self._breaks[bisect_left(self._breaks, index + 1)]
        events.append(Run(self._stretch, index, stop))
        return int(self._stretch.frames.end[stop - 1])

    def _take_other(self, data: bytes, at: int, base: int, events: list[Any]) -> int:
        """Have the generated cutter take frames in front of the next one that was found."""
        index = bisect_left(self._at, at + self._smallest)
        behind = self._at[index] if index < len(self._at) else len(data)
        end = min(behind, at + self._piece) + self._slack
        if end >= len(data):
            return self._cut(data, at, base, events)
        return at + self._cut(data[at:end], 0, base + at, events)
