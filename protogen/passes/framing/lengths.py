"""Lengths of a frame: what they count, and that a receiver can use them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from protogen.model.frame import LengthPart, Part, written_apart
from protogen.passes.context import Context, Loc
from protogen.passes.framing.virtual_parts import sent_run
from protogen.schema.syntax.parts import Part as PartSyntax

_PAYLOAD = "payload"


class Lengths:
    """The lengths of one frame, whose parts are these."""

    def __init__(self, context: Context, loc: Loc, parts: Mapping[str, PartSyntax]) -> None:
        self._context = context
        self._loc = loc
        self._parts = parts
        self._order = list(parts)

    def counted(self, loc: Loc, written: Sequence[str]) -> tuple[str, ...]:
        """The parts that a length counts, which is a part or some bits of one."""
        place = (*loc, "counts")
        counts = sent_run(self._context, self._parts, written, place, "a length counts bytes")
        if counts and _PAYLOAD not in counts:
            text = "a length that does not count the payload can't tell where the frame ends"
            self._context.error("PG133", place, text)
        if self._is_behind_payload(str(loc[len(self._loc)])):
            text = "a length behind the payload comes too late for a receiver"
            self._context.error_at_key("PG133", loc, text)
        return counts

    def _is_behind_payload(self, holder: str) -> bool:
        order = self._order
        return _PAYLOAD in order and order.index(holder) > order.index(_PAYLOAD)

    def check_number(self, parts: Sequence[Part | None]) -> None:
        """Report a length behind another one."""
        lengths = [
            (holder.name, part.name)
            for holder in filter(None, parts)
            for part in written_apart([holder])
            if isinstance(part, LengthPart)
        ]
        for holder, name in lengths[1:]:
            place = (holder,) if name == holder else (holder, "bits", name)
            text = f"the frame already has a length: `{lengths[0][1]}`"
            self._context.error_at_key("PG133", (*self._loc, *place), text)
