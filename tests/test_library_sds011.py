"""Nova SDS011 particle sensors, beside sds011lib."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "sds011lib"
COMMANDS = [
    "set_reporting_mode",
    "query_reading",
    "set_device_id",
    "set_state",
    "query_firmware",
    "set_working_period",
]
ANSWERS = {"reporting_mode": 2, "device_id": 5, "state": 6, "firmware": 7, "working_period": 8}
READING = 0xC0
ANSWER = 0xC5


class Serial:
    """A port as it has one, with what is there to read and what was written."""

    def __init__(self, data: bytes = b"") -> None:
        self.data = data
        self.written = b""

    def read(self, size: int) -> bytes:
        piece, self.data = self.data[:size], self.data[size:]
        return piece

    def write(self, data: bytes) -> None:
        self.written = data

    def open(self) -> None:
        pass

    def close(self) -> None:
        pass


class Reader:
    """Its reader, whose waits take no time."""

    def __init__(self) -> None:
        self._module: Any = peer_module("sds011lib")
        self._constants: Any = peer_module("sds011lib._constants")

    def _reader(self, serial: Serial) -> Any:
        return self._module.SDS011Reader(serial, send_command_sleep=0)

    def frame(self, case: Case) -> bytes:
        device = case.parts["device"].to_bytes(2, "big")
        if case.message not in COMMANDS:
            return self._sent(case, device)
        serial = Serial()
        self._command(self._reader(serial), case, device)
        return serial.written

    def _command(self, reader: Any, case: Case, device: bytes) -> None:
        values = case.values
        match case.message:
            case "query_reading":
                reader.request_data(device)
            case "query_firmware":
                reader.request_firmware_version(device)
            case "set_device_id":
                reader.set_device_id(values["number"].to_bytes(2, "big"), device)
            case _ if values["operation"] == 0:
                self._query(reader, case.message, device)
            case "set_reporting_mode":
                mode = self._constants.ReportingMode(bytes((values["mode"],)))
                reader._set_reporting_mode(mode, device)
            case "set_state":
                state = self._constants.SleepState(bytes((values["state"],)))
                reader.set_sleep_state(state, device)
            case "set_working_period":
                reader.set_working_period(values["period"], device)

    def _query(self, reader: Any, message: str, device: bytes) -> None:
        match message:
            case "set_reporting_mode":
                reader.request_reporting_mode(device)
            case "set_state":
                reader.request_sleep_state(device)
            case "set_working_period":
                reader.request_working_period(device)

    def _sent(self, case: Case, device: bytes) -> bytes:
        """What the sensor sends, which the library does not write: the checksum is its own."""
        kind, values = ANSWER, list(case.values.values())
        if case.message == "reading":
            kind, content = READING, b"".join(value.to_bytes(2, "little") for value in values)
        elif case.message == "device_id":
            content = bytes((ANSWERS["device_id"], 0, 0, 0))
        else:
            content = bytes((ANSWERS[case.message], *values))
        content += device
        return bytes((0xAA, kind, *content, self._module._calc_checksum(content), 0xAB))

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message in COMMANDS:
            return case.values  # it reads no command
        reader = self._reader(Serial(frame))
        match case.message:
            case "reading":
                found = reader.query_data()
                assert found.device_id == case.parts["device"].to_bytes(2, "big")
                return {"pm2_5": round(found.pm25 * 10), "pm10": round(found.pm10 * 10)}
            case "device_id":
                number = case.parts["device"].to_bytes(2, "big")
                assert reader.query_device_id().device_id == number
                return case.values
            case "firmware":
                date = reader.query_firmware_version()
                return {"year": date.year, "month": date.month, "day": date.day}
            case "working_period":
                found = reader.query_working_period()
                return self._answer(found, "period", found.interval)
            case "state":
                found = reader.query_sleep_state()
                return self._answer(found, "state", found.state.value[0])
            case _:
                found = reader.query_reporting_mode()
                return self._answer(found, "mode", found.state.value[0])

    def _answer(self, found: Any, name: str, value: int) -> Values:
        return {"operation": found.operation_type.value[0], name: value, "unused": 0}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """It looks at ten bytes at a time, here at those of each start."""
        at = data.find(0xAA)
        while at >= 0:
            frame = data[at : at + 10]
            is_whole = self._is_whole(frame)
            if is_whole:
                yield frame
            at = data.find(0xAA, at + (10 if is_whole else 1))

    def _is_whole(self, frame: bytes) -> bool:
        kinds, command = self._constants.ResponseType, self._constants.Command
        kind = kinds.QUERY_RESPONSE if frame[1:2] == b"\xc0" else kinds.GENERAL_RESPONSE
        try:
            expected = command.QUERY if frame[1:2] == b"\xc0" else command(frame[2:3])
            self._module._parse_read_response(frame, expected, kind)
        except (ValueError, *self._errors()):
            return False
        return True

    def _errors(self) -> tuple[type[Exception], ...]:
        errors = vars(peer_module("sds011lib.exceptions")).values()
        return tuple(each for each in errors if isinstance(each, type))


@pytest.fixture(scope="module")
def reader() -> Reader:
    return Reader()


def as_sent(case: Case) -> Case:
    """The case, as the library sends it: what only asks has no value."""
    values = dict(case.values)
    if values.get("operation") == 0:
        values.update((name, 0) for name in ("mode", "state", "period") if name in values)
    return replace(case, values=values)


def test_both_make_the_same_commands(reader: Reader) -> None:
    compare_frames("sds011", reader, map(as_sent, cases_of("sds011", COMMANDS)))


def test_it_reads_the_readings_that_we_make(reader: Reader) -> None:
    compare_frames("sds011", reader, cases_of("sds011", ["reading"]))


def test_it_reads_the_answers_that_we_make(reader: Reader) -> None:
    compare_frames("sds011", reader, cases_of("sds011", ANSWERS))


def test_no_frame_is_lost_that_it_finds(reader: Reader) -> None:
    compare_recovery("sds011", "sensor", reader, cases_of("sds011", ["reading", *ANSWERS]))
