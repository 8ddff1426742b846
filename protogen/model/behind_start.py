"""The plan of a frame for those who keep no start that is known."""

from __future__ import annotations

import msgspec

from protogen.model.frame_plan import FramePlan


def behind_start(plan: FramePlan) -> FramePlan:
    """Make a plan whose places are counted from behind the start literal.

    The start's own bytes have negative places.
    """
    start = len(plan.start_bytes)
    return msgspec.structs.replace(
        plan,
        head=tuple(item.skipping(start) for item in plan.head),
        further_lengths=tuple(item.skipping(start) for item in plan.further_lengths),
        checksums=tuple(item.skipping(start) for item in plan.checksums),
        region=None if plan.region is None else plan.region.skipping(start),
    )
