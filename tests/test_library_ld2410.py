"""Hi-Link LD2410 radars, beside aio-ld2410."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, endpoint_of, peer_module

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "aio_ld2410"
COMMANDS = {
    "open_configuration": 0xFF,
    "close_configuration": 0xFE,
    "write_parameters": 0x60,
    "read_parameters": 0x61,
    "open_engineering": 0x62,
    "close_engineering": 0x63,
    "write_sensitivity": 0x64,
    "read_firmware": 0xA0,
    "write_baud": 0xA1,
    "restore": 0xA2,
    "restart": 0xA3,
    "write_bluetooth": 0xA4,
    "read_mac": 0xA5,
    "log_in": 0xA8,
    "write_password": 0xA9,
    "write_resolution": 0xAA,
    "read_resolution": 0xAB,
    "write_light": 0xAD,
    "read_light": 0xAE,
    "measure_noise": 0x0B,
    "read_noise": 0x1B,
}
ANSWERS = {
    "configuration_is_open": 0xFF,
    "done": None,
    "parameters": 0x61,
    "firmware": 0xA0,
    "mac": 0xA5,
    "resolution_is": 0xAB,
    "light_is": 0xAE,
    "noise_is": 0x1B,
}
REPORTS = {"engineering_report": 1, "basic_report": 2}
NAMES = {
    "write_parameters": {
        "moving_gate": "moving_max_distance_gate",
        "static_gate": "static_max_distance_gate",
        "timeout": "presence_timeout",
    },
    "write_sensitivity": {
        "gate": "distance_gate",
        "moving": "moving_threshold",
        "static": "static_threshold",
    },
    "write_baud": {"baud": "index"},
    "write_bluetooth": {"state": "enabled"},
    "log_in": {"password": "password"},
    "write_password": {"password": "password"},
    "write_resolution": {"resolution": "resolution"},
    "measure_noise": {"duration": "duration"},
    "configuration_is_open": {"version": "protocol_version", "buffer": "buffer_size"},
    "parameters": {
        "last_gate": "max_distance_gate",
        "moving_gate": "moving_max_distance_gate",
        "static_gate": "static_max_distance_gate",
        "moving": "moving_threshold",
        "static": "static_threshold",
        "timeout": "presence_timeout",
    },
    "firmware": {"type": "type", "minor": "minor", "major": "major", "revision": "revision"},
    "mac": {"address": "address"},
    "resolution_is": {"resolution": "resolution"},
    "noise_is": {"noise": "status"},
    "targets": {
        "target": "target_status",
        "moving_distance": "moving_distance",
        "moving_energy": "moving_energy",
        "static_distance": "static_distance",
        "static_energy": "static_energy",
        "distance": "detection_distance",
    },
    "engineering_report": {
        "moving_gate": "moving_max_distance_gate",
        "static_gate": "static_max_distance_gate",
        "moving": "moving_gate_energy",
        "static": "static_gate_energy",
        "light": "photosensitive_value",
        "output": "out_pin_status",
    },
}
"""Values by its names."""
CONSTANTS = {"value", "word_0", "word_1", "word_2", "head", "tail", "check"}
"""What can have one value only."""
LIGHT = {"control": "control", "threshold": "threshold", "level": "default"}
NAMES |= {"write_light": LIGHT, "light_is": LIGHT}


def flat(values: Values) -> Values:
    """The values without the structs around them."""
    found: Values = {}
    for name, value in values.items():
        found.update(flat(value) if isinstance(value, dict) else {name: value})
    return found


def theirs(values: Values, names: dict[str, str]) -> Values:
    known = flat(values)
    return {
        name: bytes.fromhex(known[ours]) if ours == "address" else known[ours]
        for ours, name in names.items()
    }


def plain(value: Any) -> Any:
    """A value of construct as JSON lines have it."""
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, list):
        return [int(each) for each in value]
    if isinstance(value, str) and not hasattr(value, "intvalue"):
        return value
    return int(value)


def ours(found: Any, names: dict[str, str]) -> Values:
    return {name: plain(found[their]) for name, their in names.items()}


class AioLd2410:
    """The frames that aio-ld2410 describes."""

    def __init__(self) -> None:
        self._protocol: Any = peer_module("aio_ld2410.protocol")
        self._stream: Any = peer_module("aio_ld2410.stream")

    def frame(self, case: Case) -> bytes:
        protocol = self._protocol
        frame = protocol.ReportFrame if case.message in REPORTS else protocol.CommandFrame
        return bytes(frame.build({"data": self._content(case)}))

    def _content(self, case: Case) -> bytes:
        names = NAMES.get(case.message, {})
        if case.message in REPORTS:
            data = {
                "basic": theirs(case.values["targets"], NAMES["targets"]),
                "engineering": theirs(case.values, names) if names else None,
            }
            content = {"type": REPORTS[case.message], "data": data}
            return bytes(self._protocol.Report.build(content))
        if case.message in COMMANDS:
            content = {"code": COMMANDS[case.message], "data": theirs(case.values, names)}
            return bytes(self._protocol.Command.build(content))
        status = case.values["status"]
        data = theirs(case.values, names) if status == 0 else {}
        content = {"code": self._code(case), "status": status, "data": data}
        return bytes(self._protocol.Reply.build(content))

    def _code(self, case: Case) -> int:
        code: int = ANSWERS[case.message] or case.parts["code"]
        return code

    def values(self, case: Case, frame: bytes) -> Values:
        """The case's values, if it reads just these."""
        protocol = self._protocol
        names = NAMES.get(case.message, {})
        data = protocol.Frame.parse(frame).data
        if case.message in REPORTS:
            report = protocol.Report.parse(data)
            assert int(report.type) == REPORTS[case.message]
            found = ours(report.data.basic, NAMES["targets"])
            if names:
                found |= ours(report.data.engineering, names)
        elif case.message in COMMANDS:
            command = protocol.Command.parse(data)
            assert int(command.code) == COMMANDS[case.message]
            found = ours(command.data, names)
        else:
            reply = protocol.Reply.parse(data)
            assert int(reply.code) == self._code(case)
            found = {"status": int(reply.status)}
            if found["status"] == 0:
                found |= ours(reply.data, names)
        known = flat(case.values)
        assert found == {name: known[name] for name in found}
        assert {name for name in known if known[name] is not None} - set(found) <= CONSTANTS
        return case.values

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What it takes for frames, whose content it then reads."""
        protocol = self._protocol
        for frame in self._stream.FrameStream(data):
            is_report = frame.type == protocol.FrameType.REPORT
            layout = protocol.Report if is_report else protocol.Reply
            try:
                layout.parse(frame.data)
            except peer_module("construct").ConstructError:
                continue
            size = len(frame.data).to_bytes(2, "little")
            yield bytes(frame.header + size + frame.data + frame.footer)


@pytest.fixture(scope="module")
def aio_ld2410() -> AioLd2410:
    return AioLd2410()


def is_read(case: Case) -> bool:
    """False where a password has characters that it does not send."""
    return str(case.values.get("password", "")).isascii()


def test_both_make_and_read_the_same_commands(aio_ld2410: AioLd2410) -> None:
    compare_frames("ld2410", aio_ld2410, filter(is_read, cases_of("ld2410", COMMANDS)))


def test_both_make_and_read_the_same_answers(aio_ld2410: AioLd2410) -> None:
    compare_frames("ld2410", aio_ld2410, cases_of("ld2410", ANSWERS))


def test_both_make_and_read_the_same_reports(aio_ld2410: AioLd2410) -> None:
    compare_frames("ld2410", aio_ld2410, cases_of("ld2410", REPORTS))


def test_no_frame_is_lost_that_it_finds(aio_ld2410: AioLd2410) -> None:
    cases = cases_of("ld2410", [*ANSWERS, *REPORTS])
    assert {endpoint_of("ld2410", case) for case in cases} == {"sensor"}
    compare_recovery("ld2410", "sensor", aio_ld2410, cases)
