"""Frames as a decoder receives them: what the templates of every style need to know.

The C code follows the runtime's `framing/machine.py` and `decoder.py`, with everything that a frame
does not need left out. What is a fact of the frame is in its plan; here is what C makes of it.
"""

from __future__ import annotations

from functools import cached_property

from protogen.model.frame_places import PlacedPart
from protogen.model.frame_plan import FramePlan, StartRule, Store
from protogen.model.parts import BitsPart, NumberPart
from protogen.targets.c.decoders.groups import (
    Alternatives,
    GroupView,
    ReceivedMessage,
    alternatives_of,
    key_from,
    key_type,
)
from protogen.targets.c.decoders.named import NamedDecoder
from protogen.targets.c.frame.checksums import ChecksumView, checksums_of
from protogen.targets.c.frame.expressions import among, bits_of, byte, plus
from protogen.targets.c.frame.numbers import (
    LengthView,
    LiteralView,
    NumberView,
    PartView,
    ToldView,
    length_of,
    literals_of,
    numbers_of,
    told_of,
)
from protogen.targets.c.frame.part_numbers import PartNumbers
from protogen.targets.c.frame.stuffing import Node, Stuffing, StuffingKind, stuffing_of
from protogen.targets.c.frame.virtual import VirtualView, virtual_of
from protogen.targets.c.options import Events


