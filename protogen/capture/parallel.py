"""Decodes parts of a capture on several cores. The tables are those of one decoder.

A part's decoder starts at any byte, and what it finds there may be wrong. But two decoders that
have both completed the same frame are in the same state: a frame is decided by its bytes alone,
and what follows it by the bytes behind it. So the decoder of the part in front runs on past its
end until it completes a frame that the part's own decoder has, too; from there on the part's own
events count. If there is no such frame, it runs on through the whole part. Invalid bytes are no
such sign: where they begin and end depends on what was before.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Protocol

from protogen.capture.cuts import Frame, behind, frames_of, renumbered, until
from protogen.capture.source import forget
from protogen.capture.tables import Tables

ROWS = 8 << 20
"""Bytes of rows that a part should have: many for what a part costs by itself, and so few that
those of all parts at hand stay in the processor's cache."""
PARTS = range(1 << 20, (8 << 20) + 1)
"""Bytes that a part may have."""
ROOM = 64 << 20
"""Bytes of rows that a part may have before its turn has come."""
_WINDOW = 1 << 6
"""Bytes at least that a decoder runs on at a time to find a frame of the next part."""
_EVENTS = 4
"""As many events should be in them."""

_SAMPLE = 1 << 16
"""Bytes that tell how many rows there will be."""


class Engine(Protocol):
    """A decoder that can begin anywhere."""

    def start(self, offset: int, sequence: int = 0) -> None:
        """Begin a stream at this byte of the capture; the first event has this number."""

    def renumber(self, more: int) -> None:
        """The numbers of the next events are greater by so many."""

    def step(self, data: memoryview) -> tuple[int, Tables]:
        """Take some of the next bytes: how many, and what came of them."""

    def flush(self) -> Iterator[Tables]:
        """Take the end of the capture."""


@dataclass(slots=True)
class _Run:
    """A decoder, how far it has come, and what it found that is not delivered yet."""

    engine: Engine
    position: int
    found: deque[Tables] = field(default_factory=deque)


@dataclass(frozen=True, slots=True)
class _Known:
    """A place behind which no byte belongs to an event in front of it: the next event's number."""

    offset: int
    number: int


@dataclass(frozen=True, slots=True)
class _Meeting:
    """A frame that two decoders have completed: its number for each of them, and its end."""

    number: int
    other: int
    end: int


