"""rFLEX by hand: `struct`, slotted objects, events. What an expert writes who wants speed."""

from __future__ import annotations

from enum import IntEnum
from itertools import starmap
from struct import Struct, error


class Axis(IntEnum):
    LINEAR = 0
    ANGULAR = 1


class Motor:
    __slots__ = (
        "acceleration",
        "axis",
        "position",
        "timestamp",
        "torque",
        "unknown",
        "velocity",
    )

    def __init__(
        self,
        unknown: int,
        timestamp: int,
        axis: Axis | int,
        position: int,
        velocity: int,
        acceleration: int,
        torque: int,
    ) -> None:
        self.unknown = unknown
        self.timestamp = timestamp
        self.axis = axis
        self.position = position
        self.velocity = velocity
        self.acceleration = acceleration
        self.torque = torque


class Reading:
    __slots__ = ("cluster", "distance")

    def __init__(self, cluster: int, distance: int) -> None:
        self.cluster = cluster
        self.distance = distance


class Sonar:
    __slots__ = ("readings", "timestamp", "unknown")

    def __init__(self, unknown: int, timestamp: int, readings: list[Reading]) -> None:
        self.unknown = unknown
        self.timestamp = timestamp
        self.readings = readings


class Event:
    __slots__ = ("message", "number", "offset", "raw")

    def __init__(self, offset: int, raw: bytes, number: int, message: Motor | Sonar) -> None:
        self.offset = offset
        self.raw = raw
        self.number = number
        self.message = message


class Unknown:
    __slots__ = ("offset", "raw")

    def __init__(self, offset: int, raw: bytes) -> None:
        self.offset = offset
        self.raw = raw


class Invalid(Unknown):
    __slots__ = ()


AXES: list[Axis | int] = [*Axis, *range(2, 256)]
UNPACK_MOTOR = Struct(">IIBiiii").unpack
UNPACK_PAIR = Struct(">II").unpack_from
ITER_READINGS = Struct(">BH").iter_unpack
new = object.__new__
"""An object without a call of its class's `__init__`, which takes longer than all the rest."""


def read_motor(payload: bytes) -> Motor:
    item = new(Motor)
    (
        item.unknown,
        item.timestamp,
        axis,
        item.position,
        item.velocity,
        item.acceleration,
        item.torque,
    ) = UNPACK_MOTOR(payload)
    item.axis = AXES[axis]
    return item


def read_sonar(payload: bytes) -> Sonar:
    readings = list(starmap(Reading, ITER_READINGS(payload[8:])))
    unknown, timestamp = UNPACK_PAIR(payload)
    return Sonar(unknown, timestamp, readings)


KINDS = {0x0221: read_motor, 0x0402: read_sonar}
BYTES = [bytes((byte,)) for byte in range(256)]


def xor(data: bytes) -> int:
    """All bytes of at most 255, laid over each other by halves."""
    great = int.from_bytes(data, "little")
    if len(data) > 32:
        great ^= great >> 1024
        great ^= great >> 512
        great ^= great >> 256
    great ^= great >> 128
    great ^= great >> 64
    great ^= great >> 32
    great ^= great >> 16
    return (great ^ great >> 8) & 0xFF


def stuffed(content: bytes) -> bytes:
    if 0x1B in content or 0x7C in content:
        return content.replace(b"\x1b", b"\x1b\x00").replace(b"\x7c", b"\x7c\x1b\x01")
    return content


def unstuffed(wire: bytes) -> bytes:
    """Raises ValueError where no sender would have put these bytes."""
    bars = wire.count(b"\x7c\x1b\x01")
    if wire.count(b"\x7c") != bars or wire.count(b"\x1b") != bars + wire.count(b"\x1b\x00"):
        raise ValueError("stuffing")
    return wire.replace(b"\x1b\x00", b"\x1b").replace(b"\x7c\x1b\x01", b"\x7c")


PACK_MOTOR = Struct(">IIBiiii").pack
PACK_PAIR = Struct(">II").pack
PACK_READING = Struct(">BH").pack
PACK_HEAD = Struct(">BBBB").pack


def framed(class_id: int, number: int, subclass: int, payload: bytes) -> bytes:
    content = PACK_HEAD(class_id, number, subclass, len(payload)) + payload + BYTES[xor(payload)]
    return b"\x1b\x02" + stuffed(content) + b"\x1b\x03"


def encode_motor(item: Motor, number: int) -> bytes:
    """Raises struct.error where a value does not fit."""
    payload = PACK_MOTOR(
        item.unknown,
        item.timestamp,
        item.axis,
        item.position,
        item.velocity,
        item.acceleration,
        item.torque,
    )
    return framed(0x02, number, 0x21, payload)


def encode_sonar(item: Sonar, number: int) -> bytes:
    """Raises struct.error where a value does not fit."""
    readings = [PACK_READING(each.cluster, each.distance) for each in item.readings]
    payload = PACK_PAIR(item.unknown, item.timestamp) + b"".join(readings)
    return framed(0x04, number, 0x02, payload)


def content_of(wire: bytes) -> bytes:
    """Bytes between start and end. Raises ValueError."""
    content = unstuffed(wire) if 0x1B in wire or 0x7C in wire else wire
    if len(content) < 5 or content[3] != len(content) - 5 or xor(content[4:]):
        raise ValueError("length or checksum")
    return content


def decode(frame: bytes) -> Motor | Sonar:
    """The message of exactly one frame. Raises ValueError or struct.error."""
    if frame[:2] != b"\x1b\x02" or frame[-2:] != b"\x1b\x03":
        raise ValueError("no whole frame")
    content = content_of(frame[2:-2])
    read = KINDS.get(content[0] << 8 | content[2])
    if read is None:
        raise ValueError("no message has this identity")
    return read(content[4:-1])


GREATEST = 782


class Decoder:
    """Cuts what flex sends into events."""

    def __init__(self) -> None:
        self._data = b""
        self._offset = 0

    def feed(self, data: bytes) -> list[Event | Unknown]:  # noqa: C901, PLR0915 - without calls
        """The events of the next bytes."""
        data = self._data + data if self._data else data
        base = self._offset
        events: list[Event | Unknown] = []
        append = events.append
        find = data.find
        startswith = data.startswith
        get = KINDS.get
        at = 0
        while True:
            if not startswith(b"\x1b\x02", at):
                start = find(b"\x1b\x02", at)
                if start < 0:
                    break
                append(Invalid(base + at, data[at:start]))
                at = start
            end = find(b"\x1b\x03", at + 2)
            if end < 0:
                if len(data) - at > GREATEST:
                    append(Invalid(base + at, data[at : at + 2]))
                    at += 2
                    continue
                break
            wire = data[at + 2 : end]
            end += 2
            content = wire
            if 0x1B in wire or 0x7C in wire:
                again = wire.rfind(b"\x1b\x02")
                if again >= 0:
                    append(Invalid(base + at, data[at : at + 2 + again]))
                    at += 2 + again
                    continue
                try:
                    content = unstuffed(wire)
                except ValueError:
                    append(Invalid(base + at, data[at:end]))
                    at = end
                    continue
            if len(content) < 5 or content[3] != len(content) - 5 or xor(content[4:]):
                append(Invalid(base + at, data[at:end]))
                at = end
                continue
            read = get(content[0] << 8 | content[2])
            if read is None:
                append(Unknown(base + at, data[at:end]))
            else:
                try:
                    append(Event(base + at, data[at:end], content[1], read(content[4:-1])))
                except error:
                    append(Invalid(base + at, data[at:end]))
            at = end
        self._data = data[at:]
        self._offset = base + at
        return events
