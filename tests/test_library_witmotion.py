"""WitMotion's inertial sensors, beside witmotion."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from struct import pack
from types import SimpleNamespace
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "witmotion"
COMMANDS = {
    "unlock": 0x69,
    "save": 0x00,
    "calibrate": 0x01,
    "set_output": 0x02,
    "set_rate": 0x03,
    "set_baud": 0x04,
    "set_bias": None,
    "set_pin": None,
    "set_pulse": None,
    "set_period": None,
    "sleep": 0x22,
    "set_direction": 0x23,
    "set_algorithm": 0x24,
    "read_register": 0x27,
    "set_gyroscope_calibration": 0x63,
    "write_register": None,
}
PACKETS = {
    "time": ("TimeMessage", "<6BH"),
    "acceleration": ("AccelerationMessage", "<4h"),
    "rate": ("AngularVelocityMessage", "<4h"),
    "angle": ("AngleMessage", "<4h"),
    "magnetic_field": ("MagneticMessage", "<4h"),
    "quaternion": ("QuaternionMessage", "<4h"),
}
"""What it knows."""
UNITS = {
    "acceleration": 16 * 9.8 / 32768,
    "rate": 2000 / 32768,
    "angle": 180 / 32768,
    "magnetic_field": 1,
    "quaternion": 1 / 32768,
}


def time(message: Any) -> list[int]:
    """Its time, whose year it takes for one behind 1970, and months and days as from 0."""
    read = datetime.fromtimestamp(message.timestamp, UTC)
    date = [read.year - 1970, read.month - 1, read.day - 1]
    return [*date, read.hour, read.minute, read.second, round(read.microsecond / 1000)]


def vector(values: tuple[float, ...], unit: float) -> list[int]:
    return [round(each / unit) for each in values]


READ: dict[str, Callable[[Any, float], list[int]]] = {
    "acceleration": lambda m, unit: [*vector(m.a, unit), round(m.temp_celsius * 100)],
    "rate": lambda m, unit: [*vector(m.w, unit), round(m.temp_celsius * 100)],
    "angle": lambda m, unit: [*vector((m.roll, m.pitch, m.yaw), unit), m.version],
    "magnetic_field": lambda m, unit: [*m.mag, round(m.temp_celsius * 100)],
    "quaternion": lambda m, unit: vector(m.q, unit),
}


class Port:
    """A serial port as it has one, which tells when there is no more to read."""

    def __init__(self, imu: Any, data: bytes) -> None:
        self._imu = imu
        self._data = data
        self.at = 0

    def read(self, size: int) -> bytes:
        piece = self._data[self.at : self.at + size]
        self.at += len(piece)
        self._imu.should_exit = len(piece) < size
        return piece + bytes(size - len(piece)) if self._imu.should_exit else piece


class WitMotion:
    """Its sensor, of which the port is not opened, and its messages."""

    def __init__(self) -> None:
        self._module: Any = peer_module("witmotion")
        self._protocol: Any = peer_module("witmotion.protocol")

    def frame(self, case: Case) -> bytes:
        if case.message in PACKETS:
            name, layout = PACKETS[case.message]
            kind, body = getattr(self._protocol, name), pack(layout, *case.values.values())
            return bytes((0x55, kind.code, *body, kind.compute_checksum(body)))
        number = case.parts.get("register", COMMANDS[case.message])
        (value,) = case.values.values()
        register = SimpleNamespace(value=number)
        return bytes(self._protocol.ConfigCommand(register, value % 65536).serialize())

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message in COMMANDS:
            return case.values  # it reads no command
        ((_, message),) = self._read(frame)
        assert type(message).__name__ == PACKETS[case.message][0]
        found = time(message) if case.message == "time" else self._measured(case, message)
        return dict(zip(case.values, found, strict=True))

    def _measured(self, case: Case, message: Any) -> list[int]:
        return READ[case.message](message, UNITS[case.message])

    def _read(self, data: bytes) -> list[tuple[int, Any]]:
        """What its thread reads, and where it ends."""
        messages: list[tuple[int, Any]] = []
        imu = self._module.IMU.__new__(self._module.IMU)
        imu.ser, imu.should_exit = Port(imu, data), False
        imu.subscribers = {}
        imu._handle_message = lambda message: messages.append((imu.ser.at, message))
        imu._rxloop()
        return messages

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        for end, _ in self._read(data):
            yield data[end - 11 : end]


@pytest.fixture(scope="module")
def witmotion() -> WitMotion:
    return WitMotion()


def as_read(case: Case) -> Case:
    """The case, with a time that there is, and a version that it takes for a positive one."""
    values = dict(case.values)
    if case.message == "time":
        bounds = {"month": 12, "day": 28, "hour": 24, "minute": 60, "second": 60}
        values |= {name: values[name] % bound for name, bound in bounds.items()}
        values["millisecond"] %= 1000
    if case.message == "angle":
        values["version"] &= 0x7FFF
    return replace(case, values=values)


def test_both_make_the_same_commands(witmotion: WitMotion) -> None:
    compare_frames("witmotion", witmotion, cases_of("witmotion", COMMANDS))


def test_it_reads_the_packets_that_we_make(witmotion: WitMotion) -> None:
    compare_frames("witmotion", witmotion, map(as_read, cases_of("witmotion", PACKETS)))


def test_no_frame_is_lost_that_it_finds(witmotion: WitMotion) -> None:
    drawn = [as_read(case) for case in cases_of("witmotion", PACKETS)]
    compare_recovery("witmotion", "sensor", witmotion, drawn)
