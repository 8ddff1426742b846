"""Bytes that a frame can need on the wire, as far as its parts and the size of its payload tell."""

from __future__ import annotations

from collections.abc import Iterable

from protogen.model.frame_places import PlacedPart
from protogen.model.frame_plan import FramePlan
from protogen.model.parts import IdentityPart, LengthPart, LiteralPart, TypedPart
from protogen.model.transparency import FULL_GROUP, Cobs

_MOST_VALUES = 4096
"""Values of a part that are tried; with more, each of its bytes counts as one that is replaced."""


def room(plan: FramePlan, payload: int, beside: int | None = None) -> int:
    """Wire bytes that the frame of a payload can need; `beside` is that of several plans."""
    absent = 0 if payload else plan.optional_size
    content = plan.head_size + payload + plan.tail_size - absent
    if plan.region is None:
        return content + len(plan.end_bytes)
    if isinstance(plan.region.encoding, Cobs):
        return content + len(plan.end_bytes) + content // FULL_GROUP + 1
    if plan.region.insertion is not None:
        return content + len(plan.end_bytes) + content // len(plan.region.insertion.sequence)
    return plan.region.longest * content + (room_beside(plan) if beside is None else beside)


def room_beside(plan: FramePlan, *, known: bool = True) -> int:
    """What a frame needs beside the most for each byte of its content.

    That is its end, less what bytes need less that are never replaced: 0 or below it, mostly.
    Identities are `known` where a frame has none but those of the sender's messages.
    """
    if plan.region is None:
        return len(plan.end_bytes)
    plain = sum(_plain(plan, item, known=known) for item in plan.placed if not item.is_optional)
    return len(plan.end_bytes) - (plan.region.longest - 1) * plain


def _plain(plan: FramePlan, item: PlacedPart, *, known: bool) -> int:
    """Bytes of a part that are one byte each on the wire, whatever it holds."""
    assert plan.region is not None
    if not item.is_stuffed:
        return item.size
    replaced = {byte for byte, _ in plan.region.codes}
    if not replaced:  # All are, by digits.
        return 0
    each = _values(plan, item, known=known)
    if each is None:
        return 0
    return sum(replaced.isdisjoint(place) for place in zip(*each, strict=True))


def _values(plan: FramePlan, item: PlacedPart, *, known: bool) -> Iterable[bytes] | None:
    """The bytes of each value that a part has in frames; None where that is not known."""
    part = item.part
    if isinstance(part, LiteralPart):
        return [part.bytes]
    if not isinstance(part, TypedPart):
        return None
    values: list[range] = []
    if isinstance(part, LengthPart) and plan.length is not None and not plan.length.over_wire:
        if part.name == plan.length.part.name:
            greatest = max((group.greatest for group in plan.groups), default=0)
            values = [range(plan.length.base, plan.length.counted(greatest) + 1)]
    elif isinstance(part, IdentityPart) and known:
        index = [one.name for one in plan.frame.identity].index(part.name)
        runs = [run for group in plan.groups for run in group.told_by.runs[index]]
        values = [range(first, last + 1) for first, last in runs]
    if not values or sum(map(len, values)) > _MOST_VALUES:
        return None
    return [part.encode(value) for run in values for value in run]
