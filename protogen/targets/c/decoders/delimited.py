"""A decoder of frames that a protected end delimits: bytes are kept, and judged at the end.

No frame begins inside of another one's bytes, so nothing is read again: what does not fit is given
up until the next end or start.
"""

from __future__ import annotations

from functools import cached_property

from protogen.c_language.numbers import unsigned_type
from protogen.model.frame_plan import StartRule, Store
from protogen.targets.c.decoders.flat import FlatDecoder
from protogen.targets.c.decoders.groups import GroupView, constants_by_size
from protogen.targets.c.decoders.received import ReceivedFrame
from protogen.targets.c.frame.expressions import byte
from protogen.targets.c.frame.stuffing import StuffingKind

_SHORT_COBS = 254
"""Content of so many bytes can be one group of COBS that is full."""
_DIGITS = b"0123456789ABCDEFabcdef"
_KINDS = (
    StuffingKind.CODES,
    StuffingKind.LENIENT_ESCAPE,
    StuffingKind.BASE16,
    StuffingKind.COBS,
)


class DelimitedDecoder(FlatDecoder, frozen=True, dict=True):
    """Counters and conditions of such a decoder."""

    # --- sizes ------------------------------------------------------------------------------------

    @cached_property
    def greatest_payload(self) -> int:
        """Bytes of the greatest payload that some message can have; no longer frame is kept."""
        messages = [message for group in self.groups for message in group.messages]
        if any(message.can_be_longer for message in messages):
            return self.plan.payload.greatest
        return max((max(message.greatest, message.fills) for message in messages), default=0)

    @property
    def in_front(self) -> int:
        """Bytes of the buffer in front of the content: a zero for the first group of COBS."""
        return 1 if self.is_cobs else 0

    @property
    def behind(self) -> int:
        """Bytes of the buffer behind the content: the first of an end, until the second comes."""
        return 1 if self.end_size > 1 and self.stuffing is None else 0

    @property
    def buffer_size(self) -> int:
        """Bytes of the buffer."""
        return self.in_front + self.around + self.greatest_payload + self.behind

    @cached_property
    def counter(self) -> str:
        """The type of what counts bytes of the buffer or their digits, and one byte more."""
        most = self.counted(self.buffer_size)
        bits = next(bits for bits in (8, 16, 32) if most < (1 << bits) - 4)
        return f"uint{bits}_t"

    @property
    def kept_content(self) -> str:
        """Where the content begins in the buffer."""
        return f"&decoder->buffer[{self.in_front}]" if self.in_front else "decoder->buffer"

    @property
    def size_is_kept(self) -> bool:
        """True if a member says how large the payload of a complete frame is."""
        return self._size_varies and not self.size_in_buffer

    @property
    def _size_varies(self) -> bool:
        """True if the message does not tell how large the payload of a complete frame is."""
        if self.only_size is not None:
            return False
        messages = [message for group in self.groups for message in group.messages]
        vary = any(message.is_fitted or not message.fixed for message in messages)
        return vary or self.shows_tail

    @cached_property
    def size_in_buffer(self) -> str:
        """The same as a length in the buffer says it; empty where none does in so many words."""
        length = self.plan.length
        if length is None or self.plan.frame.told_length or self.fits_payloads:
            return ""
        placed = self.plan.part(length.part.name)
        if not placed.in_head or length.part.type.text or length.part.type.within:
            return ""
        place = self.in_front + placed.offset
        value = self.numbers.value(length.part.type, "decoder->buffer", place)
        if length.base:
            return f"({self.counter})({value} - {length.base}U)"
        is_wider = unsigned_type(length.part.type.bits) != self.counter
        return f"({self.counter}){value}" if is_wider else value

    @property
    def tells_sizes(self) -> bool:
        """True if the message tells it, and there are several."""
        return self.only_size is None and not self._size_varies and not self.size_in_buffer

    @cached_property
    def sizes(self) -> dict[int, tuple[str, ...]]:
        """The constants of the messages by the size of their payload, where that is fixed."""
        return constants_by_size(self.groups)

    @property
    def size_member(self) -> str:
        """The member that says so."""
        return "payload"

    def size_kept(self, payload: str) -> str:
        """The size of a payload as that member holds it."""
        return payload

    @property
    def shown_size(self) -> str:
        """The payload's size of a complete frame, as an argument in front of others."""
        if self.only_size is not None:
            return ""
        if self.size_is_kept:
            return "decoder->payload, "
        if self.size_in_buffer:
            return f"{self.size_in_buffer}, "
        return f"{self.prefix}_payload_size(message), "

    # --- start and end ----------------------------------------------------------------------------

    @property
    def end(self) -> str:
        """The condition that a byte is the end, or its last one."""
        held = "decoder->held != 0U && " if self.holds_end else ""
        return f"{held}byte == {byte(self.plan.end_bytes[-1])}"

    @property
    def holds_end(self) -> bool:
        """True if a member says that the first byte of an end came; else nodes do, or nothing."""
        return self.end_size > 1 and not self.escape_starts

    @property
    def has_start(self) -> bool:
        """True if something marks the start; else the end of the frame before does."""
        return self.plan.start is not StartRule.AFTER_END

    @property
    def begins_itself(self) -> bool:
        """True if a start is no end, too."""
        return self.has_start and not self.plan.shares_delimiter

    @property
    def begun(self) -> int:
        """The number of bytes that are counted behind an end."""
        return self.lead + self.first_head if self.plan.shares_delimiter else 0

    @property
    def counter_begun(self) -> int:
        """Value of the counter then."""
        return self.counted(self.first_head) if self.plan.shares_delimiter else 0

    @property
    def gives_up_first(self) -> bool:
        """True if `push` gives up before it looks at a byte, and takes that back for a digit."""
        return self.counts_digits and self.idle_value == self.counter_begun and not self.holds_end

    @property
    def idle_member(self) -> str:
        """The counter that says that bytes pass by until a frame may begin."""
        return "content"

    @property
    def idle_value(self) -> int:
        """Value of that counter then: nothing, or more than there is room for."""
        return 0 if self.has_start else self.counted(self.buffer_size + 1)

    @property
    def has_no_room(self) -> str:
        """The condition that no byte of content is taken."""
        if not self.has_start:
            return f"at >= {self.buffer_size}U"
        return f"({self.counter})(at - 1U) >= {self.lead + self.buffer_size - 1}U"

    @property
    def ends_when_full(self) -> bool:
        """True if no byte but an end is due at one number of digits, and no end at another.

        An end is no digit, so that it gives up a frame that is too short, as all else does.
        """
        return self.gives_up_first and self.only_size is not None

    @property
    def is_full(self) -> str:
        """The condition that all digits are there; nothing is written where more are."""
        assert self.only_size is not None
        return f"at >= {self.least + self.only_size}U"

    @property
    def is_unbegun(self) -> str:
        """The condition that no start came; there is none of its digits alone."""
        begun = self.lead + self.first_head
        return "at == 0U" if begun == 1 else f"at < {begun}U"

    @property
    def least(self) -> int:
        """The number of bytes that are counted of a frame with an empty payload."""
        return self.in_front + self.counts_around + self.behind

    @property
    def is_complete(self) -> str:
        """The condition that an end ends a frame, as far as sizes and stuffing tell.

        What is too short, or given up, has a payload greater than any.
        """
        if self.only_size is not None:
            kept = self.least - self.lead + self.only_size
            found = [f"{self.content_counter} == {self.counted(kept)}U"]
        else:
            found = [f"payload <= {self.greatest_payload}U"]
        if self.least - self.behind <= self.begun and not self.only_size:
            found.append(f"at > {self.begun + self.behind}U")  # Else it is an idle line.
        if self.has_node and not self.escape_starts:
            found.append("node == 0U")
        elif self.counts_digits and self.only_size is None:
            found.append("(digits & 1U) == 0U")
        if self.groups_fill:
            found.append("code != 0U")
        return " && ".join(found)

    # --- COBS -------------------------------------------------------------------------------------

    @property
    def is_cobs(self) -> bool:
        """True if a zero stands for the code of each group but the first."""
        return self.stuffing is not None and self.stuffing.is_cobs

    @property
    def groups_fill(self) -> bool:
        """True if a group of COBS may be full, so that no zero stands behind it."""
        return self.is_cobs and self.around + self.greatest_payload >= _SHORT_COBS

    # --- counters ---------------------------------------------------------------------------------

    @property
    def weighs_sizes(self) -> bool:
        """True if a decoder of all events looks at a frame's size before its checksum."""
        is_early = self.plan.identity_is_early or not self.identified
        has_sizes = self.only_size is None and self.length is None and bool(self.groups)
        return bool(self.checksums) and is_early and has_sizes

    def has_size(self, group: GroupView) -> str:
        """The condition that a frame of the group has a size that it can have."""
        size = group.greatest if group.fixed is None else group.fixed
        return f"payload {'<=' if group.fixed is None else '=='} {size}U"

    # --- messages ---------------------------------------------------------------------------------

    def size_is_certain(self, group: GroupView) -> bool:
        """True if a payload of that identity has a size that its message can have."""
        if self.only_size is not None:
            return True
        message = group.messages[0]
        if len(group.messages) != 1:
            return False
        return message.takes_any_size or message.check_sees_size

    @property
    def judges_last(self) -> bool:
        """True: what an end ends is judged by it."""
        return True

    def is_other_length(self, length: str) -> str:
        """The condition that the payload has another size than the length says, or may say."""
        if self.only_size is not None:
            return super().is_other_length(length)
        assert self.length is not None
        base = self.length.base
        found = self.length.beyond(length, self.greatest_payload)
        due = f"({self.length.wrapping})(payload + {base}U)" if base else "payload"
        return " || ".join([*found, f"{length} != {due}"])


