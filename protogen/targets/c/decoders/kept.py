"""A decoder of frames that may hold what looks like a start: their bytes are kept as they come.

A candidate stands at the beginning of the buffer. It is looked at where its size becomes known, and
where it is complete. One that fails gives up its bytes up to the next possible start among those
that are kept, and what is behind is moved to the beginning.

Frames of one small size need none of that: the last bytes stand as they would in a frame, each
moved by the next one, and are looked at whenever they may be a frame.
"""

from __future__ import annotations

from functools import cached_property

from protogen.copying import replace
from protogen.model.frame_plan import FramePlan, StartRule, Store
from protogen.targets.c.decoders.flat import FlatDecoder
from protogen.targets.c.decoders.groups import GroupView, ReceivedMessage, constants_by_size
from protogen.targets.c.decoders.received import ReceivedFrame
from protogen.targets.c.frame.checksums import ChecksumView
from protogen.targets.c.frame.expressions import byte, differs, equals

_WINDOW = range(2, 6)
"""Sizes of frames whose bytes are moved when the next one comes.

Moving a byte takes an ATmega four cycles: up to here that is no more than counting them, and about
100 bytes of flash less. All of them, and the one in front, have a bit in a byte.
"""
_SUMMED_AT_ONCE = 4
"""The most bytes that are summed where a byte is taken."""


class KeptDecoder(FlatDecoder, frozen=True, dict=True):
    """Counters and conditions of such a decoder."""

    # --- sizes ------------------------------------------------------------------------------------

    @property
    def idle_member(self) -> str:
        """The member that is 0 where nothing of a frame is there."""
        return "passed" if self.end_is_seen else "content"

    @cached_property
    def only_size(self) -> int | None:
        """The payload's size, where all frames have the same: those of unknown messages, too."""
        return _only_size(self)

    @property
    def gives_more(self) -> bool:
        """True if what is left of a failed candidate may hold several frames."""
        return self.only_size is None

    @property
    def around(self) -> int:
        """Bytes around a payload, the end not among them."""
        absent = self.optional_size if self.only_size == 0 else 0
        return super().around - absent

    @property
    def frame_size(self) -> int:
        """Bytes of the greatest frame."""
        size = self.plan.payload.greatest if self.only_size is None else self.only_size
        return self.around + size + self.end_size

    @property
    def buffer_size(self) -> int:
        """Bytes that are kept: a frame, or what stands in front of the end's last byte."""
        return self.frame_size - (1 if self.has_window and self.begins_behind_end else 0)

    @cached_property
    def has_window(self) -> bool:
        """True if bytes are kept as they stand in a frame, and moved when the next one comes.

        They are looked at where a byte is taken, so little may have to be done for that.
        """
        is_small = self.only_size is not None and self.frame_size in _WINDOW
        at_once = self.compares_early and self.shows_inline and not self.checks_tail
        return is_small and at_once and not self.checked and self._sums_little

    @property
    def _sums_little(self) -> bool:
        size = self.only_size or 0
        return all(item.adds_bytes_up_to(_SUMMED_AT_ONCE, size) for item in self.checksums)

    @cached_property
    def counter(self) -> str:
        """The type of what counts bytes of the buffer, and two more."""
        bits = next(bits for bits in (8, 16, 32) if self.frame_size < (1 << bits) - 4)
        return f"uint{bits}_t"

    @property
    def size_is_kept(self) -> bool:
        """True if a member says how large the payload of a complete frame is."""
        if self.only_size is not None:
            return False
        messages = [message for group in self.groups for message in group.messages]
        return self.shows_tail or any(not message.fixed for message in messages)

    @property
    def tells_sizes(self) -> bool:
        """True if the message tells it, and there are several."""
        return self.only_size is None and not self.size_is_kept

    @property
    def sizes(self) -> dict[int, tuple[str, ...]]:
        """The constants of the messages by the size of their payload, where that is fixed."""
        return constants_by_size(self.groups)

    @property
    def shown_size(self) -> str:
        """The payload's size of a complete frame, as an argument in front of others."""
        if self.only_size is not None:
            return ""
        if self.size_is_kept:
            return "decoder->payload, "
        return f"{self.prefix}_payload_size(message), "

    # --- start and end ----------------------------------------------------------------------------

    @property
    def begins_behind_end(self) -> bool:
        """True if the end of the frame before marks a start, and nothing else."""
        return self.plan.start is StartRule.AFTER_END

    @property
    def begins_anywhere(self) -> bool:
        """True if nothing marks a start."""
        return self.plan.start is StartRule.ANYWHERE

    def may_begin(self, at: str) -> str:
        """The condition that a byte may be the first of a frame."""
        if self.plan.start_bytes:
            return f"{at} == {byte(self.plan.start_bytes[0])}"
        return self.is_start(at)

    @property
    def is_no_start(self) -> str:
        """The condition that no start stands in front of `content`; empty where none is marked."""
        if self.plan.start_bytes:
            return differs(self.plan.start_bytes, "content")
        return f"!({self.is_start('content[0]')})" if self.plan.start_set else ""

    def is_no_end(self, content: str) -> str:
        """The condition that the end does not stand behind a payload of that one size."""
        return differs(self.plan.end_bytes, content, self.frame_size - self.end_size)

    def is_end_alone(self, content: str) -> str:
        """The condition that an end stands where a frame would begin: nothing is in front of it."""
        return equals(self.plan.end_bytes, content)

    @property
    def end_is_seen(self) -> bool:
        """True if nothing is looked at but what stands in front of an end."""
        return self.has_window and self.begins_behind_end

    @property
    def ends_with_byte(self) -> str:
        """The condition that an end is complete with the byte that is taken.

        Its first byte is that of another input where a silence, or a frame, came between.
        """
        found = f"byte == {byte(self.plan.end_bytes[-1])}"
        if self.end_size == 1:
            return found
        first = equals(self.plan.end_bytes[:1], "decoder->buffer", self.buffer_size - 1)
        return f"{found} && {first} && (passed & 2U) != 0U"

    @property
    def stands_behind_end(self) -> str:
        """The condition that a frame may end: in front of it stands an end, and none begins it."""
        begins = ((1 << self.end_size) - 1) << (self.frame_size - self.end_size)
        return f"(passed & {byte(1 << self.frame_size | begins)}) == {byte(begins)}"

    @property
    def ends_here(self) -> str:
        """The condition that the byte at `from` is the last of an end."""
        last = self.end_size - 1
        return equals(self.plan.end_bytes, "decoder->buffer", f"from - {last}U" if last else "from")

    # --- checksums --------------------------------------------------------------------------------

    @cached_property
    def checksums(self) -> tuple[ChecksumView, ...]:
        """Those that are there; of one size of payload it is known which."""
        if self.only_size is None:
            return super().checksums
        there = (item for item in super().checksums if self.only_size or not item.optional)
        return tuple(replace(item, optional=False) for item in there)

    # --- messages ---------------------------------------------------------------------------------

    @property
    def compares_early(self) -> bool:
        """True if the head tells the message, so that its size is compared there."""
        return self.plan.identity_is_early or not self.identified

    @property
    def skips_unknown(self) -> bool:
        """True if an unknown message is as good as none.

        The first end behind its identity ends it, where the next frame may start in any case.
        """
        return self.can_open

    def fits_alone(self, group: GroupView, item: ReceivedMessage) -> str:
        """The condition that the size is the message's, and of none before it in the group."""
        before = group.messages[: group.messages.index(item)]
        others = [f"!({other.fits('payload')})" for other in before]
        return " && ".join([f"({item.fits('payload')})", *others])

    @property
    def checked(self) -> tuple[ReceivedMessage, ...]:
        """The messages whose payloads are looked at when they are complete."""
        return tuple(item for group in self.groups for item in group.messages if item.checks)


