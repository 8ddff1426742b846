"""RN#1 by hand: `struct`, slotted objects, events. What an expert writes who wants speed."""

from __future__ import annotations

import re
from enum import IntEnum, IntFlag
from struct import Struct


class GyroStatus(IntEnum):
    OK = 1


class LidarStatus(IntFlag):
    INITIALIZED = 1
    SPEED_IN_SPEC = 2


class Gyro:
    __slots__ = ("int_x", "int_y", "int_z", "status")

    def __init__(self, status: GyroStatus | int, int_x: int, int_y: int, int_z: int) -> None:
        self.status = status
        self.int_x = int_x
        self.int_y = int_y
        self.int_z = int_z


class Lidar:
    __slots__ = ("distances", "status")

    def __init__(self, status: LidarStatus, distances: list[int]) -> None:
        self.status = status
        self.distances = distances


class Event:
    __slots__ = ("message", "offset", "raw")

    def __init__(self, offset: int, raw: bytes, message: Gyro | Lidar) -> None:
        self.offset = offset
        self.raw = raw
        self.message = message


class Unknown:
    __slots__ = ("offset", "raw")

    def __init__(self, offset: int, raw: bytes) -> None:
        self.offset = offset
        self.raw = raw


class Invalid(Unknown):
    __slots__ = ()


def _plain(code: int) -> int:
    """Number of 16 bits that two bytes of 7 bits mean."""
    return code & 0x7F | code >> 1 & 0x3F80


UNSIGNED = [_plain(code) for code in range(1 << 15)]
SIGNED = [(value ^ 0x2000) - 0x2000 for value in UNSIGNED]
UNSIGNED_CODES = {_plain(code): code for code in range(1 << 15) if not code & 0x80}
SIGNED_CODES = {(value ^ 0x2000) - 0x2000: code for value, code in UNSIGNED_CODES.items()}
GYRO_STATUS: list[GyroStatus | int] = [0, GyroStatus.OK, *range(2, 128)]
LIDAR_STATUS = [LidarStatus(value) for value in range(128)]

UNPACK_GYRO = Struct("<xBHHH").unpack
UNPACK_LIDAR = Struct("<xB360H").unpack
PACK_GYRO = Struct("<BBHHH").pack
PACK_LIDAR = Struct("<BB360H").pack


def read_gyro(raw: bytes) -> Gyro:
    status, x, y, z = UNPACK_GYRO(raw)
    return Gyro(GYRO_STATUS[status], SIGNED[x], SIGNED[y], SIGNED[z])


def read_lidar(raw: bytes) -> Lidar:
    status, *codes = UNPACK_LIDAR(raw)
    return Lidar(LIDAR_STATUS[status], [*map(UNSIGNED.__getitem__, codes)])


KINDS = {0x80: (8, read_gyro), 0x84: (722, read_lidar)}
GREATEST = 722
_START = re.compile(rb"[\x80-\xfe]")


def encode_gyro(item: Gyro) -> bytes:
    """Raises struct.error or KeyError where a value does not fit."""
    status = item.status
    if not 0 <= status < 128:
        raise ValueError("status")
    codes = SIGNED_CODES
    return PACK_GYRO(0x80, status, codes[item.int_x], codes[item.int_y], codes[item.int_z])


def encode_lidar(item: Lidar) -> bytes:
    """Raises struct.error or KeyError where a value does not fit."""
    status = item.status
    if not 0 <= status < 128:
        raise ValueError("status")
    return PACK_LIDAR(0x84, status, *map(UNSIGNED_CODES.__getitem__, item.distances))


def decode(frame: bytes) -> Gyro | Lidar:
    """The message of exactly one frame. Raises ValueError."""
    try:
        size, read = KINDS[frame[0]]
    except (KeyError, IndexError):
        raise ValueError("no message has this identity") from None
    if len(frame) != size or not frame[1:].isascii():
        raise ValueError("no whole frame")
    return read(frame)


class Decoder:
    """Cuts what the brain sends into events."""

    def __init__(self) -> None:
        self._data = b""
        self._offset = 0

    def feed(self, data: bytes) -> list[Event | Unknown]:
        """The events of the next bytes."""
        data = self._data + data if self._data else data
        base = self._offset
        events: list[Event | Unknown] = []
        append = events.append
        kinds = KINDS
        at = 0
        end = len(data)
        while at < end:
            kind = kinds.get(data[at])
            if kind is None:
                next_ = _START.search(data, at + 1)
                if next_ is None:
                    break
                made = Unknown if 0x80 <= data[at] < 0xFF else Invalid
                append(made(base + at, data[at : next_.start()]))
                at = next_.start()
                continue
            size, read = kind
            stop = at + size
            raw = data[at:stop]
            if raw[1:].isascii():
                if stop > end:
                    break
                append(Event(base + at, raw, read(raw)))
                at = stop
            else:
                next_ = _START.search(data, at + 1)
                stop = next_.start() if next_ else stop
                append(Invalid(base + at, data[at:stop]))
                at = stop
        self._data = data[at:]
        self._offset = base + at
        return events
