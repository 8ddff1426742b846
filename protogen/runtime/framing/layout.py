"""Offsets of a frame's parts, added up once for each sender."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from typing import Any, NamedTuple

from protogen.runtime.attributes import attribute
from protogen.runtime.framing.frame import (
    AfterEnd,
    ChecksumPart,
    FrameSpec,
    IdentityPart,
    LengthPart,
    LiteralPart,
    Part,
    PayloadPart,
    StartLiteral,
    StartMark,
    ToldPart,
    ValuePart,
    checksums_of,
    mirrors_of,
    written_apart,
)
from protogen.runtime.payload.number import Characters


def is_optional(part: Part) -> bool:
    """True if the part is absent where the payload is empty."""
    return isinstance(part, ChecksumPart) and part.when_payload


Place = tuple[int, int]
"""The first byte of a part, and the one behind it."""


class Slice(NamedTuple):
    """Place of a part in a frame's content: its bytes before stuffing, without the end."""

    part: Part
    start: int
    end: int


class Layout:
    """A frame's parts and where they lie."""

    def __init__(self, spec: FrameSpec) -> None:
        self.spec = spec
        self.parts = _without_end(spec)
        """All parts but the end literals."""
        self.end_literals = {
            part.name: part.value
            for part in spec.parts
            if part not in self.parts and isinstance(part, LiteralPart)
        }
        """The literals that make up the end."""
        self.payload_index = next(
            index for index, part in enumerate(self.parts) if isinstance(part, PayloadPart)
        )
        self.payload = next(part for part in self.parts if isinstance(part, PayloadPart))
        self.head = self.parts[: self.payload_index]
        self.tail = self.parts[self.payload_index + 1 :]
        self.head_size = sum(part.size for part in self.head)
        early = written_apart(self.head)
        self.length = self.lengths[0] if self.lengths else None
        self._counted_around = {
            (part.name, has_payload): _counted_around(spec.parts, part, has_payload)
            for part in self.lengths
            for has_payload in (False, True)
        }
        apart = written_apart(self.parts)
        self.sent_identity = tuple(part for part in apart if isinstance(part, IdentityPart))
        self.told_identity = tuple(part for part in spec.told if part.length is None)
        self.identity: tuple[IdentityPart | ToldPart, ...] = (
            *self.told_identity,
            *self.sent_identity,
        )
        self.values = tuple(part for part in apart if isinstance(part, ValuePart))
        held = early if spec.rescans else ()
        self.bounded = tuple(part for part in self.values if part in held or part.values)
        """The values that a receiver holds to their bounds."""
        self.checksums = tuple(item for part in self.parts for item in checksums_of(part))
        self.has_wire_checksum = any(part.over_wire for part in self.checksums)
        self.start = spec.start.value if isinstance(spec.start, StartLiteral) else b""
        self.start_words = spec.start.words if isinstance(spec.start, StartMark) else ()
        """What a frame starts with; empty where nothing marks the start."""
        self.start_size = len(self.start_words[0]) if self.start_words else 0
        self.mark_size = self.start_size if self.start_size > 1 else len(self.start)
        """Bytes in front of a frame that no end is looked for in."""
        self.end = b"" if spec.end is None else spec.end.value
        is_unique = spec.end is not None and spec.end.protected
        self.shares_delimiter = is_unique and self.start == self.end
        """True if the end of a frame may be the start of the next as well, as with SLIP's flag."""
        own = () if self.shares_delimiter else self.start_words
        self.start_bytes = frozenset(word[-1] for word in own)
        """Bytes that complete a start. None where the same literal ends frames."""
        self.empty_frame = self._empty_frame()
        """A start and an end with nothing between them, which is never a frame."""
        self.empty_size = len(self.empty_frame)
        self.stuffed = tuple(
            index for index, part in enumerate(self.parts) if part.name in spec.stuffed
        )

    @cached_property
    def shown(self) -> tuple[str, ...]:
        """The names of the parts that events show."""
        return tuple(part.name for part in self._shown)

    def numbers_of(self, parts: Any) -> dict[str, int]:
        """The numbers of an event's parts, but for texts."""
        found = {name: getattr(parts, attribute(name)) for name in self.shown}
        return {name: value for name, value in found.items() if isinstance(value, int)}

    @cached_property
    def lengths(self) -> tuple[LengthPart, ...]:
        """The first tells where the frame ends, and the others have to agree with it."""
        apart = written_apart(self.parts)
        sent = (part for part in apart if isinstance(part, LengthPart))
        return (*(part.length for part in self.spec.told if part.length), *sent)

    @cached_property
    def told_length(self) -> LengthPart | None:
        """The length that a receiver is told, if there is one."""
        return self.length if any(part.length for part in self.spec.told) else None

    @cached_property
    def holders(self) -> Mapping[str, str]:
        """The names of the parts that have the bytes of checksums, by the names of these."""
        return {item.name: part.name for part in self.parts for item in checksums_of(part)}

    @cached_property
    def early_identity(self) -> bool:
        """True if there is an identity, and nothing of it behind the payload."""
        early = written_apart(self.head)
        return bool(self.identity) and all(part in early for part in self.sent_identity)

    @cached_property
    def mirrored(self) -> frozenset[str]:
        """The names of the parts from which bits follow."""
        return frozenset(item.of for part in self.parts for item in mirrors_of(part))

    @cached_property
    def ends_idle(self) -> bool:
        """True if a silence ends a frame, and no byte."""
        return self.spec.silence is not None

    @cached_property
    def counts_wire(self) -> bool:
        """True if the length counts stuffed bytes, so that only their end tells the payload's."""
        return self.length is not None and self.length.over_wire

    @cached_property
    def texts(self) -> tuple[tuple[int, Characters], ...]:
        """The parts that events show as texts, by their places among all that they show."""
        return tuple(
            (index, part.number)
            for index, part in enumerate(self._shown)
            if isinstance(part.number, Characters)
        )

    @cached_property
    def _shown(self) -> tuple[ToldPart | IdentityPart | ValuePart, ...]:
        apart = written_apart(self.parts)
        sent = (part for part in apart if isinstance(part, IdentityPart | ValuePart))
        return (*self.told_identity, *sent)

    def _empty_frame(self) -> bytes:
        if isinstance(self.spec.start, AfterEnd):
            return self.end
        return self.start + self.end if self.shares_delimiter else b""

    def tail_size(self, payload: int) -> int:
        """Bytes behind a payload of that size."""
        return sum(part.size for part in self.tail if payload or not is_optional(part))

    def slices(self, payload: int) -> Iterator[Slice]:
        """The parts that a frame with a payload of that size has."""
        start = 0
        for part in self.parts:
            if is_optional(part) and not payload:
                continue
            end = start + (payload if isinstance(part, PayloadPart) else part.size)
            yield Slice(part, start, end)
            start = end

    def payload_size(self, content: int) -> int | None:
        """The payload's size where the content has that size; None if there is none."""
        extra = content - self.head_size
        if extra == self.tail_size(0):
            return 0
        size = extra - self.tail_size(1)
        return size if size > 0 else None

    def covered(
        self,
        part: ChecksumPart,
        places: Mapping[str, Place],
        data: bytes,
        virtual: Mapping[str, bytes],
    ) -> bytes:
        """The bytes that a checksum runs over, out of those of a frame without its end.

        `virtual` has the bytes of parts that are not sent.
        """
        others = {**self.end_literals, **virtual} if virtual else self.end_literals
        pieces = [
            data[slice(*places[name])] if name in places else others.get(name, b"")
            for name in part.covers
        ]
        return b"".join(pieces)

    def region_end(self, part: LengthPart, value: int) -> int | None:
        """Wire bytes up to the end of what is stuffed, by a length over the wire.

        None if no frame has that length.
        """
        least = self.counted(part, 0)
        others = sum(item.size for item in self.spec.parts if item.name not in part.counts)
        if not least <= value <= min(part.greatest, self.spec.greatest - others):
            return None
        return value - least + sum(part.size for part in self.parts[: self.stuffed[-1] + 1])

    @cached_property
    def behind_region(self) -> int:
        """Bytes between what is stuffed and the end."""
        return sum(part.size for part in self.parts[self.stuffed[-1] + 1 :])

    def counted(self, part: LengthPart, payload: int) -> int:
        """The value of a length part for a payload of that size."""
        return payload + self._counted_around[part.name, payload > 0]

    def told_size(self, payload: int) -> dict[str, int]:
        """What a receiver has to be told of the size of a frame with a payload of that size."""
        told = self.told_length
        return {} if told is None else {told.name: self.counted(told, payload)}

    def told_of(self, frame: bytes) -> dict[str, int]:
        """The same of the bytes of a whole frame."""
        size = self.payload_size(len(frame) - len(self.end))
        return {} if size is None else self.told_size(size)

    def bounds(self, part: LengthPart) -> tuple[int, int]:
        """The least and the greatest value of a length part that a receiver takes."""
        greatest = self.counted(part, self.spec.greatest_payload)
        return max(part.least, self.counted(part, 0)), min(part.greatest, greatest)

    def counted_payload(self, part: LengthPart, value: int) -> int | None:
        """The payload's size for a value of a length part; None if a receiver takes none such."""
        empty = value == self.counted(part, 0)
        size = 0 if empty else value - (self.counted(part, 1) - 1)
        is_taken = part.least <= value <= part.greatest and size <= self.spec.greatest_payload
        return size if is_taken and (empty or size > 0) else None


def _counted_around(parts: Iterable[Part], length: LengthPart, has_payload: bool) -> int:
    """Bytes that a length counts besides the payload."""
    return sum(
        part.size
        for part in parts
        if part.name in length.counts and (has_payload or not is_optional(part))
    )


def _without_end(spec: FrameSpec) -> tuple[Part, ...]:
    """The parts without the literals at the end that make up the end."""
    left = 0 if spec.end is None else len(spec.end.value)
    parts = list(spec.parts)
    while left > 0 and isinstance(parts[-1], LiteralPart):
        left -= parts.pop().size
    return tuple(parts)
