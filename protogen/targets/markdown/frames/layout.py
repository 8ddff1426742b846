"""Places of parts in a frame, and of payload bytes in the frame around them.

Positions are bytes as a logic analyser counts them, from 0, wherever the wire allows it: with
Base16 each byte of the payload takes two, and the code byte of COBS is a part. Where stuffing can
insert bytes, positions are those of the unstuffed frame.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import accumulate

import msgspec

from protogen.copying import replace
from protogen.model.frame import Frame
from protogen.model.parts import LengthPart, Part, PayloadPart, UnsentPart, varying_bits
from protogen.model.sizes import SizeSet
from protogen.model.transparency import FULL_GROUP, Base16, Cobs
from protogen.model.types import Field
from protogen.targets.markdown.text.words import code, size_text, span

INDICES = "ijkl"
"""Names of the indices of nested arrays, outermost first."""

_NOTHING = SizeSet.exactly(0)


class CodePart(Part, frozen=True, kw_only=True):
    """A part that an encoding puts in front of its region. It is in no schema."""

    size: int
    name: str = "COBS code"


def part_title(part: Part) -> str:
    """Print the name of a part as tables show it."""
    return part.name if isinstance(part, CodePart) else code(part.name)


class Place(msgspec.Struct, frozen=True):
    """An offset in a payload. Where `base` is a text, what it counts from varies in place."""

    offset: int = 0
    base: str = ""
    strides: tuple[int, ...] = ()
    """Bytes from one element to the next, for each array around it."""

    def plus(self, size: int) -> Place:
        """Return the place so many bytes further on."""
        return Place(self.offset + size, self.base, self.strides)

    def text(self, size: int | None, start: int = 0, scale: int = 1) -> str:
        """Print which bytes these are, with the payload from `start` on, scaled."""
        if size == 0:
            return ""
        if size is None:
            return f"from {self._bytes(1, start, scale)}"
        return self._bytes(size * scale, start, scale)

    def _bytes(self, size: int, start: int, scale: int) -> str:
        strides = self._strides(scale) if self.strides else ""
        if not self.base:
            return span(start + self.offset * scale, size) + strides
        return self.base + (f" + {span(self.offset, size)}" if self.offset else "") + strides

    def _strides(self, scale: int) -> str:
        pairs = zip(self.strides, INDICES, strict=False)
        scaled = ((step * scale, index) for step, index in pairs)
        return "".join(f" + {'' if step == 1 else step}{index}" for step, index in scaled)


def behind(name: str) -> Place:
    """Return the place behind a field of varying size."""
    return Place(base=f"end of {code(name)}")


def element(place: Place, stride: int | None, name: str) -> Place:
    """Return where element `i` of an array at `place` starts; `stride` is None if sizes vary."""
    if stride is None or len(place.strides) == len(INDICES):
        return Place(base=f"start of {code(name)}")
    return replace(place, strides=(*place.strides, stride))


class Slot(msgspec.Struct, frozen=True, kw_only=True):
    """Place of a part in frames whose payload has certain sizes."""

    part: Part
    sizes: SizeSet
    """Unstuffed bytes."""
    scale: int
    """Bytes on the wire for each of them."""
    start: int | None
    """Bytes in front of it; None where that varies."""
    rest: int | None
    """Bytes from its start to the frame's end; None where that varies."""

    @property
    def size(self) -> str:
        """Number of these bytes, as tables show it."""
        return "" if isinstance(self.part, UnsentPart) else size_text(self.sizes)

    @property
    def rows(self) -> Iterator[tuple[str, str, Part]]:
        """Place, size and part, then those of the parts that are bits of it."""
        yield self.place, self.size, self.part
        for part in varying_bits(self.part):
            if part.name == self.part.name:
                continue  # All bits of a part that follows from another, which is there already.
            yield ", ".join(filter(None, (self.place, part.type.label))), "", part

    def field_places(self, fields: Sequence[Field]) -> Iterator[tuple[Field, int, int]]:
        """Each of a payload's fields that has bytes, with the first of them and their number."""
        start = self.start or 0
        for field in fields:
            size = (field.size or 0) * self.scale
            if size:
                yield field, start, size
            start += size

    @property
    def place(self) -> str:
        """Place of these bytes in the frame."""
        if isinstance(self.part, UnsentPart):
            return "not sent"
        if self.start is not None:
            return self._from_start(self.start)
        return "" if self.rest is None else self._from_end(self.rest)

    def _from_start(self, start: int) -> str:
        fixed = self.sizes.fixed
        return f"from {start}" if fixed is None else span(start, fixed * self.scale)

    def _from_end(self, rest: int) -> str:
        size = (self.sizes.fixed or rest) * self.scale
        first, last = _from_last(rest - 1), _from_last(rest - size)
        return first if first == last else f"{first} to {last}"


