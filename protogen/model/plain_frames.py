"""Frames without rare things, which targets may take or make in one go.

Where these hold, a target prints no more than where everything is. All other frames are left to
what knows every frame.
"""

from __future__ import annotations

from protogen.model.frame_places import Place, Run, Side
from protogen.model.frame_plan import FramePlan
from protogen.model.part_plans import ChecksumPlan, StuffedRegion
from protogen.model.parts import BitsPart, ChoicePart, LengthPart, Part, TypedPart
from protogen.model.transparency import Escape, Substitution

_BITS = (8, 16, 32)
_FEW = 8
"""So many bytes that are stuffed are compared one by one."""


def is_plain(plan: FramePlan) -> bool:
    """True if a frame has no rare things.

    It has literals and numbers of whole bytes with any value, a size that the head tells, checksums
    over one run, and few sequences that are stuffed.
    """
    parts, region = [item.part for item in (*plan.head, *plan.tail)], plan.region
    is_odd = any(part.is_optional or not _is_simple(part) for part in parts)
    is_fitted = plan.is_cut or plan.frame.payload.kept is not None
    needs_more = plan.virtual or plan.further_lengths or plan.shares_delimiter or is_fitted
    sums_one = all(map(_sums_one_run, plan.checksums))
    fixed = any(sizes.fixed is not None for group in plan.groups for sizes in group.sizes)
    tells_size = plan.length is not None or fixed
    is_short = region is None or (is_listed(region) and region.before < plan.head_size)
    taken = plan.takes_whole and sums_one and tells_size and is_short
    return taken and not (is_odd or needs_more or plan.bounded)


def is_put_together(plan: FramePlan) -> bool:
    """True if such a frame can be put together around its payload, whatever it is."""
    counts_wire = plan.length is not None and plan.length.over_wire
    needs_more = len(plan.checksums) > 1 or plan.frame.limit is not None
    return is_plain(plan) and not (counts_wire or needs_more)


def _is_simple(part: Part) -> bool:
    """True if a part is no number, or one of whole bytes that has any value."""
    if not isinstance(part, TypedPart):
        return True
    type_ = part.type
    is_text = type_.is_text or type_.text is not None or type_.byte_bits == 7
    return type_.bits in _BITS and not (is_text or isinstance(part, BitsPart | ChoicePart))


def _sums_one_run(plan: ChecksumPlan) -> bool:
    """True if a checksum runs over one run of content."""
    is_run = len(plan.covers) == 1 and isinstance(plan.covers[0], Run)
    return is_run and not plan.part.over_wire


def summed_run(plan: ChecksumPlan) -> Run:
    """What a checksum of a plain frame runs over."""
    (run,) = plan.covers
    assert isinstance(run, Run)
    return run


def is_listed(region: StuffedRegion) -> bool:
    """True if a few sequences are all that a region has besides plain bytes."""
    is_few = isinstance(region.encoding, Substitution | Escape) and len(region.codes) <= _FEW
    return is_few and not (region.lenient or region.behind)


def folded_run(plan: FramePlan) -> Run | None:
    """What a checksum of bytes runs over that is the last byte of a region; None of another one."""
    is_last = plan.region is not None and is_listed(plan.region) and plan.tail_size == 1
    if plan.region is None or not is_last or len(plan.checksums) != 1:
        return None
    (item,), spec = plan.checksums[0].covers, plan.checksums[0].part.algorithm
    is_bare = spec.is_folded_byte and spec.is_bare
    if not isinstance(item, Run) or item.first.is_tail or not is_bare:
        return None
    is_behind = item.end == plan.checksums[0].placed.place == Place(Side.TAIL, 0)
    is_in = plan.region.before <= item.first.offset <= plan.head_size
    return item if is_behind and is_in else None


def zero_sum_run(plan: FramePlan) -> Run | None:
    """The same, if the run and its checksum add up to 0, so that there is nothing to compare."""
    region, run = plan.region, folded_run(plan)
    if region is None or run is None or run.first.offset not in (region.before, plan.head_size):
        return None
    spec = plan.checksums[0].part.algorithm
    return run if spec.negated == (spec.kind == "sum") else None


def length_bounds(plan: FramePlan, part: LengthPart, greatest_payload: int) -> tuple[int, int]:
    """The least and the greatest value that a length can have in a frame."""
    length = plan.counted(part)
    return max(part.least, length.base), min(length.greatest, length.base + greatest_payload)


def may_contain_marks(plan: FramePlan) -> bool:
    """True if a byte that may end a start or an end may stand inside a plain frame."""
    marks = [word[-1] for word in plan.start_words if plan.start_is_unique]
    marks += plan.end_bytes[-1:] if plan.end_is_unique else b""
    is_payload = plan.start_size == plan.head_size and not plan.tail_size
    is_known = plan.seven_bit and is_payload and min(marks, default=128) > 127
    return bool(marks) and not is_known
