"""Verdicts on damaged frames that stand in the input as a whole.

A judge spares the reference from taking such a frame byte by byte, and says what a `Candidate`
would say. What is not plain is left to a candidate.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from protogen.runtime.errors import ByteError, Reason
from protogen.runtime.framing.frame import (
    BitsPart,
    ChecksumPart,
    LiteralPart,
    NumberPart,
    Part,
    StartMark,
    written_apart,
)
from protogen.runtime.framing.layout import Place
from protogen.runtime.framing.machine import Failure, wrong_sum
from protogen.runtime.framing.sender import SenderSpec
from protogen.runtime.transparency import Escape, Substitution, TransparencyError

Verdict = Failure | int | None
"""What stands at a start: no frame, or one of so many bytes that ends in front of the next start.
None where neither is plain."""

_KEPT = 16
"""Heads and sizes of which is remembered what they tell: a wire must not fill the memory."""


def judge_of(sender: SenderSpec[Any, Any]) -> Judge | None:
    """The judge of a sender's damaged frames; None where only the reference can judge them."""
    frame, layout = sender.frame, sender.layout
    sums_alone = all(isinstance(p, ChecksumPart) and not p.when_payload for p in layout.tail)
    is_told = layout.length is not None or layout.early_identity
    if not (sums_alone and is_told) or layout.has_wire_checksum or layout.shares_delimiter:
        return None
    if layout.counts_wire:
        return None
    if not isinstance(frame.start, StartMark):
        return None
    if not frame.start.protected:
        return None if layout.stuffed or layout.end else SizeJudge(sender)
    is_plain = frame.end is None or frame.end.protected
    return SliceJudge(sender) if is_plain and _is_stuffed_plainly(sender) else None


def idle_judge_of(sender: SenderSpec[Any, Any]) -> IdleJudge | None:
    """The judge of what a silence ends; None where only the reference can judge it."""
    layout = sender.layout
    sums_alone = all(isinstance(p, ChecksumPart) and not p.when_payload for p in layout.tail)
    is_plain = sums_alone and bool(layout.checksums) and layout.length is None
    if not (layout.ends_idle and is_plain) or layout.has_wire_checksum or layout.stuffed:
        return None
    if sender.frame.told:
        return None
    return IdleJudge(sender)


def _is_stuffed_plainly(sender: SenderSpec[Any, Any]) -> bool:
    """True if nothing is stuffed, or all between start and end, in one way only."""
    layout, stuffing = sender.layout, sender.frame.transparency
    if stuffing is None or not layout.stuffed:
        return layout.start_size <= 1
    before = sum(part.size for part in layout.parts[: layout.stuffed[0]])
    is_whole = before == len(layout.start) > 0 and layout.stuffed[-1] == len(layout.parts) - 1
    if not is_whole or not isinstance(stuffing, Substitution | Escape) or stuffing.lenient:
        return False
    return _is_held(stuffing, layout.start[:-1])


def _is_held(stuffing: Substitution | Escape, begun: bytes) -> bool:
    """True if a region neither refuses the beginning of a start, nor takes it for content."""
    unstuffer = stuffing.decoder()
    try:
        return not any(unstuffer.push(byte) for byte in begun)
    except TransparencyError:
        return False


