"""Places of parts in a frame."""

from __future__ import annotations

from enum import Enum, auto

import msgspec

from protogen.model.parts import Part


class Side(Enum):
    """Side of the payload that a place is counted on."""

    HEAD = auto()
    TAIL = auto()


class Place(msgspec.Struct, frozen=True):
    """A place in the content."""

    side: Side
    offset: int
    """Bytes from the first byte of the content, or from the first one behind the payload."""
    absent: int = 0
    """Number of these bytes that are absent where the payload is empty."""

    @property
    def is_tail(self) -> bool:
        """True if it is counted from the first byte behind the payload."""
        return self.side is Side.TAIL

    def at(self, head_size: int, payload: int) -> int:
        """Index in the content of a frame with such a payload."""
        if self.side is Side.HEAD:
            return self.offset
        return head_size + payload + self.offset - (0 if payload else self.absent)

    def skipping(self, start: int) -> Place:
        """The same place in content whose first bytes, so many, are not counted."""
        return self if self.is_tail else Place(self.side, self.offset - start, self.absent)


class PlacedPart(msgspec.Struct, frozen=True):
    """A part of a fixed size, and where it lies in the content."""

    part: Part
    place: Place
    is_stuffed: bool

    @property
    def name(self) -> str:
        """Name of the part."""
        return self.part.name

    @property
    def size(self) -> int:
        """Bytes of content."""
        return self.part.size

    @property
    def offset(self) -> int:
        """Bytes from the head's or the tail's first byte."""
        return self.place.offset

    @property
    def end(self) -> int:
        """Offset of the first byte behind the part."""
        return self.place.offset + self.size

    @property
    def end_place(self) -> Place:
        """Place of the first byte behind the part."""
        absent = self.place.absent + (self.size if self.is_optional else 0)
        return Place(self.place.side, self.end, absent)

    @property
    def in_head(self) -> bool:
        """True if the part stands in front of the payload."""
        return self.place.side is Side.HEAD

    @property
    def is_optional(self) -> bool:
        """True if the part is absent where the payload is empty."""
        return self.part.is_optional

    def skipping(self, start: int) -> PlacedPart:
        """The same part in content whose first bytes, so many, are not counted."""
        return PlacedPart(self.part, self.place.skipping(start), self.is_stuffed)


class Run(msgspec.Struct, frozen=True):
    """A run of content, from `first` to in front of `end`."""

    first: Place
    end: Place
    over_stuffing: bool = False
    """True if it is stuffed on the wire, and summed as it is there."""

    def skipping(self, start: int) -> Run:
        """The same run in content whose first bytes, so many, are not counted."""
        return Run(self.first.skipping(start), self.end.skipping(start), self.over_stuffing)
