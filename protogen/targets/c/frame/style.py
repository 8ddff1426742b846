"""The style of a decoder: how much of a state machine its frames need."""

from __future__ import annotations

from enum import Enum, auto

from protogen.model.frame_plan import FramePlan, StartRule, Store
from protogen.targets.c.frame.numbers import literals_of, numbers_of
from protogen.targets.c.frame.stuffing import Node, Stuffing, StuffingKind, stuffing_of
from protogen.targets.c.options import Events


class DecoderStyle(Enum):
    """Shape in which a decoder is printed."""

    PUSH = auto()
    """A machine with states, which calls a handler: any frame, any events."""
    FLAT = auto()
    """No more states than how much of a frame is there; `push` returns the message."""


def decoder_style(plan: FramePlan, events: Events) -> DecoderStyle:
    """The style for frames of which these events are asked.

    A flat decoder is for frames that begin with a protected start and tell their size in their
    head, where nobody asks what was wrong: a byte of a start is always one, and what does not fit
    is given up.
    """
    is_flat = (
        events == "messages"
        and plan.store is Store.CONTENT
        and _delimiters_are_seen(plan)
        and size_is_early(plan, events)
        and _head_is_plain(plan)
        and _tail_is_plain(plan)
        and _region_is_plain(plan)
        and not (plan.seven_bit and not high_bytes_show(plan))
    )
    return DecoderStyle.FLAT if is_flat else DecoderStyle.PUSH


# --- the questions --------------------------------------------------------------------------------


def can_open(plan: FramePlan, events: Events) -> bool:
    """True if the payload of some frame has no size until its end is seen."""
    is_kept_whole = plan.store is not Store.CONTENT or plan.end_begins_start
    if events == "messages" and not is_kept_whole and plan.identity_is_early:
        # What nobody asked for is given up at once: no frame can start inside of it.
        return plan.length is None and bool(plan.end_bytes) and plan.has_open_groups
    return plan.opens


def size_is_early(plan: FramePlan, events: Events) -> bool:
    """True if the head tells every payload's size."""
    return not can_open(plan, events) and not plan.measures and known_from(plan) > 0


def known_from(plan: FramePlan) -> int:
    """Bytes of content that tell the payload's size, where the head tells it; else 0."""
    return plan.size_known_at or 0


def first_head(plan: FramePlan) -> int:
    """Bytes of a start."""
    return len(plan.start_bytes) if plan.start is StartRule.LITERAL else 1


def identity_is_start(plan: FramePlan) -> bool:
    """True if a start of one byte is the whole identity, and tells the payload's size."""
    numbers = numbers_of(plan, plan.head)
    return plan.start is StartRule.SET and any(n.identifies and n.last == 0 for n in numbers)


def ends_with_high_byte(plan: FramePlan) -> bool:
    """True if a high byte is either the identity of a frame, or ends what goes before it."""
    all_end = identity_is_start(plan) and plan.seven_bit and not plan.end_bytes
    return all_end and plan.start_set.start == 128


def never_passed(plan: FramePlan) -> tuple[int, ...]:
    """Bytes that are a start or an end by themselves, so that nothing else sees them."""
    return (*(plan.start_set or plan.start_bytes), *plan.end_bytes)


def high_bytes_show(plan: FramePlan) -> bool:
    """True if no byte with its most significant bit set can get into a payload unseen."""
    return ends_with_high_byte(plan) or set(range(128, 256)) <= set(never_passed(plan))


def escape_nodes(plan: FramePlan, stuffing: Stuffing | None) -> tuple[Node, ...]:
    """The nodes behind a delimiter's first byte, the one behind nothing else first."""
    nodes = () if stuffing is None else stuffing.nodes
    return tuple(node for node in nodes if node.beginning.endswith(plan.start_bytes[:1]))


def escape_starts(plan: FramePlan, stuffing: Stuffing | None) -> bool:
    """True if delimiters are told by the nodes of the stuffing.

    They have two bytes, the first of which always leads to a node that ends with it.
    """
    delimiters = [plan.start_bytes, *filter(None, [plan.end_bytes])]
    if stuffing is None or stuffing.kind is not StuffingKind.CODES:
        return False
    if any(len(delimiter) != 2 for delimiter in delimiters):
        return False
    first = delimiters[0][0]
    seconds = {delimiter[1] for delimiter in delimiters}
    nodes = escape_nodes(plan, stuffing)
    taken = {branch.byte for node in nodes for branch in node.branches}
    return (
        all(delimiter[0] == first for delimiter in delimiters)
        and len(seconds) == len(delimiters)
        and first not in seconds
        and any(node.beginning == bytes((first,)) for node in nodes)
        and not any(code.sequence[-1] == first for code in stuffing.codes)
        and not taken & seconds
    )


def reaches_end(plan: FramePlan) -> bool:
    """True if nothing but the end stands behind the stuffed region, and nothing is checked there.

    Where no end is looked for, a region's own end has to be seen to fit.
    """
    region, stuffing = plan.region, stuffing_of(plan.region)
    if region is None or stuffing is None:
        return False
    may_not_fit = stuffing.is_cobs or region.lenient
    return region.reaches_end and (plan.end_is_unique or not may_not_fit)


def is_stuffed_behind_start(plan: FramePlan) -> bool:
    """True if all that is stuffed is what stands between a start and an end."""
    region = plan.region
    return region is not None and reaches_end(plan) and region.before == first_head(plan)


# --- what a flat decoder asks ---------------------------------------------------------------------


def _delimiters_are_seen(plan: FramePlan) -> bool:
    """True if no delimiter is missed, whatever went before."""
    single = first_head(plan) == 1 and len(plan.end_bytes) <= 1
    return (
        plan.start in (StartRule.LITERAL, StartRule.SET)
        and plan.start_is_unique
        and (single or escape_starts(plan, stuffing_of(plan.region)))
        and (not plan.end_bytes or plan.end_is_unique)
        and not plan.shares_delimiter
    )


def _head_is_plain(plan: FramePlan) -> bool:
    """True if nothing of a start is checked but the identity."""
    start = first_head(plan)
    return all(n.identifies or n.last >= start for n in numbers_of(plan, plan.head))


def _tail_is_plain(plan: FramePlan) -> bool:
    """True if nothing behind the payload is checked but checksums, which are always there."""
    checked = (*numbers_of(plan, plan.tail), *literals_of(plan.tail))
    return not checked and not any(item.is_optional for item in plan.tail)


def _region_is_plain(plan: FramePlan) -> bool:
    """True if nothing is stuffed, or all between the delimiters is, each byte for itself."""
    stuffing = stuffing_of(plan.region)
    if stuffing is None:
        return True
    alone = (StuffingKind.CODES, StuffingKind.LENIENT_ESCAPE, StuffingKind.BASE16)
    return is_stuffed_behind_start(plan) and stuffing.kind in alone
