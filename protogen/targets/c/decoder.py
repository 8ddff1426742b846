"""A sender's decoder: what the templates need to know of its frames.

The C code follows `protogen/runtime/machine.py` and `decoder.py`, with everything that a frame does
not need left out. What it keeps of a candidate is one of three things:

- `content`: the unstuffed bytes alone, where no frame can start inside a failed candidate but at
  its very end, so that its bytes are never needed again.
- `wire`: its bytes as they came, where it may have to be scanned again and nothing is stuffed. They
  are the content, too.
- `both`, where a region is stuffed and a candidate may have to be scanned again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from protogen.model.checksums import ChecksumSpec, find_algorithm
from protogen.model.frame import (
    ChecksumPart,
    Cobs,
    CounterPart,
    IdentityPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    ValuePart,
)
from protogen.model.framing import AfterEnd, Anywhere, StartLiteral, StartSet
from protogen.model.messages import Message
from protogen.model.protocol import Sender
from protogen.model.types import storage_bits
from protogen.targets.c.checksums import Checksum, checksum_of
from protogen.targets.c.expressions import (
    number_of,
    octets,
    wire_bytes,
)
from protogen.targets.c.geometry import Geometry, Placed, geometry_of
from protogen.targets.c.payload.messages import MessageView
from protogen.targets.c.spelling import unsigned_type
from protogen.targets.c.stuffing import Code, Node, Stuffing, stuffing_of


@dataclass(frozen=True, slots=True)
class NumberView:
    """A number that is checked as soon as its last byte is there."""

    name: str
    last: int
    """Index of its last byte, from the head's or the tail's first byte."""
    value: str
    """Its value, read from `content`."""
    seven_bit: tuple[int, ...]
    """Offsets of its bytes, where their most significant bit has to be clear."""
    padding: str
    """What has to be zero; empty where all bits belong to the number."""
    is_length: bool
    identifies: bool


@dataclass(frozen=True, slots=True)
class LiteralView:
    """A byte that is fixed."""

    index: int
    byte: str


@dataclass(frozen=True, slots=True)
class PartView:
    """A part that events show."""

    name: str
    type: str
    doc: str
    value: str


@dataclass(frozen=True, slots=True)
class ReceivedMessage:
    """How a receiver tells a message, and whether a payload is its."""

    name: str
    constant: str
    least: int
    greatest: int
    step: int
    checks: str
    """The function that checks a payload; empty where its size says all."""

    @property
    def fixed(self) -> bool:
        """Whether the payload has always the same size."""
        return self.least == self.greatest


@dataclass(frozen=True, slots=True)
class GroupView:
    """The messages of one identity."""

    key: str
    messages: tuple[ReceivedMessage, ...]
    fixed: int | None
    greatest: int
    index: int


@dataclass(frozen=True, slots=True)
class CoverView:
    """A run of content, or a literal, that a checksum covers."""

    first: str
    last: str
    literal: str
    """Bytes of a literal of the end; empty for a run."""
    count: int
    stuffed: bool = False
    """Whether it is stuffed on the wire, and the checksum covers what is there."""


@dataclass(frozen=True, slots=True)
class ChecksumView:
    """A checksum part, as a receiver verifies it."""

    name: str
    checksum: Checksum
    covers: tuple[CoverView, ...]
    at: str
    """Index of its first byte in the content."""
    offset: int
    due: tuple[str, ...]
    """Its bytes, made of `due`."""
    optional: bool
    over_wire: bool

    @property
    def sums_stuffed(self) -> bool:
        """Whether some of what it covers is stuffed on the wire before it is summed."""
        return any(item.stuffed for item in self.covers)


@dataclass(frozen=True, slots=True)
class LengthView:
    """The length part."""

    type: str
    least: int
    greatest: int
    bits: int
    base: int
    """The value for a payload of no bytes."""
    optional: int
    """Bytes that it counts only where there is a payload."""
    payload: int
    """The greatest payload."""

    @property
    def wrapping(self) -> str:
        """The type in which the size of a payload that is too short turns out too great."""
        is_narrow = self.bits <= 8 and self.base + self.payload < 256
        return "uint8_t" if is_narrow else self.type

    @property
    def tests(self) -> tuple[str, ...]:
        """What says that `length`, or the payload's `size` after it, is none that a frame has."""
        most = (1 << (8 if self.wrapping == "uint8_t" else self.bits)) - 1
        found = []
        if self.least > self.base:
            found.append(f"length < {self.least}U")
        if self.greatest < min(self.base + self.payload, (1 << self.bits) - 1):
            found.append(f"length > {self.greatest}U")
        if self.payload < most or self.base:
            found.append(f"size > {self.payload}U")
        return tuple(found)


