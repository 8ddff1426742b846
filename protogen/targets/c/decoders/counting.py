"""Bytes that counters of decoders with states know of."""

from __future__ import annotations


def bytes_kept(*, shares: bool) -> tuple[str, str, str]:
    """Bytes of a frame that is complete, behind it, and those kept where none is.

    A delimiter that two frames share is of the first one.
    """
    size, left = "decoder->failed", "(uint32_t)decoder->count - decoder->failed"
    if not shares:
        return size, left, "decoder->count"
    kept = "(uint32_t)decoder->count - decoder->shared"
    has_more = "decoder->count > decoder->shared"
    return f"(uint32_t){size} - decoder->shared", left, f"{has_more} ? {kept} : 0U"
