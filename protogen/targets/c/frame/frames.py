"""Whole frames: what is put around a payload, and how the stuffed region is stuffed.

A frame is built in the caller's buffer. The content stands right-aligned in the room that the
frame can need at most; stuffing then writes it from the left and never overtakes itself, so that no
second buffer is needed.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import msgspec

from protogen.c_language.numbers import unsigned_type
from protogen.copying import replace
from protogen.model.frame_places import PlacedPart, Side
from protogen.model.frame_plan import FramePlan
from protogen.model.part_plans import ChecksumPlan, FurtherLength
from protogen.model.parts import (
    BitsPart,
    ChecksumPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    PayloadPart,
    VirtualPart,
)
from protogen.targets.c.decoders.decoder import DecoderView
from protogen.targets.c.frame.arguments import Argument, argument_name, argument_of
from protogen.targets.c.frame.checksums import ChecksumView, CoveredRun
from protogen.targets.c.frame.expressions import (
    Index,
    bits_put,
    byte,
    bytes_of_bits,
    less_absent,
    taken_bits,
)
from protogen.targets.c.frame.stuffing import Stuffing
from protogen.targets.c.frame.virtual import VirtualView
from protogen.targets.c.spelling import Names

_STUFFED = 128
_FEW = 4
"""So many bytes are copied one by one, without a loop."""


class ByteStore(msgspec.Struct, frozen=True):
    """One byte of a part, at an offset from the head's or tail's first byte."""

    index: str
    value: str


class Step(msgspec.Struct, frozen=True):
    """Stores that fill one part of the content."""

    in_head: bool
    stores: tuple[ByteStore, ...]
    name: str = ""
    checksum: ChecksumView | None = None
    flags: int | None = None
    """Flags of the writer for its bytes, where they differ from those before."""
    virtual: VirtualView | None = None
    """A part that is summed here and not sent."""
    counts: bool = False
    """True if it is the length part, and counts what is stuffed."""


class Half(msgspec.Struct, frozen=True):
    """Parts that are sent byte by byte in front of the payload, or behind it."""

    name: str
    steps: tuple[Step, ...]
    end: bytes = b""
    flags: int | None = None
    """Flags of the writer for the payload's bytes, where they change."""

    lengths: tuple[tuple[str, str, str], ...] = ()
    """The lengths among them, as variables: type, name and value."""