def _from_last(distance: int) -> str:
    return "last" if distance == 0 else f"last - {distance}"


@lru_cache(maxsize=1024)
def slots(frame: Frame, payload: SizeSet) -> tuple[Slot, ...]:
    """Return where each part lies in frames with such a payload; absent parts are left out.

    Those that are not sent have their places among the others, and no bytes.
    """
    sized = [(part, part_sizes(part, payload)) for part in _parts_on_wire(frame)]
    present = [
        (part, sizes)
        for part, sizes in sized
        if sizes.greatest > 0 or isinstance(part, PayloadPart | UnsentPart)
    ]
    shown = [sizes.times(SizeSet.exactly(wire_scale(frame, part))) for part, sizes in present]
    starts = accumulate(shown, initial=_NOTHING)
    rests = reversed([*accumulate(reversed(shown))])
    return tuple(
        Slot(
            part=part,
            sizes=sizes,
            scale=wire_scale(frame, part),
            start=start.fixed,
            rest=rest.fixed,
        )
        for (part, sizes), start, rest in zip(present, starts, rests, strict=False)
    )


def _parts_on_wire(frame: Frame) -> tuple[Part, ...]:
    """Return the parts of a frame, and what its encoding adds."""
    size, parts = frame.code_size, frame.declared
    if frame.transparency is None or not size:
        return parts
    first = [part.name for part in parts].index(frame.transparency.first)
    return (*parts[:first], CodePart(size=size), *parts[first:])


def part_sizes(part: Part, payload: SizeSet) -> SizeSet:
    """Return the unstuffed bytes of a part in frames whose payload has such sizes."""
    if isinstance(part, PayloadPart):
        return payload
    sizes = SizeSet.exactly(part.size)
    if not part.is_optional or payload.least > 0:
        return sizes
    return _NOTHING if payload.greatest == 0 else sizes | _NOTHING


@lru_cache(maxsize=1024)
def length_values(frame: Frame, part: LengthPart, payload: SizeSet) -> SizeSet:
    """Return what the length part can hold in front of such a payload."""
    counted = (part_sizes(frame.part(name), payload) for name in part.counts)
    found = sum(counted, start=_NOTHING)
    if not part.over_wire:
        return found
    return SizeSet.between(found.least, max(found.greatest, part.greatest))


def wire_scale(frame: Frame, part: Part) -> int:
    """Return how many bytes on the wire stand for each byte of a part, stuffing aside."""
    return 2 if isinstance(frame.encoding, Base16) and part.name in frame.stuffed else 1


def is_stuffed(frame: Frame) -> bool:
    """True if bytes on the wire can lie further on than positions say, by any number."""
    return not isinstance(frame.encoding, Base16 | Cobs | None)


def has_further_codes(frame: Frame, payload: SizeSet) -> bool:
    """True if a region can be so long that COBS puts a second code byte into it."""
    stuffed = (part_sizes(frame.part(name), payload) for name in frame.stuffed)
    region = sum(stuffed, start=_NOTHING)
    return bool(frame.code_size) and region.greatest > FULL_GROUP
