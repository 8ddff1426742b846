"""Members of a decoder's struct: what it remembers between bytes."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from protogen.targets.c.decoders.candidate import Candidate
from protogen.targets.c.decoders.decoder import DecoderView
from protogen.targets.c.decoders.delimited import DelimitedDecoder
from protogen.targets.c.decoders.kept import KeptDecoder
from protogen.targets.c.frame.stuffing import StuffingKind

POINTERS = 2
"""The handler and what it is given."""
SMALL_POINTER = 2
"""Bytes of a pointer on a small target, which aligns nothing."""
ENDING = "1: nothing comes behind the bytes that are kept, and a silence, or the end."
FOUND = "Seeking, taking, failed or lost; or a message is complete."
_DIGITS = "Digits of the candidate, with two for each byte of a start."
_SIZES = {"uint8_t": 1, "uint16_t": 2, "uint32_t": 4, "uint64_t": 8}


class Member(msgspec.Struct, frozen=True):
    """A member of the struct."""

    type: str
    name: str
    about: str
    """Description of what it holds."""
    count: int | None = None
    """Elements of an array."""

    @property
    def declaration(self) -> str:
        """The member in C."""
        return f"{self.type} {self.name}" + ("" if self.count is None else f"[{self.count}]")

    @property
    def size(self) -> int:
        """Bytes of memory."""
        return _SIZES.get(self.type, 1) * (1 if self.count is None else self.count)


def message_member(protocol: str) -> Member:
    """The member for a message that is complete. Enums take one byte on a small target."""
    return Member(f"enum {protocol}_message", "message", "The message of a frame.")


def memory_of(view: DecoderView) -> int:
    """Bytes that the decoder takes on an 8-bit controller."""
    pointers = 0 if view.polled else POINTERS
    return pointers * SMALL_POINTER + sum(member.size for member in members_of(view))


def members_of(view: DecoderView | Candidate) -> tuple[Member, ...]:
    """The members, behind the handler and its `user` where there is one; the buffers last."""
    if isinstance(view, DecoderView) and (view.delimited or view.kept):
        return _of_lean(view)
    plan, push, stuffing = view.plan, view.push, view.stuffing
    kind = None if stuffing is None else stuffing.kind
    is_push = view.flat is None
    has_limit = not view.simple if view.flat is None else view.flat.only_size is None
    is_polled = is_push and view.is_polled
    fails = view.keeps_wire or push.decides_later
    holds = is_push and push.searches and push.holds_delimiter
    begins_next = is_push and push.keeps_behind
    has_node = stuffing is not None if view.flat is None else view.flat.has_node
    has_code = is_push and kind in (StuffingKind.BASE16, StuffingKind.COBS)
    is_paired = view.flat is not None and view.flat.counts_digits
    content = _DIGITS if is_paired else "Bytes of the candidate without stuffing."
    if view.flat is not None and view.flat.escape_flag is not None:
        content = "Bytes of the candidate without stuffing; its highest bit: an escape came."
    extra = "Bytes behind a failed candidate that may belong to a start."
    open_from = "Bytes on the wire in front of the first that may be a start."
    counters = (
        (view.all_events, "noise", "Bytes of noise that are in no event yet."),
        (is_push and push.counts_wire, "wire", "Bytes of the candidate on the wire."),
        (True, "content", content),
        (is_push, "payload", "Size of the payload, or the most that there is room for."),
        (has_limit, "limit", "Bytes of content that the frame has, or can have."),
        (view.keeps_wire, "count", "Bytes in the buffer."),
        (view.keeps_wire, "next", "Place in the buffer of the byte to read next."),
        (fails, "failed", "Bytes of the candidate that failed."),
        (push.decides_later, "extra", extra),
        (plan.measures, "due", "Bytes of content at which the payload is measured again."),
        (view.ends_at_start, "open_from", open_from),
        (
            push.counts_passed,
            "passed",
            "Bytes on the wire that are part of the candidate's content.",
        ),
        (view.length_over_wire, "stop", "Those up to the end of the stuffed region; 0: not known."),
        (is_polled and view.fits_payloads, "fitted", "Size of the payload as events show it."),
    )
    states = (
        (is_push, "state", FOUND if is_polled else "Seeking, taking, failed or lost."),
        (view.all_events and fails, "reason", "Why the candidate failed."),
        (is_push and push.has_flags, "flags", "What is known of the candidate."),
        (plan.measures, "group", "Number of the identity whose payload is measured."),
        (begins_next, "behind", "Last bytes of the candidate that begin the next one."),
        (is_push and push.keeps_match, "match", "Bytes of a delimiter that the input ends with."),
        (plan.shares_delimiter, "shared", "Bytes of the candidate that ended the frame before."),
        (holds, "held", "Bytes of a delimiter that are held back."),
        (push.awaits_end, "end_left", "Bytes of the end that are due."),
        (push.crosses_region, "region", "In front of the stuffed region, inside, or behind."),
        (has_node, "node", "Place inside a sequence of the stuffing; 0 outside."),
        (has_code, "code", "First half of a byte, or the code of a group."),
        (is_polled and view.keeps_wire, "ending", ENDING),
    )
    found = [
        *(Member(view.counter, name, about) for is_there, name, about in counters if is_there),
        *(Member("uint8_t", name, about) for is_there, name, about in states if is_there),
    ]
    if is_polled and isinstance(view, DecoderView):
        found.append(message_member(view.protocol))
    found += _told(view)
    if view.all_events:
        offset = "Offset of the first byte that is in no event yet."
        found.insert(0, Member("uint32_t", "offset", offset))
    if stuffing is not None and kind is StuffingKind.LENIENT_CODES:
        about = "Bytes that may be a sequence of the stuffing."
        found.append(Member("uint8_t", "sequence", about, stuffing.longest))
    buffer_size = (view.flat or view).buffer_size
    found.append(Member("uint8_t", "buffer", "Bytes of the candidate.", buffer_size))
    if view.keeps_both:
        found.append(Member("uint8_t", "unstuffed", "Content of the candidate.", plan.greatest))
    if is_polled and view.filled_size:
        about = "The payload that was filled up with zeros."
        found.append(Member("uint8_t", "filled", about, view.filled_size))
    if push.wire_ends:
        about = "Where each byte of content ends on the wire."
        found.append(Member(view.counter, "ends", about, plan.greatest))
    return tuple(found)


def _told(view: DecoderView | Candidate) -> Iterator[Member]:
    """The members for parts that are not sent."""
    for part in view.told_parts:
        yield Member(part.type, part.kept, f"What was told of {part.name}.")
        yield Member(part.type, part.own, "The same of the candidate.")
        if part.once:
            yield Member("uint8_t", part.is_new, "1: it was told since that began.")
    if view.told_length is not None:
        about = "Why no frame has the length that was told, if none has."
        yield Member("uint8_t", "refused", about)


def _of_lean(view: DecoderView) -> tuple[Member, ...]:
    """The members of a decoder with little more than a buffer."""
    if view.kept is not None:
        return _of_kept(view.kept)
    assert view.delimited is not None
    return _of_delimited(view.delimited)


def _of_delimited(view: DelimitedDecoder) -> tuple[Member, ...]:
    """The members of a decoder that judges frames at their end."""
    content = _DIGITS if view.counts_digits else "Bytes in the buffer."
    node = "Place inside a sequence of the stuffing; 0 outside."
    if view.is_cobs:
        node = "Bytes up to the code of the next group."
    found = (
        (True, Member(view.counter, "content", content)),
        (
            view.size_is_kept,
            Member(view.counter, "payload", "Size of the payload of a complete frame."),
        ),
        (view.has_node, Member("uint8_t", "node", node)),
        (view.holds_end, Member("uint8_t", "held", "1: the first byte of an end was the last.")),
        (view.groups_fill, Member("uint8_t", "code", "Code of the group.")),
        (True, Member("uint8_t", "buffer", "Bytes of the candidate.", view.buffer_size)),
    )
    return tuple(member for is_there, member in found if is_there)


def _of_kept(view: KeptDecoder) -> tuple[Member, ...]:
    """The members of a decoder that looks through what it keeps."""
    if view.has_window:
        passed = "A bit for each of the last bytes: 0 where an end is complete with it."
        content = "Bytes in the buffer, but for the last one."
        return (
            Member("uint8_t", "passed", passed)
            if view.begins_behind_end
            else Member(view.counter, "content", content),
            Member("uint8_t", "buffer", "The last bytes.", view.buffer_size),
        )
    buffer = Member("uint8_t", "buffer", "Bytes of the candidate, and behind it.", view.buffer_size)
    if not view.gives_more:
        return Member(view.counter, "content", "Bytes in the buffer."), buffer
    payload = Member(view.counter, "payload", "Size of the payload of a complete frame.")
    due = "Bytes of a message, or of a candidate when it is looked at again."
    return (
        Member(view.counter, "content", "Bytes in the buffer."),
        Member(view.counter, "due", due),
        *((payload,) if view.size_is_kept else ()),
        Member("uint8_t", "ending", "1: no more bytes follow those in the buffer."),
        buffer,
    )


def candidate_members(view: Candidate) -> tuple[Member, ...]:
    """The members of a candidate of one of several forms, behind the pointer to its bytes."""
    verdict = "Why it is no frame, if it is none; 0: not known yet."
    return (
        *(member for member in members_of(view) if view.keeps(member.name)),
        Member("uint8_t", "verdict", verdict),
        message_member(view.protocol),
    )
