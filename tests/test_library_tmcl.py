"""Trinamic TMCL, beside pytrinamic."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "pytrinamic"
SIZE = 9
COMMANDS = {
    "rotate_right": 1,
    "rotate_left": 2,
    "stop_motor": 3,
    "move_to": 4,
    "set_axis_parameter": 5,
    "get_axis_parameter": 6,
    "store_axis_parameter": 7,
    "restore_axis_parameter": 8,
    "set_global_parameter": 9,
    "get_global_parameter": 10,
    "store_global_parameter": 11,
    "restore_global_parameter": 12,
    "search_reference": 13,
    "set_output": 14,
    "get_input": 15,
    "calculate": 19,
    "compare": 20,
    "jump_if": 21,
    "jump": 22,
    "call": 23,
    "return": 24,
    "enable_interrupt": 25,
    "disable_interrupt": 26,
    "wait": 27,
    "end_program": 28,
    "access_bus": 29,
    "set_coordinate": 30,
    "get_coordinate": 31,
    "capture_coordinate": 32,
    "calculate_with_x": 33,
    "accumulator_to_axis_parameter": 34,
    "accumulator_to_global_parameter": 35,
    "clear_error": 36,
    "set_interrupt_vector": 37,
    "return_from_interrupt": 38,
    "accumulator_to_coordinate": 39,
    "stop_application": 128,
    "run_application": 129,
    "step_application": 130,
    "reset_application": 131,
    "start_download": 132,
    "quit_download": 133,
    "read_memory": 134,
    "get_application_status": 135,
    "get_firmware_version": 136,
    "restore_factory_settings": 137,
    "watch_positions": 138,
    "enter_bootloader": 242,
    "reset_module": 255,
    "user_function": None,
    "other": None,
}
METHODS: dict[str, Callable[[Any, list[int]], Any]] = {
    "rotate_right": lambda port, v: port.rotate(v[1], v[2]),
    "stop_motor": lambda port, v: port.stop(v[1]),
    "move_to": lambda port, v: port.move(*v),
    "search_reference": lambda port, v: port.reference_search(*v[:2]),
    "set_axis_parameter": lambda port, v: port.set_axis_parameter(*v),
    "get_axis_parameter": lambda port, v: port.get_axis_parameter(*v[:2]),
    "store_axis_parameter": lambda port, v: port.store_axis_parameter(*v[:2]),
    "restore_axis_parameter": lambda port, v: port.restore_axis_parameter(*v[:2]),
    "set_global_parameter": lambda port, v: port.set_global_parameter(*v),
    "get_global_parameter": lambda port, v: port.get_global_parameter(*v[:2]),
    "store_global_parameter": lambda port, v: port.store_global_parameter(*v[:2]),
    "restore_global_parameter": lambda port, v: port.restore_global_parameter(*v[:2]),
    "enter_bootloader": lambda port, v: port.send_boot(),
}
"""What it has methods for."""
IGNORED = {
    "rotate_right": ["type"],
    "stop_motor": ["type", "value"],
    "search_reference": ["value"],
    "get_axis_parameter": ["value"],
    "store_axis_parameter": ["value"],
    "restore_axis_parameter": ["value"],
    "get_global_parameter": ["value"],
    "store_global_parameter": ["value"],
    "restore_global_parameter": ["value"],
}
"""Values that do not matter, for which these methods write zero."""
REPLIES = {
    "done": 100,
    "application_status": 100,
    "firmware_version": 100,
    "loaded": 101,
    "positions_reached": 128,
    "refused": None,
}
COMMAND_OF_REPLY = {"application_status": 135, "firmware_version": 136, "positions_reached": 138}


class PyTrinamic:
    """Its requests and replies, and an interface that keeps what it sends."""

    def __init__(self) -> None:
        self._tmcl: Any = peer_module("pytrinamic.tmcl")
        self._helpers: Any = peer_module("pytrinamic.helpers")
        interface = peer_module("pytrinamic.connections.tmcl_interface").TmclInterface

        class Recorder(interface):  # type: ignore[misc, valid-type]
            sent = b""

            def _send(self, host_id: int, module_id: int, data: bytes) -> None:
                self.sent = bytes(data)

            def _recv(self, host_id: int, module_id: int) -> bytes:
                return bytes((host_id, module_id, 100, self.sent[1], 0, 0, 0, 0, 0))

        self._recorder = Recorder

    def frame(self, case: Case) -> bytes:
        parts, values = case.parts, case.values
        if case.message in COMMANDS:
            return self._command(case, list(values.values()))
        if case.message == "version_text":
            text = f"{values['module']:04}V{values['version']:03}"
            return bytes((parts["host"], *text.encode()))
        status = parts.get("status", REPLIES[case.message])
        command = parts.get("command", COMMAND_OF_REPLY.get(case.message))
        value = next(iter(values.values()))
        if case.message == "firmware_version":
            value = (values["module"] << 16) + (values["major"] << 8) + values["minor"]
        reply = self._tmcl.TMCLReply(parts["host"], parts["address"], status, command, value)
        return bytes(reply.to_buffer())

    def _command(self, case: Case, values: list[int]) -> bytes:
        address = case.parts["address"]
        if case.message in METHODS:
            port = self._recorder(default_module_id=address)
            METHODS[case.message](port, values)
            return bytes(port.sent)
        command = case.parts.get("command", COMMANDS[case.message])
        return bytes(self._tmcl.TMCLRequest(address, command, *values).to_buffer())

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message in COMMANDS:
            request = self._tmcl.TMCLRequest.from_buffer(frame)
            found = [request.commandType, request.motorBank, self._signed(case, request.value)]
            return dict(zip(case.values, found, strict=True))
        reply = self._tmcl.TMCLReply.from_buffer(frame)
        if case.message == "version_text":
            module, version = reply.version_string().split("V")
            return {"module": int(module), "mark": ord("V"), "version": int(version)}
        assert reply.is_checksum_correct()
        if case.message == "firmware_version":
            version = self._tmcl.GetInfo.FWVersion(reply.value)
            major, minor = divmod(version.minor, 256)
            return {"module": version.major, "major": major, "minor": minor}
        return {next(iter(case.values)): self._signed(case, reply.value)}

    def _signed(self, case: Case, value: int) -> int:
        is_signed = list(case.values)[-1] in SIGNED
        return int(self._helpers.to_signed_32(value)) if is_signed else value

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What has the right sum, looked for byte by byte."""
        at = 0
        while at + SIZE <= len(data):
            frame = data[at : at + SIZE]
            if self._tmcl.TMCLReply.from_buffer(frame).is_checksum_correct():
                yield frame
                at += SIZE
            else:
                at += 1


SIGNED = ("value", "velocity", "position", "operand")


@pytest.fixture(scope="module")
def pytrinamic() -> PyTrinamic:
    return PyTrinamic()


def as_sent(case: Case) -> Case:
    """The case, as a method sends it."""
    return replace(case, values=case.values | dict.fromkeys(IGNORED.get(case.message, ()), 0))


def test_both_make_and_read_the_same_commands(pytrinamic: PyTrinamic) -> None:
    compare_frames("tmcl", pytrinamic, map(as_sent, cases_of("tmcl", COMMANDS)))


def test_both_make_and_read_the_same_replies(pytrinamic: PyTrinamic) -> None:
    compare_frames("tmcl", pytrinamic, cases_of("tmcl", REPLIES))


def test_it_reads_the_version_as_a_text(pytrinamic: PyTrinamic) -> None:
    compare_frames("tmcl", pytrinamic, cases_of("tmcl", ["version_text"]))


def test_no_frame_is_lost_that_it_finds(pytrinamic: PyTrinamic) -> None:
    compare_recovery("tmcl", "host", pytrinamic, cases_of("tmcl", COMMANDS))
    compare_recovery("tmcl", "module", pytrinamic, cases_of("tmcl", REPLIES))
