"""Cases that are measured: five messages, and streams of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from random import Random
from types import ModuleType
from typing import Any

from generated.python import matty, rflex, rn1

Row = tuple[Any, ...]
"""The values of a message in the order of its fields; arrays are tuples, so are their records."""

STREAM = 1 << 16
"""Bytes of a stream, about: what one read of a file gives."""
FEW = 64
"""Messages that are decoded and encoded one by one, so that no value is always the same."""

CLUSTERS = (*range(0x06), *range(0x10, 0x15), *range(0x20, 0x26))
"""The 17 sonars of an ATRV-Jr."""


@dataclass(frozen=True)
class Case:
    """A message, in frames of its protocol."""

    title: str
    protocol: str
    message: str
    module: ModuleType
    sender: str
    kind: type[Any]
    draw: Callable[[Random], Row]
    """The values of one message."""
    counter: str | None = None
    """The part of a frame that counts."""
    factor: int = 1
    """Times by which the stream is longer than usual."""
    size: int = STREAM

    @cached_property
    def rows(self) -> list[Row]:
        """The values of all messages of the stream."""
        return list(self._rows())

    def _rows(self) -> Iterator[Row]:
        dice = Random(self.title)
        size = 0
        while size < self.size:
            row = self.draw(dice)
            size += len(self.frame(row, 0))
            yield row

    @cached_property
    def messages(self) -> list[Any]:
        """The same as generated messages."""
        return [self.made(row) for row in self.rows]

    @cached_property
    def frames(self) -> list[bytes]:
        """The same as frames."""
        return [self.frame(row, place & 0xFF) for place, row in enumerate(self.rows)]

    @cached_property
    def stream(self) -> bytes:
        """The same as bytes on the wire."""
        return b"".join(self.frames)

    def made(self, row: Row) -> Any:
        """The generated message of such values."""
        names = self.kind.__fields__
        values = dict(zip(names, row, strict=True))
        if self.message == "sonar_data":
            readings = (rflex.SonarDataReadings(cluster=a, distance=b) for a, b in row[2])
            values["readings"] = list(readings)
        for name, value in values.items():
            if isinstance(value, tuple):
                values[name] = list(value)
        return self.kind(**values)

    def row(self, message: Any) -> Row:
        """The values of a message of anybody whose attributes are called like the fields."""
        return tuple(_plain(getattr(message, name)) for name in self.kind.__fields__)

    def frame(self, row: Row, counter: int) -> bytes:
        """The frame of such values, as the reference makes it."""
        parts = {self.counter: counter} if self.counter else {}
        frame = self.module.encode(self.made(row), self.sender, engine="construct", **parts)
        return bytes(frame)


def _plain(value: Any) -> Any:
    if isinstance(value, (list, tuple)):
        return tuple(map(_plain, value))
    if hasattr(value, "cluster"):
        return value.cluster, value.distance
    return int(value)


def _signed(dice: Random, bits: int) -> int:
    return dice.getrandbits(bits) - (1 << bits - 1)


def _gyro(dice: Random) -> Row:
    return (dice.randrange(2), *(_signed(dice, 14) for _ in range(3)))


def _lidar(dice: Random) -> Row:
    return dice.randrange(4), tuple(dice.getrandbits(14) for _ in range(360))


def _motor(dice: Random) -> Row:
    bits = dice.getrandbits
    rest = (_signed(dice, 32) for _ in range(4))
    return bits(32), bits(32), dice.randrange(2), *rest


def _sonar(dice: Random) -> Row:
    readings = tuple((cluster, dice.getrandbits(16)) for cluster in CLUSTERS)
    return 2, dice.getrandbits(32), readings


def _status(dice: Random) -> Row:
    bits = dice.getrandbits
    signed = _signed(dice, 16), _signed(dice, 16)
    return bits(8), dice.randrange(3), bits(16), bits(16), *signed, *(bits(16) for _ in range(4))


def cases(size: int = STREAM) -> tuple[Case, ...]:
    """The five messages, in streams of about so many bytes."""
    return (
        Case("rn1 gyro", "rn1", "gyro", rn1, "brain", rn1.Gyro, _gyro, size=size),
        Case("rn1 lidar", "rn1", "lidar", rn1, "brain", rn1.Lidar, _lidar, size=size),
        Case(
            "rflex read-motor",
            "rflex",
            "read_motor",
            rflex,
            "flex",
            rflex.ReadMotor,
            _motor,
            counter="number",
            size=size,
        ),
        Case(
            "rflex sonar",
            "rflex",
            "sonar_data",
            rflex,
            "flex",
            rflex.SonarData,
            _sonar,
            counter="number",
            size=size,
        ),
        Case(
            "matty status",
            "matty",
            "status",
            matty,
            "esp",
            matty.Status,
            _status,
            counter="counter",
            size=size,
        ),
    )
