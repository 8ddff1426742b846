"""Streams of frames with damage between them, and what a decoder owes to the undamaged ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from protogen.model.framing import AfterEnd, Framing, StartLiteral, StartSet


@dataclass(frozen=True, slots=True)
class Stream:
    """Bytes, and where in them undamaged frames stand."""

    data: bytes
    frames: tuple[tuple[int, bytes], ...]


@st.composite
def streams(draw: st.DrawFn, frames: Sequence[bytes]) -> Stream:
    """The frames in order, with noise, cut and wrong frames before, between and behind them."""
    data = b""
    whole: list[tuple[int, bytes]] = []
    for frame in frames:
        if draw(st.booleans()):
            data += draw(_damage(frames))
        whole.append((len(data), frame))
        data += frame
    if draw(st.booleans()):
        data += draw(_damage(frames))
    return Stream(data, tuple(whole))


@st.composite
def _damage(draw: st.DrawFn, frames: Sequence[bytes]) -> bytes:
    """Bytes that are no frame, as far as that is up to them."""
    frame = draw(st.sampled_from(frames))
    kind = draw(st.sampled_from(["noise", "cut", "tail", "flipped", "dropped", "inserted"]))
    if kind == "noise":
        return draw(st.binary(min_size=1, max_size=8))
    place = draw(st.integers(0, len(frame) - 1))
    if kind == "cut":
        return frame[:place]
    if kind == "tail":
        return frame[place:]
    if kind == "dropped":
        return frame[:place] + frame[place + 1 :]
    wrong = bytes((draw(st.integers(0, 255)),))
    return frame[:place] + wrong + frame[place + (kind == "flipped") :]


@st.composite
def portions(draw: st.DrawFn, data: bytes) -> list[bytes]:
    """The data cut anywhere."""
    cuts = sorted(draw(st.lists(st.integers(0, len(data)), max_size=6)))
    return [data[low:high] for low, high in zip([0, *cuts], [*cuts, len(data)], strict=True)]


def lost(
    framing: Framing, stream: Stream, events: Sequence[Any], *, is_idle: bool
) -> list[tuple[int, bytes]]:
    """Undamaged frames that a decoder had to find and did not.

    A frame may be hidden by another valid one that begins earlier, in the damage, unless the start
    is protected: then only the first bytes of a start of several bytes can be taken for its end.
    `is_idle`: a silence alone ends frames, so that only the last one can be found.
    """
    valid = [event for event in events if event.kind != "invalid"]
    found = {(event.offset, event.raw) for event in valid}
    shared = _shared(framing)
    return [
        (offset, frame)
        for offset, frame in stream.frames
        if (offset, frame) not in found
        and (not shared or (offset + shared, frame[shared:]) not in found)
        and _is_due(framing, stream.data[:offset])
        and not (is_idle and offset + len(frame) < len(stream.data))
        and not _is_hidden(framing, offset, valid)
    ]


def _shared(framing: Framing) -> int:
    """The size of a start that can also be the end of the frame before; 0: it never is."""
    start, end = framing.start, framing.end
    if isinstance(start, StartLiteral) and end is not None and start.bytes == end.bytes:
        return len(start.bytes)
    return 0


def _is_due(framing: Framing, before: bytes) -> bool:
    """True if a frame may start behind these bytes."""
    if not isinstance(framing.start, AfterEnd):
        return True
    assert framing.end is not None
    return not before or before.endswith(framing.end.bytes)


def _is_hidden(framing: Framing, offset: int, valid: Sequence[Any]) -> bool:
    reach = offset + _hideable(framing)
    return any(event.offset < offset < event.offset + event.size < reach for event in valid)


def _hideable(framing: Framing) -> int:
    """One more than the greatest number of bytes that can be taken for the end of another frame."""
    start = framing.start
    if isinstance(start, StartLiteral) and start.protected:
        return len(start.bytes)
    if isinstance(start, StartSet) and start.protected:
        return len(start.words[0])
    if isinstance(start, AfterEnd) and framing.end is not None and framing.end.protected:
        return 1
    return 1 << 30
