"""Lengths and checksums over bytes as they are on the wire: whether a receiver can follow them."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.model.frame import Frame
from protogen.model.parts import ChecksumPart, LengthPart
from protogen.model.transparency import Escape, Insertion, Substitution
from protogen.passes.context import Context, Loc
from protogen.passes.framing.capacity import counted_size

_BYTE_BY_BYTE = Substitution | Escape | Insertion
"""Stuffings that take each byte off the wire as it comes."""


def check_wire_length(context: Context, frame: Frame, loc: Loc) -> None:
    """Report a length over the wire that does not tell where the frame ends."""
    length = frame.length
    if length is None or not length.over_wire:
        return
    for text, hint in _obstacles(frame, length):
        context.error("PG249", (*loc, length.name, "over"), text, hint)
        return  # The others may follow from it.


def _obstacles(frame: Frame, length: LengthPart) -> Iterator[tuple[str, str]]:
    transparency = frame.transparency
    if transparency is None or frame.stuffed.isdisjoint(length.counts):
        yield "nothing that it counts is stuffed", "remove `over`"
        return
    if not isinstance(transparency.encoding, _BYTE_BY_BYTE) or transparency.lenient:
        hint = "count unstuffed bytes, or use `substitute` or `escape`, and not `lenient`"
        yield "with this stuffing, a receiver can't tell where so many bytes end", hint
    if length.name in frame.stuffed:
        yield "a length that is stuffed itself can't count what is sent", "send it unstuffed"
    missing = sorted(frame.stuffed - {*length.counts})
    if missing:
        text = f"`{missing[0]}` is stuffed, too, and not counted: its size on the wire varies"
        yield text, "count all stuffed parts"
    if frame.payload.name not in frame.stuffed:
        yield "the payload is not stuffed, so its size has to be counted itself", "stuff it, too"
    for part in frame.checksums:
        if frame.holder(part.name).name in frame.stuffed:
            text = f"the checksum `{part.name}` is stuffed, so the length would depend on its value"
            yield text, "send the checksum unstuffed"
        if part.is_optional:
            text = f"`{part.name}` may be absent, which only the payload would tell"
            yield text, "remove `when`"
    least = counted_size(frame, length, empty=True)
    if length.least > least:
        text = f"its least value is {length.least}, and it counts {least} bytes besides the payload"
        hint = f"bound it above alone: `range: [{least}, {length.greatest}]`"
        yield f"{text}, which stuffing makes more", hint


def check_wire_sum(context: Context, frame: Frame, part: ChecksumPart, loc: Loc) -> None:
    """Report a checksum over some of what is stuffed, where bytes depend on those in front."""
    if not part.over_wire or not isinstance(frame.encoding, Insertion):
        return
    missing = [item.name for item in frame.parts if item.name in frame.stuffed - {*part.covers}]
    if missing and not frame.stuffed.isdisjoint(part.covers):
        text = f"what is put in depends on `{missing[0]}`, which it does not cover"
        hint = "cover all that is stuffed, or sum unstuffed bytes"
        context.error("PG250", (*loc, part.name, "over"), text, hint)
