"""A possible frame of one of several forms in C, while other forms read the same bytes."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from protogen.model.frame_plan import StartRule
from protogen.targets.c.decoders.push import PushDecoder
from protogen.targets.c.frame.virtual import VirtualView, virtual_of

_OWNERS = (
    "offset",
    "noise",
    "count",
    "next",
    "failed",
    "state",
    "reason",
    "shared",
    "ending",
    "buffer",
)
"""What is kept once for all forms."""


class Candidate(PushDecoder, frozen=True, dict=True):
    """A candidate of one form: what it reads is kept as it came, and by its owner."""

    @property
    def prefix(self) -> str:
        """Prefix of its functions and its struct."""
        return f"{self.types}_candidate"

    @property
    def all_events(self) -> bool:
        """True: what is no frame has a size, by which forms are compared."""
        return True

    @property
    def keeps_wire(self) -> bool:
        """True: another form may find a frame in the same bytes."""
        return True

    @property
    def keeps_both(self) -> bool:
        """True if content is not what stands on the wire."""
        return self.plan.region is not None

    @property
    def wire_is_content(self) -> bool:
        """True if it is."""
        return self.plan.region is None

    @property
    def push(self) -> Candidate:
        """The members and conditions, which templates ask a decoder for."""
        return self

    @property
    def takes_content(self) -> bool:
        """False: no frame is taken whole."""
        return False

    @property
    def flat(self) -> None:
        """None: it has states."""

    polled = flat
    fills_in_place = False

    @cached_property
    def virtual(self) -> tuple[VirtualView, ...]:
        """The parts that are not sent; the functions are those of the form's own decoder."""
        return virtual_of(self.plan, self.types, self.numbers)

    def told(self, key: str) -> str:
        """The identity that stands for all that its message has."""
        return f"{self.types}_told({key})" if self.alternatives else key

    @property
    def opening(self) -> Iterator[tuple[str, str]]:
        """The members that it begins with, and their values."""
        yield from ((name, value) for name, value in super().opening if self.keeps(name))

    @property
    def tracks(self) -> bool:
        """True if a start inside ends it, so that its bytes are looked at for one."""
        return super().tracks and self.starts_inside

    @property
    def literals(self) -> dict[str, list[dict[str, int]]]:
        """States of the literals that are looked for inside."""
        sought = "end" if self.plan.end_bytes else "start"
        used = {"start": self.tracks, "end": False} | ({sought: True} if self.searches else {})
        return {name: states for name, states in super().literals.items() if used[name]}

    @property
    def counts_beginnings(self) -> bool:
        """True if it matters how many bytes of one of several starts are held back."""
        return self.reads_beginnings

    def keeps(self, member: str) -> bool:
        """True if a member of a decoder is its own, and not its owner's."""
        return self.tracks if member == "match" else member not in _OWNERS

    @property
    def begins(self) -> tuple[bytes, ...]:
        """The words that a frame begins with, where one has to stand at its start."""
        is_marked = self.plan.start in (StartRule.LITERAL, StartRule.SET)
        return self.plan.start_words if is_marked else ()

    @property
    def begins_with_byte(self) -> bool:
        """True if its first byte alone tells whether a frame may begin there."""
        return bool(self.begins) and len(self.begins[0]) == 1
