"""Frame plan of a sender: how its frame is laid out, found, and taken.

Works out the frame plan from the frame's parts and its framing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

from protogen.model.frame import Frame
from protogen.model.frame_places import Place, PlacedPart, Run, Side
from protogen.model.frame_plan import EndRule, FramePlan, StartRule
from protogen.model.framing import AfterEnd, Anywhere, Framing, StartLiteral, StartSet
from protogen.model.identities import Identities
from protogen.model.messages import Message, Overload
from protogen.model.part_plans import (
    ChecksumPlan,
    FurtherLength,
    IdentityGroup,
    LengthPlan,
    StuffedRegion,
    VirtualPlan,
)
from protogen.model.parts import (
    ChecksumPart,
    LengthPart,
    LiteralPart,
    Part,
    PayloadPart,
    VirtualPart,
    written_apart,
)
from protogen.model.transparency import Base16, Cobs, Encoding, Escape, Insertion, Substitution
from protogen.passes.framing.capacity import counted_size, tail_literals
from protogen.passes.framing.transparencies import beginning_in

_START_RULES = {
    StartLiteral: StartRule.LITERAL,
    StartSet: StartRule.SET,
    AfterEnd: StartRule.AFTER_END,
    Anywhere: StartRule.ANYWHERE,
}


def plan_frame(
    frame: Frame,
    framing: Framing,
    messages: Sequence[Message],
    overloads: Sequence[Overload],
) -> FramePlan:
    """The plan of a sender's frame."""
    virtual = tuple(_virtual(part, messages) for part in frame.virtual)
    return _Planner(frame, framing).plan(identity_groups(frame, messages, overloads), virtual)


def _virtual(part: VirtualPart, messages: Sequence[Message]) -> VirtualPlan:
    """Values of a part that is not sent; messages that share an identity have the same."""
    values = {message.told_by: message.virtual_value(part) for message in messages}
    known = tuple((key, value) for key, value in values.items() if value is not None)
    return VirtualPlan(part=part, values=known)


def identity_groups(
    frame: Frame, messages: Sequence[Message], overloads: Sequence[Overload]
) -> tuple[IdentityGroup, ...]:
    """The messages that a receiver can yield, by identity.

    Of messages that nothing tells apart, it yields the one that the overload names.
    """
    found: dict[Identities, list[Message]] = {}
    hidden = set().union(*(overload.hidden for overload in overloads))
    for message in messages:
        if message.name not in hidden:
            found.setdefault(message.told_by, []).append(message)
    return tuple(_group(frame, identities, group) for identities, group in found.items())


def _group(frame: Frame, identities: Identities, messages: Sequence[Message]) -> IdentityGroup:
    return IdentityGroup(
        identity=identities.first,
        key=frame.key(identities.first),
        messages=tuple(messages),
        sizes=tuple(
            frame.payload.carried(message.sizes, can_be_cut=message.can_be_cut)
            for message in messages
        ),
        identities=identities if identities.count > 1 else None,
    )