@dataclass(frozen=True, slots=True)
class FollowStep:
    """How much of a literal the input ends with, behind one byte."""

    byte: str
    matched: int


@dataclass(frozen=True, slots=True)
class Followed:
    """A literal that is tracked byte by byte."""

    name: str
    what: str
    states: tuple[tuple[FollowStep, ...], ...]
    """For each size that was seen before: what the next byte makes of it."""


@dataclass(frozen=True, slots=True)
class DecoderView:
    """Everything that the templates print of a decoder."""

    prefix: str
    upper: str
    protocol: str
    protocol_upper: str
    name: str
    title: str
    geometry: Geometry
    greatest: int
    counter: str
    """The type of sizes."""
    start: str
    """`literal`, `set`, `after_end` or `anywhere`."""
    start_protected: bool
    least_start: int
    greatest_start: int
    start_bytes: str
    end_bytes: str
    end_protected: bool
    store: str
    stuffing: Stuffing | None
    region_begin: str
    region_end: str
    region_can_be_empty: bool
    region_to_end: bool
    """Whether nothing but the end stands behind the stuffed region, which begins in the head."""
    head_literals: tuple[LiteralView, ...]
    head_numbers: tuple[NumberView, ...]
    tail_literals: tuple[LiteralView, ...]
    tail_numbers: tuple[NumberView, ...]
    length: LengthView | None
    groups: tuple[GroupView, ...]
    key_type: str
    key: str
    early_key: str
    """The key, made of bytes of the content."""
    parts: tuple[PartView, ...]
    checksums: tuple[ChecksumView, ...]
    announced: str
    seven_bit: bool
    can_open: bool
    can_measure: bool
    ends_at_start: bool
    all_events: bool
    """Whether invalid bytes and unknown frames are delivered too."""

    @property
    def head_size(self) -> int:
        """Bytes in front of the payload."""
        return self.geometry.head_size

    @property
    def tail_size(self) -> int:
        """Bytes behind a payload."""
        return self.geometry.tail_size

    @property
    def optional_size(self) -> int:
        """Bytes of the tail that are absent where the payload is empty."""
        return self.geometry.optional_size

    @property
    def start_size(self) -> int:
        """Bytes of the start literal."""
        return len(self.geometry.start)

    @property
    def end_size(self) -> int:
        """Bytes of the end literal."""
        return len(self.geometry.end)

    @property
    def shares(self) -> bool:
        """Whether an end may be the next frame's start."""
        return self.geometry.shares_delimiter

    @property
    def searches(self) -> bool:
        """Whether a delimiter is looked for inside candidates, from the start or later."""
        return self.end_protected or (self.can_open and self.start != "anywhere")

    @property
    def delimiter(self) -> bytes:
        """What is looked for."""
        return self.geometry.end or self.geometry.start

    @property
    def keeps_wire(self) -> bool:
        """Whether candidates can be scanned again."""
        return self.store != "content"

    @property
    def matches(self) -> bytes:
        """The literal that is tracked byte by byte to find starts."""
        return self.geometry.end if self.start == "after_end" else self.geometry.start

    @property
    def literals(self) -> tuple[Followed, ...]:
        """The literals of several bytes that are tracked."""
        tracked = {"end" if self.start == "after_end" else "start": self.matches}
        if self.searches:
            tracked["end" if self.geometry.end else "start"] = self.delimiter
        return tuple(_followed(name, item) for name, item in tracked.items() if len(item) > 1)

    @property
    def simple(self) -> bool:
        """Whether the payload's size is known before the payload begins."""
        return not self.can_open and not self.can_measure

    @property
    def has_flags(self) -> bool:
        """Whether a candidate has more states than its counters say."""
        return not self.simple or (self.stuffing is not None and self.stuffing.kind == "cobs")

    @property
    def counts_wire(self) -> bool:
        """Whether it matters how many bytes a candidate has on the wire."""
        if self.all_events or self.keeps_wire or not self.simple or self.shares:
            return True
        return self.start not in ("literal", "set")

    @property
    def keeps_behind(self) -> bool:
        """Whether it matters that a candidate's last bytes are not its own."""
        return self.all_events or self.keeps_wire or self.ends_at_start or self.start == "set"

    @property
    def keeps_match(self) -> bool:
        """Whether a start or an end takes several bytes, or was seen before it matters."""
        return len(self.matches) > 1 or self.start == "after_end"

    @property
    def decides_later(self) -> bool:
        """Whether the bytes behind a failed candidate may tell that its last ones are a start."""
        return (
            self.all_events
            and not self.keeps_wire
            and self.start == "literal"
            and self.start_size > 1
        )

    @property
    def awaits_end(self) -> bool:
        """Whether the end is due in one place, and not looked for."""
        return bool(self.geometry.end) and not self.end_protected

    @property
    def start_decides(self) -> bool:
        """Whether a candidate may be over with its start."""
        least = self.geometry.sender.framing.least
        return self.start == "set" or least <= self.start_size

    @property
    def content_size(self) -> int:
        """Bytes there is room for in a frame without its stuffing."""
        return self.greatest if self.store == "both" else self.buffer_size

    @property
    def known_from(self) -> int:
        """How many bytes of content tell the payload's size, where that is simple."""
        return next((n.last + 1 for n in self.head_numbers if n.is_length or n.identifies), 0)

    @property
    def unlimited(self) -> str:
        """What bounds a payload or all content while its size is unknown: the room for it."""
        size = self.content_size
        return str(size - self.head_size - self.tail_size if self.simple else size) + "U"

    @property
    def first_head(self) -> int:
        """Bytes of a start."""
        return self.start_size if self.start == "literal" else 1

    @property
    def known_by_identity(self) -> bool:
        """Whether the identity tells the payload's size."""
        return self.length is None and self.geometry.early_identity

    @property
    def always_known(self) -> bool:
        """Whether every frame that gets to its end is a message."""
        messages = [message for group in self.groups for message in group.messages]
        return self.known_by_identity and not any(message.checks for message in messages)

    @property
    def early_at_start(self) -> bool:
        """Whether a start of one byte is the whole identity, and tells the payload's size."""
        return self.start == "set" and any(n.identifies and n.last == 0 for n in self.head_numbers)

    @property
    def start_completes(self) -> bool:
        """Whether some frame is a start and nothing else."""
        around = self.head_size + self.tail_size
        return any(group.fixed == 0 and around == self.first_head for group in self.groups)

    @property
    def escape_starts(self) -> bool:
        """Whether delimiters are told by the nodes of the stuffing.

        They have two bytes, the first of which always leads to a node that ends with it.
        """
        delimiters = [self.geometry.start, *filter(None, [self.geometry.end])]
        stuffing = self.stuffing
        if stuffing is None or stuffing.kind != "codes" or any(len(d) != 2 for d in delimiters):
            return False
        first = delimiters[0][0]
        seconds = {delimiter[1] for delimiter in delimiters}
        taken = {branch.byte for node in self.escape_nodes for branch in node.branches}
        return (
            all(delimiter[0] == first for delimiter in delimiters)
            and len(seconds) == len(delimiters)
            and first not in seconds
            and any(node.beginning == bytes((first,)) for node in stuffing.nodes)
            and not any(code.sequence[-1] == first for code in stuffing.codes)
            and not taken & seconds
        )

    @property
    def escape_nodes(self) -> tuple[Node, ...]:
        """The nodes behind a delimiter's first byte, the one behind nothing else first."""
        nodes = () if self.stuffing is None else self.stuffing.nodes
        return tuple(node for node in nodes if node.beginning.endswith(self.geometry.start[:1]))

    @property
    def flat(self) -> bool:
        """Whether a candidate needs no more states than how much of it is there.

        It begins with a protected start, tells its size in its head, and nobody asks what was wrong
        with it: a byte of a start is always one, and whatever does not fit is given up.
        """
        end = len(self.geometry.end)
        single = self.first_head == 1 and end <= 1
        return (
            not self.all_events
            and self.store == "content"
            and self.start in ("literal", "set")
            and self.start_protected
            and (single or self.escape_starts)
            and (not end or self.end_protected)
            and self.simple
            and self.known_from > 0
            and not self.shares
            and not self.optional_size
            and not (self.seven_bit and not self._high_bytes_show)
            and not self.tail_literals
            and not self.tail_numbers
            and not any(n.last < self.first_head for n in self.head_numbers if not n.identifies)
            and self._is_stuffed_flatly
        )

    @property
    def only_size(self) -> int | None:
        """The payload's size where a flat decoder knows messages of one fixed size alone.

        Frames of other sizes are given up where they tell their size: nobody asks for them, and no
        frame can start inside of them.
        """
        sizes = {group.fixed if len(group.messages) == 1 else None for group in self.groups}
        return sizes.pop() if self.flat and len(sizes) == 1 else None

    @property
    def idle_member(self) -> str:
        """The counter of a flat decoder that says that no candidate is open.

        No byte gets into a candidate whose limit is nought, which is the shortest test; but only
        where a limit is all that is in front of it can that not be mistaken for a payload's size.
        """
        is_size = self.head_size + self.tail_size > self.first_head
        return "content" if is_size or self.only_size is not None else "limit"

    @property
    def idle_value(self) -> int:
        """What that counter is then: nothing, or more than there is room for.

        A frame that is complete but for its end has no room either, which is the same test.
        """
        is_bounded = self.only_size is not None and not self.end_size
        return 0 if is_bounded or self.idle_member == "limit" else self.buffer_size + 1

    @property
    def gives_up_high_bytes(self) -> bool:
        """Whether a high byte is either the identity of a frame, or ends what goes before it."""
        all_end = self.early_at_start and self.seven_bit and not self.end_size
        return all_end and self.least_start == 128

    @property
    def _high_bytes_show(self) -> bool:
        """Whether no byte with its most significant bit set can get into a payload unseen."""
        return self.gives_up_high_bytes or set(range(128, 256)) <= set(self.never_passed)

    @property
    def _is_stuffed_flatly(self) -> bool:
        if self.stuffing is None:
            return True
        kinds = ("codes", "lenient_escape", "base16")
        begins = self.region_begin == f"{self.first_head}U"
        return self.region_to_end and begins and self.stuffing.kind in kinds

    @property
    def whole(self) -> bool:
        """Whether `feed` can take a whole frame at once, where one stands in the input."""
        if self.stuffing is not None and (
            self.stuffing.kind != "codes"
            or not self._is_stuffed_flatly
            or len(self.specials) > 5
            or any(len(code.sequence) < 2 for code in self.stuffing.codes)
        ):
            return False
        return (
            self.store in ("content", "wire")
            and self.start in ("literal", "set")
            and self.known_from > 0
            and (self.length is not None or any(g.fixed is not None for g in self.groups))
            and not self.shares
            and not self.optional_size
            and not self.tail_literals
            and not self.tail_numbers
            and not (self.start_protected and self.stuffing is None and not self._starts_show)
        )

    @property
    def takes_content(self) -> bool:
        """Whether a frame may be delivered from where it stands in the input."""
        return self.whole and self.stuffing is None

    @property
    def _starts_show(self) -> bool:
        """Whether a frame with a start inside is never taken, without a search for starts."""
        return self.gives_up_high_bytes and self.head_size == 1 and not self.tail_size

    @property
    def specials(self) -> tuple[int, ...]:
        """The bytes of a stuffed region that do not stand for themselves, or begin a delimiter."""
        assert self.stuffing is not None
        root = self.stuffing.nodes[0]
        starts = set(self.never_passed) if self.start == "set" else set(self.geometry.start[:1])
        taken = {branch.byte for branch in root.branches} | set(root.refused)
        return tuple(sorted(taken | starts | set(self.geometry.end[:1])))

    def codes_from(self, byte: int) -> tuple[Code, ...]:
        """The sequences of the stuffing that begin with a byte, the longest first."""
        codes = () if self.stuffing is None else self.stuffing.codes
        found = [code for code in codes if code.sequence[0] == byte]
        return tuple(sorted(found, key=lambda code: -len(code.sequence)))

    @property
    def never_passed(self) -> tuple[int, ...]:
        """Bytes that are a start or an end by themselves, so that nothing else sees them."""
        if self.start == "set":
            starts = list(range(self.least_start, self.greatest_start + 1))
        else:
            starts = list(self.geometry.start)
        return (*starts, *self.geometry.end)

    @property
    def keeps_start(self) -> bool:
        """Whether something reads the start's bytes again."""
        covers = [cover for item in self.checksums for cover in item.covers if not cover.literal]
        firsts = [cover.first for cover in covers]
        return self.start == "set" or any(
            first == f"{index}U" for first in firsts for index in range(self.first_head)
        )

    @property
    def flat_heads(self) -> bool:
        """Whether something behind the start, in front of the payload, is looked at."""
        indices = [item.index for item in self.head_literals] + [n.last for n in self.head_numbers]
        return any(index >= self.first_head for index in indices)

    @property
    def tail_parts(self) -> bool:
        """Whether events show a part from behind the payload."""
        return any("tail[" in part.value for part in self.parts)

    @property
    def wire_ends(self) -> bool:
        """Whether a checksum covers stuffed bytes, so that their places are kept."""
        over_wire = [cover for item in self.checksums if item.over_wire for cover in item.covers]
        return self.store == "both" and any(not cover.literal for cover in over_wire)

    @property
    def sees_content(self) -> bool:
        """Whether something is done with a byte of content besides counting it."""
        looks = self.head_size or self.seven_bit or self.tail_literals or self.tail_numbers
        return self.store != "wire" or bool(looks)

    @property
    def buffer_size(self) -> int:
        """Bytes of the buffer."""
        if self.keeps_wire:
            return self.greatest + max(self.start_size - 1, 0)
        content = self.head_size + self.geometry.sender.framing.payload.greatest + self.tail_size
        return self.greatest if self.length is None else min(self.greatest, content)


