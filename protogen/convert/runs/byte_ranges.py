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

from collections.abc import Callable, Iterator
from typing import Any

import msgspec
import numpy as np

from protogen.capture.tables import Tables as Filled
from protogen.convert.columns.column_batches import ColumnBatch, ColumnDecoder
from protogen.convert.inputs.chunks import Chunk
from protogen.convert.inputs.remote_files import Stream

PIECE = 1 << 20
"""Bytes that are decoded at once."""
_STEP = 1 << 16
"""The same where two decoders run side by side."""
_SIZE_BITS = 21
"""A frame has at most 1 MiB. So its place and size fit a number of 64 bits, up to `GREATEST`."""
GREATEST = 1 << (64 - _SIZE_BITS)
"""The most bytes of a capture whose parts can be told to fit each other: 8 TiB."""


class Frame(msgspec.Struct, frozen=True):
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
        self._size = size
        self._start = start
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
                raise EOFError(f"the capture ends at byte {self.fed}, not at {self._size}")
            self.fed += len(data)
            found += self._decoder.feed(Chunk(data))
        if self.fed == self._size:
            found += self._decoder.flush()
        for batch in found:
            self.covered = self._start + batch.filled.offset + batch.filled.size
        return found


def keys_of(batch: ColumnBatch) -> Any:
    """Place and size of each frame of a batch, in one number each."""
    filled: Filled = batch.filled
    tables = [*filled.messages.values(), filled.unknown]
    parts = [
        ((rows["offset"] + np.uint64(batch.start)) << np.uint64(_SIZE_BITS)) | rows["size"]
        for rows in tables
        if len(rows)
    ]
    return np.concatenate(parts).astype("u8") if parts else np.zeros(0, "u8")


def _frame(key: int) -> Frame:
    return Frame(key >> _SIZE_BITS, key & ((1 << _SIZE_BITS) - 1))


def guess_entry(stream: Stream, size: int, start: int, lead: int, make: MakeDecoder) -> Frame:
    """The frame at which a decoder from `lead` bytes before and one from `start` meet."""
    before = Track(stream, size, max(0, start - lead), make)
    before_keys = [keys_of(batch) for batch in before.advance(start)]
    own = Track(stream, size, start, make)
    own_keys: list[Any] = []
    while True:
        step = min(size, own.fed + _STEP)
        before_keys += [keys_of(batch) for batch in before.advance(step)]
        own_keys += [keys_of(batch) for batch in own.advance(step)]
        common = np.intersect1d(np.concatenate(before_keys), np.concatenate(own_keys))
        if len(common):
            return _frame(int(common[0]))
        if own.fed == size:
            return END
        # Only what the slower of both has not decoded yet can still be met at.
        low = min(before.covered, own.covered)
        before_keys = [_from(np.concatenate(before_keys), low)]
        own_keys = [_from(np.concatenate(own_keys), low)]


def _from(keys: Any, low: int) -> Any:
    return keys[keys >= np.uint64(low << _SIZE_BITS)]


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
        own_keys, other_keys = np.zeros(0, "u8"), np.zeros(0, "u8")
        while True:
            step = min(self._size, own.fed + _STEP)
            found = own.advance(step)
            waiting += found
            own_keys = np.concatenate([own_keys, *map(keys_of, found)])
            other_keys = np.concatenate([other_keys, *map(keys_of, other.advance(step))])
            # In front of the entry this decoder need not be right.
            common = _from(np.intersect1d(own_keys, other_keys), max(0, self._entry.offset))
            if len(common):
                self.exit = _frame(int(common[0]))
                break
            # What the other has decoded without meeting is ours; the rest has to wait for it.
            ready = [batch for batch in waiting if _end(batch) <= other.covered]
            waiting = waiting[len(ready) :]
            yield from (between(batch, self._entry.end, None) for batch in ready)
            low = min(own.covered, other.covered)
            own_keys, other_keys = _from(own_keys, low), _from(other_keys, low)
            if own.fed == self._size:
                break
        last = None if self.exit == END else self.exit.end
        yield from (between(batch, self._entry.end, last) for batch in waiting)


def _end(batch: ColumnBatch) -> int:
    return batch.start + batch.filled.offset + batch.filled.size


def between(batch: ColumnBatch, low: int, high: int | None) -> ColumnBatch:
    """The rows of a batch that begin at `low` or later, and before `high`."""
    first = batch.start + batch.filled.offset
    last = _end(batch)
    above = max(low, first)
    below = last if high is None else min(high, last)
    if (above, below) == (first, last):
        return batch
    filled = batch.filled
    kept = Filled(
        schema=filled.schema,
        engine=filled.engine,
        messages={
            name: _rows_between(rows, batch.start, above, below)
            for name, rows in filled.messages.items()
        },
        invalid=_rows_between(filled.invalid, batch.start, above, below),
        unknown=_rows_between(filled.unknown, batch.start, above, below),
        payloads=filled.payloads,
        offset=filled.offset,
        size=max(0, below - above),
        sequence=filled.sequence,
        events=filled.events,
    )
    return batch.with_rows(kept)


def _rows_between(rows: Any, start: int, low: int, high: int) -> Any:
    offsets = rows["offset"] + np.uint64(start)
    return rows[(offsets >= np.uint64(low)) & (offsets < np.uint64(max(low, high)))]