def is_delimited(frame: ReceivedFrame) -> bool:
    """True if a frame can be judged at its end, and nothing of it is looked at twice."""
    plan = frame.plan
    return (
        plan.store is Store.CONTENT
        and plan.end_is_unique
        and _end_is_plain(frame)
        and _start_is_plain(frame)
        and not plan.is_cut_off
        and not plan.ends_idle
        and not frame.told_parts
        and not frame.length_over_wire
        and not any(number.contradicts for number in frame.tail_numbers)
        and not frame.optional_tail
        and _region_is_plain(frame)
    )


def _end_is_plain(frame: ReceivedFrame) -> bool:
    """True if the end is one byte, or two of which the first tells nothing else where it stands.

    Where it begins sequences of the stuffing, too, their nodes tell.
    """
    end, stuffing = frame.plan.end_bytes, frame.stuffing
    if len(end) == 1 or frame.escape_starts:
        return True
    if len(end) != 2 or end[0] == end[1] or frame.plan.shares_delimiter:
        return False
    return stuffing is None or (stuffing.kind is StuffingKind.BASE16 and end[0] not in _DIGITS)


def _start_is_plain(frame: ReceivedFrame) -> bool:
    """True if the end of the frame before is the start, or what stands nowhere else and shows."""
    plan = frame.plan
    if plan.start is StartRule.AFTER_END:
        return True
    if plan.start not in (StartRule.LITERAL, StartRule.SET):
        return False
    return plan.start_is_unique and (plan.start_size == 1 or frame.escape_starts)


def _region_is_plain(frame: ReceivedFrame) -> bool:
    """True if nothing is stuffed, or all between the delimiters is."""
    region, stuffing = frame.plan.region, frame.stuffing
    if region is None or stuffing is None:
        return True
    before = 0 if frame.plan.start is StartRule.AFTER_END else frame.first_head
    is_whole = frame.region_to_end and region.before == before
    if stuffing.is_cobs and (frame.plan.start_size or stuffing.lenient):
        return False
    return is_whole and stuffing.kind in _KINDS
