"""Frame plan: every fact of a sender's frame that a decoder, an encoder, a table or a page needs.

*Content* is the bytes of all parts before stuffing, without the literals that make up the end.
The *head* is the parts in front of the payload, the *tail* those behind it, without the end.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from enum import Enum, auto
from functools import cached_property
from typing import Any

import msgspec

from protogen.model.frame import Frame
from protogen.model.frame_places import PlacedPart, Run
from protogen.model.messages import Message
from protogen.model.part_plans import (
    ChecksumPlan,
    CountedLength,
    FurtherLength,
    IdentityGroup,
    LengthPlan,
    StuffedRegion,
    VirtualPlan,
)
from protogen.model.parts import (
    ChoicePart,
    CounterPart,
    IdentityPart,
    LengthPart,
    Part,
    ValuePart,
    varying_bits,
    written_apart,
)
from protogen.model.sizes import SizeSet

_FEW = 256
"""So many identities are looked at one by one."""


class StartRule(Enum):
    """Mark of the start of a frame."""

    LITERAL = auto()
    SET = auto()
    """One of several words, or a first byte of a range of its own."""
    AFTER_END = auto()
    """The end of the frame before, or the start of the stream."""
    ANYWHERE = auto()
    """Nothing: sizes and checksums tell."""


class EndRule(Enum):
    """Rule by which a frame of a known message ends."""

    DELIMITER = auto()
    """The next end literal, which occurs nowhere else in a frame."""
    NEXT_START = auto()
    """The next start, at the latest: starts occur nowhere else, and stuffing varies the size."""
    LENGTH = auto()
    """The length part."""
    IDENTITY = auto()
    """The size of the message's payload."""
    IDLE = auto()
    """A silence of the line, and no byte."""


class Store(Enum):
    """Bytes that a decoder keeps of a candidate until its verdict."""

    CONTENT = auto()
    """Unstuffed bytes alone: no frame can start inside a failed candidate but at its end."""
    WIRE = auto()
    """Bytes as they came. Nothing is stuffed, so they are the content, too."""
    BOTH = auto()


