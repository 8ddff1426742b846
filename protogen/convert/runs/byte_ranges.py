"""A range of a capture, decoded alone, and still the rows of a decoder that came all the way.

A decoder that begins anywhere finds its way by itself, but not at once. After two decoders have
completed the same frame (the same offset and size) they agree on all that follows: a decoder knows
nothing but the bytes behind the last thing that it completed. So ranges meet at frames:

* A range's decoder runs on past the end of the range, beside a second one that begins there, until
  both complete the same frame. That is the range's *exit*; the rows up to its end belong to it.
* A range's rows begin behind its *entry*, which has to be the exit of the range before. To work at
  the same time as the others, a range guesses it: with a decoder that begins a little before the
  range, beside its own. Whoever collects the ranges compares, and has those that guessed wrong done
  again with the right entry.

Noise is not enough to meet at: two decoders can call the same bytes noise for different reasons.
By induction from the capture's start, all rows are those of one decoder, whatever the ranges are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import msgspec
import numpy as np

from protogen.capture.cuts import Frame as Place
from protogen.capture.cuts import frames_of
from protogen.convert.columns.column_batches import ColumnBatch, ColumnDecoder
from protogen.convert.inputs.chunks import Chunk
from protogen.convert.inputs.remote_files import Stream
from protogen.copying import replace

PIECE = 1 << 20
"""Bytes that are decoded at once."""
_STEP = 1 << 16
"""The same where two decoders run side by side."""


class Frame(msgspec.Struct, frozen=True, array_like=True):
    """Frame at which decoders meet: its offset and size in the capture."""

    offset: int
    size: int

    @property
    def end(self) -> int:
        """Behind its last byte."""
        return self.offset + self.size


END = Frame(-1, 0)
"""Stands for the end of the capture, where decoders have not met before."""
START = Frame(0, 0)
"""Stands for the start of the capture."""

MakeDecoder = Callable[[int], ColumnDecoder]
"""Makes a decoder whose first byte has that offset."""


class Track:
    """A decoder on its way through a capture, from some byte on."""

    def __init__(self, stream: Stream, size: int, start: int, make: MakeDecoder) -> None:
        self._stream = stream
        self.size = size
        self._decoder = make(start)
        self.fed = start
        """The decoder has been given all bytes in front of this one."""
        self.covered = start
        """All that is in front of this byte is decoded."""

    def advance(self, end: int) -> list[ColumnBatch]:
        """Decode up to `end`, or if that is the end of the capture, all that is left."""
        found: list[ColumnBatch] = []
        self._stream.seek(self.fed)
        while self.fed < end:
            data = self._stream.read(min(PIECE, end - self.fed))
            if not data:
                raise EOFError(f"the capture ends at byte {self.fed}, not at {self.size}")
            self.fed += len(data)
            found += self._decoder.feed(Chunk(data))
        if self.fed == self.size:
            found += self._decoder.flush()
        for batch in found:
            self.covered = _end(batch)
        return found


def _meet(front: Track, other: Track, low: int) -> Iterator[tuple[list[ColumnBatch], Frame | None]]:
    """Run two decoders side by side, until both have completed a frame from the byte `low` on.

    What the first one finds, step by step, and with the last that frame, or the capture's end.
    """
    mine, theirs = set[Place](), set[Place]()
    while True:
        step = min(front.size, front.fed + _STEP)
        found = front.advance(step)
        mine |= _frames(found, low)
        theirs |= _frames(other.advance(step), low)
        if common := mine & theirs:
            yield found, Frame(*min(common))
            return
        if front.fed == front.size:
            yield found, END
            return
        yield found, None
        # Only what the slower of both has not decoded yet can still be met at.
        low = max(low, min(front.covered, other.covered))
        mine, theirs = ({it for it in places if it[0] >= low} for places in (mine, theirs))


def _frames(batches: Iterable[ColumnBatch], low: int) -> set[Place]:
    """The frames of batches that begin at `low` or later."""
    return {place for batch in batches for place in frames_of(batch.filled, low)}


def guess_entry(stream: Stream, size: int, start: int, lead: int, make: MakeDecoder) -> Frame:
    """The frame at which a decoder from `lead` bytes before and one from `start` meet."""
    before = Track(stream, size, max(0, start - lead), make)
    before.advance(start)
    entry = END
    for _, met in _meet(before, Track(stream, size, start, make), start):
        entry = met or END
    return entry


class RangeDecoder:
    """Decodes a range behind its entry, up to its exit."""

    def __init__(
        self, stream: Stream, size: int, span: tuple[int, int], entry: Frame, make: MakeDecoder
    ) -> None:
        """Decode the range `span` of a capture of `size` bytes."""
        self._stream = stream
        self._size = size
        self._start, self._end = span
        self._entry = entry
        self._make = make
        self.exit = END
        """Frame at which the next range's rows begin; known when all batches are through."""

    def batches(self) -> Iterator[ColumnBatch]:
        """The batches of the range."""
        if self._entry == END:
            return
        own = Track(self._stream, self._size, self._start, self._make)
        while own.fed < self._end:
            for batch in own.advance(min(self._end, own.fed + PIECE)):
                yield between(batch, self._entry.end, None)
        if self._end < self._size:
            yield from self._run_on(own)

    def _run_on(self, own: Track) -> Iterator[ColumnBatch]:
        """Go on until a decoder that begins at the range's end has completed the same frame."""
        other = Track(self._stream, self._size, self._end, self._make)
        waiting: list[ColumnBatch] = []
        # In front of the entry this decoder need not be right.
        for found, met in _meet(own, other, max(self._end, self._entry.offset)):
            waiting += found
            if met is not None:
                self.exit = met
                break
            # What the other has decoded without meeting is ours; the rest has to wait for it.
            ready = [batch for batch in waiting if _end(batch) <= other.covered]
            waiting = waiting[len(ready) :]
            yield from (between(batch, self._entry.end, None) for batch in ready)
        last = None if self.exit == END else self.exit.end
        yield from (between(batch, self._entry.end, last) for batch in waiting)


def _end(batch: ColumnBatch) -> int:
    return batch.filled.offset + batch.filled.size


def between(batch: ColumnBatch, low: int, high: int | None) -> ColumnBatch:
    """The rows of a batch that begin at `low` or later, and before `high`."""
    filled = batch.filled
    first, last = filled.offset, _end(batch)
    above = max(low, first)
    below = last if high is None else min(high, last)
    if (above, below) == (first, last):
        return batch
    kept = replace(
        filled,
        messages={
            name: _rows_between(rows, above, below) for name, rows in filled.messages.items()
        },
        invalid=_rows_between(filled.invalid, above, below),
        unknown=_rows_between(filled.unknown, above, below),
        size=max(0, below - above),
    )
    return replace(batch, filled=kept)


def _rows_between(rows: Any, low: int, high: int) -> Any:
    offsets = rows["offset"]
    return rows[(offsets >= np.uint64(low)) & (offsets < np.uint64(max(low, high)))]
