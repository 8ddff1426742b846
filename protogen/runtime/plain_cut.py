"""Cutter of what needs no look at each byte: frames in order, and plain damage between them."""

from __future__ import annotations

from typing import Generic

from protogen.runtime.events import Event, InvalidEvent
from protogen.runtime.framing.damage import Judge, judge_of
from protogen.runtime.framing.machine import Failure
from protogen.runtime.framing.sender import Cutter, MessageT_co, PartsT_co, SenderSpec
from protogen.runtime.framing.starts import Starts


class PlainCutter(Generic[MessageT_co, PartsT_co]):
    """Cuts one sender's stream as far as it is plain what stands there."""

    def __init__(
        self, sender: SenderSpec[MessageT_co, PartsT_co], cut: Cutter, starts: Starts
    ) -> None:
        """`cut` takes the frames that are in order."""
        self._sender = sender
        self._cut = cut
        self._starts = starts
        self._greatest = sender.frame.greatest
        self._has_judge = True
        self._judge: Judge | None = None

    def take(
        self, data: bytes, at: int, base: int, events: list[Event[MessageT_co, PartsT_co]]
    ) -> int:
        """Add the events from `at` on; the place of the first byte that is not plain.

        `base` is the offset of the data in the input.
        """
        at = self._cut(data, at, base, events)
        while self._has_judge:
            start = self._starts.find(data, at + 1, len(data) + 1)
            end = -1 if start < 0 else self._damage(data, at, start, base, events)
            if end < 0:
                break
            self._noise(data[end:start], base + end, events)
            at = self._cut(data, start, base, events)
        return at

    def verdict(self, data: bytes, start: int, *, is_all: bool) -> Failure | None:
        """The verdict on a candidate, where it plainly is no frame.

        `is_all`: the input ends behind the data.
        """
        judge = self._judge_of_damage()
        if judge is None:
            return None
        end = self._starts.find(data, start + 1, len(data) + 1)
        verdict = judge.verdict(data, start, end, is_all=is_all)
        return verdict if isinstance(verdict, Failure) else None

    def _judge_of_damage(self) -> Judge | None:
        """Judge of damaged frames, made when first needed; None: candidates take them."""
        if self._has_judge and self._judge is None:
            self._judge = judge_of(self._sender)
            self._has_judge = self._judge is not None
        return self._judge

    def _damage(
        self,
        data: bytes,
        at: int,
        start: int,
        base: int,
        events: list[Event[MessageT_co, PartsT_co]],
    ) -> int:
        """Take what begins there and doesn't reach to the next start; the place behind it.

        -1: it is not plain what that is.
        """
        judge = self._judge_of_damage()
        if judge is None:
            return -1
        if self._starts.find(data, at, at + 1) < 0:
            return at
        verdict = judge.verdict(data, at, start, is_all=False)
        if verdict is None:
            return -1
        if isinstance(verdict, int):
            end = at + verdict
            return end if self._cut(data[at:end], 0, base + at, events) == verdict else -1
        end = min(at + (verdict.size or 1), start)
        name, raw = self._sender.name, data[at:end]
        events.append(InvalidEvent(base + at, raw, name, verdict.reason, verdict.problem))
        return end

    def _noise(
        self, noise: bytes, offset: int, events: list[Event[MessageT_co, PartsT_co]]
    ) -> None:
        for low in range(0, len(noise), self._greatest):
            raw = noise[low : low + self._greatest]
            events.append(InvalidEvent(offset + low, raw, self._sender.name, "noise"))
