"""A decoder with states in C: what it remembers, and the conditions that are made of that."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from protogen.model.frame_places import Side
from protogen.model.frame_plan import StartRule
from protogen.targets.c.decoders.counting import bytes_kept
from protogen.targets.c.decoders.groups import GroupView, ReceivedMessage
from protogen.targets.c.decoders.states import PushStates
from protogen.targets.c.frame.expressions import Index, byte, equals
from protogen.targets.c.frame.stuffing import StuffingKind


class PushDecoder(PushStates, frozen=True, dict=True):
    """Members and conditions of a decoder with states."""

    # --- sizes ------------------------------------------------------------------------------------

    @property
    def payload(self) -> str:
        """The payload's size in C."""
        return "decoder->payload"

    @cached_property
    def known(self) -> str:
        """The condition that the payload's size is known."""
        return self._known("!=", ">=", "true")

    @cached_property
    def unknown(self) -> str:
        """The opposite condition."""
        return self._known("==", "<", "false")

    def _known(self, equality: str, order: str, otherwise: str) -> str:
        if not self.simple:
            return f"{self._flag('KNOWN')} {equality} 0U"
        return f"decoder->content {order} {self.known_from}U" if self.known_from else otherwise

    def _flag(self, name: str) -> str:
        return f"(decoder->flags & {self.protocol_upper}_{name})"

    @property
    def open(self) -> str:
        """The condition that only what follows the payload will tell its size."""
        return f"{self._flag('OPEN')} != 0U"

    @property
    def searching(self) -> str:
        """The condition that a delimiter is looked for."""
        return f"{self._flag('SEARCHING')} != 0U"

    @property
    def not_searching(self) -> str:
        """The opposite condition."""
        return f"{self._flag('SEARCHING')} == 0U"

    @cached_property
    def limit(self) -> str:
        """Bytes of content, as far as their number is known."""
        if not self.simple:
            return "decoder->limit"
        if not self.optional_size:
            return f"decoder->payload + {self.around}U"
        around = f"(decoder->payload == 0U ? {self.least_around}U : {self.around}U)"
        return f"(decoder->payload + {around})"

    @cached_property
    def full(self) -> str:
        """The condition that all content is there."""
        if self.simple:
            return f"decoder->content == {self.limit}"
        return f"({self.known} && decoder->content == decoder->limit)"

    @property
    def surplus_is_plain(self) -> bool:
        """True if one reason stands for every byte too many."""
        return self.announced == "SIZE" or (self.simple and not self.known_from)

    @property
    def finds_size_early(self) -> bool:
        """True if the size is looked up as soon as the identity is there."""
        return self._finds_size and self.plan.identity_is_early and not self.plan.is_told_alone

    @property
    def finds_size_at_once(self) -> bool:
        """True if the size is known before the first byte, or how it will be."""
        return self._finds_size and not self.identified

    @property
    def finds_size_by_told(self) -> bool:
        """True if what was told tells the size, before the first byte."""
        return self._finds_size and self.plan.is_told_alone

    @property
    def _finds_size(self) -> bool:
        return bool(self.groups) and self.length is None

    def greatest_content(self, group: GroupView) -> int:
        """Bytes of content that a frame of the group has at most."""
        around = self.around if group.greatest else self.least_around
        return min(around + group.greatest, self.plan.given_up_at)

    # --- what is complete -------------------------------------------------------------------------

    only_size = None
    """The payload's size is looked up, or told, whatever it is."""

    @property
    def kept_content(self) -> str:
        """Where the content begins in the decoder."""
        return "decoder->unstuffed" if self.keeps_both else "decoder->buffer"

    @property
    def shown_size(self) -> str:
        """The payload's size of a complete frame, as an argument in front of others."""
        return f"{self.payload}, "

    @property
    def gives_more(self) -> bool:
        """True if one byte may complete several messages: those in bytes that are kept."""
        return self.keeps_wire

    @property
    def waits_behind_frames(self) -> bool:
        """True if a candidate begins behind a frame at once, in whose place it is kept.

        So that waits for the next call, as events show what is there. Where a byte of a set ends a
        frame, that has no message: all messages say where they end.
        """
        begins = self.begins_anywhere or self.plan.shares_delimiter
        return self.keeps_wire or begins or (self.ends_at_start and bool(self.marks))

    # --- messages ---------------------------------------------------------------------------------

    def fits(self, item: ReceivedMessage) -> str:
        """The condition that the size is the message's."""
        if item.takes_any_size:
            return "true"
        condition = item.fits("size")
        return condition if item.fixed else f"({condition})"

    def fits_some(self, group: GroupView) -> str:
        """The condition that the size is that of some message of the group."""
        return " || ".join(map(self.fits, group.messages))

    def fits_alone(self, group: GroupView, item: ReceivedMessage) -> str:
        """The condition that the size is the message's, and of none before it in the group."""
        before = group.messages[: group.messages.index(item)]
        return " && ".join([self.fits(item), *(f"!({self.fits(other)})" for other in before)])

    # --- bytes on the wire ------------------------------------------------------------------------

    @property
    def wire_without_behind(self) -> str:
        """Bytes of a candidate without those that are not its own."""
        return "decoder->wire" + (" - decoder->behind" if self.keeps_behind else "")

    @property
    def wire_without_shared(self) -> str:
        """Bytes of a candidate without those of the frame before."""
        return "decoder->wire" + (" - decoder->shared" if self.plan.shares_delimiter else "")

    @property
    def own_wire(self) -> str:
        """Bytes of a frame that are nobody else's."""
        return self.wire_without_shared + (" - decoder->behind" if self.keeps_behind else "")

    @property
    def size_without_behind(self) -> str:
        """The same where the bytes before are taken off."""
        return "size" + (" - decoder->behind" if self.keeps_behind else "")

    @property
    def has_own_bytes(self) -> str:
        """The condition that a candidate has bytes that are nobody else's."""
        if self.plan.shares_delimiter:
            return "decoder->wire > decoder->shared"
        return "decoder->wire != 0U" if self.counts_wire else "decoder->content != 0U"

    @property
    def bytes_kept(self) -> tuple[str, str, str]:
        """For counters: bytes of a complete frame, behind it, and those kept where none is."""
        return bytes_kept(shares=self.plan.shares_delimiter)

    # --- the stuffed region -----------------------------------------------------------------------

    @property
    def crosses_region(self) -> bool:
        """True if the stuffed region ends before the frame does."""
        return self.stuffing is not None and not self.region_to_end

    @property
    def is_always_inside(self) -> bool:
        """True if all content is stuffed."""
        region = self.plan.region
        is_first = region is not None and region.first.side is Side.HEAD and not region.first.offset
        return self.region_to_end and is_first

    @property
    def inside(self) -> str:
        """The condition that the next byte is stuffed."""
        if self.region_to_end:
            return f"decoder->content >= {self.region_begin}"
        return f"decoder->region == {self.protocol_upper}_INSIDE"

    @property
    def region_begin(self) -> str:
        """Bytes of content in front of the region."""
        assert self.plan.region is not None
        return Index(self.plan.region.first, self.plan.head_size).of(self.payload)

    @property
    def region_end(self) -> str:
        """Bytes of content up to the region's end."""
        assert self.plan.region is not None
        return Index(self.plan.region.end, self.plan.head_size).of(self.payload)

    @property
    def sees_empty_region(self) -> bool:
        """True if a region of no content has bytes on the wire."""
        can_be_empty = self.plan.region is not None and self.plan.region.can_be_empty
        return can_be_empty and self.stuffing is not None and self.stuffing.is_cobs

    @property
    def _is_not_empty(self) -> list[str]:
        return [f"{self._flag('EMPTY')} == 0U"] if self.sees_empty_region else []

    @property
    def region_opens(self) -> str:
        """The condition that the region begins here."""
        region = self.plan.region
        assert region is not None
        found = [f"decoder->region == {self.protocol_upper}_BEFORE"]
        if region.first.side is Side.TAIL:
            found.append(self.known)
        if self.region_begin != "0U":
            found.append(f"decoder->content >= {self.region_begin}")
        return " && ".join(found)

    @property
    def region_closes(self) -> str:
        """The condition that the region ends here."""
        assert self.plan.region is not None
        found = [f"decoder->region == {self.protocol_upper}_INSIDE"]
        if self.plan.region.end.side is Side.TAIL:
            found.append(self.known)
        found += [f"decoder->content >= {self.region_end}", *self._is_not_empty]
        if self.searches:
            looked_for = "" if self.plan.end_is_unique else f" && {self.searching}"
            found.append(f"!({self.full}{looked_for})")
        return " && ".join(found)

    @property
    def finishes_region(self) -> bool:
        """True if it is looked at whether the region can end where it does."""
        if self.stuffing is None:
            return False
        is_lenient = self.stuffing.kind is StuffingKind.LENIENT_CODES
        return not self.region_to_end or (self.searches and not is_lenient)

    @property
    def cobs_is_cut(self) -> str:
        """The condition that a group of COBS is not complete."""
        assert self.stuffing is not None
        nothing = "" if self.stuffing.lenient else " || decoder->code == 0U"
        return f"decoder->node != 0U{nothing}"

    @property
    def region_reason(self) -> str:
        """The reason why the region can't end here, if it can't."""
        stuffing, upper = self.stuffing, self.protocol_upper
        assert stuffing is not None
        refused, fine = f"{upper}_{stuffing.reason}", f"{upper}_NO_REASON"
        if not stuffing.is_cobs:
            return f"decoder->node {stuffing.is_whole} ? {fine} : {refused}"
        if stuffing.lenient:
            return f"cut ? {refused} : {fine}"
        return f"(cut || {self._flag('NEEDLESS')} != 0U) ? {refused} : {fine}"

    def holds(self, sequence: bytes) -> str:
        """The condition that what is held begins with the sequence."""
        return f"decoder->node >= {len(sequence)}U && {equals(sequence, 'held')}"

    @property
    def held_beginnings(self) -> list[str]:
        """The conditions that what is held is the beginning of a sequence."""
        assert self.stuffing is not None
        beginnings = dict.fromkeys(
            code.sequence[:size]
            for code in self.stuffing.codes
            for size in range(1, len(code.sequence))
        )
        return [
            f"(decoder->node == {len(beginning)}U && {equals(beginning, 'held')})"
            for beginning in beginnings
        ]

    # --- between parts ----------------------------------------------------------------------------

    @property
    def crosses(self) -> bool:
        """True if something is done between two parts."""
        if self.plan.ends_idle:
            return False
        refuses = self.seeks_end and self.plan.start is StartRule.ANYWHERE
        return self.crosses_region or refuses or not self.plan.end_is_unique

    @property
    def content_ends(self) -> str:
        """The condition that no content is due any more."""
        return " && ".join([self.full, *self._is_not_empty])

    @property
    def search_begins(self) -> str:
        """The condition that from now on a delimiter has to be looked for."""
        looked_for = [] if self.plan.end_is_unique else [self.not_searching]
        return " && ".join([self.open, self.unknown, *looked_for])

    @property
    def in_payload(self) -> str:
        """The condition that a byte is the payload's, behind the head."""
        known = "" if self.simple else f"{self.unknown} || "
        head = f"{self.plan.head_size}U + " if self.plan.head_size else ""
        return f"{known}index < {head}decoder->payload"

    @property
    def payload_ends(self) -> str:
        """The condition that a byte is the payload's last."""
        known = "" if self.simple else f"{self.known} && "
        return f"{known}index + 1U == {self.plan.head_size}U + decoder->payload"

    @property
    def payload_byte_is_high(self) -> str:
        """The condition that a byte of the payload has a bit that it must not have."""
        if not (self.plan.tail_size and self.can_open):
            return "byte > 0x7FU"
        measuring = f" || {self._flag('MEASURING')} != 0U" if self.plan.measures else ""
        return f"byte > 0x7FU && ({self.known}{measuring})"

    # --- start and end ----------------------------------------------------------------------------

    def follow(self, at: str) -> str:
        """Bytes of the tracked literal that the input ends with behind a byte."""
        if len(self.matches[0]) == 1:
            return f"({at} == {byte(self.matches[0][0])}) ? (uint8_t)1U : (uint8_t)0U"
        name = "end" if self.plan.start is StartRule.AFTER_END else "start"
        return f"{self.prefix}_follow_{name}(decoder->match, {at})"

    @property
    def tracks(self) -> bool:
        """True if a candidate's bytes are looked at for a start."""
        return self.keeps_match and (bool(self.marks) or not self.keeps_wire)

    @property
    def start(self) -> str:
        """The condition that a start ends with this byte."""
        if self.plan.start_set or not self.keeps_match:
            return self.is_start("byte")
        return self.is_whole("decoder->match")

    @property
    def behind_start(self) -> str:
        """The condition that a start here is not the candidate's own."""
        counted = "wire >" if self.counts_wire else "content >="
        return f"decoder->{counted} {self.first_head}U"

    @property
    def starts_inside(self) -> bool:
        """True if a start inside a candidate ends it."""
        is_marked = self.plan.start in (StartRule.LITERAL, StartRule.SET)
        return (
            is_marked
            and not self.plan.shares_delimiter
            and (self.plan.start_is_unique or self.ends_at_start)
        )

    @property
    def start_inside(self) -> str:
        """The condition that this is a start that ends the candidate."""
        may_close = [] if self.plan.start_is_unique else [self.may_close]
        return " && ".join([self.start, self.behind_start, *may_close])

    @property
    def may_close(self) -> str:
        """The condition that a start may end a frame here."""
        return f"{self.searching} && decoder->wire >= decoder->open_from + {self.first_head}U"

    @property
    def idles(self) -> bool:
        """True if an end right behind a start, or behind an end, is an idle line."""
        return self.plan.shares_delimiter or self.plan.start is StartRule.AFTER_END

    @property
    def is_idle_line(self) -> str:
        """The condition that an end comes where nothing of a frame is in front of it."""
        found = [
            f"decoder->wire == {self.start_size + self.end_size}U",
            f"byte == {byte(self.plan.end_bytes[-1])}",
        ]
        if self.end_size > 1 and self.keeps_wire:
            found.append(equals(self.plan.end_bytes[:-1], "decoder->buffer", self.start_size))
        elif self.end_size > 1:
            found.append(f"decoder->held == {self.end_size - 1}U")
        return " && ".join(found)

    @property
    def search(self) -> str:
        """Call that looks at a byte inside a candidate: the search, or none."""
        passed, sought = (
            f"{self.prefix}_pass(decoder, byte)",
            f"{self.prefix}_search(decoder, byte)",
        )
        if not self.searches:
            return passed
        conditions = [] if self.plan.end_is_unique else [self.searching]
        conditions += [self.behind_start] if self.start_size else []
        if not conditions:
            return sought
        condition = " && ".join(conditions)
        return f"{f'({condition})' if self.start_size else condition} ? {sought} : {passed}"

    @property
    def looks_back(self) -> bool:
        """True if parts are checked when only the end has told where they lie."""
        return bool(self.plan.seven_bit and self.plan.tail_size) or self.checks_tail

    @property
    def behind_region(self) -> int:
        """Bytes between the stuffed region and the end."""
        assert self.plan.region is not None
        return self.plan.region.behind

    @property
    def tail_is_there(self) -> str:
        """The condition that no part is absent."""
        optional = self.optional_tail
        names = [f"!absent{number}" for number in range(1, len(optional) + 1)]
        return " && ".join(names) or "true"

    @property
    def compares_at_once(self) -> bool:
        """True if one byte tells a start, so that none has to be waited for."""
        return self.start_size == 1 and not self.plan.shares_delimiter

    @property
    def start_arguments(self) -> tuple[str, ...]:
        """The bytes of a start that was seen; `state` is that of the search for several."""
        if len(self.marks) > 1:
            return tuple(self.start_byte("state", f"{i}U") for i in range(self.start_size))
        return tuple(map(byte, self.plan.start_bytes)) or ("byte",)

    @property
    def start_seen(self) -> tuple[str, str]:
        """What tells the start that was seen, as a parameter and as an argument behind others."""
        if self.plan.start_set:
            return ", uint8_t byte", ", byte"
        return (", uint8_t state", ", decoder->match") if len(self.marks) > 1 else ("", "")

    @property
    def counts_held_start(self) -> bool:
        """True if the first bytes of a start become noise when no more of it comes."""
        return bool(self.marks) and self.all_events and self.keeps_match

    @property
    def opening(self) -> Iterator[tuple[str, str]]:
        """The members that a candidate begins with, and their values."""
        stuffing = self.stuffing
        if self.counts_wire:
            yield "wire", "0"
        yield "content", "0"
        yield "payload", self.unlimited if self.simple else "0"
        named = {
            "limit": self.unlimited if not self.simple else "",
            "flags": "0" if self.has_flags else "",
            "behind": "0" if self.keeps_behind else "",
            "match": "0" if self.keeps_match and self.marks else "",
            "shared": "0" if self.plan.shares_delimiter else "",
            "held": "0" if self.searches and self.holds_delimiter else "",
            "end_left": "0" if self.awaits_end else "",
            "passed": "0" if self.counts_passed else "",
            "stop": "0" if self.length_over_wire else "",
            "region": f"{self.protocol_upper}_BEFORE" if self.crosses_region else "",
            "node": "0" if stuffing is not None else "",
            "code": "0" if stuffing is not None and stuffing.is_cobs else "",
        }
        yield from ((name, value) for name, value in named.items() if value)
