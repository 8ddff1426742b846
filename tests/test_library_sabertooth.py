"""Sabertooth motor drivers, beside pysabertooth."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "pysabertooth"
COMMANDS = [
    "forward_1",
    "backward_1",
    "set_min_voltage",
    "set_max_voltage",
    "forward_2",
    "backward_2",
    "drive_1",
    "drive_2",
    "forward",
    "backward",
    "right",
    "left",
    "drive",
    "turn",
    "set_timeout",
    "set_baud",
    "set_ramp",
    "set_deadband",
]
"""By their numbers."""
SIZE = 4


class Port:
    """A serial port, with what was written."""

    is_open = True

    def __init__(self) -> None:
        self.written: list[bytes] = []

    def write(self, data: bytes) -> None:
        self.written.append(data)

    def flush(self) -> None:
        pass

    def close(self) -> None:
        pass


class PySabertooth:
    """Its driver, of which the port is not opened."""

    def __init__(self) -> None:
        module: Any = peer_module("pysabertooth")
        self._port = Port()
        self.driver: Any = module.Sabertooth.__new__(module.Sabertooth)
        self.driver.saber = self._port

    def sent(self, address: int) -> list[bytes]:
        """The port's list, emptied, of a driver of that address."""
        self.driver.address = address
        self._port.written.clear()
        return self._port.written

    def frame(self, case: Case) -> bytes:
        (value,) = case.values.values()
        return self._command(case.parts["address"], COMMANDS.index(case.message), value)

    def _command(self, address: int, command: int, value: int) -> bytes:
        written = self.sent(address)
        self.driver.sendCommand(command, value)
        return written[0]

    def values(self, case: Case, frame: bytes) -> Values:
        return case.values  # it reads no command

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What it would send."""
        at = 0
        while at + SIZE <= len(data):
            frame = data[at : at + SIZE]
            address, command, value, _ = frame
            if 128 <= address <= 135 and frame == self._command(address, command, value):
                yield frame
                at += SIZE
            else:
                at += 1


@pytest.fixture(scope="module")
def pysabertooth() -> PySabertooth:
    return PySabertooth()


def test_both_make_the_same_commands(pysabertooth: PySabertooth) -> None:
    compare_frames("sabertooth", pysabertooth, cases_of("sabertooth", COMMANDS))


@pytest.mark.parametrize(
    ("motor", "percent", "frame"),
    [
        (1, 100, "80 00 7F 7F"),
        (1, -50, "80 01 3F 40"),
        (2, 50, "80 04 3F 43"),
        (2, -100, "80 05 7F 04"),
    ],
)
def test_its_methods_drive_by_these_commands(
    pysabertooth: PySabertooth, motor: int, percent: int, frame: str
) -> None:
    written = pysabertooth.sent(128)
    pysabertooth.driver.drive(motor, percent)
    assert [each.hex(" ").upper() for each in written] == [frame]


def test_no_frame_is_lost_that_it_finds(pysabertooth: PySabertooth) -> None:
    compare_recovery("sabertooth", "host", pysabertooth, cases_of("sabertooth", COMMANDS))