class FrameView(msgspec.Struct, frozen=True, dict=True):
    """A sender's frame, as it is built."""

    decoder: DecoderView

    @property
    def plan(self) -> FramePlan:
        """The plan of the frame."""
        return self.decoder.plan

    @property
    def _names(self) -> Names:
        return self.decoder.names

    @property
    def _stuffing(self) -> Stuffing | None:
        return self.decoder.stuffing

    # --- arguments --------------------------------------------------------------------------------

    def _argument(self, part: NumberPart) -> Argument:
        return argument_of(part, argument_name(part.name, self._names))

    @cached_property
    def identity(self) -> tuple[Argument, ...]:
        """The identity parts that are sent."""
        return tuple(self._argument(part) for part in self.plan.sent_identity)

    @cached_property
    def arguments(self) -> tuple[Argument, ...]:
        """The parts that the caller gives."""
        return tuple(self._argument(part) for part in self.plan.frame.caller_parts)

    @cached_property
    def virtual(self) -> dict[str, Argument]:
        """The parts that are not sent, which each message has a value for."""
        return {
            part.name: Argument(
                name=argument_name(part.name, self._names),
                part=part.name,
                type=unsigned_type(part.type.bits),
                doc=part.about.doc,
                refused="",
            )
            for part in self.plan.frame.virtual
        }

    @property
    def _parameters(self) -> tuple[Argument, ...]:
        return (*self.identity, *self.virtual.values(), *self.arguments)

    @property
    def parameters(self) -> str:
        """The parts that a frame is made of and that vary, as parameters behind others."""
        return "".join(f", {item.type} {item.name}" for item in self._parameters)

    @property
    def byte_arguments(self) -> tuple[str, ...]:
        """Parameters of the function that makes the frame of a message that is a byte.

        The byte comes first, as the message does in its callers: then nothing is moved.
        """
        others = (f"{item.type} {item.name}" for item in self._parameters)
        return ("uint8_t byte", "uint8_t *frame", "size_t capacity", *others)

    @property
    def passed_on(self) -> str:
        """The same as arguments behind others."""
        return "".join(f", {name}" for name in self.names)

    @property
    def names(self) -> list[str]:
        """Names of these parameters."""
        return [item.name for item in self._parameters]

    # --- sizes ------------------------------------------------------------------------------------

    @property
    def content_size(self) -> str:
        """Bytes of content."""
        return self._size(self.plan.head_size)

    @property
    def coded_size(self) -> str:
        """Bytes of content and of the code in front of it."""
        return self._size(1 + self.plan.head_size)

    def _size(self, ahead: int) -> str:
        """Bytes of payload and tail, and so many in front of them."""
        start = f"{ahead}U + payload" if ahead else "payload"
        return start + self.decoder.tail_behind("payload")

    @property
    def length(self) -> str:
        """The length part's value; empty where there is none."""
        view = self.decoder.length
        return "" if view is None else _counted(view.base, view.optional)

    @property
    def length_type(self) -> str:
        """Type of the length part's value."""
        length = self.plan.length
        return "" if length is None else _length_type(length.part)

    @cached_property
    def lengths(self) -> tuple[tuple[str, str, str], ...]:
        """The lengths as variables: type, name and value."""
        if self.plan.frame.told_length is not None:
            return ()
        first = [(self.length_type, "length", self.length)] if self.length else []
        return (*first, *map(self._further, self.plan.further_lengths))

    def _further(self, item: FurtherLength) -> tuple[str, str, str]:
        name = argument_name(item.part.name, self._names)
        return _length_type(item.part), name, _counted(item.base, item.optional)

    # --- the stuffed region -----------------------------------------------------------------------

    @property
    def is_cobs(self) -> bool:
        """True if the region is stuffed in groups."""
        return self._stuffing is not None and self._stuffing.is_cobs

    @property
    def is_one_region(self) -> bool:
        """True if groups of COBS hold all content, and the zero of the end is right behind them."""
        ends_in_zero = self.plan.end_bytes[:1] == b"\0"
        is_whole = self.begins_at == 0 and self.decoder.region_to_end
        return self.is_cobs and is_whole and ends_in_zero

    @property
    def worst(self) -> int:
        """Bytes on the wire for one stuffed byte, at most."""
        return 1 if self._stuffing is None else self._stuffing.longest

    @property
    def region_begin(self) -> str:
        """Bytes of content in front of the region."""
        assert self.plan.region is not None
        return Index(self.plan.region.first, self.plan.head_size).of("payload")

    @property
    def region_end(self) -> str:
        """Bytes of content up to the region's end."""
        assert self.plan.region is not None
        return Index(self.plan.region.end, self.plan.head_size).of("payload")

    @property
    def begins_at(self) -> int | None:
        """Bytes in front of the stuffed region, where these are few and always as many."""
        region = self.plan.region
        if region is None or region.first.side is Side.TAIL or region.first.offset > _FEW:
            return None
        return region.first.offset

    @cached_property
    def _written_ahead(self) -> dict[str, str]:
        """The bytes that no content needs, by their index.

        They stand in front of the stuffed region, and are known without a look at other bytes.
        """
        if not self.begins_at:
            return {}
        read = {name for c in self.plan.checksums for name in (c.placed.name, *_covered(c))}
        own = [s for s in self.steps if s.in_head and s.checksum is None and not s.counts]
        plain = [s for s in own if s.name not in read]
        stores = {store.index: store.value for step in plain for store in step.stores}
        front = [f"{index}U" for index in range(self.begins_at)]
        return {index: stores[index] for index in front if index in stores}

    @property
    def ahead(self) -> list[str]:
        """Each byte in front of the stuffed region."""
        assert self.begins_at is not None
        front = [f"{index}U" for index in range(self.begins_at)]
        return [self._written_ahead.get(index, f"content[{index}]") for index in front]

    @property
    def escaped_byte(self) -> str:
        """A byte as it stands behind the escape."""
        assert self._stuffing is not None
        xor = self._stuffing.xor
        return f"(uint8_t)(byte ^ {byte(xor)})" if xor else "byte"

    def stuffs_bytes(self, streaming: tuple[str, ...]) -> bool:
        """True if bytes are stuffed one by one, because they are summed or sent so."""
        if self._stuffing is None or self.is_cobs:
            return False
        return self.sums_stuffed or self.decoder.length_over_wire or self.decoder.name in streaming

    @property
    def sums_stuffed(self) -> bool:
        """True if a checksum covers stuffed bytes as they are on the wire."""
        return any(item.sums_stuffed for item in self.decoder.checksums)

    @cached_property
    def summed(self) -> ChecksumView | None:
        """The checksum that is worked out while the bytes that it covers are stuffed.

        It covers all that is stuffed, and nothing but its own bytes stands behind that.
        """
        if self._stuffing is None or self.is_cobs or len(self.decoder.checksums) != 1:
            return None
        checksum = self.decoder.checksums[0]
        is_alone = len(self.plan.tail) == 1 and not checksum.is_bits
        is_alone = is_alone and checksum.at.place.side is not Side.HEAD
        plain = is_alone and not checksum.optional and not checksum.over_wire
        plain = plain and not self._stuffing.inserts
        fits = plain and self.decoder.region_to_end and self._covers_region(checksum)
        return checksum if fits else None

    def _covers_region(self, checksum: ChecksumView) -> bool:
        """True if a checksum covers all from the region's first byte to the payload's last."""
        cover = checksum.covers[0] if len(checksum.covers) == 1 else None
        if self.begins_at is None or not isinstance(cover, CoveredRun):
            return False
        first, last = cover.first.place, cover.last.place
        begins = first.side is Side.HEAD and first.offset == self.begins_at
        return begins and last.side is Side.TAIL and last.offset == 0

    @property
    def summed_byte(self) -> str:
        """The checksum of one byte."""
        assert self.summed is not None
        return self.summed.wire_bytes(f"{self.summed.checksum.function}_final(sum)")[0]

    # --- the parts --------------------------------------------------------------------------------

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The parts in the order in which they can be filled: checksums behind what they cover.

        A length that counts what is stuffed comes behind all but these.
        """
        plain = [item for item in self.plan.placed if not isinstance(item.part, ChecksumPart)]
        if self.decoder.length_over_wire:
            plain.sort(key=lambda item: isinstance(item.part, LengthPart))
        left = list(self.plan.checksums)
        done: list[Step] = []
        while left:
            names = {item.placed.name for item in left}
            ready = next(item for item in left if names.isdisjoint(_covered(item)))
            left.remove(ready)
            is_bits = ready.part.type.within is not None
            done.append(self._put_bits(ready) if is_bits else self._step(ready.placed))
        return (*map(self._step, plain), *done)

    @property
    def steps_ahead(self) -> tuple[Step, ...]:
        """Those of them that are filled before anything is stuffed."""
        summed = self.summed
        steps = (s for s in self.steps if summed is None or s.checksum is not summed)
        return tuple(s for s in steps if not self._is_written_ahead(s))

    def _is_written_ahead(self, step: Step) -> bool:
        """True if all bytes of a part are."""
        written = self._written_ahead
        is_plain = bool(step.stores) and step.in_head and step.checksum is None
        return is_plain and all(store.index in written for store in step.stores)

    def _step(self, item: PlacedPart) -> Step:
        part = item.part
        less = less_absent(item.place, "payload")
        match part:
            case LiteralPart():
                values = tuple(map(byte, part.bytes))
            case BitsPart():
                numbers = (*part.members, *(mirror.of for mirror in part.mirrors))
                values = bytes_of_bits(part, {it.name: self._value(it) for it in numbers})
            case NumberPart():
                values = self.decoder.numbers.bytes_of(part.type, self._value(part))
            case ChecksumPart():
                values = self.decoder.numbers.bytes_of(part.type, "due")
            case _:
                values = ()
        stores = tuple(
            ByteStore(f"{item.offset + index}U{less}", value) for index, value in enumerate(values)
        )
        checksum = next((c for c in self.decoder.checksums if c.name == part.name), None)
        counts = isinstance(part, LengthPart) and self.decoder.length_over_wire
        return Step(item.in_head, stores, part.name, checksum, counts=counts)

    def _put_bits(self, item: ChecksumPlan) -> Step:
        """The step that puts a checksum in bits of a part whose other bits stand there."""
        target = "content" if item.placed.in_head else "tail"
        less = less_absent(item.placed.place, "payload")
        stores = []
        for place, value in bits_put(item.part.type, taken_bits(item.part, "due")):
            index = f"{item.placed.offset + place}U{less}"
            stores.append(ByteStore(index, f"(uint8_t)({target}[{index}] | {value})"))
        checksum = next(c for c in self.decoder.checksums if c.name == item.part.name)
        return Step(item.placed.in_head, tuple(stores), item.part.name, checksum)

    def _value(self, part: NumberPart) -> str:
        """The value of a number that is not worked out of other bytes."""
        is_length = self.plan.length is not None and part.name == self.plan.length.part.name
        return "length" if is_length else argument_name(part.name, self._names)

    # --- byte by byte -----------------------------------------------------------------------------

    @property
    def sends_tail(self) -> bool:
        """True if something is sent behind the payload."""
        return bool(self.plan.end_bytes or self.plan.tail)

    @cached_property
    def halves(self) -> tuple[Half, ...]:
        """Parts that are sent in front of the payload, and those behind it."""
        steps: list[Step] = []
        payload_flags: int | None = None
        before = 0
        placed = {item.name: item for item in self.plan.placed}
        payload = self.plan.frame.parts.index(self.plan.frame.payload)
        views = {view.name: view for view in self.decoder.virtual}
        for part in self.plan.frame.declared:
            if isinstance(part, VirtualPart):
                steps.append(Step(part.place <= payload, (), virtual=views[part.name]))
                continue
            flags = self._flags(part.name)
            change = None if flags == before else flags
            if isinstance(part, PayloadPart):
                payload_flags = change
            elif part.name in placed:
                steps.append(replace(self._step(placed[part.name]), flags=change))
            else:
                continue
            before = flags
        in_head = tuple(s for s in steps if s.in_head)
        in_tail = tuple(s for s in steps if not s.in_head)
        in_front, behind = (tuple(self._lengths_on(side)) for side in Side)
        head = Half("head", in_head, flags=payload_flags, lengths=in_front)
        tail = Half("tail", in_tail, self.plan.end_bytes, lengths=behind)
        return (head, tail) if self.sends_tail else (head,)

    def _lengths_on(self, side: Side) -> Iterator[tuple[str, str, str]]:
        """The lengths on one side of the payload, as variables."""
        if not self.lengths:
            return
        for part, variable in zip(self.plan.frame.lengths, self.lengths, strict=True):
            if self.plan.part(part.name).place.side is side:
                yield variable

    def _flags(self, name: str) -> int:
        """Flags of a part: the checksums that cover it, and whether it is stuffed."""
        checksums = enumerate(self.plan.frame.checksums)
        covering = sum(1 << index for index, part in checksums if name in part.covers)
        region = self.plan.region
        return covering | (_STUFFED if region is not None and name in region.parts else 0)


def _counted(base: int, optional: int) -> str:
    """The value of a length, by what it counts besides the payload."""
    if not optional:
        return f"{base}U + payload" if base else "payload"
    return f"(payload == 0U ? {base}U : {base + optional}U + payload)"


def _length_type(part: LengthPart) -> str:
    return unsigned_type(max(16, part.type.bits))


def _covered(item: ChecksumPlan) -> set[str]:
    return set(item.part.covers) - {item.placed.name}
