"""One possible frame, taken byte by byte until it is complete or proves to be none.

A `Candidate` starts where a frame may start. It decides as early as the bytes allow, and looks at
nothing but them, so that it does not matter how they arrive.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from protogen.runtime.errors import Reason
from protogen.runtime.framing.content import Content, Rejected
from protogen.runtime.framing.frame import AfterEnd, Anywhere, ChecksumPart, StartMark
from protogen.runtime.framing.layout import Place, Slice
from protogen.runtime.framing.sender import SenderSpec
from protogen.runtime.transparency import TransparencyError, Unstuffer

_NOTHING: Mapping[str, int] = {}


class Cut(NamedTuple):
    """A complete frame whose length and checksums are right: the values of parts, the payload."""

    size: int
    numbers: dict[str, int]
    payload: bytes


class Failure(NamedTuple):
    """The first `size` bytes of a candidate, which are no frame."""

    size: int
    reason: Reason
    problem: str


class Candidate:
    """A possible frame of one sender. Of no use after its verdict."""

    def __init__(
        self,
        sender: SenderSpec[Any, Any],
        *,
        shares_start: bool = False,
        told: Mapping[str, int] = _NOTHING,
    ) -> None:
        """With `shares_start`, the end of the frame before is also this one's start.

        `told` has the values of parts that are not sent.
        """
        self.sender = sender
        self._spec = sender.frame
        self._given_up_at = sender.frame.given_up_at
        self._layout = sender.layout
        self._wire = bytearray()
        self._shared = 0  # How many of these bytes, in front, are those of the frame before.
        self._behind = 0  # How many of these bytes, at the end, are not the candidate's own.
        self._content = Content(sender, told)
        self._cut: Cut | None = None
        # A delimiter is looked for: bytes that may begin it are held back until that is clear.
        self._delimiters = self._protected_ends()
        self._held = b""
        self._end_left = 0  # Bytes still to come of an end that stands in a known place.
        self._ends_at_start = False  # The next start ends the frame, and nothing else does.
        self._open_from = 0  # Where on the wire the payload of such a frame begins.
        # The stuffed region: not begun, begun (with an unstuffer), or finished.
        self._region_begun = False
        self._unstuffer: Unstuffer | None = None
        self._waiting = 0  # Bytes that were released together with the one that is taken.
        self._empty_left = 0  # Wire bytes still to come of a region that holds nothing.
        self._passed = 0  # Wire bytes that were taken as content or stuffing.
        self._wire_ends: list[int] = []  # As many as were passed, for each byte of content.
        self._refused = self._refusal()
        if shares_start:
            self._take_over(self._layout.start)

    def _refusal(self) -> Rejected | None:
        """What is wrong before the first byte: no frame has what was told, or it has no size."""
        try:
            self._content.begin()
            self._cross()
        except Rejected as why:
            return why
        return None

    def _take_over(self, start: bytes) -> None:
        for byte in start:
            self.push(byte)
        self._shared = len(start)

    @property
    def content_size(self) -> int:
        """Bytes of content so far."""
        return len(self._content.bytes)

    @property
    def content_limit(self) -> int | None:
        """Bytes of content that there can be at most; None where that is not known yet."""
        return self._content.limit

    def push(self, byte: int) -> Cut | Failure | None:
        """Take the next byte. None: the candidate needs more."""
        self._wire.append(byte)
        try:
            if self._refused is None:
                self._take(byte)
            elif len(self._wire) > self._layout.start_size:
                raise self._refused
            if self._cut is None and len(self._wire) >= self._given_up_at:
                raise Rejected("length", f"no frame has more than {self._spec.greatest} bytes")
        except Rejected as why:
            return self._failure(why)
        return self._cut

    def flush(self) -> Cut | Failure:
        """Take the end of the input, or a silence."""
        try:
            self._close_at_flush()
        except Rejected as why:
            return self._failure(why)
        assert self._cut is not None
        return self._cut

    def _failure(self, why: Rejected) -> Failure:
        return Failure(self._own_size(), why.reason, why.problem)

    def _own_size(self) -> int:
        return len(self._wire) - self._shared - self._behind

    # --- where the frame ends -------------------------------------------------------------------

    def _protected_ends(self) -> tuple[bytes, ...]:
        end = self._spec.end
        return (end.value,) if end is not None and end.protected else ()

    def _take(self, byte: int) -> None:
        start = self._start_inside() if byte in self._layout.start_bytes else 0
        if start:
            self._meet_start(start)
        elif len(self._wire) == self._layout.empty_size and self._is_empty():
            self._reject_empty()
        elif self._delimiters and len(self._wire) > self._layout.mark_size:
            self._search(byte)
        else:
            self._pass(byte)

    def _start_inside(self) -> int:
        """The size of a start that the wire ends with and that ends this candidate, or 0."""
        start = self._spec.start
        assert isinstance(start, StartMark)
        size = self._layout.start_size
        before = len(self._wire) - size
        if before <= 0 or not self._wire.endswith(self._layout.start_words):
            return 0
        ends_it = start.protected or (self._ends_at_start and before >= self._open_from)
        return size if ends_it else 0

    def _meet_start(self, size: int) -> None:
        self._behind = size
        if not self._ends_at_start or len(self._wire) - size < self._open_from:
            raise Rejected("truncated", "another frame starts inside")
        self._held = b""
        self._close()

    def _is_empty(self) -> bool:
        return self._wire == self._layout.empty_frame

    def _reject_empty(self) -> None:
        # Where the same literal starts and ends a frame, this end may be the next frame's start.
        if not isinstance(self._spec.start, AfterEnd):
            self._behind = len(self._layout.end)
        raise Rejected("noise", "there is nothing in front of the end")

    def _search(self, byte: int) -> None:
        """Look for the delimiter; let pass what can't begin it."""
        if not self._held:
            for item in self._delimiters:
                if item[0] == byte:
                    break
            else:
                self._pass(byte)
                return
        self._held += bytes((byte,))
        if self._held in self._delimiters:
            self._held = b""
            self._close()
            return
        while not any(item.startswith(self._held) for item in self._delimiters):
            first, self._held = self._held[0], self._held[1:]
            self._pass(first)

    def _match_end(self, byte: int) -> None:
        if byte != self._layout.end[-self._end_left]:
            raise self._content.surplus()
        self._end_left -= 1
        if not self._end_left:
            self._complete()

    def _close_at_flush(self) -> None:
        if not (self._ends_at_start or self._layout.ends_idle):
            raise Rejected("truncated", "the input ends inside the frame")
        held, self._held = self._held, b""
        for byte in held:
            self._pass(byte)
        self._close()

    def _close(self) -> None:
        """End the frame here, whatever is known of its size."""
        self._finish_region()
        self._content.close()
        self._complete()

    # --- wire bytes, one after another ------------------------------------------------------------

    def _pass(self, byte: int) -> None:
        """Take a byte that begins no delimiter."""
        if self._end_left:
            self._match_end(byte)
            return
        self._passed += 1
        if self._unstuffer is not None:
            self._unstuff(self._unstuffer, byte)
        elif self._content.is_full:
            raise self._content.surplus()
        else:
            self._accept(byte)
        if self._content.region_end is not None:
            self._reach(self._content.region_end)

    def _reach(self, region_end: int) -> None:
        """Do what is due where the length says that something ends."""
        if self._passed == region_end:
            self._finish_region()
        if self._passed == region_end + self._layout.behind_region:
            self._content.close_counted()
            self._cross()

    def _unstuff(self, unstuffer: Unstuffer, byte: int) -> None:
        try:
            released = unstuffer.push(byte)
        except TransparencyError as error:
            raise Rejected(error.reason, str(error)) from None
        if self._empty_left:
            self._empty_left -= 1
            self._cross()
        elif self._content.is_full:
            raise self._content.surplus()
        for index, value in enumerate(released, start=1):
            self._waiting = len(released) - index
            self._accept(value)

    def _accept(self, value: int) -> None:
        if self._layout.has_wire_checksum:
            self._wire_ends.append(self._passed)
        if self._content.accept(value):
            self._cross()

    def _cross(self) -> None:
        """Do what is due between two parts."""
        if self._layout.stuffed:
            self._cross_region()
        if self._content.is_full and not self._empty_left:
            self._meet_full()
        elif self._content.is_open and not (self._delimiters or self._layout.counts_wire):
            self._open()

    def _open(self) -> None:
        """From now on only a delimiter, or a silence, can tell where the frame ends."""
        if self._layout.ends_idle:
            return
        if isinstance(self._spec.start, Anywhere):
            raise Rejected("size", "the identity is unknown, and nothing else gives a size")
        self._delimiters = tuple(filter(None, (self._layout.end,)))
        if not self._delimiters and not self._ends_at_start:
            self._ends_at_start = True
            self._open_from = len(self._wire)
            self._delimiters = self._layout.start_words if self._layout.mark_size else ()

    def _meet_full(self) -> None:
        if self._delimiters or self._layout.ends_idle:
            return
        if self._layout.end:
            self._end_left = len(self._layout.end)
        else:
            self._complete()

    # --- the stuffed region -----------------------------------------------------------------------

    def _cross_region(self) -> None:
        first, last = self._layout.stuffed[0], self._layout.stuffed[-1]
        if not self._region_begun and self._content.index >= first:
            self._begin_region()
        if self._unstuffer is not None and self._content.index > last and not self._empty_left:
            ends_at_delimiter = self._content.is_full and self._delimiters
            if not ends_at_delimiter:
                self._finish_region(surplus=True)

    def _begin_region(self) -> None:
        transparency = self._spec.transparency
        assert transparency is not None
        self._region_begun = True
        self._unstuffer = transparency.decoder()
        if self._content.index > self._layout.stuffed[-1]:
            self._empty_left = len(transparency.encode(b""))

    def _finish_region(self, surplus: bool = False) -> None:
        """End the region. What was held back until now is content, or a `surplus` of it."""
        unstuffer, self._unstuffer = self._unstuffer, None
        if unstuffer is None:
            return
        try:
            released = unstuffer.finish()
        except TransparencyError as error:
            raise Rejected(error.reason, str(error)) from None
        if surplus and (released or self._waiting):
            raise self._content.surplus()
        for value in released:
            self._accept(value)

    # --- the complete frame -----------------------------------------------------------------------

    def _complete(self) -> None:
        content = self._content
        assert content.payload_size is not None
        slices = {item.part.name: item for item in self._layout.slices(content.payload_size)}
        virtual = self.sender.virtual(content.numbers) if self._spec.virtual else {}
        for part in self._layout.checksums:
            if self._layout.holders[part.name] in slices:
                self._check(part, slices, virtual)
        start = self._layout.head_size
        payload = bytes(content.bytes[start : start + content.payload_size])
        self._cut = Cut(self._own_size(), content.numbers, payload)

    def _check(
        self, part: ChecksumPart, slices: dict[str, Slice], virtual: Mapping[str, bytes]
    ) -> None:
        data = bytes(self._wire if part.over_wire else self._content.bytes)
        places = {name: self._span(item, part.over_wire) for name, item in slices.items()}
        item = slices[self._layout.holders[part.name]]
        found = bytes(self._content.bytes[item.start : item.end])
        problem = wrong_sum(self.sender, part, (data, places, virtual), found)
        if problem is not None:
            raise Rejected("checksum", problem)

    def _span(self, item: Slice, over_wire: bool) -> tuple[int, int]:
        """Place of a part in the content, or on the wire."""
        if not over_wire or item.start == item.end:
            return item.start, item.end
        start = self._wire_ends[item.start - 1] if item.start else 0
        return start, self._wire_ends[item.end - 1]