class FramePlan(msgspec.Struct, frozen=True, kw_only=True, dict=True):
    """A sender's frame, worked out once. Sizes are in bytes."""

    frame: Frame
    # The start and the end.
    start: StartRule
    start_bytes: bytes
    """The start literal; empty where something else marks the start."""
    start_words: tuple[bytes, ...]
    """What a frame starts with, in order and of one size; empty where nothing marks the start."""
    start_is_unique: bool
    """True if a start occurs nowhere else in a frame."""
    end_rule: EndRule
    end_bytes: bytes
    """The end literal; empty where there is none."""
    end_is_unique: bool
    """True if the end literal occurs nowhere else in a frame."""
    # The parts.
    head: tuple[PlacedPart, ...]
    tail: tuple[PlacedPart, ...]
    end_literals: tuple[Part, ...]
    """The parts that make up the end."""
    length: LengthPlan | None
    """The first length, which decides where a frame ends."""
    further_lengths: tuple[FurtherLength, ...]
    """The lengths behind it, each of which has to agree with it."""
    checksums: tuple[ChecksumPlan, ...]
    virtual: tuple[VirtualPlan, ...]
    """The parts that are not sent, in the order of the schema."""
    region: StuffedRegion | None
    # Identities and sizes.
    groups: tuple[IdentityGroup, ...]
    """By identity, in the order of the messages."""
    payload: SizeSet
    """Payload sizes that a frame can carry, those of unknown messages included."""
    least: int
    """Wire bytes of the smallest frame."""
    greatest: int
    """Wire bytes that no frame exceeds."""
    # What an engine may do.
    seven_bit: bool
    """True if every payload byte has its most significant bit clear."""
    rescans: bool
    """True if a frame can start inside a failed candidate, in front of its end."""
    is_regular: bool
    """True if only checksums stand behind the payload, all of them or none are optional, and the
    stuffed region holds the payload and not the start."""
    takes_whole: bool
    """True if a frame that stands in the input can be taken as a whole, without a candidate."""
    streams: bool
    """True if a frame can be sent byte by byte, without a look at what follows."""
    cut_ambiguous: bool
    """True if an encoder has to check that a decoder cuts its frame where it ends."""
    is_cut_off: bool = False
    """True if parts and stuffing allow more bytes than `greatest`, so that they are counted."""

    # --- sizes ------------------------------------------------------------------------------------

    @property
    def head_size(self) -> int:
        """Bytes of content in front of the payload."""
        return self.head[-1].end if self.head else 0

    @property
    def tail_size(self) -> int:
        """Bytes of content behind a payload that is not empty."""
        return self.tail[-1].end if self.tail else 0

    @property
    def tail_size_empty(self) -> int:
        """Bytes of content behind a payload that is empty."""
        return sum(item.size for item in self.tail if not item.is_optional)

    @property
    def optional_size(self) -> int:
        """Bytes of content that are absent where the payload is empty."""
        return sum(item.size for item in self.placed if item.is_optional)

    @property
    def size_known_at(self) -> int | None:
        """Bytes of content that tell the payload's size; None if they are not all in the head."""
        if self.length is not None:
            return None if self.length.over_wire else self._length_end(self.length)
        if not self.sent_identity:
            return 0 if self.groups and all(g.fixed is not None for g in self.groups) else None
        return self.part(self.sent_identity[-1].name).end if self.identity_is_early else None

    def _length_end(self, length: LengthPlan) -> int:
        """Bytes of content up to the end of the length; none of one that is told."""
        return 0 if self.frame.told_length else self.part(length.part.name).end

    @property
    def is_trimmed(self) -> bool:
        """True if senders leave out zeros at the end of payloads, and receivers fill them up."""
        return self.frame.payload.is_trimmed

    @property
    def is_cut(self) -> bool:
        """True if receivers leave what is behind the bytes of a payload that they know."""
        return self.frame.payload.is_cut

    @property
    def is_fitted(self) -> bool:
        """True if receivers fill payloads up, or cut them, to the size that the message has."""
        return self.frame.payload.is_fitted

    def takes_any_size(self, group: IdentityGroup) -> bool:
        """True if no payload is too short or too long for the messages of an identity."""
        is_cut = self.is_cut and all(message.can_be_cut for message in group.messages)
        return is_cut and all(sizes.least == 0 for sizes in group.sizes)

    @property
    def bounds_payload(self) -> bool:
        """True if no frame carries a payload greater than the plan's, whatever its message is."""
        return self.length is not None or self.frame.limit is not None

    def told_size(self, wire: int) -> dict[str, int]:
        """The length that a receiver is told of a frame of so many bytes, if it is told one.

        In such a frame, nothing is stuffed.
        """
        part = self.frame.told_length
        if part is None or self.length is None:
            return {}
        payload = wire - self.head_size - self.tail_size - len(self.end_bytes)
        return {part.name: self.length.counted(max(0, payload))}

    def told_before(self, message: Message, given: Mapping[str, Any], wire: int) -> dict[str, Any]:
        """What a receiver has to be told before a frame of the message, of so many bytes.

        `given` has values of its parts.
        """
        identity = dict(zip(self.frame.identity, message.identity, strict=True))
        told = {it.name: given.get(it.name, identity[it]) for it in self.frame.told_identity}
        return {**told, **self.told_size(wire)}

    # --- places -----------------------------------------------------------------------------------

    @property
    def skipped(self) -> int:
        """Bytes of the start that places are not counted from."""
        return -self.head[0].offset if self.head else 0

    @cached_property
    def covers_start(self) -> bool:
        """True if a checksum runs over some of the start."""
        runs = [run for item in self.checksums for run in item.covers if isinstance(run, Run)]
        start = self.start_size - self.skipped
        return any(not run.first.is_tail and run.first.offset < start for run in runs)

    # --- parts ------------------------------------------------------------------------------------

    def counted(self, part: LengthPart) -> CountedLength:
        """What a length of the frame counts."""
        assert self.length is not None
        every = (self.length, *self.further_lengths)
        return next(item for item in every if item.part.name == part.name)

    @property
    def content(self) -> tuple[Part, ...]:
        """The parts in wire order, the payload among them, without the end."""
        return self.frame.parts[: len(self.frame.parts) - len(self.end_literals)]

    @property
    def payload_index(self) -> int:
        """The place of the payload among them."""
        return self.content.index(self.frame.payload)

    @cached_property
    def _stuffed(self) -> list[int]:
        names = self.frame.stuffed
        return [index for index, item in enumerate(self.content) if item.name in names]

    @property
    def first_stuffed(self) -> int:
        """The place of the first one that is stuffed; -1 where none is."""
        return min(self._stuffed, default=-1)

    @property
    def last_stuffed(self) -> int:
        """The place of the last one."""
        return max(self._stuffed, default=-1)

    @property
    def placed(self) -> tuple[PlacedPart, ...]:
        """The parts of the head and the tail in wire order."""
        return (*self.head, *self.tail)

    def part(self, name: str) -> PlacedPart:
        """The part of the head or the tail of that name; raises KeyError.

        One that is bits of another lies where that does.
        """
        for item in self.placed:
            if item.name == name:
                return item
        return self._members[name]

    @cached_property
    def _members(self) -> dict[str, PlacedPart]:
        """The parts, and what follows from parts, that are bits of others, where these lie."""
        return {
            part.name: PlacedPart(part, item.place, item.is_stuffed)
            for item in self.placed
            for part in varying_bits(item.part)
        }

    def written_apart(self, items: Iterable[PlacedPart]) -> tuple[PlacedPart, ...]:
        """Some parts, in place of those whose bits are parts these."""
        return tuple(
            self._members[part.name] if item.part is not part else item
            for item in items
            for part in written_apart((item.part,))
        )

    @property
    def identity(self) -> tuple[IdentityPart, ...]:
        """The identity parts: those that receivers are told, and the others in wire order."""
        return self.frame.identity

    @property
    def sent_identity(self) -> tuple[IdentityPart, ...]:
        """The identity parts that are sent, in wire order."""
        return self.frame.sent_identity

    @property
    def is_told_alone(self) -> bool:
        """True if there is an identity, and nothing of it is sent."""
        return bool(self.frame.told_identity) and not self.sent_identity

    @property
    def identity_bits(self) -> int:
        """Bits of the number that all identity parts make up."""
        return sum(part.type.bits for part in self.identity)

    @property
    def identity_is_early(self) -> bool:
        """True if there is an identity, and nothing of it stands behind the payload."""
        return bool(self.identity) and self.frame.identity_is_early

    @property
    def bounded(self) -> tuple[PlacedPart, ...]:
        """The parts whose values a receiver holds to their bounds.

        These are literals of which there are several, and numbers in front of the payload where a
        frame can start inside a failed candidate: the sooner one fails the better.
        """
        kinds = CounterPart | ValuePart
        early = tuple(
            item
            for item in self.written_apart(self.head)
            if self.rescans and isinstance(item.part, kinds) and item.part.is_bounded
        )
        return tuple(
            item
            for item in self.written_apart(self.placed)
            if item in early or isinstance(item.part, ChoicePart)
        )

    @property
    def sizes_told_at(self) -> int | None:
        """Bytes of content that tell an identity, and the size that a message of it has to have.

        None where a receiver need not look at both before the whole frame is there.
        """
        if self.length is None or self.length.over_wire or not self.rescans or not self.groups:
            return None
        if self.identity and not self.identity_is_early:
            return None
        if all(map(self.takes_any_size, self.groups)):
            return None
        ends = (self.part(part.name).end for part in self.sent_identity[-1:])
        return max((self._length_end(self.length), *ends))

    @property
    def shown(self) -> tuple[PlacedPart, ...]:
        """The parts that events show: identity, counters and values."""
        kinds = IdentityPart | CounterPart | ValuePart
        return tuple(
            item for item in self.written_apart(self.placed) if isinstance(item.part, kinds)
        )

    # --- start and end ----------------------------------------------------------------------------

    @property
    def shares_delimiter(self) -> bool:
        """True if the end of a frame may also be the start of the next.

        Where the literal can stand in the data as well, it is one or the other.
        """
        return self.end_is_unique and self.start_bytes == self.end_bytes

    @property
    def start_size(self) -> int:
        """Bytes of what marks the start; 0 where nothing does."""
        return len(self.start_words[0]) if self.start_words else 0

    @property
    def mark_size(self) -> int:
        """Bytes in front of a frame that no end is looked for in.

        Where one of several bytes marks the start, it is looked at as any other is.
        """
        return self.start_size if self.start_size > 1 else len(self.start_bytes)

    @cached_property
    def start_set(self) -> tuple[int, ...]:
        """First bytes of a frame, where one of several bytes marks the start; else empty."""
        if self.start is not StartRule.SET or self.start_size > 1:
            return ()
        return tuple(word[0] for word in self.start_words)

    @property
    def end_begins_start(self) -> bool:
        """True if a start may seem to begin inside of an end that belongs to the frame before."""
        if self.shares_delimiter:
            return False
        end = self.end_bytes
        if self.start is StartRule.SET and not end:
            return False
        return any(_begins_inside(start, end) for start in self.start_words)

    @property
    def store(self) -> Store:
        """Bytes that a decoder keeps of a candidate."""
        if self.region is None:
            return Store.WIRE if self.rescans else Store.CONTENT
        over_wire = any(checksum.part.over_wire for checksum in self.checksums)
        return Store.BOTH if over_wire or self.rescans else Store.CONTENT

    @property
    def opens(self) -> bool:
        """True if the size of some payload is not known before the end of its bytes."""
        if self.length is not None:
            return self.length.over_wire
        if self.identity:
            return True  # An unknown identity tells no size.
        return self.has_end and self.has_open_groups

    @property
    def has_end(self) -> bool:
        """True if a literal or a silence stands at the end of every frame."""
        return bool(self.end_bytes) or self.ends_idle

    @property
    def ends_idle(self) -> bool:
        """True if a silence ends a frame."""
        return self.end_rule is EndRule.IDLE

    @property
    def given_up_at(self) -> int:
        """Wire bytes of a candidate that is given up if it is no frame by then.

        Of a frame that only a silence ends, one byte more than the greatest has.
        """
        return self.greatest + self.ends_idle

    @property
    def measures(self) -> bool:
        """True if the size of some payload follows from its first bytes alone."""
        return self.length is None and not self.has_end and self.has_open_groups

    @cached_property
    def has_open_groups(self) -> bool:
        """True if the payloads of some identity vary in size."""
        return any(group.fixed is None for group in self.groups)

    @property
    def ends_at_start(self) -> bool:
        """True if some frame ends where the next starts, and nothing else tells."""
        if self.length is not None:
            return False
        return self.opens and not self.has_end and self.start is not StartRule.ANYWHERE

    @cached_property
    def has_one_spelling(self) -> bool:
        """True if a frame can only have the bytes that an encoder makes of what is in it."""
        lenient = self.region is not None and self.region.lenient
        if lenient or self.cut_ambiguous or self.shares_delimiter or self.is_fitted:
            return False
        messages = (message for group in self.groups for message in group.messages)
        return all(message.plan.has_one_spelling for message in messages)

    def may_look_idle(self, message: Message) -> bool:
        """True if a frame of the message may have an end where only a start is in front of it."""
        if self.start is not StartRule.AFTER_END and not self.shares_delimiter:
            return False
        start = len(self.start_bytes) - self.skipped
        behind = [item.part for item in self.head if item.offset >= start]
        first = behind[0] if behind else None
        if not isinstance(first, IdentityPart) or first.size < len(self.end_bytes):
            return True
        index = self.identity.index(first)
        if message.told_by.values(index) > _FEW:
            return True
        runs = message.told_by.runs[index]
        values = (value for least, most in runs for value in range(least, most + 1))
        return any(first.encode(value).startswith(self.end_bytes) for value in values)


def _begins_inside(start: bytes, end: bytes) -> bool:
    """True if a start may seem to begin inside of an end."""
    endings = [end[place:] for place in range(len(end))]
    begins = any(item.startswith(start) or start.startswith(item) for item in endings)
    return begins or end in start[1:]
