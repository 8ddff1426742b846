"""Oracle of recovery: which undamaged frames a decoder has to find, and what became of each.

The design promises that every frame that was not itself damaged is found. Exactly:

* Where the start of a frame is protected (it occurs nowhere else in a valid frame), every one.
  Where the same literal ends frames, too, the frame may be found without its start: that was the
  end of valid bytes in front, of a frame that lost its own end.
* Where frames have no start and a protected end, every one at the start of the stream or behind an
  end. In front of any other, damage reaches up to it: nothing tells where it begins.
* Where only a silence ends frames, every one with a silence behind it: here the last one, at the
  end of the stream.
* Where nothing protects the delimiters, or there are none, every one (behind an end, if that is
  where frames begin) that no accepted frame reaches into: one that began in front of it, and whose
  length, checksum and end are right by chance.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from enum import StrEnum
from typing import Any

from corpus import Stream

from protogen.runtime.framing.frame import AfterEnd, FrameSpec, StartLiteral, StartMark


class Fate(StrEnum):
    """Fate of an undamaged frame."""

    FOUND = "found"
    NOT_DUE = "not due"
    """It was not found, and it does not stand behind an end, where alone such frames begin, or no
    silence is behind it, which alone ends it."""
    COVERED = "covered"
    """It was not found, and an accepted frame that began in front of it reaches into it."""
    LOST = "lost"
    """It was not found, without any excuse."""


def fates(spec: FrameSpec, stream: Stream, events: Sequence[Any]) -> list[Fate]:
    """Fate of each undamaged frame of a stream."""
    accepted = {(event.offset, event.raw) for event in events if event.kind != "invalid"}
    return [_fate(spec, stream, accepted, *frame) for frame in stream.frames]


def _fate(
    spec: FrameSpec, stream: Stream, accepted: set[tuple[int, bytes]], offset: int, raw: bytes
) -> Fate:
    shared = len(shared_start(spec))
    if (offset, raw) in accepted or (offset + shared, raw[shared:]) in accepted:
        return Fate.FOUND
    is_behind = stream.data[offset + len(raw) :]
    if not is_due(spec, stream.data[:offset]) or (spec.silence is not None and is_behind):
        return Fate.NOT_DUE
    if any(start < offset < start + len(other) for start, other in accepted):
        return Fate.COVERED
    return Fate.LOST


def is_due(spec: FrameSpec, before: bytes) -> bool:
    """True if a frame can begin behind these bytes, which begin with the stream."""
    if not isinstance(spec.start, AfterEnd):
        return True
    assert spec.end is not None
    return not before or before.endswith(spec.end.value)


def is_protected(spec: FrameSpec) -> bool:
    """True if what a frame begins behind or with occurs nowhere inside of a valid frame."""
    if isinstance(spec.start, StartMark):
        return spec.start.protected
    return isinstance(spec.start, AfterEnd) and spec.end is not None and spec.end.protected


def shared_start(spec: FrameSpec) -> bytes:
    """The start, where it can also be the end of the frame in front."""
    if isinstance(spec.start, StartLiteral) and spec.end is not None:
        is_shared = spec.start.value == spec.end.value and spec.end.protected
        return spec.start.value if is_shared else b""
    return b""


def false_frames(spec: FrameSpec, sent: Container[bytes], events: Iterable[Any]) -> list[Any]:
    """Accepted frames that nobody sent. Damage and noise may make up one of those that were."""
    start = shared_start(spec)
    return [
        event
        for event in events
        if event.kind != "invalid" and event.raw not in sent and start + event.raw not in sent
    ]
