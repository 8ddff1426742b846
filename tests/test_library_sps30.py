"""Sensirion SPS30 particle sensors, beside shdlc-sps30."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from math import isfinite
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "shdlc_sps30"
FLAG = b"\x7e"
COMMANDS: dict[str, Callable[[Any, Values], Any]] = {
    "start_measurement": lambda c, v: c.SPS30_StartMeasurement(v["format"] == 5),
    "stop_measurement": lambda c, v: c.SPS30_StopMeasurement(),
    "read_measurement": lambda c, v: c.SPS30_ReadMeasuredValue(False),
    "sleep": lambda c, v: c.SPS30_Sleep(),
    "wake_up": lambda c, v: c.SPS30_WakeUp(),
    "clean_fan": lambda c, v: c.SPS30_StartFanCleaning(),
    "read_cleaning_interval": lambda c, v: c.SPS30_ReadAutoCleaningInterval(),
    "write_cleaning_interval": lambda c, v: c.SPS30_WriteAutoCleaningInterval(v["interval"]),
    "read_device_information": lambda c, v: c.SPS30_DeviceInformation(v["what"] == 0),
    "read_version": lambda c, v: c.SPS30_ReadVersion(),
    "read_status": lambda c, v: c.SPS30_ReadDeviceStatusRegister(v["clear"] == 1),
    "reset": lambda c, v: c.SPS30_DeviceReset(),
}
"""Each command by a class of it."""
NAMES = [
    *("mass_1_0", "mass_2_5", "mass_4_0", "mass_10"),
    *("number_0_5", "number_1_0", "number_2_5", "number_4_0", "number_10"),
    "typical_size",
]
LAYOUTS = {
    "done": (None, ""),
    "refused": (None, ""),
    "no_measurement": (0x03, ""),
    "measurement": (0x03, ">10f"),
    "measurement_integer": (0x03, ">10H"),
    "cleaning_interval_written": (0x80, ""),
    "cleaning_interval": (0x80, ">I"),
    "device_information": (0xD0, "text"),
    "version": (0xD1, ">7B"),
    "status": (0xD2, ">IB"),
}
"""Commands that are answered, and the data of the answer: it makes none."""


class Sps30:
    """The commands of shdlc-sps30, in the frames of its driver."""

    def __init__(self) -> None:
        self._commands: Any = peer_module("shdlc_sps30.commands")
        self._frames: Any = peer_module("sensirion_shdlc_driver.serial_frame_builder")
        self._errors: Any = peer_module("sensirion_shdlc_driver.errors")

    def frame(self, case: Case) -> bytes:
        builder = self._frames.ShdlcSerialMosiFrameBuilder
        address = case.parts["address"]
        if case.message in COMMANDS:
            command = COMMANDS[case.message](self._commands, case.values)
            return bytes(builder(address, command.id, command.data).to_bytes())
        number, layout = LAYOUTS[case.message]
        if number is None:
            number = case.parts["command"]
        if layout == "text":
            data = case.values["text"].encode("latin-1") + b"\0"
        else:
            is_float = layout.endswith("f")
            values = case.values.values()
            data = struct.pack(layout, *(float(value) if is_float else value for value in values))
        state = case.parts["fault"] << 7 | case.parts.get("error", 0)
        content = bytes((address, number, state, len(data))) + data
        content += bytes((builder._calculate_checksum(content),))
        return FLAG + bytes(builder._stuff_data_bytes(content)) + FLAG

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message in COMMANDS:
            return case.values  # it reads no command
        address, number, state, data = self._read(frame)
        assert address == case.parts["address"]
        assert (number, state & 0x7F) == self._identity(case)
        assert state >> 7 == case.parts["fault"]
        return self._understood(case, data)

    def _identity(self, case: Case) -> tuple[int, int]:
        number, _ = LAYOUTS[case.message]
        return case.parts["command"] if number is None else number, case.parts.get("error", 0)

    def _understood(self, case: Case, data: bytes) -> Values:
        commands = self._commands
        match case.message:
            case "measurement" | "measurement_integer":
                is_integer = case.message == "measurement_integer"
                command = commands.SPS30_ReadMeasuredValue(is_integer)
                masses, numbers, size = command.interpret_response(data)
                found = map(as_json, (*masses, *numbers, size))
                return dict(zip(NAMES, found, strict=True))
            case "cleaning_interval":
                command = commands.SPS30_ReadAutoCleaningInterval()
                return {"interval": command.interpret_response(data)}
            case "device_information":
                command = commands.SPS30_DeviceInformation_SerialNumber()
                return {"text": command.interpret_response(data)}
            case "version":
                found = commands.SPS30_ReadVersion().interpret_response(data)
                values = case.values  # it skips the bytes that are reserved
                assert found == (
                    (values["firmware_major"], values["firmware_minor"]),
                    values["hardware"],
                    (values["shdlc_major"], values["shdlc_minor"]),
                )
                return values
            case "status":
                found = commands.SPS30_ReadDeviceStatusRegister().interpret_response(data)
                states = case.values["states"]
                assert found == tuple(bool(states & 1 << bit) for bit in (21, 5, 4))
                return case.values
            case "no_measurement":
                assert commands.SPS30_ReadMeasuredValue(False).interpret_response(data) is None
        assert data == b""
        return {}

    def _read(self, frame: bytes) -> tuple[int, int, int, bytes]:
        builder = self._frames.ShdlcSerialMisoFrameBuilder()
        assert builder.add_data(frame)
        address, number, state, data = builder.interpret_data()
        return address, number, state, data

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What it takes for an answer between two delimiters."""
        for piece in data.split(FLAG):
            frame = FLAG + piece + FLAG
            try:
                self._read(frame)
            except self._errors.ShdlcResponseError:
                continue
            yield frame


def as_json(value: float) -> float | str:
    """The value as JSON lines have it, which know no number for infinity."""
    return value if isfinite(value) else str(value)


@pytest.fixture(scope="module")
def sps30() -> Sps30:
    return Sps30()


def as_sent(case: Case) -> Case:
    """The case, as it can ask: for the product type or for the serial number."""
    if case.message != "read_device_information":
        return case
    return replace(case, values={"what": 0 if case.values["what"] == 0 else 3})


def is_ascii(case: Case) -> bool:
    """False where a text has characters that it does not read."""
    return case.message != "device_information" or case.values["text"].isascii()


def test_both_make_the_same_commands(sps30: Sps30) -> None:
    compare_frames("sps30", sps30, map(as_sent, cases_of("sps30", COMMANDS)))


def test_it_reads_the_answers_that_we_make(sps30: Sps30) -> None:
    compare_frames("sps30", sps30, filter(is_ascii, cases_of("sps30", LAYOUTS)))


def test_no_frame_is_lost_that_it_finds(sps30: Sps30) -> None:
    compare_recovery("sps30", "sensor", sps30, cases_of("sps30", LAYOUTS), shared=FLAG)