_Summed = tuple[bytes, Mapping[str, Place], Mapping[str, bytes]]
"""Bytes, the places of parts in them, and the bytes of parts that are not sent."""


def wrong_sum(
    sender: SenderSpec[Any, Any], part: ChecksumPart, summed: _Summed, found: bytes
) -> str | None:
    """Description of a checksum that is not that of the covered bytes; None if it is.

    One that covers what is not sent, and not known for the frame's identity, is never right.
    """
    data, places, virtual = summed
    unknown = sender.without_value(part, virtual)
    if unknown:
        return f"the identity is unknown, and so is {unknown}, which {part.name} covers"
    covered = sender.layout.covered(part, places, data, virtual)
    return part.fault(found, part.algorithm.compute(covered))


def verdict_on(
    sender: SenderSpec[Any, Any],
    data: bytes,
    *,
    shares_start: bool = False,
    told: Mapping[str, int] = _NOTHING,
) -> tuple[Cut | Failure, int]:
    """The verdict on a candidate that is the whole input, and the offset of the byte that gave it.

    The end of the input gives it where no byte does. With `shares_start` the end of the frame
    before, which is not in `data`, is the candidate's start.
    """
    candidate = Candidate(sender, shares_start=shares_start, told=told)
    for offset, byte in enumerate(data):
        verdict = candidate.push(byte)
        if verdict is not None:
            return verdict, offset
    return candidate.flush(), len(data)
