"""Capacity of a frame: how long its payload can be."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import product

from protogen.model.frame import Frame
from protogen.model.parts import ChoicePart, LengthPart, LiteralPart, Part, PayloadPart
from protogen.model.sizes import SizeSet
from protogen.passes.proofs.wire_code import EVERY_BYTE, code_of, part_bytes

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


def wire_limit(frame: Frame) -> int | None:
    """Wire bytes that no frame exceeds by what bounds it, or by a length over the wire."""
    length = frame.length
    if length is None or not length.over_wire:
        return frame.limit
    others = sum(part.size for part in frame.parts if part.name not in length.counts)
    stated = length.greatest + others
    return stated if frame.limit is None else min(stated, frame.limit)


def payload_range(frame: Frame) -> SizeSet | None:
    """The payload sizes that a length part or a greatest size of frames leaves; None for any.

    A frame that can carry none at all is reported when it is built.
    """
    stated = stated_range(frame)
    if frame.limit is None or (stated is None and frame.length is not None):
        return stated
    room = payload_room(frame, frame.limit)
    if room is None or stated is None:
        return None if room is None else SizeSet.between(0, room)
    return stated.within(0, room)


def payload_room(frame: Frame, size: int) -> int | None:
    """The greatest payload of which some frame has at most `size` bytes; None: there is none."""
    left = size - least_around(frame, empty=False)
    payload = left // max(_least_wire(frame, frame.payload), 1)
    if payload > 0:
        return payload
    return 0 if size >= least_around(frame, empty=True) else None


def least_size(frame: Frame) -> int:
    """Wire bytes of the shortest frame that its length part can state."""
    stated = stated_range(frame)
    payload = 0 if stated is None else stated.least
    return least_around(frame, empty=not payload) + payload * _least_wire(frame, frame.payload)


def least_around(frame: Frame, *, empty: bool) -> int:
    """Wire bytes around a payload, which is empty or not, where stuffing takes the fewest."""
    is_lenient = frame.transparency is not None and frame.transparency.lenient
    codes = 0 if is_lenient and empty else frame.code_size
    others = (part for part in frame.parts if not isinstance(part, PayloadPart))
    there = (part for part in others if not (empty and part.is_optional))
    return codes + sum(_least_wire(frame, part) for part in there)


def _least_wire(frame: Frame, part: Part) -> int:
    """Wire bytes of a part, or of one byte of the payload, where stuffing takes the fewest."""
    code = code_of(frame.encoding) if part.name in frame.stuffed else None
    if code is None:
        return 1 if isinstance(part, PayloadPart) else part.size
    return sum(min(len(code[byte]) for byte in values) for values in part_bytes(part, EVERY_BYTE))


def stated_range(frame: Frame) -> SizeSet | None:
    """The payload sizes that each length can state; None where there is no length, or no size."""
    found = [range_of(frame, length) for length in frame.lengths]
    sizes = [item for item in found if item is not None]
    if not sizes or len(sizes) < len(found):
        return None
    least, greatest = max(it.least for it in sizes), min(it.greatest for it in sizes)
    return SizeSet.between(least, greatest) if least <= greatest else None


def range_of(frame: Frame, length: LengthPart) -> SizeSet | None:
    """The payload sizes that a length can state; None if there are none."""
    around = counted_size(frame, length, empty=False)
    least, greatest = max(length.least - around, 1), length.greatest - around
    if length.least <= counted_size(frame, length, empty=True) <= length.greatest:
        return SizeSet.between(0, max(greatest, 0))
    return SizeSet.between(least, greatest) if least <= greatest else None


def tail_literals(frame: Frame) -> tuple[LiteralPart, ...]:
    """The literals that close the frame, outside the transparency."""
    stuffed = frame.transparency.last if frame.transparency else None
    return tuple(_literals(reversed(frame.parts), stuffed))[::-1]


def head_literals(frame: Frame) -> tuple[LiteralPart, ...] | tuple[ChoicePart]:
    """The literals that open the frame, outside the transparency: many, or a choice of them."""
    stuffed = frame.transparency.first if frame.transparency else None
    first = frame.parts[0]
    if isinstance(first, ChoicePart) and first.name != stuffed:
        return (first,)
    return tuple(_literals(frame.parts, stuffed))


def _literals(parts: Iterable[Part], stuffed: str | None) -> Iterator[LiteralPart]:
    """Yield the literals that come first, up to a stuffed part."""
    for part in parts:
        if not isinstance(part, LiteralPart) or part.name == stuffed:
            return
        yield part


def joined_words(parts: Iterable[LiteralPart | ChoicePart]) -> tuple[bytes, ...]:
    """Byte strings that literals can be together, in order."""
    choices = (part.words if isinstance(part, ChoicePart) else (part.bytes,) for part in parts)
    return tuple(sorted(map(b"".join, product(*choices))))


def is_delimited(frame: Frame) -> bool:
    """True if the frame itself tells where the payload ends, or is refused as it should."""
    told = frame.length or frame.silence or tail_literals(frame)
    return bool(told or unclear_behind_stuffing(frame))


def unclear_behind_stuffing(frame: Frame) -> tuple[Part, ...]:
    """The unstuffed parts behind stuffed ones that begin where nothing tells: they are refused."""
    if frame.transparency is None or frame.length is not None:
        return ()
    names = [part.name for part in frame.parts]
    ends = tail_literals(frame)
    behind = frame.parts[names.index(frame.transparency.last) + 1 :]
    return tuple(part for part in behind if part not in ends)
