"""Exactly one frame, as bytes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from protogen.runtime.errors import DecodeError, PayloadFault
from protogen.runtime.events import FrameEvent, frame_event
from protogen.runtime.framing.layout import Layout
from protogen.runtime.framing.machine import Candidate, Cut, Failure, verdict_on
from protogen.runtime.framing.sender import MessageT_co, PartsT_co, SenderSpec


def read_frame(
    senders: Sequence[SenderSpec[MessageT_co, PartsT_co]], data: bytes, told: Mapping[str, int]
) -> FrameEvent[MessageT_co, PartsT_co]:
    """The event of the frame that `data` is, in the first form that it has.

    `told` has the values of identity parts that are not sent; the others have their defaults.

    Raises DecodeError, at the byte that proves it; of several forms that of which most is there.
    """
    found: DecodeError | None = None
    for sender in senders:
        try:
            return _read_as(sender, data, told)
        except DecodeError as error:
            if found is None or error.offset > found.offset:
                found = error
    assert found is not None
    raise found


def _read_as(
    sender: SenderSpec[MessageT_co, PartsT_co], data: bytes, told: Mapping[str, int]
) -> FrameEvent[MessageT_co, PartsT_co]:
    if not may_start(sender.layout, data):
        raise DecodeError("noise", "no frame starts so")
    told = {**sender.layout.told_of(data), **told}
    cut = _cut(sender, data, told)
    try:
        message = sender.read(cut.numbers, cut.payload)
    except PayloadFault as error:
        offset = _wire_offset(sender, data, told, min(error.offset, len(cut.payload)))
        raise DecodeError(error.reason, error.problem, offset=offset, path=error.path) from None
    return frame_event(sender, cut, message, data, 0)


def may_start(layout: Layout, data: bytes) -> bool:
    """True if the first bytes of a frame can be these."""
    return not layout.start_words or data.startswith(layout.start_words)


def _cut(sender: SenderSpec[MessageT_co, PartsT_co], data: bytes, told: Mapping[str, int]) -> Cut:
    """The only frame in `data`."""
    verdict, offset = verdict_on(sender, data, told=told)
    if isinstance(verdict, Failure):
        raise DecodeError(verdict.reason, verdict.problem, offset=offset)
    if verdict.size < len(data):
        problem = f"the frame has only {verdict.size} of these {len(data)} bytes"
        raise DecodeError("size", problem, offset=verdict.size)
    return verdict


def _wire_offset(
    sender: SenderSpec[MessageT_co, PartsT_co], data: bytes, told: Mapping[str, int], offset: int
) -> int:
    """Place of a byte of the payload in the frame, stuffing included."""
    candidate = Candidate(sender, told=told)
    for place, byte in enumerate(data):
        candidate.push(byte)
        if candidate.content_size > sender.layout.head_size + offset:
            return place
    return len(data)
