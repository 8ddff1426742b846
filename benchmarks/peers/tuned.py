"""By hand for speed alone: whole buffers in, lists of tuples out, without offsets and raw bytes.

What is not plainly in order goes to the decoders with slotted objects.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from itertools import repeat
from operator import attrgetter
from struct import Struct
from typing import Any
from zlib import adler32

from peers import slotted_matty, slotted_rflex

Tuples = list[tuple[Any, ...]]

# --- RN#1 -----------------------------------------------------------------------------------------

_GYROS = re.compile(rb"\x80([\x00-\x7f]{7})")
_LIDARS = re.compile(rb"\x84([\x00-\x7f]{721})")
_GYRO = Struct("<Bhhh")
_LIDAR = Struct("<B360H")


@lru_cache(64)
def _masks(lane: bytes, count: int) -> int:
    return int.from_bytes(lane * count, "little")


def gyro(data: bytes) -> Tuples:
    """All gyro messages: status and three integrals each."""
    payloads = _GYROS.findall(data)
    count = len(payloads)
    # The pairs of all messages at once, as lanes of one great integer.
    great = int.from_bytes(b"".join(payloads), "little")
    plain = great & _masks(b"\x7f\x7f\x00\x7f\x00\x7f\x00", count)
    plain |= great >> 1 & _masks(b"\x00\x80\x3f\x80\x3f\x80\x3f", count)
    plain += (plain & _masks(b"\x00\x00\x20\x00\x20\x00\x20", count)) * 6  # Their signs.
    return list(_GYRO.iter_unpack(plain.to_bytes(7 * count, "little")))


def lidar(data: bytes) -> Tuples:
    """All turns of the lidar: status and 360 distances each, one after the other."""
    payloads = _LIDARS.findall(data)
    count = len(payloads)
    great = int.from_bytes(b"".join(payloads), "little")
    plain = great & _masks(b"\x7f" + 360 * b"\x7f\x00", count)
    plain |= great >> 1 & _masks(b"\x00" + 360 * b"\x80\x3f", count)
    return list(_LIDAR.iter_unpack(plain.to_bytes(721 * count, "little")))


# --- rFLEX ----------------------------------------------------------------------------------------

_HEAD = b"\x1b\x02"
_BETWEEN = b"\x1b\x03\x1b\x02"
_END = b"\x1b\x03"
_MOTOR = Struct(">4xIIBiiiix")
_SONAR = Struct(">II")
_READING = Struct(">BH")


def _contents(data: bytes) -> list[bytes]:
    """Payloads in the frames of a stream. Raises ValueError where it is not plainly in order."""
    if not (data.startswith(_HEAD) and data.endswith(_END)):
        raise ValueError("no whole frames")
    pieces = data[2:-2].split(_BETWEEN)
    unstuffed = slotted_rflex.unstuffed
    return [
        piece if b"\x1b" not in piece and b"|" not in piece else unstuffed(piece)
        for piece in pieces
    ]


def motor(data: bytes) -> Tuples:
    """All read-motor messages."""
    try:
        contents = _contents(data)
    except ValueError:
        return list(_slotted_motors(data))
    joined = b"".join(contents)
    count = len(contents)
    heads = joined[0::30], joined[2::30], joined[3::30]
    is_regular = {*map(len, contents)} == {30}
    if not is_regular or heads != (b"\x02" * count, b"\x21" * count, b"\x19" * count):
        return list(_slotted_motors(data))
    checksums = 0
    for place in range(4, 30):
        checksums ^= int.from_bytes(joined[place::30], "little")
    return list(_slotted_motors(data)) if checksums else list(_MOTOR.iter_unpack(joined))


def _slotted_motors(data: bytes) -> Iterator[tuple[Any, ...]]:
    fields = attrgetter(
        "unknown", "timestamp", "axis", "position", "velocity", "acceleration", "torque"
    )
    for event in slotted_rflex.Decoder().feed(data):
        message = getattr(event, "message", None)
        if isinstance(message, slotted_rflex.Motor):
            yield fields(message)


def sonar(data: bytes) -> Tuples:
    """All sonar messages: first word, time and a list of readings."""
    try:
        contents = _contents(data)
    except ValueError:
        return list(_slotted_sonars(data))
    found: Tuples = []
    xor = slotted_rflex.xor
    unpack, readings = _SONAR.unpack_from, _READING.iter_unpack
    for content in contents:
        size = len(content)
        if size < 13 or size % 3 != 1 or content[3] != size - 5 or xor(content[4:]):
            return list(_slotted_sonars(data))
        if content[0] == 4 and content[2] == 2:
            found.append((*unpack(content, 4), list(readings(content[12:-1]))))
    return found


def _slotted_sonars(data: bytes) -> Iterator[tuple[Any, ...]]:
    for event in slotted_rflex.Decoder().feed(data):
        message = getattr(event, "message", None)
        if isinstance(message, slotted_rflex.Sonar):
            readings = [(each.cluster, each.distance) for each in message.readings]
            yield message.unknown, message.timestamp, readings


# --- Matty ----------------------------------------------------------------------------------------

_STATUS = Struct("<3xBBHHhhHHHHx")


def status(data: bytes) -> Tuples:
    """All status messages."""
    first, *pieces = data.split(b"\x55")
    unstuffed = slotted_matty.unstuffed
    contents = [piece if b"\x56" not in piece else unstuffed(piece) or b"" for piece in pieces]
    joined = b"".join(contents)
    count = len(contents)
    is_regular = not first and {*map(len, contents)} == {22}
    heads = joined[0::22], joined[2::22]
    if not is_regular or heads != (b"\x14" * count, b"I" * count):
        return list(_slotted_statuses(data))
    if any(map((0xFF).__and__, map(adler32, contents, repeat(0)))):
        return list(_slotted_statuses(data))
    return list(_STATUS.iter_unpack(joined))


def _slotted_statuses(data: bytes) -> Iterator[tuple[Any, ...]]:
    fields = attrgetter(
        *("status", "mode", "voltage", "current", "speed", "angle"),
        *(f"encoder{place}" for place in range(4)),
    )
    for event in slotted_matty.Decoder().feed(data):
        message = getattr(event, "message", None)
        if isinstance(message, slotted_matty.Status):
            yield fields(message)


STREAMS = {
    "gyro": gyro,
    "lidar": lidar,
    "read_motor": motor,
    "sonar_data": sonar,
    "status": status,
}
