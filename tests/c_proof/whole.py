"""Contracts of what takes a frame whole, out of bytes that are all there."""

from __future__ import annotations

import re

from c_proof.contracts import Contracts

_LIMIT = re.compile(r"left > (\d+)U\)")
_SIZES = re.compile(r"case (0x\w+)U:\n +\*payload = (\d+);")
"""Bytes of payload that a frame with a start of its own has."""


def takes_whole(
    made: Contracts, prefix: str, valid: str, changes: str, room: int, *promises: str
) -> None:
    """What takes frames whole, out of bytes that are all there."""
    data = r"\valid_read(data + (0 .. size - 1))"
    buffer = f"decoder->buffer[0 .. {room - 1}]"
    most = 0
    if made.has(f"{prefix}_measure_head"):
        head = made.body(f"{prefix}_measure_head")
        of_starts = _SIZES.findall(head)
        [limit] = _LIMIT.findall(head) or ["255"]
        most = max((int(size) for _, size in of_starts), default=int(limit))
        last = max(map(int, re.findall(r"content\[(\d+)\]", head)))
        made.put_safe(
            f"{prefix}_measure_head",
            rf"requires \valid(payload) && \valid_read(content + (0 .. {last}))",
            r"requires \separated(payload, content + (0 .. 0))",
            "assigns *payload",
            rf"ensures \result ==> *payload <= {most}",
            *_of_starts(of_starts),
        )
    made.put_safe(f"{prefix}_is_idle", r"requires \valid_read(decoder)", r"assigns \nothing")
    if made.has(f"{prefix}_unstuff_to"):
        changes = f"{changes}, {buffer}"
        made.put_safe(
            f"{prefix}_unstuff_one",
            rf"requires from <= size && {data} && \valid(unstuffed)",
            "assigns *unstuffed",
            r"ensures \result <= size && (\result == 0 || from < \result)",
        )
        made.put_safe(
            f"{prefix}_unstuff_to",
            f"requires 0 < from && from <= size && at <= need && need <= {room}",
            rf"requires \valid(decoder) && {data} && \separated(decoder, data + (0 .. size - 1))",
            f"assigns {buffer}",
            r"ensures \result <= size",
        )
        inside = "invariant 0 < from && from <= size && at <= need"
        made.loops(f"{prefix}_unstuff_to", inside, assigns=[buffer])
    if made.has(f"{prefix}_hand_over"):
        made.put_safe(
            f"{prefix}_hand_over",
            f"{valid} && content == decoder->buffer && payload <= {most}",
            "assigns decoder->offset, decoder->noise",
            r"ensures \result == 0 || \result == wire",
        )
    apart = rf"{data} && size > 0 && \separated(decoder, data + (0 .. size - 1))"
    made.put_safe(
        f"{prefix}_take_whole",
        f"{valid} && {apart}",
        changes,
        r"ensures \result <= size",
        *promises,
    )


def _of_starts(sizes: list[tuple[str, str]]) -> list[str]:
    """What a start says of the payload's size."""
    if not sizes:
        return []
    told = (f"(content[0] == {start} && *payload == {size})" for start, size in sizes)
    return [rf"ensures \result ==> {' || '.join(told)}"]