class _Planner:
    def __init__(self, frame: Frame, framing: Framing) -> None:
        self._frame = frame
        self._framing = framing
        start, end = framing.start, framing.end
        self._start = start
        self._start_bytes = start.bytes if isinstance(start, StartLiteral) else b""
        self._unique_start = isinstance(start, StartLiteral | StartSet) and start.protected
        self._end_bytes = b"" if end is None else end.bytes
        self._unique_end = end is not None and end.protected
        self._shares = self._unique_end and self._start_bytes == self._end_bytes
        self._end_literals = () if end is None else tail_literals(frame)
        self._content = frame.parts[: len(frame.parts) - len(self._end_literals)]
        self._payload_index = next(
            i for i, part in enumerate(self._content) if isinstance(part, PayloadPart)
        )
        self._head = tuple(self._place(Side.HEAD, self._content[: self._payload_index]))
        self._tail = tuple(self._place(Side.TAIL, self._content[self._payload_index + 1 :]))
        self._head_size = sum(item.size for item in self._head)

    def plan(
        self, groups: tuple[IdentityGroup, ...], virtual: tuple[VirtualPlan, ...]
    ) -> FramePlan:
        framing = self._framing
        length = self._length()
        return FramePlan(
            frame=self._frame,
            start=_START_RULES[type(self._start)],
            start_bytes=self._start_bytes,
            start_words=self._start_words(),
            start_is_unique=self._unique_start,
            end_rule=self._end_rule(),
            end_bytes=self._end_bytes,
            end_is_unique=self._unique_end,
            head=self._head,
            tail=self._tail,
            end_literals=self._end_literals,
            length=length,
            further_lengths=tuple(self._further_lengths(length)),
            checksums=tuple(self._checksum(part) for part in self._frame.checksums),
            virtual=virtual,
            region=self._region,
            groups=groups,
            payload=framing.payload,
            least=framing.least,
            greatest=framing.greatest,
            seven_bit=framing.seven_bit,
            rescans=self._rescans(),
            is_regular=self._is_regular,
            takes_whole=self._takes_whole(),
            streams=self._streams(),
            cut_ambiguous=framing.cut_ambiguous,
            is_cut_off=framing.is_cut_off,
        )

    # --- parts ------------------------------------------------------------------------------------

    def _place(self, side: Side, parts: Sequence[Part]) -> Iterator[PlacedPart]:
        offset = absent = 0
        for part in parts:
            yield PlacedPart(part, Place(side, offset, absent), part.name in self._stuffed)
            offset += part.size
            absent += part.size if part.is_optional else 0

    def _placed(self, name: str) -> PlacedPart | None:
        """The part of that name; None for the payload and for literals of the end."""
        return next((item for item in (*self._head, *self._tail) if item.name == name), None)

    def _bounds(self, name: str) -> tuple[Place, Place]:
        """Begin and end of a part of the content."""
        item = self._placed(name)
        if item is None:
            return Place(Side.HEAD, self._head_size), Place(Side.TAIL, 0)
        return item.place, item.end_place

    def _length(self) -> LengthPlan | None:
        part = self._frame.length
        if part is None:
            return None
        base, optional = self._counted(part)
        if not part.over_wire:
            return LengthPlan(part=part, base=base, optional=optional)
        names = [item.name for item in self._frame.parts]
        last = max(names.index(name) for name in self._stuffed)
        others = sum(item.size for item in self._frame.parts if item.name not in part.counts)
        return LengthPlan(
            part=part,
            base=base,
            optional=optional,
            region_end=sum(item.size for item in self._frame.parts[: last + 1]),
            most=min(part.greatest, self._framing.greatest - others),
        )

    def _counted(self, part: LengthPart) -> tuple[int, int]:
        """What a length counts of an empty payload's frame, and besides that of any other one's."""
        base = counted_size(self._frame, part, empty=True)
        return base, counted_size(self._frame, part, empty=False) - base

    def _further_lengths(self, first: LengthPlan | None) -> Iterator[FurtherLength]:
        """The lengths behind the first one."""
        for part in self._frame.lengths[1:]:
            assert first is not None
            placed = self._placed(self._frame.holder(part.name).name)
            assert placed is not None
            base, optional = self._counted(part)
            yield FurtherLength(part=part, placed=placed, first=first, base=base, optional=optional)

    # --- start and end ----------------------------------------------------------------------------

    def _start_words(self) -> tuple[bytes, ...]:
        start = self._start
        if isinstance(start, StartSet):
            return start.words
        return tuple(filter(None, (self._start_bytes,)))

    def _end_rule(self) -> EndRule:
        if self._frame.silence is not None:
            return EndRule.IDLE
        if self._unique_end:
            return EndRule.DELIMITER
        if self._stuffed and self._unique_start and not self._end_bytes:
            return EndRule.NEXT_START
        return EndRule.IDENTITY if self._frame.length is None else EndRule.LENGTH

    def _rescans(self) -> bool:
        if self._frame.silence is not None:
            return True
        end_is_final = self._unique_end and not beginning_in(self._end_bytes, self._end_bytes[1:])
        match self._start:
            case StartLiteral():
                return not (end_is_final if self._shares else self._unique_start)
            case StartSet():
                return not self._unique_start
            case AfterEnd():
                return not end_is_final
        return True

    # --- the stuffed region -----------------------------------------------------------------------

    @cached_property
    def _stuffed(self) -> tuple[str, ...]:
        """The parts of the content that are stuffed."""
        stuffed = self._frame.stuffed
        return tuple(part.name for part in self._content if part.name in stuffed)

    @cached_property
    def _region(self) -> StuffedRegion | None:
        transparency = self._frame.transparency
        if transparency is None:
            return None
        names = [part.name for part in self._content]
        begin = names.index(self._stuffed[0])
        stop = begin + len(self._stuffed)
        parts = self._content[begin:stop]
        covers_payload = begin <= self._payload_index < stop
        can_be_empty = all(part.is_optional or isinstance(part, PayloadPart) for part in parts)
        return StuffedRegion(
            encoding=transparency.encoding,
            lenient=transparency.lenient,
            parts=self._stuffed,
            first=self._bounds(self._stuffed[0])[0],
            end=self._bounds(self._stuffed[-1])[1],
            before=sum(part.size for part in self._content[:begin]),
            behind=sum(part.size for part in self._content[stop:]),
            literals_in_front=all(isinstance(part, LiteralPart) for part in self._content[:begin]),
            covers_payload=covers_payload,
            can_be_empty=can_be_empty,
            reaches_end=stop == len(names) and begin <= self._payload_index and not can_be_empty,
            codes=_codes(transparency.encoding),
        )

    # --- checksums --------------------------------------------------------------------------------

    def _checksum(self, part: ChecksumPart) -> ChecksumPlan:
        holder = self._frame.holder(part.name)
        placed = self._placed(holder.name)
        assert placed is not None
        declared = [item.name for item in self._frame.declared]
        own = declared.index(holder.name)
        return ChecksumPlan(
            part=part,
            placed=placed,
            covers=tuple(self._covers(part)),
            is_behind=all(declared.index(name) < own for name in part.covers),
        )

    def _covers(self, part: ChecksumPart) -> list[Run | bytes | VirtualPart]:
        found: list[Run | bytes | VirtualPart] = []
        for name in part.covers:
            virtual = self._frame.virtual_part(name)
            if virtual is not None:
                found.append(virtual)
                continue
            covered = self._frame.part(name)
            if isinstance(covered, LiteralPart) and covered in self._end_literals:
                found.append(covered.bytes)
                continue
            first, end = self._bounds(name)
            over = part.over_wire and name in self._stuffed
            last = found[-1] if found else None
            if isinstance(last, Run) and last.end == first and last.over_stuffing == over:
                found[-1] = Run(last.first, end, over)
            else:
                found.append(Run(first, end, over))
        return found

    # --- what an engine may do --------------------------------------------------------------------

    @property
    def _region_is_plain(self) -> bool:
        region = self._region
        if region is None:
            return True
        starts_in_front = isinstance(self._start, AfterEnd) or region.before > 0
        return starts_in_front and region.covers_payload

    @cached_property
    def _is_regular(self) -> bool:
        behind = all(isinstance(item.part, ChecksumPart) for item in self._tail)
        are_alike = len({part.when_payload for part in self._frame.checksums}) < 2
        return behind and are_alike and self._region_is_plain

    @property
    def _end_is_told(self) -> bool:
        """True if bytes of the wire tell where a frame ends, before they are unstuffed."""
        if self._end_rule() in (EndRule.DELIMITER, EndRule.NEXT_START):
            return True
        if self._end_rule() is EndRule.IDLE:
            return False
        return not self._stuffed and bool(self._frame.length or self._frame.identity)

    def _takes_whole(self) -> bool:
        region = self._region
        checksums = [self._checksum(part).placed for part in self._frame.checksums]
        optional = any(part.when_payload for part in self._frame.checksums)
        early = {part.name for part in written_apart([item.part for item in self._head])}
        told = [*self._frame.identity, *filter(None, [self._frame.length])]
        cuts_region = region is not None and region.behind and region.before < self._head_size
        if region is not None and region.insertion is not None:
            return False
        if self._frame.length_over_wire or self._frame.told:
            return False
        return (
            self._is_regular
            and self._end_is_told
            and not isinstance(self._start, Anywhere)
            and all(part.name in early for part in told)
            and not (region is not None and any(p.over_wire for p in self._frame.checksums))
            and not (optional and any(item.in_head for item in checksums))
            and not (optional and cuts_region)
            and (not self._shares or self._shares_plainly)
        )

    @property
    def _shares_plainly(self) -> bool:
        """True if a frame with a shared delimiter is all that is between two of them."""
        region = self._region
        size = len(self._start_bytes)
        alone = region is None or (region.literals_in_front and region.before == size)
        return alone and self._unique_end

    def _streams(self) -> bool:
        """What follows is told by checksums in front of it, by COBS, and by lengths over the wire.

        So is what is put in behind several bytes, of which a sender would have to remember some. A
        checksum in bits of a part is put in when the other bits are there.
        """
        transparency = self._frame.transparency
        if transparency is not None:
            over_wire = any(part.over_wire for part in self._frame.checksums)
            if over_wire or isinstance(transparency.encoding, Cobs | Insertion):
                return False
            if self._frame.length_over_wire:
                return False
        checksums = self._frame.checksums
        are_whole = all(part.type.within is None for part in checksums)
        return are_whole and all(self._checksum(part).is_behind for part in checksums)


def _codes(encoding: Encoding) -> tuple[tuple[int, bytes], ...]:
    match encoding:
        case Substitution(table=table):
            return tuple(sorted(dict(table).items()))
        case Escape(byte=escape, of=of, xor=xor):
            return tuple((byte, bytes((escape, byte ^ xor))) for byte in sorted(set(of)))
        case Insertion() | Base16() | Cobs():
            return ()
