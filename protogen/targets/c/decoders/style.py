"""The style of a decoder: how much of a state machine its frames need."""

from __future__ import annotations

from enum import Enum, auto

from protogen.model.frame_plan import StartRule, Store
from protogen.targets.c.decoders.delimited import is_delimited
from protogen.targets.c.decoders.kept import is_kept
from protogen.targets.c.decoders.received import ReceivedFrame
from protogen.targets.c.frame.stuffing import StuffingKind


class DecoderStyle(Enum):
    """Shape in which a decoder is printed."""

    PUSH = auto()
    """A machine with states: any frame, any events."""
    FLAT = auto()
    """No more states than how much of a frame is there."""
    DELIMITED = auto()
    """The same where a frame is judged at its end, whatever its head says."""
    KEPT = auto()
    """The same where a start may stand inside of a frame, whose bytes are looked through again."""


def decoder_style(frame: ReceivedFrame) -> DecoderStyle:
    """The style for frames of which some events are asked.

    Where nobody asks what was wrong, what does not fit is given up. A flat decoder is for frames
    that begin with a protected start and tell their size in their head: a byte of a start is
    always one. A delimited one is for those with a protected end. Nothing of an identity is told.
    One that keeps bytes is for those that nothing protects and that tell their size early.
    """
    if frame.all_events or not (_tail_stays(frame) and _payload_is_plain(frame)):
        return DecoderStyle.PUSH
    if is_delimited(frame):
        return DecoderStyle.DELIMITED
    if _is_flat(frame):
        return DecoderStyle.FLAT
    return DecoderStyle.KEPT if is_kept(frame) else DecoderStyle.PUSH


def _is_flat(frame: ReceivedFrame) -> bool:
    """True if a frame is told by its start, and its size by its head."""
    return (
        frame.plan.store is Store.CONTENT
        and not frame.plan.is_cut_off
        and not frame.told_parts
        and _delimiters_are_seen(frame)
        and frame.simple
        and frame.known_from > 0
        and _head_is_plain(frame)
        and _tail_is_plain(frame)
        and _region_is_plain(frame)
    )


def _delimiters_are_seen(frame: ReceivedFrame) -> bool:
    """True if no delimiter is missed, whatever went before."""
    plan = frame.plan
    single = plan.start_size <= 1 and len(plan.end_bytes) <= 1
    return (
        plan.start in (StartRule.LITERAL, StartRule.SET)
        and plan.start_is_unique
        and (single or frame.escape_starts)
        and (not plan.end_bytes or plan.end_is_unique)
        and not plan.shares_delimiter
    )


def _head_is_plain(frame: ReceivedFrame) -> bool:
    """True if nothing of a start is checked but the identity."""
    return all(n.identifies or n.last >= frame.first_head for n in frame.head_numbers)


def _tail_is_plain(frame: ReceivedFrame) -> bool:
    """True if nothing behind the payload is checked but checksums, which are always there."""
    return not frame.checks_tail and not frame.optional_tail


def _tail_stays(frame: ReceivedFrame) -> bool:
    """True if what an event shows of the tail is still where its payload ends.

    One that is cut ends elsewhere, and the zeros that fill one up take the tail's place.
    """
    return not frame.fits_payloads or all(part.in_head for part in frame.parts)


def _region_is_plain(frame: ReceivedFrame) -> bool:
    """True if nothing is stuffed, or all between the delimiters is, each byte for itself."""
    if frame.stuffing is None:
        return True
    alone = (StuffingKind.CODES, StuffingKind.LENIENT_ESCAPE, StuffingKind.BASE16)
    return frame.is_stuffed_behind_start and frame.stuffing.kind in alone


def _payload_is_plain(frame: ReceivedFrame) -> bool:
    """True if no byte with its most significant bit set can get into a payload unseen."""
    return not frame.plan.seven_bit or _high_bytes_show(frame)


def _high_bytes_show(frame: ReceivedFrame) -> bool:
    """True if every byte with that bit set is a start or an end."""
    return frame.gives_up_high_bytes or set(range(128, 256)) <= set(frame.never_passed)
