"""The protocol of `imu.yaml` by hand: `struct`, slotted objects, events."""

from __future__ import annotations

from binascii import crc_hqx
from enum import IntEnum
from struct import Struct


class State(IntEnum):
    IDLE = 1
    MOVING = 2


class Sample:
    __slots__ = ("forces", "rates", "state", "time")

    def __init__(self, time: int, state: State | int, rates: list[int], forces: list[int]) -> None:
        self.time = time
        self.state = state
        self.rates = rates
        self.forces = forces


class Event:
    __slots__ = ("message", "offset", "raw")

    def __init__(self, offset: int, raw: bytes, message: Sample) -> None:
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


SYNC = b"\xb5\x62"
STATES: list[State | int] = [0, *State, *range(3, 256)]
UNPACK = Struct("<IBhhhhhh").unpack
UNPACK_HEAD = Struct("<xxBH").unpack_from
UNPACK_CRC = Struct("<H").unpack_from
AROUND = 7
GREATEST = 256


def read_sample(payload: bytes) -> Sample:
    time, state, a, b, c, d, e, f = UNPACK(payload)
    return Sample(time, STATES[state], [a, b, c], [d, e, f])


KINDS = {0x10: (17, read_sample)}


class Decoder:
    """Cuts what the board sends into events."""

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
        startswith = data.startswith
        get = KINDS.get
        at, size = 0, len(data)
        while size - at >= AROUND:
            if not startswith(SYNC, at):
                start = find(SYNC, at)
                if start < 0:
                    break
                append(Invalid(base + at, data[at:start]))
                at = start
                continue
            kind, length = UNPACK_HEAD(data, at)
            end = at + length + AROUND
            known = get(kind)
            if length <= GREATEST and (known is None or known[0] == length):
                if end > size:
                    break
                raw = data[at:end]
                if crc_hqx(raw[2:-2], 0) == UNPACK_CRC(raw, length + 5)[0]:
                    if known is None:
                        append(Unknown(base + at, raw))
                    else:
                        append(Event(base + at, raw, known[1](raw[5:-2])))
                    at = end
                    continue
            start = find(SYNC, at + 1)
            if start < 0:
                break
            append(Invalid(base + at, data[at:start]))
            at = start
        self._data = data[at:]
        self._offset = base + at
        return events
