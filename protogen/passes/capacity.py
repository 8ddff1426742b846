"""How long can a payload be in a frame?"""

from __future__ import annotations

from protogen.model.frame import ChecksumPart, Frame, LiteralPart, NumberPart, Part
from protogen.model.sizes import SizeSet

GREATEST_FRAME = 1 << 20
"""No frame may be longer than 1 MiB: a receiver has to hold it."""


def part_size(part: Part) -> int:
    """Unstuffed bytes of a part; 0 for the payload."""
    match part:
        case LiteralPart():
            return len(part.bytes)
        case NumberPart() | ChecksumPart():
            return part.type.size
    return 0


def counted_size(frame: Frame) -> int:
    """Bytes that the length part counts besides the payload."""
    length = frame.length
    return 0 if length is None else sum(part_size(frame.part(name)) for name in length.counts)


def payload_range(frame: Frame) -> SizeSet | None:
    """The payload sizes that the length part can state; None where there is no length part."""
    length = frame.length
    if length is None:
        return None
    fixed = counted_size(frame)
    greatest = max(length.greatest - fixed, 0)
    return SizeSet.between(min(max(length.least - fixed, 0), greatest), greatest)


def tail_literals(frame: Frame) -> tuple[LiteralPart, ...]:
    """The literals that close the frame, outside the transparency."""
    found: list[LiteralPart] = []
    for part in reversed(frame.parts):
        if not isinstance(part, LiteralPart) or _is_last_covered(frame, part):
            break
        found.insert(0, part)
    return tuple(found)


def head_literals(frame: Frame) -> tuple[LiteralPart, ...]:
    """The literals that open the frame, outside the transparency."""
    found: list[LiteralPart] = []
    for part in frame.parts:
        if not isinstance(part, LiteralPart) or _is_first_covered(frame, part):
            break
        found.append(part)
    return tuple(found)


def _is_last_covered(frame: Frame, part: Part) -> bool:
    return frame.transparency is not None and frame.transparency.last == part.name


def _is_first_covered(frame: Frame, part: Part) -> bool:
    return frame.transparency is not None and frame.transparency.first == part.name


def is_delimited(frame: Frame) -> bool:
    """Whether the frame itself tells where the payload ends."""
    return frame.length is not None or bool(tail_literals(frame))