def decoder_view(
    protocol: str,
    sender: Sender,
    title: str,
    views: Mapping[str, MessageView],
    *,
    all_events: bool = True,
) -> DecoderView:
    """The view of a sender's decoder; `views` has the messages that were chosen."""
    return _Builder(protocol, sender, title, views, all_events).view()


class _Builder:
    def __init__(
        self,
        protocol: str,
        sender: Sender,
        title: str,
        views: Mapping[str, MessageView],
        all_events: bool,
    ) -> None:
        self._all_events = all_events
        self._protocol = protocol
        self._sender = sender
        self._title = title
        self._views = views
        self._geometry = geometry_of(sender)
        self._prefix = f"{protocol}_{sender.name}"

    def view(self) -> DecoderView:
        geometry, framing = self._geometry, self._sender.framing
        start = framing.start
        around = geometry.head_size + geometry.tail_size + len(geometry.start) + len(geometry.end)
        bits = _counter_bits(framing.greatest + around)
        head = self._numbers(geometry.head)
        groups = self._groups()
        is_open, measures = self._opens(groups), self._measures(groups)
        end = framing.end
        return DecoderView(
            prefix=self._prefix,
            upper=self._prefix.upper(),
            protocol=self._protocol,
            protocol_upper=self._protocol.upper(),
            name=self._sender.name,
            title=self._title,
            geometry=geometry,
            greatest=framing.greatest,
            counter=f"uint{bits}_t",
            start=_start_kind(start),
            start_protected=isinstance(start, StartLiteral | StartSet) and start.protected,
            least_start=start.least if isinstance(start, StartSet) else 0,
            greatest_start=start.greatest if isinstance(start, StartSet) else 0,
            start_bytes=octets(geometry.start),
            end_bytes=octets(geometry.end),
            end_protected=end is not None and end.protected,
            store=self._store(),
            stuffing=self._stuffing(),
            region_begin=self._region(first=True),
            region_end=self._region(first=False),
            region_can_be_empty=self._region_can_be_empty(),
            region_to_end=self._region_to_end(),
            head_literals=_literals(geometry.head),
            head_numbers=head,
            tail_literals=_literals(geometry.tail),
            tail_numbers=self._numbers(geometry.tail),
            length=self._length(),
            groups=groups,
            key_type=self._key_type(),
            key=self._key(),
            early_key=self._early_key(),
            parts=self._parts(),
            checksums=self._checksum_views(),
            announced="SIZE" if geometry.length is None else "LENGTH",
            seven_bit=framing.seven_bit,
            can_open=is_open,
            can_measure=measures,
            all_events=self._all_events,
            ends_at_start=is_open and not geometry.end and not isinstance(start, Anywhere),
        )

    # --- what is kept ---------------------------------------------------------------------------

    def _stuffing(self) -> Stuffing | None:
        transparency = self._sender.frame.transparency
        return None if transparency is None else stuffing_of(transparency)

    def _store(self) -> str:
        if self._sender.frame.transparency is None:
            return "wire" if self._scans_again() else "content"
        over_wire = any(part.over_wire for part in self._sender.frame.checksums)
        return "both" if over_wire or self._scans_again() else "content"

    def _scans_again(self) -> bool:
        """Whether a frame can start inside a failed candidate, before its end."""
        start, end = self._sender.framing.start, self._sender.framing.end
        geometry = self._geometry
        match start:
            case StartLiteral():
                alone = not geometry.shares_delimiter
                protected = end is not None and end.protected and _has_no_border(geometry.end)
                return not (start.protected if alone else protected)
            case StartSet():
                return not start.protected
            case AfterEnd():
                return end is None or not end.protected or not _has_no_border(end.bytes)
        return True

    # --- the stuffed region ---------------------------------------------------------------------

    def _region(self, *, first: bool) -> str:
        transparency = self._sender.frame.transparency
        if transparency is None:
            return ""
        placed = self._geometry.placed(transparency.first if first else transparency.last)
        if placed is None:
            return self._behind_head(0 if first else None)
        offset = placed.offset if first else placed.end
        if self._geometry.is_head(placed):
            return f"{offset}U"
        return self._tail_place(offset)

    def _behind_head(self, offset: int | None) -> str:
        if offset == 0:
            return f"{self._geometry.head_size}U"
        return f"{self._geometry.head_size}U + decoder->payload"

    def _tail_place(self, offset: int) -> str:
        """A place in the tail, counted in content."""
        absent = sum(p.size for p in self._geometry.tail if p.is_optional and p.offset < offset)
        base = self._geometry.head_size
        if not absent:
            return f"{base + offset}U + decoder->payload"
        return (
            f"{base}U + decoder->payload + "
            f"(decoder->payload == 0U ? {offset - absent}U : {offset}U)"
        )

    def _region_can_be_empty(self) -> bool:
        """Whether all of the region's parts can be absent."""
        transparency = self._sender.frame.transparency
        if transparency is None:
            return False
        names = [part.name for part in self._sender.frame.parts]
        run = names[names.index(transparency.first) : names.index(transparency.last) + 1]
        placed = [self._geometry.placed(name) for name in run]
        return all(item is None or item.is_optional for item in placed)

    def _region_to_end(self) -> bool:
        transparency = self._sender.frame.transparency
        if transparency is None or self._region_can_be_empty():
            return False
        parts = [*self._geometry.head, *self._geometry.tail]
        last = self._geometry.tail[-1].part.name if self._geometry.tail else None
        begins = self._geometry.placed(transparency.first)
        in_head = begins is not None and self._geometry.is_head(begins)
        is_payload = begins is None
        # Where no end is looked for, the region's own end has to be seen to fit.
        end = self._sender.framing.end
        is_sought = end is not None and end.protected
        may_not_fit = isinstance(transparency.encoding, Cobs) or transparency.lenient
        if may_not_fit and not is_sought:
            return False
        ends = transparency.last == last or (
            last is None and self._geometry.placed(transparency.last) is None
        )
        return bool(parts) and (in_head or is_payload) and ends

    # --- parts ------------------------------------------------------------------------------------

    def _numbers(self, items: tuple[Placed, ...]) -> tuple[NumberView, ...]:
        found = []
        for item in items:
            part = item.part
            if isinstance(part, NumberPart):
                view = self._number(item, part)
                if view.seven_bit or view.padding or view.is_length or view.identifies:
                    found.append(view)
        return tuple(found)

    def _number(self, item: Placed, part: NumberPart) -> NumberView:
        type_ = part.type
        spare = type_.byte_bits * type_.size - type_.bits
        value = number_of(type_, "content", item.offset, self._absent(item))
        identity = self._sender.frame.identity
        return NumberView(
            name=part.name,
            last=item.end - 1,
            value=value,
            seven_bit=tuple(range(item.offset, item.end)) if type_.byte_bits == 7 else (),
            padding=f"{value} >> {type_.bits}" if spare else "",
            is_length=isinstance(part, LengthPart),
            identifies=self._geometry.early_identity
            and part is identity[-1]
            and self._geometry.length is None,
        )

    def _absent(self, item: Placed) -> str:
        """What has to be taken off the offset of a part of the tail where the payload is empty."""
        if self._geometry.is_head(item):
            return ""
        tail = self._geometry.tail
        absent = sum(other.size for other in tail if other.is_optional and other.end <= item.offset)
        return f" - (decoder->payload == 0U ? {absent}U : 0U)" if absent else ""

    def _length(self) -> LengthView | None:
        part = self._geometry.length
        if part is None:
            return None
        counted = [self._geometry.placed(name) for name in part.counts]
        ends = [
            len(other.bytes)
            for other in self._sender.frame.parts
            if isinstance(other, LiteralPart)
            and other.name in part.counts
            and self._geometry.placed(other.name) is None
        ]
        fixed = sum(item.size for item in counted if item is not None and not item.is_optional)
        optional = sum(item.size for item in counted if item is not None and item.is_optional)
        held = part.type.byte_bits * part.type.size
        return LengthView(
            type=unsigned_type(max(held, 16)),
            least=part.least,
            greatest=min(part.greatest, (1 << held) - 1),
            bits=held,
            base=fixed + sum(ends),
            optional=optional,
            payload=self._sender.framing.payload.greatest,
        )

    def _parts(self) -> tuple[PartView, ...]:
        shown = (IdentityPart, CounterPart, ValuePart)
        found = []
        for item in (*self._geometry.head, *self._geometry.tail):
            if isinstance(item.part, shown):
                in_head = self._geometry.is_head(item)
                at = "content" if in_head else "tail"
                found.append(
                    PartView(
                        item.part.name,
                        unsigned_type(item.part.type.bits),
                        item.part.about.doc,
                        _narrowed(
                            item.part,
                            number_of(item.part.type, at, item.offset, self._absent(item)),
                        ),
                    )
                )
        return tuple(found)

    def _shown(self, item: Placed, at: str) -> str:
        assert isinstance(item.part, NumberPart)
        value = number_of(item.part.type, at, item.offset, self._absent(item))
        return _narrowed(item.part, value)

    # --- messages -------------------------------------------------------------------------------

    def _key_type(self) -> str:
        bits = sum(part.type.bits for part in self._sender.frame.identity)
        return unsigned_type(max(bits, 8))

    def _key(self) -> str:
        """All identity parts in one number."""
        return self._key_from(
            {part.name: f"parts->{part.name}" for part in self._geometry.identities()}
        )

    def _key_from(self, values: Mapping[str, str]) -> str:
        parts = self._sender.frame.identity
        type_ = self._key_type()
        shift = sum(part.type.bits for part in parts)
        terms = []
        for part in parts:
            shift -= part.type.bits
            value = values[part.name]
            terms.append(f"({type_})(({type_}){value} << {shift})" if shift else value)
        return f"({type_})({' | '.join(terms)})" if len(terms) > 1 else "".join(terms)

    def _early_key(self) -> str:
        if not self._geometry.early_identity:
            return ""
        values = {part.name: part.value for part in self._parts()}
        return self._key_from(
            {part.name: values[part.name] for part in self._geometry.identities()}
        )

    def _key_of(self, identity: tuple[int, ...]) -> str:
        parts = self._sender.frame.identity
        key = 0
        for part, value in zip(parts, identity, strict=True):
            key = key << part.type.bits | value
        bits = sum(part.type.bits for part in parts)
        digits = storage_bits(max(bits, 8))
        return f"UINT{digits}_C(0x{key:0{max(2, -(-bits // 4))}X})"

    def _groups(self) -> tuple[GroupView, ...]:
        hidden = {
            name
            for overload in self._sender.overloads
            if overload.yields is not None
            for name in overload.messages
            if name != overload.yields
        }
        groups: dict[tuple[int, ...], list[Message]] = {}
        for message in self._sender.messages:
            if message.name not in hidden and message.name in self._views:
                groups.setdefault(message.identity, []).append(message)
        return tuple(
            self._group(index, key, items) for index, (key, items) in enumerate(groups.items())
        )

    def _group(self, index: int, identity: tuple[int, ...], messages: list[Message]) -> GroupView:
        sizes = {message.sizes.fixed for message in messages}
        return GroupView(
            key=self._key_of(identity),
            messages=tuple(self._message(message) for message in messages),
            fixed=sizes.pop() if len(sizes) == 1 else None,
            greatest=max(message.sizes.greatest for message in messages),
            index=index,
        )

    def _message(self, message: Message) -> ReceivedMessage:
        view = self._views[message.name]
        return ReceivedMessage(
            message.name,
            view.constant,
            message.sizes.least,
            message.sizes.greatest,
            message.sizes.step,
            view.check if self._needs_check(view) else "",
        )

    def _needs_check(self, view: MessageView) -> bool:
        """Whether a payload of a right size can still be none of the message's.

        Where all bytes carry seven bits, they were looked at one by one when they came.
        """
        if view.fixed is None or not self._sender.framing.seven_bit:
            return view.checks
        return view.checks and view.checks_values

    def _opens(self, groups: tuple[GroupView, ...]) -> bool:
        """Whether the payload of some frame has no size until its end is seen."""
        if self._geometry.length is not None:
            return False
        if not self._all_events and self._store() == "content" and self._geometry.early_identity:
            # What nobody asked for is given up at once: no frame can start inside of it.
            return bool(self._geometry.end) and any(group.fixed is None for group in groups)
        if not self._sender.frame.identity:
            return bool(self._geometry.end) and any(group.fixed is None for group in groups)
        if not self._geometry.early_identity:
            return True
        return True  # An unknown identity says nothing of the size.

    def _measures(self, groups: tuple[GroupView, ...]) -> bool:
        if self._geometry.length is not None or self._geometry.end:
            return False
        return any(group.fixed is None for group in groups)

    # --- checksums ------------------------------------------------------------------------------

    def _checksum_views(self) -> tuple[ChecksumView, ...]:
        return tuple(self._checksum(part) for part in self._sender.frame.checksums)

    def _checksum(self, part: ChecksumPart) -> ChecksumView:
        placed = self._geometry.placed(part.name)
        assert placed is not None
        in_head = self._geometry.is_head(placed)
        return ChecksumView(
            name=part.name,
            checksum=checksum_of(part.algorithm, checksum_name(self._protocol, part.algorithm)),
            covers=self._covers(part),
            at=str(placed.offset) if in_head else self._tail_place(placed.offset),
            offset=placed.offset,
            due=wire_bytes(part.type, "due"),
            optional=part.when_payload,
            over_wire=part.over_wire,
        )

    def _covers(self, part: ChecksumPart) -> tuple[CoverView, ...]:
        """Runs of content, neighbours joined."""
        found: list[CoverView] = []
        for name in part.covers:
            view = replace(
                self._cover(name), stuffed=part.over_wire and name in self._geometry.stuffed
            )
            last = found[-1] if found else None
            if (
                last
                and last.last == view.first
                and not view.literal
                and last.stuffed == view.stuffed
            ):
                found[-1] = replace(last, last=view.last)
            else:
                found.append(view)
        return tuple(found)

    def _cover(self, name: str) -> CoverView:
        placed = self._geometry.placed(name)
        if placed is not None and self._geometry.is_head(placed):
            return CoverView(f"{placed.offset}U", f"{placed.end}U", "", 0)
        if placed is not None:
            first = f"{self._tail_place(placed.offset)}"
            return CoverView(first, f"{self._tail_place(placed.end)}", "", 0)
        part = self._sender.frame.part(name)
        if isinstance(part, LiteralPart):
            return CoverView("", "", octets(part.bytes), len(part.bytes))
        head = self._geometry.head_size
        return CoverView(f"{head}U", f"{head}U + decoder->payload", "", 0)