class Parts:
    """Reads a capture in parts, some of them ahead."""

    def __init__(
        self,
        data: memoryview,
        engines: Sequence[Engine],
        part: int | None = None,
        room: int = ROOM,
    ) -> None:
        """`engines`: one for each part that is decoded at a time, and one more at least.

        `part`: bytes of a part; None: what suits the rows. A part whose rows take more than `room`
        bytes is decoded on only when its turn has come.
        """
        self._data = data
        self._free = list(engines)
        self._given = part
        self._part = part or PARTS[0]
        self._room = room
        self._known = _Known(0, 0)
        self._rate = (0, 1)  # Events, and the bytes that they cover.

    def tables(self, workers: int) -> Iterator[Tables]:
        """All tables, in order."""
        self._sample()
        starts = iter(range(0, max(1, len(self._data)), self._part))
        ahead: deque[Future[_Run]] = deque()
        with ThreadPoolExecutor(workers, "protogen-capture") as pool:
            try:
                self._decode_ahead(pool, starts, ahead)
                run = ahead.popleft().result()
                yield from self._deliver(run)
                while ahead:
                    run = yield from self._seam(run, ahead.popleft().result())
                    self._decode_ahead(pool, starts, ahead)
                    yield from self._deliver(run)
                yield from run.engine.flush()
            finally:
                for future in ahead:
                    future.cancel()

    def _sample(self) -> None:
        """Let a decoder see how many rows there will be, before memory is got for all."""
        if len(self._data) > self._part:
            engine = self._free[0]
            engine.start(0)
            taken, tables = engine.step(self._data[: min(self._part, _SAMPLE)])
            self._rate = (tables.events, max(1, tables.size))
            if self._given is None:
                wanted = ROWS * taken // max(1, tables.nbytes)
                self._part = min(max(wanted, PARTS[0]), PARTS[-1])

    def _decode_ahead(
        self, pool: ThreadPoolExecutor, starts: Iterator[int], ahead: deque[Future[_Run]]
    ) -> None:
        while self._free and (start := next(starts, None)) is not None:
            engine = self._free.pop()
            engine.start(start, self._foreseen(start))
            ahead.append(pool.submit(self._decode, engine, start))

    def _foreseen(self, start: int) -> int:
        """The number of the first event from a byte on, if all goes on as before.

        It is right where frames have one size. Then rows need not be numbered anew, which may take
        a third as long as to fill them; else they are.
        """
        events, size = self._rate
        return self._known.number + (start - self._known.offset) * events // size

    def _end(self, position: int) -> int:
        """Of the part that begins there, or that the byte is in."""
        return min(len(self._data), (position // self._part + 1) * self._part)

    def _decode(self, engine: Engine, start: int) -> _Run:
        """Decode a part as if a stream began there."""
        run = _Run(engine, start)
        end, size = self._end(start), 0
        while run.position < end and size <= self._room:
            tables = self._step(run, end)
            run.found.append(tables)
            size += tables.nbytes
        return run

    def _step(self, run: _Run, end: int) -> Tables:
        taken, tables = run.engine.step(self._data[run.position : end])
        run.position += taken
        return tables

    def _deliver(self, run: _Run) -> Iterator[Tables]:
        """What was found, and the rest of a part that was not decoded to its end."""
        while run.found:
            yield run.found.popleft()
        forget(self._data, max(0, run.position - self._part), run.position)
        end = -(-run.position // self._part) * self._part
        while run.position < min(end, len(self._data)):
            yield self._step(run, end)

    def _seam(self, run: _Run, other: _Run) -> Generator[Tables, None, _Run]:
        """Run on to where both agree, or through the part; then that which goes on is left."""
        start, window = run.position, self._window()
        end = self._end(start)
        while run.position < end:
            stop = min(end, run.position + window)
            while run.position < stop:
                tables = self._step(run, stop)
                met = _meeting(tables, other.found, start)
                if met is not None:
                    yield until(tables, met.number, met.end)
                    _take_over(other, met)
                    self._learn(_Known(met.end, met.number + 1))
                    self._free.append(run.engine)
                    return other
                yield tables
            window *= 2
        self._free.append(other.engine)
        return run

    def _window(self) -> int:
        """Bytes that a decoder runs on at first."""
        events, size = self._rate
        return min(max(_WINDOW, _EVENTS * size // max(1, events)), _SAMPLE)

    def _learn(self, known: _Known) -> None:
        """Foresee numbers from here on, by the rate since the last frame that was known."""
        before, self._known = self._known, known
        self._rate = (known.number - before.number, known.offset - before.offset)


def _meeting(tables: Tables, others: Sequence[Tables], start: int) -> _Meeting | None:
    """The first frame from the byte `start` on that both have."""
    mine = frames_of(tables, start)
    last = max((offset for offset, _ in mine), default=-1)
    theirs: dict[Frame, int] = {}
    for item in others:
        if item.offset > last:
            break
        theirs |= frames_of(item, start, last + 1)
    both = [frame for frame in mine if frame in theirs]
    if not both:
        return None
    frame = min(both)
    return _Meeting(mine[frame], theirs[frame], sum(frame))


def _take_over(run: _Run, met: _Meeting) -> None:
    """Forget all up to the frame, and number what is behind it on."""
    kept: deque[Tables] = deque()
    more = met.number - met.other
    for tables in run.found:
        if tables.sequence > met.other:
            kept.append(renumbered(tables, more))
        elif tables.sequence + tables.events > met.other + 1:
            kept.append(renumbered(behind(tables, met.other, met.end), more))
    run.found = kept
    run.engine.renumber(more)
