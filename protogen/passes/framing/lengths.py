"""Lengths of a frame: what they count, and that a receiver can use them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from protogen.copying import replace
from protogen.model.frame import Frame
from protogen.model.parts import (
    BitsPart,
    LengthPart,
    MirrorBits,
    Part,
    PayloadPart,
    ToldLength,
    written_apart,
)
from protogen.model.sizes import SizeSet
from protogen.passes.context import Context, Loc
from protogen.passes.framing.bit_names import place_of_number
from protogen.passes.framing.capacity import counted_size, range_of, stated_range
from protogen.passes.framing.virtual_parts import sent_run
from protogen.schema.syntax.parts import Part as PartSyntax

_PAYLOAD = "payload"


class Lengths:
    """The lengths of one frame, whose parts are these."""

    def __init__(self, context: Context, loc: Loc, parts: Mapping[str, PartSyntax]) -> None:
        self._context = context
        self._loc = loc
        self._parts = parts

    def counted(self, loc: Loc, written: Sequence[str]) -> tuple[str, ...]:
        """The parts that a length counts, which is a part or some bits of one."""
        place = (*loc, "counts")
        counts = sent_run(self._context, self._parts, written, place, "a length counts bytes")
        if counts and _PAYLOAD not in counts:
            text = "a length that does not count the payload can't tell where the frame ends"
            self._context.error("PG133", place, text)
        return counts

    def check_first(self, parts: Sequence[Part | None]) -> None:
        """Report lengths of which none stands in front of the payload."""
        behind, found = False, []
        for holder in filter(None, parts):
            behind = behind or isinstance(holder, PayloadPart)
            for part in written_apart([holder]):
                if isinstance(part, LengthPart) and not isinstance(part, ToldLength):
                    name = part.name
                    place = (name,) if name == holder.name else (holder.name, "bits", name)
                    found.append((behind, place))
        for place in (place for _, place in found if found[0][0]):
            text = "a length behind the payload comes too late for a receiver"
            self._context.error_at_key("PG133", (*self._loc, *place), text)

    def agreed(self, frame: Frame) -> Frame | None:
        """The frame, where each of several lengths is bounded by what all of them allow.

        None where they never agree. That a length states no payload at all is reported later.
        """
        if len(frame.lengths) < 2 or any(range_of(frame, it) is None for it in frame.lengths):
            return frame
        if not self._count_alike(frame):
            return None
        stated = stated_range(frame)
        if stated is None:
            self._never_agree(frame)
            return None
        bounded = {part.name: part for part in _bounded(frame, stated)}
        return replace(frame, parts=tuple(_with(part, bounded) for part in frame.parts))

    def _count_alike(self, frame: Frame) -> bool:
        """True if all lengths count unstuffed bytes."""
        for part in frame.lengths:
            if part.over_wire:
                other = next(it for it in frame.lengths if it is not part)
                text = f"`{part.name}` counts bytes on the wire, and `{other.name}` is one, too"
                hint = "count unstuffed bytes, or make one of them a part with a `type` alone"
                self._context.error("PG285", (*self._loc, part.name, "over"), text, hint)
                return False
        return True

    def _never_agree(self, frame: Frame) -> None:
        (one, sizes), (other, others) = self._apart(frame)
        text = f"`{one.name}` states payloads of {_bytes(sizes)}"
        text = f"{text}, and `{other.name}` of {_bytes(others)}"
        place = place_of_number(self._loc, frame, other.name)
        hint = "change a `range`, or what one of them counts"
        self._context.error_at_key("PG286", place, text, hint)

    @staticmethod
    def _apart(frame: Frame) -> tuple[tuple[LengthPart, SizeSet], tuple[LengthPart, SizeSet]]:
        """Two lengths that never agree, in wire order."""
        found = [(part, range_of(frame, part)) for part in frame.lengths]
        sizes = [(part, item) for part, item in found if item is not None]
        low = min(sizes, key=lambda it: it[1].greatest)
        high = max(sizes, key=lambda it: it[1].least)
        return (low, high) if sizes.index(low) < sizes.index(high) else (high, low)


def _bytes(sizes: SizeSet) -> str:
    count = sizes.fixed
    return f"{sizes.least} to {sizes.greatest} bytes" if count is None else f"{count} bytes"


def _bounded(frame: Frame, stated: SizeSet) -> Iterator[LengthPart]:
    """The lengths, each bounded by what all allow; those behind the first have to agree with it."""
    first = frame.lengths[0]
    for part in frame.lengths:
        own = range_of(frame, part)
        assert own is not None
        least, greatest = part.least, part.greatest
        if own.least < stated.least:
            least = stated.least + counted_size(frame, part, empty=False)
        if own.greatest > stated.greatest:
            empty = not stated.greatest
            greatest = stated.greatest + counted_size(frame, part, empty=empty)
        agrees_with = None if part is first else first.name
        yield replace(part, least=least, greatest=greatest, agrees_with=agrees_with)


def _with(part: Part, bounded: Mapping[str, LengthPart]) -> Part:
    """A part of the frame with these lengths in it."""
    if not isinstance(part, BitsPart):
        return bounded.get(part.name, part)
    members = tuple(bounded.get(item.name, item) for item in part.members)
    mirrors = tuple(_mirror_with(item, bounded) for item in part.mirrors)
    return replace(part, members=members, mirrors=mirrors)


def _mirror_with(item: MirrorBits, bounded: Mapping[str, LengthPart]) -> MirrorBits:
    return replace(item, of=bounded.get(item.of.name, item.of))
