"""Capacity of a frame: how long its payload can be."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from protogen.model.frame import Frame, LengthPart, LiteralPart, Part
from protogen.model.sizes import SizeSet

GREATEST_FRAME = 1 << 20
"""No frame may be longer than 1 MiB: a receiver has to hold it."""

_MANY = 10**18


def amount(number: int) -> str:
    """A number of bytes for people; counts that multiply can make it longer than any text."""
    return str(number) if number < _MANY else "more than 10^18"


def counted_size(frame: Frame, length: LengthPart, *, empty: bool) -> int:
    """Bytes that the length part counts besides the payload, which is empty or not."""
    counted = (frame.part(name) for name in length.counts)
    return sum(part.size for part in counted if not (empty and part.is_optional))


def payload_range(frame: Frame) -> SizeSet | None:
    """The payload sizes that the length part can state; None where it is missing or states none.

    A frame whose length part can state none at all is reported when it is built.
    """
    length = frame.length
    if length is None:
        return None
    around = counted_size(frame, length, empty=False)
    least, greatest = max(length.least - around, 1), length.greatest - around
    if length.least <= counted_size(frame, length, empty=True) <= length.greatest:
        return SizeSet.between(0, max(greatest, 0))
    return SizeSet.between(least, greatest) if least <= greatest else None


def tail_literals(frame: Frame) -> tuple[LiteralPart, ...]:
    """The literals that close the frame, outside the transparency."""
    stuffed = frame.transparency.last if frame.transparency else None
    return tuple(_literals(reversed(frame.parts), stuffed))[::-1]


def head_literals(frame: Frame) -> tuple[LiteralPart, ...]:
    """The literals that open the frame, outside the transparency."""
    stuffed = frame.transparency.first if frame.transparency else None
    return tuple(_literals(frame.parts, stuffed))


def _literals(parts: Iterable[Part], stuffed: str | None) -> Iterator[LiteralPart]:
    """Yield the literals that come first, up to a stuffed part."""
    for part in parts:
        if not isinstance(part, LiteralPart) or part.name == stuffed:
            return
        yield part


def is_delimited(frame: Frame) -> bool:
    """True if the frame itself tells where the payload ends."""
    return frame.length is not None or bool(tail_literals(frame))
