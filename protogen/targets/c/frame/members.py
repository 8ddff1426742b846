"""Members of a decoder's struct: what it remembers between bytes."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from protogen.targets.c.frame.decoder import DecoderView
from protogen.targets.c.frame.stuffing import StuffingKind

_POINTERS = 2
"""The handler and what it is given."""
_SMALL_POINTER = 2
"""Bytes of a pointer on a small target, which aligns nothing."""
_ABOUT = {
    "offset": "Offset of the first byte that is in no event yet.",
    "noise": "Bytes of noise that are in no event yet.",
    "wire": "Bytes of the candidate on the wire.",
    "content": "Bytes of the candidate without stuffing.",
    "payload": "Size of the payload, or the most that there is room for.",
    "limit": "Bytes of content that the frame has, or can have.",
    "count": "Bytes in the buffer.",
    "next": "Place in the buffer of the byte to read next.",
    "failed": "Bytes of the candidate that failed.",
    "extra": "Bytes behind a failed candidate that may belong to a start.",
    "due": "Bytes of content at which the payload is measured again.",
    "open_from": "Bytes on the wire in front of the first that may be a start.",
    "passed": "Bytes on the wire that are part of the candidate's content.",
    "state": "Seeking, taking or failed.",
    "reason": "Why the candidate failed.",
    "flags": "What is known of the candidate.",
    "group": "Number of the identity whose payload is measured.",
    "behind": "Last bytes of the candidate that begin the next one.",
    "match": "Bytes of a delimiter that the input ends with.",
    "shared": "Bytes of the candidate that ended the frame before.",
    "held": "Bytes of a delimiter that are held back.",
    "end_left": "Bytes of the end that are due.",
    "region": "In front of the stuffed region, inside, or behind.",
    "node": "Place inside a sequence of the stuffing; 0 outside.",
    "code": "First half of a byte, or the code of a group.",
    "sequence": "Bytes that may be a sequence of the stuffing.",
    "buffer": "Bytes of the candidate.",
    "unstuffed": "Content of the candidate.",
    "ends": "Where each byte of content ends on the wire.",
}
_SIZES = {"uint8_t": 1, "uint16_t": 2, "uint32_t": 4}


class Member(msgspec.Struct, frozen=True):
    """A member of the struct."""

    type: str
    name: str
    count: int | None = None
    """Elements of an array."""

    @property
    def declaration(self) -> str:
        """The member in C."""
        return f"{self.type} {self.name}" + ("" if self.count is None else f"[{self.count}]")

    @property
    def about(self) -> str:
        """Description of what it holds."""
        return _ABOUT[self.name]

    @property
    def size(self) -> int:
        """Bytes of memory."""
        return _SIZES[self.type] * (1 if self.count is None else self.count)


def members_of(view: DecoderView) -> tuple[Member, ...]:
    """The members, behind the handler and its `user` where there is one; the buffers last."""
    return (*_counters(view), *_states(view), *_buffers(view))


def memory_of(view: DecoderView) -> int:
    """Bytes that the decoder takes on an 8-bit controller."""
    pointers = 0 if view.flat else _POINTERS
    return pointers * _SMALL_POINTER + sum(member.size for member in members_of(view))


def _counters(view: DecoderView) -> Iterator[Member]:
    type_, push = view.counter, view.push
    if view.flat:
        yield Member(type_, "content")
        if view.only_size is None:
            yield Member(type_, "limit")
        return
    if view.all_events:
        yield Member("uint32_t", "offset")
    named = {
        "noise": view.all_events,
        "wire": push.counts_wire,
        "content": True,
        "payload": True,
        "limit": not view.simple,
        "count": view.keeps_wire,
        "next": view.keeps_wire,
        "failed": view.keeps_wire or push.decides_later,
        "extra": push.decides_later,
        "due": view.plan.measures,
        "open_from": view.ends_at_start,
        "passed": push.wire_ends,
    }
    yield from (Member(type_, name) for name, is_there in named.items() if is_there)


def _states(view: DecoderView) -> Iterator[Member]:
    stuffing, push = view.stuffing, view.push
    kind = None if stuffing is None else stuffing.kind
    is_push = view.flat is None
    named = {
        "state": is_push,
        "reason": view.all_events and (view.keeps_wire or push.decides_later),
        "flags": is_push and push.has_flags,
        "group": view.plan.measures,
        "behind": is_push and push.keeps_behind,
        "match": is_push and push.keeps_match,
        "shared": view.plan.shares_delimiter,
        "held": is_push and push.searches and push.holds_delimiter,
        "end_left": push.awaits_end,
        "region": push.crosses_region,
        "node": stuffing is not None,
        "code": kind in (StuffingKind.BASE16, StuffingKind.COBS),
    }
    yield from (Member("uint8_t", name) for name, is_there in named.items() if is_there)
    if stuffing is not None and kind is StuffingKind.LENIENT_CODES:
        yield Member("uint8_t", "sequence", stuffing.longest)


def _buffers(view: DecoderView) -> Iterator[Member]:
    yield Member("uint8_t", "buffer", view.buffer_size)
    if view.keeps_both:
        yield Member("uint8_t", "unstuffed", view.plan.greatest)
    if view.push.wire_ends:
        yield Member(view.counter, "ends", view.plan.greatest)
