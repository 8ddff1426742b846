"""By hand with NumPy: whole streams of one message into structured arrays.

Frames are found, unstuffed, checked and read all at once. A stream of rn1 may be damaged; of rflex
and matty all frames must be whole and of the message's size, else ValueError is raised.
"""

from __future__ import annotations

from typing import Any

import numpy as np

Array = Any

# --- RN#1 -----------------------------------------------------------------------------------------


def _payloads(data: bytes, identity: int, size: int) -> Array:
    """One row of bytes for the payload of each whole message."""
    octets = np.frombuffer(data, np.uint8)
    starts = np.flatnonzero(octets & 0x80)
    ends = np.append(starts[1:], len(octets))
    starts = starts[(octets[starts] == identity) & (ends - starts > size)]
    return octets[starts[:, None] + np.arange(1, size + 1)]


def _plain(payloads: Array) -> Array:
    """The numbers of 14 bits behind the status."""
    return payloads[:, 1::2] | payloads[:, 2::2].astype(np.uint16) << 7


GYRO = np.dtype([("status", "u1"), *((f"int_{axis}", "<i2") for axis in "xyz")])
LIDAR = np.dtype([("status", "u1"), ("distances", "<u2", 360)])


def gyro(data: bytes) -> Array:
    payloads = _payloads(data, 0x80, 7)
    numbers = ((_plain(payloads) << 2).astype(np.int16)) >> 2
    found = np.empty(len(payloads), GYRO)
    found["status"] = payloads[:, 0]
    for place, axis in enumerate("xyz"):
        found[f"int_{axis}"] = numbers[:, place]
    return found


def lidar(data: bytes) -> Array:
    payloads = _payloads(data, 0x84, 721)
    found = np.empty(len(payloads), LIDAR)
    found["status"] = payloads[:, 0]
    found["distances"] = _plain(payloads)
    return found


# --- rFLEX ----------------------------------------------------------------------------------------

_HEAD = [("class_id", "u1"), ("number", "u1"), ("subclass", "u1"), ("length", "u1")]
_WORDS = [("unknown", ">u4"), ("timestamp", ">u4")]
_SIGNED = [(name, ">i4") for name in ("position", "velocity", "acceleration", "torque")]
MOTOR = np.dtype([*_HEAD, *_WORDS, ("axis", "u1"), *_SIGNED, ("checksum", "u1")])
READING = np.dtype([("cluster", "u1"), ("distance", ">u2")])


def _rflex(data: bytes) -> tuple[Array, Array]:
    """The bytes in the frames, and the size of each. Raises ValueError."""
    octets = np.frombuffer(data, np.uint8)
    escapes = np.flatnonzero(octets == 0x1B)
    if escapes[-1] + 1 == len(octets):
        raise ValueError("cut off")
    codes = octets[escapes + 1]
    starts, ends, bars = (escapes[codes == code] for code in (2, 3, 1))
    is_paired = len(starts) == len(ends) and starts[0] == 0 and ends[-1] + 2 == len(octets)
    if not is_paired or (starts[1:] != ends[:-1] + 2).any() or (codes > 3).any():
        raise ValueError("not frame behind frame")
    if len(bars) != np.count_nonzero(octets == 0x7C) or (octets[bars - 1] != 0x7C).any():
        raise ValueError("stuffing")
    keep = np.ones(len(octets), bool)
    keep[escapes + 1] = False
    keep[starts] = keep[ends] = keep[bars] = False
    kept = np.cumsum(keep, dtype=np.int64)
    return octets[keep], kept[ends] - kept[starts]


def motor(data: bytes) -> Array:
    content, sizes = _rflex(data)
    if (sizes != 30).any():
        raise ValueError("size")
    rows = content.reshape(-1, 30)
    found = rows.view(MOTOR)[:, 0]
    if np.bitwise_xor.reduce(rows[:, 4:], axis=1).any():
        raise ValueError("checksum")
    if (rows[:, [0, 2, 3]] != (2, 0x21, 25)).any():
        raise ValueError("head")
    return found


def sonar(data: bytes) -> Array:
    content, sizes = _rflex(data)
    size = int(sizes[0])
    if size < 13 or size % 3 != 1 or (sizes != size).any():
        raise ValueError("size")
    count = (size - 13) // 3
    kind = np.dtype([*_HEAD, *_WORDS, ("readings", READING, count), ("checksum", "u1")])
    rows = content.reshape(-1, size)
    if np.bitwise_xor.reduce(rows[:, 4:], axis=1).any():
        raise ValueError("checksum")
    if (rows[:, [0, 2, 3]] != (4, 2, size - 5)).any():
        raise ValueError("head")
    return rows.view(kind)[:, 0]


# --- Matty ----------------------------------------------------------------------------------------

_UNSIGNED = [(f"encoder{place}", "<u2") for place in range(4)]
STATUS = np.dtype(
    [
        *(("length", "u1"), ("counter", "u1"), ("command", "u1"), ("status", "u1"), ("mode", "u1")),
        *(("voltage", "<u2"), ("current", "<u2"), ("speed", "<i2"), ("angle", "<i2")),
        *_UNSIGNED,
        ("crc", "u1"),
    ]
)


def status(data: bytes) -> Array:
    octets = np.frombuffer(data, np.uint8)
    starts = np.flatnonzero(octets == 0x55)
    escapes = np.flatnonzero(octets == 0x56)
    plain = octets.copy()
    plain[escapes + 1] ^= 0xFF
    keep = np.ones(len(octets), bool)
    keep[starts] = keep[escapes] = False
    kept = np.cumsum(keep, dtype=np.int64)[starts]
    content = plain[keep]
    if starts[0] or (np.diff(kept, append=len(content)) != 22).any():
        raise ValueError("size")
    if np.isin(octets[escapes + 1], (0xAA, 0xA9), invert=True).any():
        raise ValueError("stuffing")
    rows = content.reshape(-1, 22)
    if rows.sum(axis=1, dtype=np.uint8).any():
        raise ValueError("checksum")
    if (rows[:, [0, 2]] != (20, ord("I"))).any():
        raise ValueError("head")
    return rows.view(STATUS)[:, 0]


STREAMS = {
    "gyro": gyro,
    "lidar": lidar,
    "read_motor": motor,
    "sonar_data": sonar,
    "status": status,
}
