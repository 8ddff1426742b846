"""The decoder: bytes in any portions -> events."""

from __future__ import annotations

import gc
from collections.abc import Mapping, Sequence
from typing import Any, Generic, Literal

from protogen.runtime.errors import PayloadFault, Reason
from protogen.runtime.events import Event, InvalidEvent, MessageEvent, frame_event
from protogen.runtime.framing.forms import (
    FormsCandidate,
)
from protogen.runtime.framing.frame import AfterEnd, Anywhere
from protogen.runtime.framing.machine import Candidate, Cut, Failure
from protogen.runtime.framing.prefix import FormsPrefix, Prefix, prefix_of_any
from protogen.runtime.framing.sender import MessageT_co, PartsT_co, SenderSpec
from protogen.runtime.framing.told import GivenNumber
from protogen.runtime.search import Search

Engine = Literal["fast", "construct"]
"""Engine that decodes and encodes. `construct` is the reference: byte by byte, and construct's own
parser. `fast` does the same with generated straight-line code wherever all is in order."""


BytesLike = bytes | bytearray | memoryview
"""Objects that bytes are taken from; others with a buffer are taken as well."""

_LOOKED = 4096
"""So many bytes are looked through in the time that a candidate takes to be given one."""

_PIECE = 1 << 15
"""Bytes of a large portion that are taken at once, without a collection of garbage."""


def check_engine(engine: str) -> None:
    """Raise ValueError unless there is such an engine."""
    if engine not in ("fast", "construct"):
        raise ValueError(f"there is no engine {engine!r}; there are: fast, construct")


def octets(data: object) -> bytes:
    """The bytes of a bytes-like object. Raises TypeError for anything else."""
    try:
        return bytes(memoryview(data))  # type: ignore[arg-type]
    except TypeError:
        kind = type(data).__name__
        raise TypeError(f"needs bytes, a bytearray or a memoryview, not {kind}") from None