class Judge:
    """Judge of one sender's damaged frames."""

    def __init__(self, sender: SenderSpec[Any, Any]) -> None:
        self._sender = sender
        self._layout = layout = sender.layout
        self._greatest = sender.frame.greatest
        self._around = layout.head_size + layout.tail_size(1)
        self._places = lru_cache(_KEPT)(self._places_of)
        self._payload_size = lru_cache(_KEPT)(self._payload_size_of)
        self._asks_identity = layout.length is None or (
            layout.spec.rescans and (layout.early_identity or not layout.identity)
        )
        asked = layout.sent_identity if self._asks_identity else ()
        checked: tuple[Part, ...] = (*asked, *layout.lengths, *layout.bounded)
        head = [item for item in layout.slices(1) if item.part in layout.head]
        self._literals = [
            (item.part.value, slice(item.start, item.end))
            for item in head
            if isinstance(item.part, LiteralPart) and item.start >= layout.start_size
        ]
        self._held = [
            (item.part, slice(item.start, item.end))
            for item in head
            if isinstance(item.part, BitsPart)
        ]
        self._checked = [
            (part, slice(item.start, item.end))
            for item in head
            for part in written_apart((item.part,))
            if isinstance(part, NumberPart)
            and (
                part in checked or part.name in layout.mirrored or part.number.bits < 8 * part.size
            )
        ]

    def verdict(self, data: bytes, start: int, end: int, *, is_all: bool) -> Verdict:
        """The verdict on the candidate that starts there.

        `end`: place of the next start, or -1. `is_all`: the input ends behind the data.
        """
        raise NotImplementedError

    def _of_whole(self, content: bytes, size: int, own: int) -> Failure | None:
        """The verdict on a content of the right size: a wrong checksum, or nothing plain."""
        places = self._places(size)
        virtual = self._virtual(content, places)
        for part in self._layout.checksums:
            found = content[slice(*places[self._layout.holders[part.name]])]
            problem = wrong_sum(self._sender, part, (content, places, virtual), found)
            if problem is not None:
                return Failure(own, "checksum", problem)
        return None

    def _virtual(self, content: bytes, places: Mapping[str, Place]) -> Mapping[str, bytes]:
        """The bytes of parts that are not sent; the identity stands in front of the payload."""
        if not self._sender.frame.virtual:
            return {}
        numbers = {
            part.name: part.number.decode(content[slice(*places[held.name])])
            for held in self._layout.parts
            for part in written_apart((held,))
            if part in self._layout.sent_identity
        }
        return self._sender.virtual(numbers)

    def _places_of(self, size: int) -> dict[str, Place]:
        return {part.name: (start, end) for part, start, end in self._layout.slices(size)}

    def _may_hold(self, content: bytes, size: int) -> bool:
        """True if no byte of the payload has a bit that it must not have."""
        head_size = self._layout.head_size
        return not self._sender.frame.seven_bit or content[head_size : head_size + size].isascii()

    def _payload_size_of(self, head: bytes) -> int | Failure | None:
        """The payload's size, or the verdict on a length that can't be; None: nothing plain."""
        layout, part = self._layout, self._layout.length
        numbers = self._numbers(head)
        if numbers is None:
            return None
        if part is None:
            group = self._sender.group(self._sender.identity(numbers))
            return None if group is None else group.fixed
        value = numbers[part.name]
        size = layout.counted_payload(part, value)
        if size is not None:
            is_agreed = all(
                numbers[other.name] == layout.counted(other, size) for other in layout.lengths[1:]
            )
            return size if is_agreed and self._fits(size, numbers) else None
        end = next(place.stop for checked, place in self._checked if checked is part)
        return self._of_length(head[:end], f"{part.name} is {value}")

    def _numbers(self, head: bytes) -> dict[str, int] | None:
        """The numbers that tell something; None where not all of the head is there, or right."""
        if len(head) < self._layout.head_size:
            return None
        if any(head[place] != value for value, place in self._literals):
            return None
        try:
            for held, place in self._held:
                held.check(head[place])
            numbers = {part.name: part.number.decode(head[place]) for part, place in self._checked}
            for held, place in self._held:
                for mirror in held.mirrors:
                    mirror.check(head[place], numbers[mirror.of])
        except ByteError:
            return None
        bounded = self._layout.bounded
        is_right = all(part.holds(numbers[part.name]) for part in bounded)
        return numbers if is_right else None

    def _fits(self, size: int, numbers: dict[str, int]) -> bool:
        """True unless the identity shows at once that the size can't be."""
        if not self._asks_identity:
            return True
        group = self._sender.group(self._sender.identity(numbers))
        return group is None or group.holds(size)

    def _of_length(self, content: bytes, problem: str) -> Failure | None:
        """The verdict on a length that can't be, with which a content ends."""
        return Failure(len(content), "length", problem)


