"""The search for frames: where one may start, and what takes or judges what begins there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic

from protogen.runtime.framing.damage import IdleJudge, idle_judge_of
from protogen.runtime.framing.forms import (
    FormsCandidate,
    FormsCutter,
    FormStarts,
    check_together,
    cutter_of,
)
from protogen.runtime.framing.machine import Candidate
from protogen.runtime.framing.sender import MessageT_co, PartsT_co, SenderSpec
from protogen.runtime.framing.starts import Starts, starts_of
from protogen.runtime.framing.told import Told
from protogen.runtime.plain_cut import PlainCutter


class Search(Generic[MessageT_co, PartsT_co]):
    """Search for the frames of one sender, or of several forms at once."""

    starts: Starts | FormStarts
    cutter: PlainCutter[MessageT_co, PartsT_co] | FormsCutter | None
    """Takes what is plainly in order; None where only the reference does."""
    idle_judge: IdleJudge | None
    """Judges what begins in front of a silence; None where only the reference does."""

    def __init__(
        self, senders: Sequence[SenderSpec[MessageT_co, PartsT_co]], *, is_fast: bool
    ) -> None:
        """`is_fast`: what is plain is taken and judged by other engines than the reference.

        Raises ValueError where the frames are found in different ways.
        """
        self._senders = senders
        self.told = Told(senders)
        if len(senders) == 1:
            cut = senders[0].cut if is_fast else None
            self.starts = starts_of(senders[0].frame)
            self.cutter = None if cut is None else PlainCutter(senders[0], cut, self.starts)
            self.idle_judge = idle_judge_of(senders[0]) if is_fast else None
            return
        self.idle_judge = None
        check_together(senders)
        self._forms = FormStarts(senders)
        self.starts = self._forms
        self.cutter = cutter_of(senders, self._forms) if is_fast else None

    def candidate(self, data: bytes, at: int, *, is_fresh: bool) -> Candidate | FormsCandidate:
        """What begins there; `is_fresh`: nothing has come in front of it."""
        told = self.told.begin_frame()
        if len(self._senders) == 1:
            return Candidate(self._senders[0], told=told)
        return FormsCandidate(self._senders, self._forms, data, at, is_fresh=is_fresh, told=told)

    def sharing(self) -> Candidate | FormsCandidate:
        """What begins with the end of the frame before."""
        if len(self._senders) == 1:
            return Candidate(self._senders[0], shares_start=True, told=self.told.begin_frame())
        return FormsCandidate.sharing(self._senders, self.told.begin_frame())
