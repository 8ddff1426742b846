"""Payloads out of bytes that were seen to be a frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from protogen.runtime.framing.layout import Layout, is_optional
from protogen.runtime.framing.machine import Cut, verdict_on
from protogen.runtime.framing.sender import SenderSpec


def payload_of(
    sender: SenderSpec[Any, Any], raw: bytes, told: Mapping[str, int] | None = None
) -> bytes:
    """The payload of what was seen to be a frame: the raw bytes of an event.

    `told` has the values of identity parts that are not sent.
    """
    layout = sender.layout
    # Its start may have been the end of the frame before, which is not among its bytes.
    begins_inside = layout.shares_delimiter and not raw.startswith(layout.start)
    content = _content_of(layout, layout.start + raw if begins_inside else raw)
    size = None if content is None else layout.payload_size(len(content))
    if content is None or size is None:
        verdict, _ = verdict_on(sender, raw, shares_start=begins_inside, told=told or {})
        assert isinstance(verdict, Cut)
        return verdict.payload
    return content[layout.head_size : layout.head_size + size]


def _content_of(layout: Layout, wire: bytes) -> bytes | None:
    """The content of a whole frame. None where its stuffed bytes can't be told at a glance."""
    content = wire[: len(wire) - len(layout.end)]
    transparency = layout.spec.transparency
    if transparency is None or not layout.stuffed:
        return content
    first, last = layout.stuffed[0], layout.stuffed[-1]
    behind = layout.parts[last + 1 :]
    if not first <= layout.payload_index <= last or any(map(is_optional, behind)):
        return None
    begin = sum(part.size for part in layout.parts[:first])
    end = len(content) - sum(part.size for part in behind)
    return content[:begin] + transparency.decode(content[begin:end]) + content[end:]
