"""Winsen MH-Z19 sensors, beside pymhz19-async."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator
from struct import pack
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "pymhz19_async"
COMMANDS: dict[str, tuple[str, Callable[[Case], tuple[Any, ...]]]] = {
    "read": ("GET_CLAMPED_CO2_TEMPERATURE", lambda case: ()),
    "read_unlimited": ("GET_CO2", lambda case: ()),
    "set_self_calibration": ("SET_ABC", lambda case: (case.values["state"] == 0xA0,)),
    "get_self_calibration": ("GET_ABC", lambda case: ()),
    "calibrate_zero": ("SET_CALIBRATION_400PPM", lambda case: ()),
    "calibrate_span": ("SET_CALIBRATION_SPAN", lambda case: (case.values["co2"],)),
    "set_range": ("SET_RANGE", lambda case: (case.values["max"],)),
    "get_range": ("GET_RANGE", lambda case: ()),
    "reset": ("RESET", lambda case: ()),
    "get_version": ("GET_FIRMWARE_VERSION", lambda case: ()),
    "write_configuration": ("WRITE_CONFIG", lambda case: (place(case), case.values["value"])),
    "read_configuration": ("READ_CONFIG", lambda case: (place(case),)),
}
"""Its codes and their arguments."""
ANSWERS = {
    "measurement": (0x86, ">HBBH"),
    "unlimited_measurement": (0x85, ">HHH"),
    "self_calibration": (0x7D, ">5s?"),
    "range_is": (0x9B, ">HHH"),
    "version": (0xA0, ">4sH"),
    "done": (None, ">B5s"),
    "configuration": (None, ">6s"),
    "other": (None, ">6s"),
}
READ: dict[str, Callable[[Any], Values]] = {
    "measurement": lambda event: {"co2": event["CO2"], "temperature": event["temperature"] + 40},
    "unlimited_measurement": lambda event: {"co2": event["CO2"]},
    "self_calibration": lambda event: {"is_on": int(event["ABC"])},
    "range_is": lambda event: {"max": event["max"]},
    "version": lambda event: {"version": event["version"].rstrip("\0")},
    "done": lambda event: {"accepted": 1} if event["ack"] else {},
    "configuration": lambda event: {},
    "other": lambda event: {},
}
"""The values that it names."""
RANGES = (2000, 5000, 10000)


def place(case: Case) -> int:
    return int((case.parts["command"] & 3) << 8) + int(case.values["place"])


class Transport:
    """What a serial port writes."""

    written = b""

    def write(self, data: bytes) -> None:
        self.written = data


class PyMhz19:
    """Its protocol, and the events that it found."""

    def __init__(self) -> None:
        base: Any = peer_module("mhz19_async.mhz19").MHZ19Protocol

        class Recorder(base):  # type: ignore[misc]
            def event_received(self, event: dict[str, Any]) -> None:
                events.append(event)

        events: list[dict[str, Any]] = []
        self._events = events
        self._class: Any = Recorder
        self._loop = asyncio.new_event_loop()

    def close(self) -> None:
        self._loop.close()

    def frame(self, case: Case) -> bytes:
        if case.message in ANSWERS:
            code, layout = ANSWERS[case.message]
            command = case.parts.get("command", code)
            content = bytes((command,)) + pack(layout, *map(packed, case.values.items()))
            return bytes((0xFF, *content, self._class.checksum(content)))
        protocol, transport = self._class(self._loop), Transport()
        protocol.connection_made(transport)
        name, arguments = COMMANDS[case.message]
        protocol.send_command(self._class.Codes[name], *arguments(case))
        return transport.written

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message in COMMANDS:
            return case.values  # it reads no command
        self._receive(frame)
        (event,) = self._events
        assert "error" not in event
        return case.values | READ[case.message](event)  # it has names for some of them

    def _receive(self, data: bytes) -> None:
        self._events.clear()
        self._class(self._loop).data_received(data)

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        self._receive(data)
        for event in self._events:
            yield bytes((0xFF, event["command"], *event["raw"], event["checksum"]))


def packed(item: tuple[str, Any]) -> Any:
    """A value as struct takes it."""
    name, value = item
    if isinstance(value, str):
        return value.encode() if name == "version" else bytes.fromhex(value)
    return value


@pytest.fixture(scope="module")
def peer() -> Iterator[PyMhz19]:
    peer = PyMhz19()
    yield peer
    peer.close()


def as_sent(case: Case) -> Case:
    """The case, as it sends it."""
    values = dict(case.values)
    if case.message == "set_range":
        values["max"] = RANGES[values["max"] % 3]
    if case.message == "set_self_calibration":
        values["state"] = 0xA0 * (values["state"] % 2)
    return replace(case, values=values)


def is_read(case: Case) -> bool:
    """False for a text that it can't read."""
    return str(case.values.get("version", "")).isascii()


def test_both_make_the_same_commands(peer: PyMhz19) -> None:
    compare_frames("mhz19", peer, map(as_sent, cases_of("mhz19", COMMANDS)))


def test_it_reads_the_answers_that_we_make(peer: PyMhz19) -> None:
    compare_frames("mhz19", peer, filter(is_read, cases_of("mhz19", ANSWERS)))


def test_no_frame_is_lost_that_it_finds(peer: PyMhz19) -> None:
    compare_recovery("mhz19", "sensor", peer, cases_of("mhz19", ANSWERS))