def _narrowed(part: NumberPart, value: str) -> str:
    """The value in the type of its bits, which its wire bytes may have more of."""
    type_ = part.type
    wide = storage_bits(type_.byte_bits * type_.size)
    return value if wide <= type_.width else f"({unsigned_type(type_.bits)})({value})"


def checksum_name(protocol: str, spec: ChecksumSpec) -> str:
    """The name of the C function of an algorithm."""
    name = spec.name
    if find_algorithm(name) != spec:  # The schema gives the parameters.
        order = f"{'r' if spec.refin else 'n'}{'r' if spec.refout else 'n'}"
        name = f"crc_{spec.width}_{spec.poly:x}_{spec.init:x}_{order}_{spec.xorout:x}"
    letters = "".join(c if c.isalnum() else "_" for c in name.lower())
    return f"{protocol}_{letters}".replace("__", "_")


def _followed(name: str, literal: bytes) -> Followed:
    states = tuple(_steps(literal, matched) for matched in range(len(literal) + 1))
    return Followed(name, f"the {name}", states)


def _steps(literal: bytes, matched: int) -> tuple[FollowStep, ...]:
    """For each byte that goes on with some of the literal: how much of it stands there then."""
    found = []
    for byte in dict.fromkeys(literal):
        seen = literal[:matched] + bytes((byte,))
        sizes = range(min(len(seen), len(literal)), 0, -1)
        longest = next((size for size in sizes if seen.endswith(literal[:size])), 0)
        if longest:
            found.append(FollowStep(f"0x{byte:02X}", longest))
    return tuple(found)


def _counter_bits(greatest: int) -> int:
    """The width of what counts bytes of a candidate, and a few bytes behind it."""
    return next(bits for bits in (8, 16, 32) if greatest < (1 << bits) - 4)


def _start_kind(start: object) -> str:
    match start:
        case StartLiteral():
            return "literal"
        case StartSet():
            return "set"
        case AfterEnd():
            return "after_end"
    return "anywhere"


def _literals(items: tuple[Placed, ...]) -> tuple[LiteralView, ...]:
    return tuple(
        LiteralView(item.offset + index, f"0x{byte:02X}")
        for item in items
        if isinstance(item.part, LiteralPart)
        for index, byte in enumerate(item.part.bytes)
    )


def _has_no_border(literal: bytes) -> bool:
    """Whether no beginning of the literal is also an end of it."""
    return not any(literal.endswith(literal[:size]) for size in range(1, len(literal)))