class SizeJudge(Judge):
    """Judge of frames whose size is told by their first bytes; a start may occur inside of them."""

    def verdict(self, data: bytes, start: int, end: int, *, is_all: bool) -> Verdict:
        """The verdict on the candidate that starts there."""
        size = self._payload_size(data[start : start + self._layout.head_size])
        if not isinstance(size, int):
            return size
        limit = self._around + size
        content = data[start : start + limit]
        if limit > self._greatest or not self._may_hold(content, size):
            return None
        if len(content) == limit:
            return self._of_whole(content, size, limit)
        problem = "the input ends inside the frame"
        return Failure(len(content), "truncated", problem) if is_all else None


class IdleJudge(Judge):
    """Judge of frames that only a silence ends: what is in front of it is all of a candidate."""

    def verdict(self, data: bytes, start: int, end: int, *, is_all: bool) -> Failure | None:
        """The verdict on the candidate that starts there."""
        content = data[start:]
        size = len(content) - self._around
        if not is_all or size < 0 or len(content) > self._greatest:
            return None
        numbers = self._numbers(content[: self._layout.head_size])
        if numbers is None or not self._may_hold(content, size) or not self._fits(size, numbers):
            return None
        return self._of_whole(content, size, len(content))


class SliceJudge(Judge):
    """Judge of what stands between two starts, which can't occur inside of a frame."""

    def __init__(self, sender: SenderSpec[Any, Any]) -> None:
        super().__init__(sender)
        layout = sender.layout
        self._front = len(layout.start) or 1
        self._end = layout.end
        self._stuffing = sender.frame.transparency if layout.stuffed else None
        self._announced: Reason = "size" if layout.length is None else "length"

    def verdict(self, data: bytes, start: int, end: int, *, is_all: bool) -> Verdict:
        """The verdict on the candidate that starts there."""
        return None if end < 0 else self._of_slice(data[start:end])

    def _of_slice(self, wire: bytes) -> Verdict:
        if len(wire) >= self._greatest:
            return None
        behind = wire.find(self._end, self._front) if self._end else -1
        try:
            content = self._content(wire if behind < 0 else wire[:behind])
        except TransparencyError:
            return None
        size = self._payload_size(content[: self._layout.head_size])
        if not isinstance(size, int):
            return size
        limit = self._around + size
        if not self._may_hold(content, size):
            return None
        if self._end:
            return self._of_ended(wire, behind, content, limit, size)
        if len(content) < limit:
            return _truncated(wire)
        if len(content) == limit:
            return self._of_whole(content, size, len(wire))
        own = self._wire_size(content[:limit])
        return self._of_whole(content[:limit], size, own) or own

    def _of_ended(
        self, wire: bytes, behind: int, content: bytes, limit: int, size: int
    ) -> Failure | None:
        """The verdict where an end literal ends the frame, which stands at `behind` if at all."""
        if len(content) > limit:
            problem = f"there are more than {limit} bytes, or no end"
            return self._at(content[: limit + 1], self._announced, problem)
        if behind < 0:
            return _truncated(wire)
        own = behind + len(self._end)
        if len(content) < limit:
            problem = f"the frame ends behind {len(content)} of {limit} bytes"
            return Failure(own, self._announced, problem)
        return self._of_whole(content, size, own)

    def _content(self, wire: bytes) -> bytes:
        if self._stuffing is None:
            return wire
        return wire[: self._front] + self._stuffing.decode(wire[self._front :])

    def _at(self, content: bytes, reason: Reason, problem: str) -> Failure | None:
        """The verdict that falls with the last byte of a content."""
        if self._end and self._may_be_held(content[-1:]):
            return None
        return Failure(self._wire_size(content), reason, problem)

    def _may_be_held(self, byte: bytes) -> bool:
        """True if a candidate may take the byte only when it has seen what follows."""
        is_stuffed = self._stuffing is not None and self._stuffing.encode(byte) != byte
        return byte in self._end or is_stuffed

    def _wire_size(self, content: bytes) -> int:
        if self._stuffing is None:
            return len(content)
        return self._front + len(self._stuffing.encode(content[self._front :]))

    def _of_length(self, content: bytes, problem: str) -> Failure | None:
        return self._at(content, "length", problem)


def _truncated(wire: bytes) -> Failure:
    return Failure(len(wire), "truncated", "another frame starts inside")