class Decoder(Generic[MessageT_co, PartsT_co]):
    """Cuts what is on a line into events: what one endpoint sends, or several.

    The raw bytes of all events, joined, are the input; how the input is divided among calls of
    `feed` changes nothing. At most one greatest frame is kept between calls, and behind it what may
    yet become a start literal of three bytes or more; in front of a frame that only a silence ends,
    as much noise.
    """

    def __init__(
        self,
        sender: SenderSpec[MessageT_co, PartsT_co] | Sequence[SenderSpec[MessageT_co, PartsT_co]],
        engine: Engine = "fast",
    ) -> None:
        """`sender` may be several: endpoints, and forms of their frames.

        Raises ValueError where their frames are found in different ways.
        """
        check_engine(engine)
        senders = (sender,) if isinstance(sender, SenderSpec) else tuple(sender)
        self._senders = senders
        names = {item.name for item in senders}
        self._name = names.pop() if len(names) == 1 else ""
        self._search = Search(senders, is_fast=engine == "fast")
        self._told = self._search.told
        self._starts = self._search.starts
        self._plain_cut = self._search.cutter
        self._shares = senders[0].layout.shares_delimiter
        is_alone = not self._starts.context and not self._shares
        self._lane = self._plain_cut.take if is_alone and self._plain_cut else None
        """Takes what comes in, where nothing of earlier frames tells how a frame starts."""
        shared = len(senders[0].layout.start) if self._shares else 0
        # So many bytes a frame has that can be cut.
        self._least = min(item.frame.least for item in senders) - shared
        self._greatest = max(item.frame.greatest for item in senders)
        self._is_anywhere = isinstance(senders[0].frame.start, Anywhere)
        # Whether noise has to go where it and a candidate are longer than a frame.
        self._keeps_one = self._is_anywhere and not senders[0].layout.ends_idle
        self._events: list[Event[MessageT_co, PartsT_co]] = []
        self._data = b""  # What is not delivered, and a little context in front of it.
        self._behind = bytearray()  # What came behind it, and the candidate has taken.
        self._offset = 0  # Of the first of these bytes in the input.
        # Places in these bytes:
        self._done = 0  # All in front of it is delivered.
        self._scan = 0  # No frame starts between `_done` and here.
        self._pushed = 0  # The candidate has taken all in front of it.
        self._candidate: Candidate | FormsCandidate | None = None
        self._failure: Failure | None = None  # The candidate's, until the next start is known.
        self._shares_start = False  # Whether the candidate starts with the end before it.
        self._wanted = 0  # Before so many bytes come in, what stands at `_scan` is not judged.
        # Whether beginnings of frames can be judged.
        self._judges = self._plain_cut is not None
        self._prefix: Prefix | FormsPrefix | None = None  # Judge of them, made when first needed.
        self._plain = b""  # Bytes that the judge needs not see one by one.
        self._is_fresh = True  # Nothing came in since the start or the last flush.
        self._began_fresh = False  # The same of when the candidate began.

    @property
    def pending(self) -> int:
        """Bytes that were taken and that no event covers yet."""
        return len(self._data) + len(self._behind) - self._done

    def feed(self, data: BytesLike) -> list[Event[MessageT_co, PartsT_co]]:
        """Take the next bytes of the input; the events that are certain now.

        Raises TypeError for what is not like bytes.
        """
        if type(data) is not bytes:
            data = octets(data)  # Of what is like bytes, some have a sum of their own with them.
        if len(data) > _PIECE:
            return self._feed_large(data)
        lane = self._lane
        whole = data
        if self._data:
            if self._wanted > len(data) and not data.translate(None, self._plain):
                self._wanted -= len(data)
                self._behind += data
                return []
            if lane is None or not self._wanted or self._is_large:
                return self._feed(data)
            self._join()
            whole = self._data + data
        elif lane is None:
            return self._feed(data)
        # All in front is delivered, and a frame may start at the first of these bytes.
        events: list[Event[MessageT_co, PartsT_co]] = []
        end = lane(whole, 0, self._offset, events) if len(whole) >= self._least else 0
        self._offset += end
        self._data = whole[end:]
        self._wanted = 0
        if end < len(whole):
            self._wanted = self._wanted_at(0)
            if not self._wanted:
                self._events = events
                self._run(final=False)
                return self._deliver()
        return events

    def _feed_large(self, data: bytes) -> list[Event[MessageT_co, PartsT_co]]:
        """The same of a large portion, piece by piece.

        The garbage collector looks through all new events again and again, which takes longer than
        to make them, and none of them is garbage. So it pauses for each piece, and looks at the
        youngest objects behind it, for what damaged frames and other threads leave.
        """
        events: list[Event[MessageT_co, PartsT_co]] = []
        for at in range(0, len(data), _PIECE):
            was_on = gc.isenabled()
            gc.disable()
            try:
                events += Decoder.feed(self, data[at : at + _PIECE])
            finally:
                if was_on:
                    gc.enable()
            if was_on:
                gc.collect(0)
        return events

    @property
    def _is_large(self) -> bool:
        """True if looking at all that is kept takes longer than a candidate takes for a byte."""
        return len(self._data) + len(self._behind) > _LOOKED

    def _feed(self, data: bytes) -> list[Event[MessageT_co, PartsT_co]]:
        """The same in any state."""
        if self._is_large:
            if not data:
                return []
            if self._is_little(data):
                if self._candidate is not None:
                    return self._feed_little(self._candidate, data)
                if self._wanted:
                    self._open_candidate()
        self._join()
        self._data += data
        is_waiting, self._wanted = self._wanted > 0, 0
        is_begun = is_waiting or self._candidate is not None
        # It may stand here as a whole now, in which case what was pushed needs not be.
        if is_begun and self._cut_frames():
            is_waiting = False
        if is_waiting:
            self._wanted = self._wanted_at(self._scan)
            if self._wanted:
                return []
            self._open_candidate()
        self._run(final=False)
        return self._deliver()

    def _is_little(self, data: bytes) -> bool:
        """True if looking at all that has come takes longer than a candidate takes for `data`.

        Else the time for a frame would grow with the square of its size.
        """
        if self._is_anywhere or self._failure is not None:
            return False  # There is more to do than to ask the candidate.
        size = len(self._data) + len(self._behind)
        return size - self._scan > _LOOKED * len(data)

    def _feed_little(
        self, candidate: Candidate | FormsCandidate, data: bytes
    ) -> list[Event[MessageT_co, PartsT_co]]:
        """The same where all in front is the candidate's, and nothing else is looked at."""
        self._behind += data
        for byte in data:
            self._pushed += 1
            verdict = candidate.push(byte)
            if verdict is not None:
                self._join()
                self._judge(verdict)
                self._run(final=False)
                return self._deliver()
        return []

    def _join(self) -> None:
        """Put what has come in one piece."""
        if self._behind:
            self._data += self._behind
            self._behind = bytearray()

    @property
    def told(self) -> Mapping[str, int]:
        """What holds of parts that are not sent, by their names."""
        return self._told.current

    def tell(self, /, **values: GivenNumber) -> None:
        """Tell parts that are not sent, such as what was asked for, by their names.

        They hold for the frame that comes next and those behind it, or for one where the schema
        says so. Several values are those of frames that follow each other, of which the last stays.
        Raises ValueError where there is no such part, it can't have the value, or no frame has the
        length.
        """
        self._told.tell(values)
        self._restart()

    def hear(self, event: Event[Any, Any]) -> None:
        """Take what another decoder found on the same bus, which may tell something here."""
        if isinstance(event, InvalidEvent):
            return
        numbers = event.codec.layout.numbers_of(event.parts)
        message = event.message if isinstance(event, MessageEvent) else None
        self._told.hear(event.codec, numbers, message)
        self._restart()

    def _restart(self) -> None:
        """Let a candidate that has taken no byte know what was told since it was made."""
        if self._candidate is None or self._pushed != self._scan:
            return
        if self._shares_start:
            self._candidate = self._search.sharing()
        else:
            self._candidate = self._search.candidate(
                self._data, self._scan, is_fresh=self._began_fresh
            )

    def flush(self) -> list[Event[MessageT_co, PartsT_co]]:
        """Take the end of the input, or a silence on the line; all remaining events."""
        self._join()
        if self._wanted:
            self._open_candidate()
        self._run(final=True)
        events = self._deliver()
        self._offset += len(self._data)
        self._data = b""
        self._done = self._scan = 0
        self._is_fresh = True
        return events

    def idle(self) -> list[Event[MessageT_co, PartsT_co]]:
        """Take a silence on the line: what `flush` does, which ends what has come."""
        return self.flush()

    def _deliver(self) -> list[Event[MessageT_co, PartsT_co]]:
        """The events so far; what they cover is forgotten."""
        passed = self._done - self._starts.context
        if passed > 0:
            self._data = self._data[passed:]
            self._offset += passed
            self._done -= passed
            self._scan -= passed
            self._pushed -= passed
        events, self._events = self._events, []
        return events

    # --- seek, take, scan again -------------------------------------------------------------------

    def _run(self, final: bool) -> None:
        goes_on = True
        while goes_on:
            if self._failure is not None:
                goes_on = self._resume(self._failure, final)
            elif self._candidate is not None:
                goes_on = self._take(self._candidate, final)
            else:
                goes_on = self._seek(final)

    def _seek(self, final: bool) -> bool:
        """Look for the next possible start; what is in front of it is noise."""
        start = self._next_start()
        end = len(self._data)
        if not final:
            end = self._starts.undecided(self._data, self._scan)
        if 0 <= start <= end:
            return self._open(start, final)
        self._scan = end
        self._noise(self._scan, final)
        return False

    def _next_start(self) -> int:
        if self._is_fresh and isinstance(self._senders[0].frame.start, AfterEnd):
            return self._scan
        return self._starts.find(self._data, self._scan, len(self._data) + 1)

    def _open(self, start: int, final: bool) -> bool:
        """Begin at a possible start. False: nothing can be said before more comes in."""
        self._began_fresh, self._is_fresh = self._is_fresh, False
        if not self._is_anywhere:
            self._noise(start, complete=True)
        self._scan = self._pushed = start
        if self._cut_frames():
            return True
        if self._plain_cut is not None:
            self._failure = self._plain_cut.verdict(self._data, start, is_all=final)
            if self._failure is not None:
                return True
        elif final and self._search.idle_judge is not None:
            self._failure = self._search.idle_judge.verdict(self._data, start, -1, is_all=True)
            if self._failure is not None:
                return True
        self._wanted = 0 if final else self._wanted_at(start)
        if not self._wanted:
            self._candidate = self._search.candidate(self._data, start, is_fresh=self._began_fresh)
        return not self._wanted

    def _wanted_at(self, start: int) -> int:
        """Bytes that may come before what begins there is judged; 0: a candidate takes it."""
        if not self._judges:
            return 0
        if self._prefix is None:
            self._prefix = prefix_of_any(self._senders)
            if self._prefix is None:
                self._judges = False
                return 0
            self._plain = self._prefix.plain
        return self._prefix.wanted(self._data, start)

    def _open_candidate(self) -> None:
        """Leave what was waited for to a candidate, from its first byte on."""
        self._join()
        self._wanted = 0
        self._pushed = self._scan
        self._began_fresh, self._is_fresh = self._is_fresh, False
        self._candidate = self._search.candidate(self._data, self._scan, is_fresh=self._began_fresh)

    def _cut_frames(self) -> bool:
        """Take whole frames that stand here and are plainly in order; whether there were any."""
        if self._plain_cut is None or self._done != self._scan:
            return False
        if len(self._data) - self._scan < self._least:
            return False
        end = self._plain_cut.take(self._data, self._scan, self._offset, self._events)
        if end == self._scan:
            return False
        self._done = end
        self._give_up(end)
        if self._shares:
            self._share_end()
        return True

    def _take(self, candidate: Candidate | FormsCandidate, final: bool) -> bool:
        """Give the candidate bytes until its verdict."""
        data = self._data
        for place in range(self._pushed, len(data)):
            verdict = candidate.push(data[place])
            if self._keeps_one and place + 1 - self._done > self._greatest:
                self._noise(self._scan, complete=True)
            if verdict is not None:
                return self._judge(verdict)
        self._pushed = len(data)
        if not final:
            return False
        if self._scan < len(data):
            return self._judge(candidate.flush())
        self._candidate = None
        self._noise(self._scan, complete=True)
        return False

    def _judge(self, verdict: Cut | Failure) -> bool:
        self._failure = self._read(verdict) if isinstance(verdict, Cut) else verdict
        if self._failure is None:
            self._give_up(self._done)
            if self._shares and not self._cut_frames():
                self._share_end()
        return True

    def _share_end(self) -> None:
        """Begin a candidate with the end of the frame before, where it may be its start as well."""
        self._pushed = self._scan
        self._shares_start = True
        self._candidate = self._search.sharing()

    def _read(self, cut: Cut) -> Failure | None:
        """Deliver the frame, unless its payload is not that of its message."""
        assert self._candidate is not None
        sender = self._candidate.sender
        try:
            message = sender.read(cut.numbers, cut.payload)
        except PayloadFault as error:
            return Failure(cut.size, error.reason, str(error))
        self._noise(self._scan, complete=True)
        offset, raw = self._cover(self._scan + cut.size)
        self._events.append(frame_event(sender, cut, message, raw, offset))
        if self._told:
            self._told.pass_frame(sender, cut.numbers, message)
        return None

    def _resume(self, failure: Failure, final: bool) -> bool:
        """Go on behind the candidate's first byte, where the next frame may start."""
        if self._is_anywhere:
            self._give_up(self._scan + 1)
            self._noise(self._scan, complete=False)
            return True
        # Behind an end that was taken for a start, the frame's own start may stand.
        low = self._scan + (not self._shares_start)
        high = self._scan + (failure.size or 1)
        start = self._starts.find(self._data, low, high)
        end = high if start < 0 else start
        if not final and self._starts.undecided(self._data, low) < end:
            return False
        if start == self._scan:
            self._give_up(start)
            return True
        self._invalid(start if start >= 0 else high, failure.reason, failure.problem)
        self._give_up(self._done)
        return True

    def _give_up(self, scan: int) -> None:
        self._candidate = None
        self._failure = None
        self._shares_start = False
        self._scan = scan

    # --- events -----------------------------------------------------------------------------------

    def _cover(self, end: int) -> tuple[int, bytes]:
        """Deliver all up to `end`: where it starts in the input, and its bytes."""
        offset = self._offset + self._done
        raw = self._data[self._done : end]
        self._done = end
        return offset, raw

    def _noise(self, end: int, complete: bool) -> None:
        """Deliver noise up to `end` by greatest frames, and if it is complete the rest as well."""
        while end - self._done >= self._greatest:
            self._invalid(self._done + self._greatest, "noise", "")
        if complete and end > self._done:
            self._invalid(end, "noise", "")

    def _invalid(self, end: int, reason: Reason, problem: str) -> None:
        offset, raw = self._cover(end)
        self._events.append(InvalidEvent(offset, raw, self._name, reason, problem))
