"""Where the parts of a sender's frame lie, as constants that the C code is made of.

*Content* is the bytes of all parts before any stuffing, without the literals that make up the end.
"""

from __future__ import annotations

from dataclasses import dataclass

from protogen.model.frame import (
    ChecksumPart,
    Frame,
    IdentityPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    Part,
    PayloadPart,
)
from protogen.model.framing import StartLiteral
from protogen.model.protocol import Sender


@dataclass(frozen=True, slots=True)
class Placed:
    """A part of a fixed size, and its offset from the head's or the tail's first byte."""

    part: Part
    offset: int

    @property
    def size(self) -> int:
        """Bytes of content."""
        return size_of(self.part)

    @property
    def end(self) -> int:
        """The offset behind it."""
        return self.offset + self.size

    @property
    def is_optional(self) -> bool:
        """Whether it is absent where the payload is empty."""
        return isinstance(self.part, ChecksumPart) and self.part.when_payload


def size_of(part: Part) -> int:
    """Bytes of a part other than the payload."""
    match part:
        case LiteralPart():
            return len(part.bytes)
        case NumberPart() | ChecksumPart():
            return part.type.size
    return 0


@dataclass(frozen=True, slots=True)
class Geometry:
    """The offsets of a frame."""

    sender: Sender
    head: tuple[Placed, ...]
    """The parts in front of the payload."""
    tail: tuple[Placed, ...]
    """Those behind it, without the end; offsets as where the payload is not empty."""
    start: bytes
    """The start literal; empty where something else marks the start."""
    end: bytes
    """The end literal; empty where there is none."""

    @property
    def frame(self) -> Frame:
        """The sender's frame."""
        return self.sender.frame

    @property
    def head_size(self) -> int:
        """Bytes in front of the payload."""
        return sum(item.size for item in self.head)

    @property
    def tail_size(self) -> int:
        """Bytes behind a payload that is not empty."""
        return sum(item.size for item in self.tail)

    @property
    def optional_size(self) -> int:
        """Bytes of the parts that are absent where the payload is empty."""
        return sum(item.size for item in self.tail if item.is_optional)

    @property
    def length(self) -> LengthPart | None:
        """The length part, which stands in the head."""
        return next((p.part for p in self.head if isinstance(p.part, LengthPart)), None)

    @property
    def early_identity(self) -> bool:
        """Whether there is an identity, and all of it in front of the payload."""
        parts = self.frame.identity
        return bool(parts) and any(item.part is parts[-1] for item in self.head)

    @property
    def shares_delimiter(self) -> bool:
        """Whether the end of a frame may also be the start of the next."""
        return bool(self.start) and self.start == self.end

    @property
    def stuffed(self) -> tuple[str, ...]:
        """The names of the parts in the region under transparency."""
        transparency = self.frame.transparency
        if transparency is None:
            return ()
        names = [part.name for part in self.frame.parts]
        return tuple(names[names.index(transparency.first) : names.index(transparency.last) + 1])

    def placed(self, name: str) -> Placed | None:
        """The part of that name; None for the payload and for literals of the end."""
        return next((item for item in (*self.head, *self.tail) if item.part.name == name), None)

    def is_head(self, item: Placed) -> bool:
        """Whether the part stands in front of the payload."""
        return item in self.head

    def identities(self) -> tuple[IdentityPart, ...]:
        """The identity parts in wire order."""
        return self.frame.identity


def geometry_of(sender: Sender) -> Geometry:
    """Lay out a sender's frame."""
    end = sender.framing.end
    parts = _without_end(sender.frame, b"" if end is None else end.bytes)
    index = next(i for i, part in enumerate(parts) if isinstance(part, PayloadPart))
    start = sender.framing.start
    return Geometry(
        sender=sender,
        head=_placed(parts[:index]),
        tail=_placed(parts[index + 1 :]),
        start=start.bytes if isinstance(start, StartLiteral) else b"",
        end=b"" if end is None else end.bytes,
    )


def _without_end(frame: Frame, end: bytes) -> list[Part]:
    parts = list(frame.parts)
    left = len(end)
    while left > 0 and isinstance(parts[-1], LiteralPart):
        left -= len(parts[-1].bytes)
        parts.pop()
    return parts


def _placed(parts: list[Part]) -> tuple[Placed, ...]:
    found = []
    offset = 0
    for part in parts:
        found.append(Placed(part, offset))
        offset += size_of(part)
    return tuple(found)
