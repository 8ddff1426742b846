"""Checks of what checksums cover, when all parts of a frame are there."""

from __future__ import annotations

from collections.abc import Iterable

from protogen.model.frame import Frame
from protogen.model.parts import ChecksumPart, checksums_of
from protogen.model.transparency import Cobs
from protogen.passes.context import Context, Loc
from protogen.passes.framing.bit_names import place_of_number
from protogen.passes.framing.wire_counts import check_wire_sum


def check_checksums(context: Context, frame: Frame, loc: Loc) -> None:
    """Report checksums that cover each other, or bytes that are those of no part."""
    in_circles: set[str] = set()
    for part in frame.checksums:
        place = place_of_number(loc, frame, part.name)
        circle = [] if part.name in in_circles else _circle(frame, part.name)
        in_circles.update(circle)
        if circle:
            text = f"the checksums cover each other: {' -> '.join((*circle, part.name))}"
            context.error("PG136", (*place, "covers"), text)
        if part.over_wire and _holds_cobs(frame, part):
            text = "bytes that COBS makes belong to no single part, so none can be summed up"
            context.error("PG131", (*place, "over"), text)
        check_wire_sum(context, frame, part, loc)


def _circle(frame: Frame, name: str) -> list[str]:
    """The checksums that lead from this one back to it by what they cover, or none."""
    covers = {part.name: part.covers for part in frame.checksums}
    paths = [[name]]
    seen = {name}
    for path in paths:
        for covered in _checksums_in(frame, covers[path[-1]]):
            if covered == name:
                return path
            if covered not in seen:
                seen.add(covered)
                paths.append([*path, covered])
    return []


def _checksums_in(frame: Frame, covers: Iterable[str]) -> list[str]:
    """The checksums that have bytes among those of these parts."""
    found = (part for part in frame.parts if part.name in covers)
    return [checksum.name for part in found for checksum in checksums_of(part)]


def _holds_cobs(frame: Frame, part: ChecksumPart) -> bool:
    return isinstance(frame.encoding, Cobs) and not frame.stuffed.isdisjoint(part.covers)
