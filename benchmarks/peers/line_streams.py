"""Frames for programs on a line, made by the encoders of those that are compared."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from itertools import count
from random import Random

_HEARTBEATS = 50
"""So many messages, one of them is a heartbeat, or the time."""


def _gyros(dice: Random) -> Iterator[bytes]:
    """Frames of RN#1 that an expert's encoder makes."""
    from peers import slotted_rn1

    while True:
        values = (dice.getrandbits(14) - (1 << 13) for _ in range(3))
        yield slotted_rn1.encode_gyro(slotted_rn1.Gyro(1, *values))


def _attitudes(dice: Random) -> Iterator[bytes]:
    """Frames of MAVLink 2 that pymavlink makes."""
    from pymavlink.dialects.v20 import common

    sender = common.MAVLink(None, srcSystem=1, srcComponent=1)
    for number in count():
        if number % _HEARTBEATS:
            values = (
                struct.unpack("<f", struct.pack("<f", dice.uniform(-3, 3)))[0] for _ in "rpyrpy"
            )
            message = common.MAVLink_attitude_message(number, *values)
        else:
            message = common.MAVLink_heartbeat_message(2, 3, 81, 0, 4, 3)
        yield bytes(message.pack(sender))
        sender.seq = (sender.seq + 1) % 256


def _imus(dice: Random) -> Iterator[bytes]:
    """Frames of SBP that libsbp makes."""
    from sbp.imu import MsgImuRaw
    from sbp.navigation import MsgGPSTime

    names = "acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z"
    for number in count():
        if number % _HEARTBEATS:
            values = {name: dice.getrandbits(16) - (1 << 15) for name in names}
            message = MsgImuRaw(tow=number, tow_f=dice.getrandbits(8), **values)
        else:
            message = MsgGPSTime(wn=2000, tow=number, ns_residual=0, flags=1)
        message.sender = 0x42
        yield bytes(message.to_binary())


_MADE: dict[str, Callable[[Random], Iterator[bytes]]] = {
    "rn1": _gyros,
    "MAVLink 2": _attitudes,
    "SBP": _imus,
}


def frames_of(line: str, size: int) -> list[bytes]:
    """Frames of about so many bytes together."""
    found: list[bytes] = []
    for frame in _MADE[line](Random(line)):
        if size <= 0:
            return found
        found.append(frame)
        size -= len(frame)
    return found