def is_kept(frame: ReceivedFrame) -> bool:
    """True if each candidate tells its size in its head, or all have the same."""
    plan = frame.plan
    return (
        plan.store is Store.WIRE
        and _bounds_are_plain(frame)
        and not plan.seven_bit
        and not plan.is_cut_off
        and not plan.ends_idle
        and not plan.measures
        and not frame.told_parts
        and not frame.fits_payloads
        and bool(frame.groups)
        and _tail_is_plain(frame)
        and (_only_size(frame) is not None or _is_sized(frame))
    )


def _bounds_are_plain(frame: ReceivedFrame) -> bool:
    """True if a start is told by the byte that begins it, or by the bytes in front of it."""
    plan = frame.plan
    if plan.start_is_unique or plan.end_is_unique:
        return False
    if plan.start is StartRule.AFTER_END:
        end = plan.end_bytes
        return len(end) == 1 or (len(end) == 2 and end[0] != end[1])
    return plan.start is not StartRule.SET or bool(plan.start_set)


def _tail_is_plain(frame: ReceivedFrame) -> bool:
    """True if places in the tail do not vary where they are looked at."""
    if any(number.contradicts for number in frame.tail_numbers):
        return False
    return not (frame.checks_tail and frame.optional_tail)


def _is_sized(frame: ReceivedFrame) -> bool:
    """True if a length in the head tells the size, and nothing is looked at between head and sums.

    A candidate fails there where its head is complete, and a frame inside is not yet.
    """
    plan = frame.plan
    is_early = plan.length is not None and plan.size_known_at is not None
    is_plain = not frame.checks_tail and not frame.optional_size and not frame.can_open
    return is_early and is_plain and plan.start is not StartRule.AFTER_END


def _only_size(frame: ReceivedFrame) -> int | None:
    """The size of all payloads, if there is but one."""
    plan = frame.plan
    sizes = {group.fixed if len(group.messages) == 1 else None for group in frame.groups}
    size = sizes.pop() if len(sizes) == 1 else None
    if size is None or not _others_are_alike(plan, size):
        return None
    return None if frame.can_open and not _ends_soon(frame) else size


def _others_are_alike(plan: FramePlan, size: int) -> bool:
    """True if the frames of unknown messages have that size as well, where they tell one."""
    return plan.length is None or plan.payload.least == plan.payload.greatest == size


def _ends_soon(frame: ReceivedFrame) -> bool:
    """True if the first end ends the frame of an unknown message, and begins the next."""
    plan = frame.plan
    is_behind_end = plan.start is StartRule.AFTER_END and len(plan.end_bytes) == 1
    return is_behind_end and plan.head_size == 1 and plan.identity_is_early
