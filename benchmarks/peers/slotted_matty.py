"""Matty by hand: `struct`, slotted objects, events. What an expert writes who wants speed."""

from __future__ import annotations

from enum import IntEnum, IntFlag
from struct import Struct
from zlib import adler32


class Mode(IntEnum):
    IDLE = 0
    REMOTE = 1
    AUTONOMOUS = 2


class Flags(IntFlag):
    EMERGENCY_STOP = 0x01
    VOLTAGE_LOW = 0x02
    BUMPER_FRONT = 0x04
    BUMPER_BACK = 0x08
    ERROR_ENCODER = 0x10
    ERROR_POWER = 0x20
    RUNNING = 0x80


class Status:
    __slots__ = (
        "angle",
        "current",
        "encoder0",
        "encoder1",
        "encoder2",
        "encoder3",
        "mode",
        "speed",
        "status",
        "voltage",
    )

    def __init__(  # noqa: PLR0913
        self,
        status: Flags,
        mode: Mode | int,
        voltage: int,
        current: int,
        speed: int,
        angle: int,
        encoder0: int,
        encoder1: int,
        encoder2: int,
        encoder3: int,
    ) -> None:
        self.status = status
        self.mode = mode
        self.voltage = voltage
        self.current = current
        self.speed = speed
        self.angle = angle
        self.encoder0 = encoder0
        self.encoder1 = encoder1
        self.encoder2 = encoder2
        self.encoder3 = encoder3


class Event:
    __slots__ = ("counter", "message", "offset", "raw")

    def __init__(self, offset: int, raw: bytes, counter: int, message: Status) -> None:
        self.offset = offset
        self.raw = raw
        self.counter = counter
        self.message = message


class Unknown:
    __slots__ = ("offset", "raw")

    def __init__(self, offset: int, raw: bytes) -> None:
        self.offset = offset
        self.raw = raw


class Invalid(Unknown):
    __slots__ = ()


FLAGS = [Flags(value) for value in range(256)]
MODES: list[Mode | int] = [*Mode, *range(3, 256)]
UNPACK = Struct("<BBHHhhHHHH").unpack
PACK = Struct("<BBBBBHHhhHHHH").pack


new = object.__new__
"""An object without a call of its class's `__init__`, which takes longer than all the rest."""


def read_status(payload: bytes) -> Status:
    item = new(Status)
    (
        flags,
        mode,
        item.voltage,
        item.current,
        item.speed,
        item.angle,
        item.encoder0,
        item.encoder1,
        item.encoder2,
        item.encoder3,
    ) = UNPACK(payload)
    item.status = FLAGS[flags]
    item.mode = MODES[mode]
    return item


KINDS = {ord("I"): read_status}


def stuffed(content: bytes) -> bytes:
    if 0x55 in content or 0x56 in content:
        return content.replace(b"\x56", b"\x56\xa9").replace(b"\x55", b"\x56\xaa")
    return content


def unstuffed(wire: bytes) -> bytes | None:
    """None where an escape stands before another byte than the two it may."""
    if wire.count(b"\x56") != wire.count(b"\x56\xaa") + wire.count(b"\x56\xa9"):
        return None
    return wire.replace(b"\x56\xaa", b"\x55").replace(b"\x56\xa9", b"\x56")


def encode_status(item: Status, counter: int) -> bytes:
    """Raises struct.error where a value does not fit."""
    content = PACK(
        20,
        counter,
        0x49,
        item.status,
        item.mode,
        item.voltage,
        item.current,
        item.speed,
        item.angle,
        item.encoder0,
        item.encoder1,
        item.encoder2,
        item.encoder3,
    )
    content += (-adler32(content, 0) & 0xFF).to_bytes(1, "little")
    return b"\x55" + stuffed(content)


def framed(command: int, counter: int, payload: bytes) -> bytes:
    content = bytes((len(payload) + 2, counter, command)) + payload
    content += (-adler32(content, 0) & 0xFF).to_bytes(1, "little")
    return b"\x55" + stuffed(content)


def is_valid(content: bytes) -> bool:
    """True if these bytes from the length to the checksum are a frame."""
    return (
        len(content) >= 4
        and content[0] == len(content) - 2
        and not (adler32(content, 0) & 0xFF)
        and content[0] <= 123
    )


def decode(frame: bytes) -> Status:
    """The message of exactly one frame. Raises ValueError."""
    content: bytes | None = frame[1:]
    if frame[:1] != b"\x55" or b"\x55" in content:
        raise ValueError("no whole frame")
    if b"\x56" in content:
        content = unstuffed(content)
    if content is None or not is_valid(content):
        raise ValueError("no valid frame")
    read = KINDS.get(content[2])
    if read is None or content[0] != 20:
        raise ValueError("no known message")
    return read(content[3:-1])


GREATEST = 250


class Decoder:
    """Cuts what the robot sends into events."""

    def __init__(self) -> None:
        self._data = b""
        self._offset = 0

    def feed(self, data: bytes) -> list[Event | Unknown]:
        """The events of the next bytes."""
        data = self._data + data if self._data else data
        base = self._offset
        events: list[Event | Unknown] = []
        append = events.append
        find = data.find
        size = len(data)
        at = 0
        while at < size:
            end = find(b"\x55", at + 1)
            if end < 0:
                end = self._end(data, at)
                if end < 0:
                    break
            raw = data[at:end]
            content = raw[1:]
            if 0x56 in content:
                content = unstuffed(content) or b""
            if (
                len(content) < 4
                or content[0] != len(content) - 2
                or adler32(content, 0) & 0xFF
                or content[0] > 123
                or raw[0] != 0x55
            ):
                # What follows a whole frame is noise, and so is what starts as none.
                end = self._cut(raw, base + at, events) + at
            else:
                read = KINDS.get(content[2])
                if read is None:
                    append(Unknown(base + at, raw))
                elif content[0] != 20:
                    append(Invalid(base + at, raw))
                else:
                    append(Event(base + at, raw, content[1], read(content[3:-1])))
            at = end
        self._data = data[at:]
        self._offset = base + at
        return events

    @staticmethod
    def _end(data: bytes, at: int) -> int:
        """End of the frame that starts at the last sync, by its length; -1: not here yet."""
        size = len(data)
        if data[at] != 0x55:
            return size
        left = -1  # The length comes first.
        place = at + 1
        while place < size and left:
            byte = data[place]
            place += 1
            if byte == 0x56:
                if place == size:
                    return -1
                byte = data[place] ^ 0xFF
                place += 1
                if byte not in (0x55, 0x56):
                    return size
            if left < 0 and not 2 <= byte <= 123:
                return size
            left = byte + 1 if left < 0 else left - 1
        return -1 if left else place

    def _cut(self, raw: bytes, offset: int, events: list[Event | Unknown]) -> int:
        """The bytes between two syncs are no frame; there may be one in front of noise."""
        end = self._end(raw, 0)
        frame = raw[:end]
        try:
            if not 0 < end < len(raw):
                raise ValueError("no whole frame")
            message = decode(frame)
        except ValueError:
            events.append(Invalid(offset, raw))
        else:
            counter = (unstuffed(frame[1:]) or b"")[1]
            events += Event(offset, frame, counter, message), Invalid(offset + end, raw[end:])
        return len(raw)