class ReceivedFrame(NamedDecoder, frozen=True, dict=True):
    """A sender's frame, as a decoder receives it."""

    plan: FramePlan
    groups: tuple[GroupView, ...]
    events: Events
    numbers: PartNumbers

    # --- names ------------------------------------------------------------------------------------

    @property
    def types(self) -> str:
        """Prefix of the structs of its events and their parts."""
        return self.names.senders[self.name]

    # --- styles -----------------------------------------------------------------------------------

    @property
    def all_events(self) -> bool:
        """True if invalid bytes and unknown frames are delivered, too."""
        return self.events == "all"

    @property
    def is_polled(self) -> bool:
        """True if `push` and all others return which message is complete, one at a time.

        A decoder of all events calls a handler: one byte may tell of many.
        """
        return self.events == "messages"

    # --- sizes ------------------------------------------------------------------------------------

    @cached_property
    def counter(self) -> str:
        """The type of what counts bytes of a candidate, and a few bytes behind it."""
        most = self.plan.given_up_at + self.around + self.start_size + self.end_size
        bits = next(bits for bits in (8, 16, 32) if most < (1 << bits) - 4)
        return f"uint{bits}_t"

    @cached_property
    def optional_size(self) -> int:
        """Bytes of the tail that are absent where the payload is empty."""
        return sum(item.size for item in self.optional_tail)

    @property
    def optional_tail(self) -> tuple[PlacedPart, ...]:
        """The parts of the tail that are absent where the payload is empty."""
        return tuple(item for item in self.plan.tail if item.is_optional)

    @property
    def around(self) -> int:
        """Bytes around a payload that is not empty."""
        return self.plan.head_size + self.plan.tail_size

    @property
    def least_around(self) -> int:
        """Bytes around an empty payload."""
        return self.around - self.optional_size

    def tail_behind(self, size: str) -> str:
        """Bytes behind a payload of that size, added to what stands in front."""
        if not self.optional_size:
            return plus(self.plan.tail_size)
        least = self.plan.tail_size - self.optional_size
        return f" + ({size} == 0U ? {least}U : {self.plan.tail_size}U)"

    @property
    def start_size(self) -> int:
        """Bytes of the start literal, or of each where there are several."""
        return self.plan.mark_size

    @property
    def end_size(self) -> int:
        """Bytes of the end literal."""
        return len(self.plan.end_bytes)

    @property
    def buffer_size(self) -> int:
        """Bytes of the buffer."""
        if self.keeps_wire:
            return self.plan.given_up_at + max(self.start_size - 1, 0)
        content = self.around + self.plan.payload.greatest
        return self.plan.greatest if self.length is None else min(self.plan.greatest, content)

    @cached_property
    def filled_size(self) -> int:
        """Bytes of the greatest payload that is filled up with zeros; 0 where none is."""
        return max((item.fills for group in self.groups for item in group.messages), default=0)

    @cached_property
    def fits_payloads(self) -> bool:
        """True if some payloads are filled up, or cut, to the size that their message has."""
        return any(item.is_fitted for group in self.groups for item in group.messages)

    @cached_property
    def cuts_payloads(self) -> bool:
        """True if some payloads are cut to the size that their message has."""
        return any(item.cuts is not None for group in self.groups for item in group.messages)

    @property
    def unlimited(self) -> str:
        """Bound of a payload or all content while its size is unknown: the room for it."""
        size = self.plan.greatest if self.keeps_both else self.buffer_size
        if self.simple:
            # Where all payloads are empty, parts that need one are never there.
            size = max(size - self.around, 0)
        return f"{size}U"

    # --- start and end ----------------------------------------------------------------------------

    @property
    def first_head(self) -> int:
        """Bytes of a start."""
        return self.plan.start_size or 1

    def is_start(self, at: str) -> str:
        """The condition that a byte is a start of one byte."""
        if self.plan.start_bytes:
            return f"{at} == {byte(self.plan.start_bytes[0])}"
        return among(self.plan.start_set, at)

    # --- what is kept -----------------------------------------------------------------------------

    @property
    def keeps_wire(self) -> bool:
        """True if candidates can be scanned again."""
        return self.plan.store is not Store.CONTENT

    @property
    def keeps_both(self) -> bool:
        """True if the unstuffed bytes are kept beside those of the wire."""
        return self.plan.store is Store.BOTH

    @property
    def wire_is_content(self) -> bool:
        """True if the bytes as they came are the content, too."""
        return self.plan.store is Store.WIRE

    # --- the stuffed region -----------------------------------------------------------------------

    @cached_property
    def stuffing(self) -> Stuffing | None:
        """Encoding of the stuffed region."""
        return stuffing_of(self.plan.region)

    @cached_property
    def region_to_end(self) -> bool:
        """True if nothing but the end stands behind the stuffed region, with nothing to check.

        Where no end is looked for, a region's own end has to be seen to fit.
        """
        region, stuffing = self.plan.region, self.stuffing
        if region is None or stuffing is None:
            return False
        if self.length_over_wire:
            return False
        may_not_fit = stuffing.is_cobs or region.lenient
        return region.reaches_end and (self.plan.end_is_unique or not may_not_fit)

    @property
    def is_stuffed_behind_start(self) -> bool:
        """True if all that is stuffed is what stands between a start and an end."""
        region = self.plan.region
        return region is not None and self.region_to_end and region.before == self.first_head

    @cached_property
    def escape_starts(self) -> bool:
        """True if delimiters are told by the nodes of the stuffing.

        They have two bytes, the first of which always leads to a node that ends with it.
        """
        stuffing = self.stuffing
        delimiters = [self.plan.start_bytes, *filter(None, [self.plan.end_bytes])]
        if stuffing is None or stuffing.kind is not StuffingKind.CODES:
            return False
        if any(len(delimiter) != 2 for delimiter in delimiters):
            return False
        first = delimiters[0][0]
        seconds = {delimiter[1] for delimiter in delimiters}
        taken = {branch.byte for node in self.escape_nodes for branch in node.branches}
        return (
            all(delimiter[0] == first for delimiter in delimiters)
            and len(seconds) == len(delimiters)
            and first not in seconds
            and any(node.beginning == bytes((first,)) for node in self.escape_nodes)
            and not any(code.sequence[-1] == first for code in stuffing.codes)
            and not taken & seconds
        )

    @cached_property
    def escape_nodes(self) -> tuple[Node, ...]:
        """The nodes behind a delimiter's first byte, the one behind nothing else first."""
        nodes = () if self.stuffing is None else self.stuffing.nodes
        return tuple(node for node in nodes if node.beginning.endswith(self.plan.start_bytes[:1]))

    @cached_property
    def never_passed(self) -> tuple[int, ...]:
        """Bytes that are a start or an end by themselves, so that nothing else sees them."""
        return (*(self.plan.start_set or self.plan.start_bytes), *self.plan.end_bytes)

    # --- parts ------------------------------------------------------------------------------------

    @cached_property
    def head_literals(self) -> tuple[LiteralView, ...]:
        """Fixed bytes in front of the payload."""
        return literals_of(self.plan.head)

    @cached_property
    def head_numbers(self) -> tuple[NumberView, ...]:
        """Numbers in front of the payload that are checked."""
        return numbers_of(self.plan, self.plan.head, self.numbers)

    @cached_property
    def tail_literals(self) -> tuple[LiteralView, ...]:
        """Fixed bytes behind the payload."""
        return literals_of(self.plan.tail)

    @cached_property
    def tail_numbers(self) -> tuple[NumberView, ...]:
        """Numbers behind the payload that are checked."""
        return numbers_of(self.plan, self.plan.tail, self.numbers)

    @property
    def checks_tail(self) -> bool:
        """True if something behind the payload is checked byte by byte."""
        return bool(self.tail_literals or self.tail_numbers)

    @cached_property
    def length(self) -> LengthView | None:
        """The length part."""
        return length_of(self.plan)

    @cached_property
    def told_parts(self) -> tuple[ToldView, ...]:
        """The parts that the decoder is told."""
        return told_of(self.plan, self.names)

    @property
    def told_length(self) -> ToldView | None:
        """The length that the decoder is told, if there is one."""
        return next((part for part in self.told_parts if part.is_length), None)

    @cached_property
    def parts(self) -> tuple[ToldView | PartView, ...]:
        """The parts that events show."""
        member = self.names.member
        sent = (PartView(item, member(item.name), self.numbers) for item in self.plan.shown)
        return (*(part for part in self.told_parts if not part.is_length), *sent)

    @property
    def shows_told(self) -> bool:
        """True if events show what the decoder was told."""
        return any(isinstance(part, ToldView) for part in self.parts)

    @property
    def shows_tail(self) -> bool:
        """True if events show a part from behind the payload."""
        return any(not part.in_head for part in self.parts)

    @property
    def shows_inline(self) -> bool:
        """True if what events show of parts needs no functions."""
        return not any(isinstance(part, PartView) and part.calls for part in self.parts)

    def held_in_content(self, item: ReceivedMessage) -> str:
        """The numbers of the frame that a check takes, out of `content`, as further arguments."""
        values = {part.member: part.value("0") for part in self.parts}
        return "".join(f", {values[number.shown]}" for number in item.numbers)

    @cached_property
    def checksums(self) -> tuple[ChecksumView, ...]:
        """The checksums."""
        return checksums_of(self.plan, self.protocol, self.numbers, self.virtual)

    @cached_property
    def virtual(self) -> tuple[VirtualView, ...]:
        """The parts that are not sent."""
        return virtual_of(self.plan, self.prefix, self.numbers)

    @property
    def announced(self) -> str:
        """The reason where a frame has not the size that was announced."""
        return "SIZE" if self.length is None else "LENGTH"

    # --- identities and sizes of payloads ---------------------------------------------------------

    @property
    def identified(self) -> bool:
        """True if frames have an identity."""
        return bool(self.plan.identity)

    @property
    def key_type(self) -> str:
        """The type of a number that holds the identity."""
        return key_type(self.plan)

    def key(self, parts: str) -> str:
        """The identity of an event's parts, as one number."""
        members = {item.name: parts + self.names.member(item.name) for item in self.plan.identity}
        return self.told(key_from(self.plan, members))

    @property
    def start_key(self) -> str:
        """The identity, where a start of one byte is all of it: made of `byte`."""
        first = self.plan.head[0].part
        if not isinstance(first, BitsPart):
            return self.told("byte")
        names = {part.name: bits_of(part.type, "byte", 8) for part in self.plan.identity}
        return self.told(key_from(self.plan, names))

    @property
    def early_key(self) -> str:
        """The identity, made of bytes of the content, in front of the payload."""
        return self.told(self.key_in_content(""))

    def key_in_content(self, payload: str) -> str:
        """The identity as it stands in `content` or `tail`, with a payload of that size."""
        names = {part.name: part.value(payload) for part in self.parts}
        return key_from(self.plan, names)

    def told(self, key: str) -> str:
        """The identity that stands for all that its message has."""
        return f"{self.prefix}_told({key})" if self.alternatives else key

    @cached_property
    def alternatives(self) -> tuple[Alternatives, ...]:
        """The identities of messages that have several."""
        return alternatives_of(self.plan)

    @cached_property
    def can_open(self) -> bool:
        """True if the payload of some frame has no size until its end is seen."""
        plan = self.plan
        if self.length_over_wire:
            return True
        is_kept_whole = plan.store is not Store.CONTENT or plan.end_begins_start
        if not self.all_events and not is_kept_whole and plan.identity_is_early:
            # What nobody asked for is given up at once: no frame can start inside of it.
            return plan.length is None and plan.has_end and plan.has_open_groups
        return plan.opens

    @property
    def length_over_wire(self) -> bool:
        """True if the length counts stuffed bytes, so that the end of these is known, no sizes."""
        return self.plan.frame.length_over_wire

    @property
    def seeks_end(self) -> bool:
        """True if some frame ends where something is found that is looked for."""
        return self.can_open and not self.length_over_wire

    @property
    def simple(self) -> bool:
        """True if the payload's size is known before the payload begins."""
        return not self.can_open and not self.plan.measures

    @property
    def ends_at_start(self) -> bool:
        """True if some frame ends where the next starts, and nothing else tells."""
        return self.seeks_end and self.plan.ends_at_start

    @property
    def known_from(self) -> int:
        """Bytes of content that tell the payload's size, where the head tells it; else 0."""
        return self.plan.size_known_at or 0

    @property
    def known_by_identity(self) -> bool:
        """True if the identity tells the payload's size."""
        return self.length is None and self.plan.identity_is_early

    @property
    def identity_is_start(self) -> bool:
        """True if a start of one byte is the whole identity, and tells the payload's size."""
        first = self.plan.head[0].part if self.plan.head else None
        is_raw = isinstance(first, NumberPart | BitsPart) and first.type.text is None
        is_first = any(n.identifies and n.last == 0 for n in self.head_numbers)
        is_all = is_first and not self.told_parts
        return self.plan.start is StartRule.SET and is_all and is_raw

    @property
    def identity_is_bits(self) -> bool:
        """True if bytes that are no start may have the bits of an identity."""
        return isinstance(self.plan.head[0].part, BitsPart) if self.plan.head else False

    @property
    def gives_up_high_bytes(self) -> bool:
        """True if a high byte is either the identity of a frame, or ends what goes before it."""
        all_end = self.identity_is_start and self.plan.seven_bit and not self.plan.end_bytes
        if self.identity_is_bits:
            all_end = all_end and len(self.plan.start_set) == 128
        return all_end and self.plan.start_set[0] == 128
