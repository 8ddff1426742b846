"""Several forms of frame on one line: all of them are looked for at once.

Where bytes are a valid frame of two forms, the first one wins, and a known message over a frame
whose identity is unknown.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

from protogen.runtime.errors import PayloadFault
from protogen.runtime.events import Event
from protogen.runtime.framing.frame import AfterEnd, Start, StartLiteral, StartMark
from protogen.runtime.framing.machine import Candidate, Cut, Failure
from protogen.runtime.framing.sender import SenderSpec
from protogen.runtime.framing.starts import Starts, starts_of

Senders = Sequence[SenderSpec[Any, Any]]


class FormStarts:
    """Finds places where a frame of any form may begin."""

    def __init__(self, senders: Senders) -> None:
        self.each = [starts_of(sender.frame) for sender in senders]
        self.context = max(starts.context for starts in self.each)
        """Bytes in front of a place that tell whether it is a start."""

    def find(self, data: bytes, low: int, high: int) -> int:
        """The first start from `low` on that lies before `high`; -1 if there is none."""
        found = [starts.find(data, low, high) for starts in self.each]
        return min((place for place in found if place >= 0), default=-1)

    def undecided(self, data: bytes, low: int) -> int:
        """The first place from `low` on that more bytes may yet make a start; else the end."""
        return min(starts.undecided(data, low) for starts in self.each)


class FormsCandidate:
    """A possible frame of one of several forms. Of no use after its verdict."""

    def __init__(
        self,
        senders: Senders,
        starts: FormStarts,
        data: bytes,
        at: int,
        *,
        is_fresh: bool,
        told: Mapping[str, int],
    ) -> None:
        """It begins at a place in the data; `is_fresh`: nothing has come in front of it.

        `told` has the values of identity parts that are not sent.
        """
        begun = [
            (sender, is_begun)
            for sender, each in zip(senders, starts.each, strict=True)
            if (is_begun := _is_begun(sender, each, data, at, is_fresh)) is not None
        ]
        self._take([sender for sender, _ in begun], told)
        self._begun = [is_begun for _, is_begun in begun]

    def _take(
        self, senders: Senders, told: Mapping[str, int], *, shares_start: bool = False
    ) -> None:
        self._senders = list(senders)
        self._candidates = [
            Candidate(item, shares_start=shares_start, told=told) for item in senders
        ]
        self._verdicts: list[Cut | Failure | None] = [None] * len(senders)
        self._is_known = [False] * len(senders)
        self._wire = bytearray()
        self._chosen = 0

    @classmethod
    def sharing(cls, senders: Senders, told: Mapping[str, int]) -> FormsCandidate:
        """A candidate that begins with the end of the frame before, in any of the forms."""
        item = cls.__new__(cls)
        item._take(senders, told, shares_start=True)
        item._begun = [True] * len(senders)
        return item

    @property
    def sender(self) -> SenderSpec[Any, Any]:
        """The sender that the verdict is about."""
        return self._senders[self._chosen]

    def push(self, byte: int) -> Cut | Failure | None:
        """Take the next byte. None: the candidate needs more."""
        self._wire.append(byte)
        is_judged = False
        for index, candidate in enumerate(self._candidates):
            if self._verdicts[index] is None:
                verdict = candidate.push(byte)
                if verdict is not None:
                    self._judge(index, verdict)
                    is_judged = True
        return self._verdict() if is_judged else None

    def flush(self) -> Cut | Failure:
        """Take the end of the input."""
        for index, candidate in enumerate(self._candidates):
            if self._verdicts[index] is None:
                self._judge(index, candidate.flush())
        verdict = self._verdict()
        assert verdict is not None
        return verdict

    def _judge(self, index: int, verdict: Cut | Failure) -> None:
        sender = self._senders[index]
        if isinstance(verdict, Cut):
            try:
                message = sender.read(verdict.numbers, verdict.payload)
                self._is_known[index] = message is not None
            except PayloadFault as error:
                verdict = Failure(verdict.size, error.reason, str(error))
        elif not self._is_begun_by_now(index):
            verdict = Failure(0, verdict.reason, verdict.problem)  # No frame of it began here.
        self._verdicts[index] = verdict

    def _is_begun_by_now(self, index: int) -> bool:
        return self._begun[index] or self._wire.startswith(self._senders[index].layout.start_words)

    def _verdict(self) -> Cut | Failure | None:
        """The verdict, as soon as no form can change it."""
        for index, verdict in enumerate(self._verdicts):
            if verdict is None:
                return None
            if isinstance(verdict, Cut) and self._is_known[index]:
                return self._choose(index)
        cuts = [index for index, item in enumerate(self._verdicts) if isinstance(item, Cut)]
        if cuts:
            return self._choose(cuts[0])
        sizes = [item.size if item is not None else 0 for item in self._verdicts]
        return self._choose(sizes.index(max(sizes)))

    def _choose(self, index: int) -> Cut | Failure | None:
        self._chosen = index
        return self._verdicts[index]


def _is_begun(
    sender: SenderSpec[Any, Any], starts: Starts, data: bytes, at: int, is_fresh: bool
) -> bool | None:
    """True if a frame may begin there, False if more bytes have to tell, None if none can."""
    if is_fresh and isinstance(sender.frame.start, AfterEnd):
        return True
    if starts.find(data, at, at + 1) == at:
        return True
    return False if at < len(data) and starts.undecided(data, at) == at else None


class FormsCutter:
    """Cuts frames of several forms, as far as they are plainly in order."""

    def __init__(self, senders: Senders, starts: FormStarts) -> None:
        self._senders = list(zip(senders, starts.each, strict=True))

    def take(self, data: bytes, at: int, base: int, events: list[Event[Any, Any]]) -> int:
        """Add the events from `at` on; the place of the first byte that is not plain.

        `base` is the offset of the data in the input.
        """
        while True:
            found = self._next(data, at, base)
            if not found:
                return at
            events += found
            at += sum(event.size for event in found)

    def verdict(self, data: bytes, start: int, *, is_all: bool) -> None:
        """No verdict: candidates judge what is damaged."""

    def _next(self, data: bytes, at: int, base: int) -> list[Event[Any, Any]]:
        """Events of the frames that begin there; none where it is not plain what they are."""
        unknown: list[Event[Any, Any]] = []
        for sender, starts in self._senders:
            if starts.find(data, at, at + 1) != at:
                continue
            found: list[Event[Any, Any]] = []
            end = at + unknown[0].size if unknown else len(data)
            if sender.cut is None or sender.cut(data[:end], at, base, found) == at:
                return []
            if found[0].kind == "message":
                return found[:1] if unknown else list(_messages(found))
            unknown = unknown or found[:1]
        return unknown


def _messages(events: Sequence[Event[Any, Any]]) -> Iterator[Event[Any, Any]]:
    """The messages at the beginning: frames behind them may be of another form."""
    for event in events:
        if event.kind != "message":
            return
        yield event


def check_together(senders: Senders) -> None:
    """Raise ValueError unless one search finds the starts of all frames."""
    first = _kind_of_start(senders[0])
    for sender in senders[1:]:
        if _kind_of_start(sender) != first:
            names = f"{senders[0].key} and {sender.key}"
            raise ValueError(f"frames of {names} are found in different ways: name the sender")


def _kind_of_start(sender: SenderSpec[Any, Any]) -> object:
    """What has to be the same in all forms."""
    start, layout = sender.frame.start, sender.layout
    if layout.ends_idle:
        return "idle", StartLiteral if isinstance(start, StartMark) else type(start)
    if isinstance(start, StartMark):
        return start if layout.shares_delimiter else StartLiteral
    return sender.frame.end if isinstance(start, AfterEnd) else type(start)


def cutter_of(senders: Senders, starts: FormStarts) -> FormsCutter | None:
    """The cutter for these forms; None where their starts do not tell which one comes first.

    Nor is there one where frames tell what those behind them are.
    """
    if any(sender.frame.told for sender in senders):
        return None
    each = [sender.frame.start for sender in senders]
    if any(sender.layout.shares_delimiter for sender in senders):
        return None
    return FormsCutter(senders, starts) if _are_clear(each) else None


def _are_clear(starts: Sequence[Start]) -> bool:
    """True if two starts are equal, or never found in one place."""
    marks = [item for item in starts if isinstance(item, StartMark)]
    return len(marks) == len(starts) and all(
        one == other or _are_apart(one, other) for one, other in combinations(marks, 2)
    )


def _are_apart(one: StartMark, other: StartMark) -> bool:
    words, others = one.words, other.words
    begun = (word.startswith(others) for word in words)
    return not any(begun) and not any(word.startswith(words) for word in others)
