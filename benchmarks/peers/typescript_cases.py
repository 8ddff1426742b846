"""Streams of the three protocols for `bench_typescript.py`, in a mix as robots send it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from random import Random
from types import ModuleType
from typing import Any

from generated.python import matty, rflex, rn1

Message = dict[str, Any]
"""A message as TypeScript has it: its fields, and its name as `message`."""

STREAM = 1 << 16
"""Bytes of a stream, about."""
CLUSTERS = (*range(0x06), *range(0x10, 0x15), *range(0x20, 0x26))
"""The 17 sonars of an ATRV-Jr."""
NMEA = "$GNGGA,{time:09.2f},5004.{lat:06d},N,01423.{lon:06d},E,1,12,0.7,{alt}.1,M,45.2,M,,*4F\r\n"


def signed(dice: Random, bits: int) -> int:
    return dice.getrandbits(bits) - (1 << bits - 1)


def axes(dice: Random, message: str, prefix: str) -> Message:
    values = {f"{prefix}_{axis}": signed(dice, 14) for axis in "xyz"}
    return {"message": message, "status": 1, **values}


def brain(dice: Random) -> Iterator[Message]:
    """A turn of the LIDAR goes out with ten turns of everything else."""
    for _ in range(10):
        yield axes(dice, "gyro", "int")
        yield axes(dice, "xcel", "int")
        yield axes(dice, "compass", "avg")
        quality = dice.getrandbits(7)
        flow = {"dx": signed(dice, 14), "dy": signed(dice, 14), "q": quality}
        yield {"message": "optflow", "status": 1, **flow}
        yield {"message": "sonar", "status": 127, "distances": distances(dice, 7)}
        yield {
            "message": "facing",
            "status": 1,
            "heading": dice.randrange(360),
            "speed": signed(dice, 14),
        }
    yield {"message": "lidar", "status": 3, "distances": distances(dice, 360)}


def distances(dice: Random, count: int) -> list[int]:
    return [dice.getrandbits(14) for _ in range(count)]


def flex(dice: Random) -> Iterator[Message]:
    """Both axes five times for each turn of the sonars, with status and joystick now and then."""
    bits = dice.getrandbits
    for _ in range(5):
        for axis in range(2):
            names = ("position", "velocity", "acceleration", "torque")
            values = {name: signed(dice, 32) for name in names}
            head = {"unknown": bits(32), "timestamp": bits(32), "axis": axis}
            yield {"message": "read_motor", **head, **values}
    readings = [{"cluster": cluster, "distance": bits(16)} for cluster in CLUSTERS]
    yield {"message": "sonar_data", "unknown": 2, "timestamp": bits(32), "readings": readings}
    voltage = {"timestamp": bits(32), "battery_voltage": bits(16), "brake": bits(1)}
    yield {"message": "system_status", **voltage}
    sticks = {"horizontal": signed(dice, 32), "vertical": signed(dice, 32), "buttons": bits(2)}
    yield {"message": "joystick_data", "timestamp": bits(32), **sticks}


def esp(dice: Random) -> Iterator[Message]:
    """A status and an acknowledgement, ten times for each position."""
    for _ in range(10):
        encoders = {f"encoder{index}": dice.getrandbits(16) for index in range(4)}
        yield {
            "message": "status",
            "status": dice.getrandbits(8),
            "mode": dice.randrange(3),
            "voltage": dice.getrandbits(16),
            "current": dice.getrandbits(16),
            "speed": signed(dice, 16),
            "angle": signed(dice, 16),
            **encoders,
        }
        yield {"message": "ack"}
    place = {name: dice.randrange(1_000_000) for name in ("lat", "lon")}
    text = NMEA.format(time=dice.random() * 240_000, alt=dice.randrange(1000), **place)
    yield {"message": "gps", "nmea": text}


@dataclass(frozen=True)
class Mix:
    """What an endpoint sends, as a stream."""

    protocol: str
    sender: str
    module: ModuleType
    turn: Callable[[Random], Iterator[Message]]
    counter: str | None = None
    """The part of a frame that counts."""
    size: int = STREAM

    @cached_property
    def messages(self) -> list[Message]:
        dice = Random(self.protocol)
        found: list[Message] = []
        size = 0
        while size < self.size:
            turn = list(self.turn(dice))
            size += sum(len(self.frame(message, 0)) for message in turn)
            found += turn
        return found

    @cached_property
    def frames(self) -> list[bytes]:
        """The same as frames, as the reference in Python makes them."""
        return [self.frame(message, index & 255) for index, message in enumerate(self.messages)]

    def frame(self, message: Message, counter: int) -> bytes:
        values = {name: value for name, value in message.items() if name != "message"}
        made = self.module.MESSAGES[message["message"]].from_dict(values)
        parts = {self.counter: counter} if self.counter else {}
        return bytes(self.module.encode(made, self.sender, engine="construct", **parts))

    def request(self) -> dict[str, Any]:
        """What `typescript/measure.mjs` is asked."""
        counters = [index & 255 if self.counter else None for index in range(len(self.frames))]
        return {
            "sender": self.sender,
            "counter": self.counter,
            "messages": self.messages,
            "counters": counters,
            "frames": [frame.hex() for frame in self.frames],
        }


def mixes(size: int = STREAM) -> tuple[Mix, ...]:
    return (
        Mix("rn1", "brain", rn1, brain, size=size),
        Mix("rflex", "flex", rflex, flex, counter="number", size=size),
        Mix("matty", "esp", matty, esp, counter="counter", size=size),
    )
