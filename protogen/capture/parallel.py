"""Decodes parts of a capture on several cores. The tables are those of one decoder.

A part's decoder starts at any byte, and what it finds there may be wrong. But two decoders that
have both completed the same frame are in the same state: a frame is decided by its bytes alone,
and what follows it by the bytes behind it. So the decoder of the part in front runs on past its
end until it completes a frame that the part's own decoder has, too; from there on the part's own
events count. If there is no such frame, it runs on through the whole part. Invalid bytes are no
such sign: where they begin and end depends on what was before.

Nearly always the frame is the first one behind the part's end. So a decoder runs on to the end of
that one at once, and says where it stopped to the part's own, which may be at work in another
thread: the sooner it knows, the fewer rows have numbers to be put right.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import suppress
from itertools import pairwise
from threading import Lock, get_ident
from typing import TYPE_CHECKING

import msgspec

from protogen.capture.cuts import Frame, behind, frames_of, renumbered, until
from protogen.capture.errors import CaptureError
from protogen.capture.source import forget
from protogen.capture.tables import Tables

if TYPE_CHECKING:
    from protogen.capture.native import NativeEngine

ROWS = 6 << 20
"""Bytes of rows that a part should have: many for what a part costs by itself, and few for what all
parts at hand take."""
PARTS = range(1 << 14, (8 << 20) + 1)
"""Bytes that a part may have: few where short frames have long rows."""
ROOM = 256 << 20
"""Bytes of rows that all parts at hand may have before their turn has come."""
_UNLIKE = 4
"""Parts that have so many times the bytes that would suit, or so much less, do not suit."""
_WINDOW = 1 << 6
"""Bytes at least in which a frame is looked for that the next part has, too."""
_EVENTS = 4
"""As many events should be in them."""
_REACH = 1 << 12
"""Bytes in which a part that is decoded on beyond its end should come upon a frame, at least."""
_SAMPLE = 1 << 16
"""Bytes that tell how many rows there will be."""


class _Run(msgspec.Struct):
    """A part of the capture: its decoder, and what that found."""

    engine: NativeEngine
    start: int
    end: int
    beyond: int
    """Byte up to which its decoder may come before the next part is decoded."""
    position: int
    """First byte that the decoder has not read yet."""
    found: deque[Tables] = msgspec.field(default_factory=deque)
    """Tables that are not delivered yet."""
    is_held: bool = False
    """True if its decoder holds that still."""
    is_decoded: bool = False
    """As far as that is possible ahead."""
    is_placed: bool = False
    """True if all that was found counts, under the right numbers."""
    is_whole: bool = False
    """True if the next part goes on where what was found ends."""
    is_stuck: bool = False
    """True if it has to be decoded on to find that place."""


class _Known(msgspec.Struct, frozen=True):
    """A place behind which no byte belongs to an event in front of it: the next event's number."""

    offset: int
    number: int


class _Meeting(msgspec.Struct, frozen=True):
    """A frame that two decoders have completed: its number for each of them, and its end."""

    number: int
    other: int
    end: int


