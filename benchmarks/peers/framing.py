"""Frames by hand for the peers that only read payloads: found, unstuffed, checked; without events.

A stream in order is cut with what `slotted_*` uses; no peer pays for more framing than the code by
hand does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from peers import slotted_matty, slotted_rflex

Payloads = Iterator[tuple[int, bytes]]
"""The counter of a frame, and its payload."""

_SIZES = {0x80: 8, 0x84: 722}


def rn1(data: bytes) -> Payloads:
    """Raises ValueError at bytes that are no whole frame."""
    at = 0
    while at < len(data):
        end = at + _SIZES[data[at]]
        payload = data[at + 1 : end]
        if end > len(data) or not payload.isascii():
            raise ValueError("no whole frame")
        yield 0, payload
        at = end


def rflex(data: bytes) -> Payloads:
    """Raises ValueError at bytes that are no valid frame."""
    at = 0
    while at < len(data):
        end = data.find(b"\x1b\x03", at + 2)
        if end < 0 or not data.startswith(b"\x1b\x02", at):
            raise ValueError("no whole frame")
        content = slotted_rflex.content_of(data[at + 2 : end])
        yield content[1], content[4:-1]
        at = end + 2


def matty(data: bytes) -> Payloads:
    """Raises ValueError at bytes that are no valid frame."""
    first, *pieces = data.split(b"\x55")
    if first:
        raise ValueError("no sync")
    for piece in pieces:
        content = slotted_matty.unstuffed(piece) if b"\x56" in piece else piece
        if content is None or not slotted_matty.is_valid(content):
            raise ValueError("no valid frame")
        yield content[1], content[3:-1]


PAYLOADS: dict[str, Callable[[bytes], Payloads]] = {"rn1": rn1, "rflex": rflex, "matty": matty}


def framed_rn1(identity: int) -> Callable[[bytes, int], bytes]:
    start = bytes((identity,))
    return lambda payload, _: start + payload


def framed_rflex(class_id: int, subclass: int) -> Callable[[bytes, int], bytes]:
    return lambda payload, count: slotted_rflex.framed(class_id, count, subclass, payload)


def framed_status(payload: bytes, count: int) -> bytes:
    return slotted_matty.framed(0x49, count, payload)


FRAMED: dict[str, Callable[[bytes, int], bytes]] = {
    "gyro": framed_rn1(0x80),
    "lidar": framed_rn1(0x84),
    "read_motor": framed_rflex(0x02, 0x21),
    "sonar_data": framed_rflex(0x04, 0x02),
    "status": framed_status,
}
"""The frame of a payload with a counter."""