class Parts:
    """Reads a capture in parts, some of them ahead.

    Whoever takes the tables decodes parts, too, until there are some to take: to be woken for each
    of them takes longer than to look. The threads that decode beside that never wait for whoever
    takes the tables, who may never come back: without a decoder for the next part they end, to be
    begun anew. Whoever has decoded a part fits together what can be.
    """

    def __init__(
        self,
        data: memoryview,
        engines: Sequence[NativeEngine],
        part: int | None = None,
        room: int = ROOM,
    ) -> None:
        """`engines`: one for each part that is at hand, which are two at least.

        `part`: bytes of a part; None: what suits the rows. A part whose rows take more than its
        share of `room` bytes is decoded on only when its turn has come.
        """
        self._data = data
        self._given = part
        self._part = part or PARTS[0]
        self._room = room // len(engines)
        self._known = _Known(0, 0)
        self._rate = (0, 1)  # Events, and the bytes that they cover.
        self._lock = Lock()  # For what follows, and for what runs say of themselves.
        self._free = list(engines)
        self._next: int | None = 0  # Where the next part begins, if there is one.
        self._reach = 0  # How far the last part that was begun may be decoded on.
        self._ended = 0  # Threads that had no decoder for a part.
        self._tasks: list[Future[None]] = []  # What threads are at, if they are not done yet.
        self._runs: deque[_Run] = deque()  # Those that were begun, until all is delivered.
        self._awaited: Callable[[], bool] | None = None
        self._come = Lock()  # Held until what is awaited has come: less work than a condition.
        self._come.acquire()
        self._is_joining = False
        self._is_over = False
        self._error: BaseException | None = None
        self._process = os.getpid()

    def tables(self, workers: int) -> Iterator[Tables]:
        """All tables, in order. So many threads decode, of which one is whoever takes them."""
        self._sample()
        own: set[int] = set()
        others = workers - 1
        threads = max(1, others)
        pool = ThreadPoolExecutor(threads, "protogen-capture", lambda: own.add(get_ident()))
        is_closed = False
        try:
            for _ in range(others):
                self._let_work(pool)
            yield from self._in_order(pool)
        except GeneratorExit:
            is_closed = True
            raise
        finally:
            # Python may find a reading that nobody refers to any more in any thread, in the middle
            # of anything: as where threads begin, whose end can't be waited for then; or in one of
            # the reading's own, which can't wait for itself, and has the lock, perhaps.
            self._is_over = True
            if self._is_at_home:
                pool.shutdown(wait=not is_closed, cancel_futures=True)
                if is_closed and get_ident() not in own:
                    wait([task for task in self._tasks if not task.cancelled()])

    @property
    def _is_at_home(self) -> bool:
        """True if this is the process in which the threads are, and none that was forked off."""
        return os.getpid() == self._process

    def _sample(self) -> None:
        """Let a decoder see how many rows there will be, before memory is got for all."""
        if len(self._data) > self._part:
            engine = self._free[0]
            engine.start(0)
            taken, tables = engine.step(self._data[: min(self._given or _SAMPLE, _SAMPLE)])
            self._rate = (tables.events, max(1, tables.size))
            if self._given is None:
                self._part = _suiting(taken, tables.nbytes)

    # --- whoever takes the tables ----------------------------------------------------------------

    def _in_order(self, pool: ThreadPoolExecutor) -> Iterator[Tables]:
        is_last = False
        while not is_last:
            self._await(self._is_due)
            run = self._runs[0]
            while run.found:
                yield run.found.popleft()
            if run.is_whole:
                self._leave(0, pool)
                continue
            yield from self._go_on(run, pool)
            is_last = run.end == len(self._data)
            if is_last:
                yield from run.engine.flush()
            self._leave(0, pool)
            self._join()

    def _is_due(self) -> bool:
        """True if the first part can be delivered: all that was found, at least."""
        run = self._runs[0] if self._runs else None
        return (
            run is not None
            and run.is_placed
            and run.is_decoded
            and (run.is_whole or run.is_stuck or run.end == len(self._data))
        )

    def _is_next_decoded(self) -> bool:
        return len(self._runs) > 1 and self._runs[1].is_decoded

    def _await(self, awaited: Callable[[], bool]) -> None:
        """Decode parts until it is so, or none is left to begin; then wait.

        Raises what went wrong in a thread.
        """
        self._check_process()
        while not self._has_come(awaited) and (run := self._begin()) is not None:
            self._add(run)
        with self._lock:
            self._awaited = awaited
            self._tell()
        self._come.acquire()
        if self._error is not None:
            try:
                raise self._error
            finally:
                self._error = None  # It leads to what it was raised in, as to the capture.

    def _has_come(self, awaited: Callable[[], bool]) -> bool:
        """True if it is so, or never will be, as something went wrong."""
        with self._lock:
            return self._error is not None or awaited()

    def _check_process(self) -> None:
        """Raise CaptureError where nobody is there to wait for, and locks may stay as they are."""
        if not self._is_at_home:
            raise CaptureError("with workers, a capture is read on by the process that began to")

    def _leave(self, place: int, pool: ThreadPoolExecutor) -> None:
        """Let go of a part, whose bytes nobody reads again."""
        self._check_process()
        run = self._runs[place]
        forget(self._data, run.start, run.end)
        with self._lock:
            self._free.append(run.engine)
            del self._runs[place]
            is_wanted = bool(self._ended and self._next is not None)
            self._ended -= is_wanted
        if is_wanted:
            self._let_work(pool)

    def _let_work(self, pool: ThreadPoolExecutor) -> None:
        """Begin a thread. Where Python ends and begins none any more, it goes without."""
        with suppress(RuntimeError):
            task = pool.submit(self._work)
            self._tasks = [task, *(task for task in self._tasks if not task.done())]

    def _go_on(self, run: _Run, pool: ThreadPoolExecutor) -> Iterator[Tables]:
        """The rest of a part, and what its decoder finds until it agrees with a part behind it."""
        while run.position < run.end:
            yield self._step(run, run.end)
        while run.end < len(self._data) and not run.is_whole:
            self._await(self._is_next_decoded)
            yield from self._seam(run, self._runs[1])
            if not run.is_whole:
                run.end = self._runs[1].end
                self._leave(1, pool)

    def _seam(self, run: _Run, other: _Run) -> Iterator[Tables]:
        """Run on to where both agree, or through the part, which is dropped then."""
        if other.is_held:
            self._take(other)
        window = self._window()
        while run.position < other.end:
            stop = min(other.end, run.position + window)
            while run.position < stop:
                tables = self._step(run, stop)
                met = _meeting([tables], other.found, run.end)
                if met is not None:
                    self._take_over(other, met)
                    run.is_whole = other.is_placed = True
                    yield until(tables, met.number, met.end)
                    return
                yield tables
            window *= 2

    # --- the threads, and whoever takes the tables while there are none ---------------------------

    def _work(self) -> None:
        """Decode one part after another, and fit together what can be."""
        try:
            while (run := self._begin(ending=1)) is not None:
                self._add(run)
        except BaseException as error:
            with self._lock:
                self._error = error
                self._tell()

    def _add(self, run: _Run) -> None:
        """Decode a part, and fit together what can be then."""
        self._decode(run)
        with self._lock:
            run.is_decoded = True
            self._tell()
        self._join()

    def _tell(self) -> None:
        """Wake who waits, if that has come, or something went wrong."""
        if self._awaited is not None and (self._error is not None or self._awaited()):
            self._awaited = None
            self._come.release()

    def _begin(self, ending: int = 0) -> _Run | None:
        """The next part; None if none is left, or wanted, or there is no decoder for it now.

        `ending`: threads that end then.
        """
        with self._lock:
            start = self._next
            if self._is_over or start is None or not self._free:
                self._ended += ending
                return None
            part = max(self._part, 2 * self._reach)  # The one in front does not get to its end.
            self._reach = min(max(_REACH, self._window()), part // 2)
            end = min(len(self._data), start + part)
            self._next = end if end < len(self._data) else None
            beyond = min(len(self._data), end + self._reach)
            run = _Run(self._free.pop(), start, end, beyond, start, is_placed=start == 0)
            run.engine.start(start, self._foreseen(start))
            self._runs.append(run)
            return run

    def _foreseen(self, start: int) -> int:
        """The number of the first event from a byte on, if all goes on as before.

        It is right where frames have one size. Then rows need not be numbered anew; else they are.
        """
        events, size = self._rate
        return self._known.number + (start - self._known.offset) * events // size

    def _decode(self, run: _Run) -> None:
        """Decode a part as if a stream began there, and on to where the next one should agree."""
        data = self._data[run.start : run.beyond]
        run.position += run.engine.run(data, run.end - run.start, run.end)
        run.is_held = True
        if run.engine.is_full or run.is_placed:
            size = self._take(run).nbytes
            while run.position < run.end and size <= self._room:
                run.found.append(self._step(run, run.beyond))
                size += run.found[-1].nbytes

    def _take(self, run: _Run) -> Tables:
        """Tables that its decoder holds."""
        run.is_held = False
        found = run.engine.take()
        run.found.append(found)
        if self._given is None and found.size >= PARTS[0]:
            suiting = _suiting(found.size, found.nbytes)
            if max(suiting, self._part) >= _UNLIKE * min(suiting, self._part):
                self._part = suiting
        return found

    def _step(self, run: _Run, end: int) -> Tables:
        taken, tables = run.engine.step(self._data[run.position : end])
        run.position += taken
        return tables

    def _join(self) -> None:
        """Fit together what can be; unless another thread does, which then sees all there is."""
        with self._lock:
            if self._is_joining:
                return
            self._is_joining = True
        while (pair := self._pair()) is not None:
            run, other = pair
            fits = self._fit(run, other)
            with self._lock:
                run.is_stuck = not fits
                run.is_whole = other.is_placed = fits
                self._tell()

    def _pair(self) -> tuple[_Run, _Run] | None:
        """Two parts to fit together; None if there are none now, and nobody does so any more."""
        with self._lock:
            for run, other in pairwise(self._runs):
                if not run.is_whole:
                    if run.is_placed and run.is_decoded and not run.is_stuck:
                        if other.is_decoded:
                            return run, other
                        other.engine.tell(run.engine)
                    break
            self._is_joining = False
            return None

    def _fit(self, run: _Run, other: _Run) -> bool:
        """Fit a part to the one in front of it, if they agree somewhere as far as is known."""
        fits = other.engine.is_joined or (other.is_held and other.engine.join(run.engine))
        if other.is_held:
            self._take(other)
        if fits:
            self._learn(_Known(*run.engine.place))
            return True
        met = self._met(run, other)
        if met is None:
            return False
        run.found = _until(run.found, met)
        self._take_over(other, met)
        return True

    def _met(self, run: _Run, other: _Run) -> _Meeting | None:
        """Frame at which two parts agree, if the first was decoded so far."""
        tail = [tables for tables in run.found if tables.offset + tables.size > run.end]
        stop = run.end + self._window()
        while run.position > run.end:
            met = _meeting(tail, other.found, run.end, stop)
            if met is not None or stop >= run.position:
                return met
            stop += 3 * (stop - run.end)
        return None

    def _window(self) -> int:
        """Bytes in which some frames should be."""
        events, size = self._rate
        return min(max(_WINDOW, _EVENTS * size // max(1, events)), _SAMPLE)

    def _take_over(self, run: _Run, met: _Meeting) -> None:
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
        self._learn(_Known(met.end, met.number + 1))

    def _learn(self, known: _Known) -> None:
        """Foresee numbers from here on, by the rate since the last frame that was known."""
        before, self._known = self._known, known
        self._rate = (known.number - before.number, known.offset - before.offset)


def _suiting(size: int, rows: int) -> int:
    """Bytes that a part should have where so many have rows of so many bytes."""
    return min(max(ROWS * size // max(1, rows), PARTS[0]), PARTS[-1])


def _meeting(
    mine: Iterable[Tables], others: Iterable[Tables], start: int, stop: int | None = None
) -> _Meeting | None:
    """The first frame from the byte `start` on, and before `stop` if given, that both have."""
    numbers: dict[Frame, int] = {}
    for tables in mine:
        numbers |= frames_of(tables, start, stop)
    last = max((offset for offset, _ in numbers), default=-1)
    theirs: dict[Frame, int] = {}
    for tables in others:
        if tables.offset > last:
            break
        theirs |= frames_of(tables, start, last + 1)
    frame = min(numbers.keys() & theirs.keys(), default=None)
    return None if frame is None else _Meeting(numbers[frame], theirs[frame], sum(frame))


def _until(found: Iterable[Tables], met: _Meeting) -> deque[Tables]:
    """Tables that were found, up to the frame."""
    kept: deque[Tables] = deque()
    for tables in found:
        if tables.offset + tables.size <= met.end:
            kept.append(tables)
        elif tables.offset < met.end:
            kept.append(until(tables, met.number, met.end))
    return kept
