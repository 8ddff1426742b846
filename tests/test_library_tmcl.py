"""Trinamic TMCL, beside pytrinamic."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from random import Random
from struct import pack
from typing import Any

import pytest
from compiled import module_at
from library_support import FRAMES, cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

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
STORED = ["stored_command", "stored_head", "stored_value"]
"""What answers `read_memory`."""
READ_MEMORY = 134
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
        if case.message in STORED:
            return self._stored(parts["host"], case.message, values)
        status = parts.get("status", REPLIES[case.message])
        command = parts.get("command", COMMAND_OF_REPLY.get(case.message))
        value = next(iter(values.values()))
        if case.message == "application_status":
            value = (values["state"] << 24) + values["next"]
        if case.message == "firmware_version":
            value = (values["module"] << 16) + (values["major"] << 8) + values["minor"]
        reply = self._tmcl.TMCLReply(parts["host"], parts["address"], status, command, value)
        return bytes(reply.to_buffer())

    def _stored(self, host: int, message: str, values: Values) -> bytes:
        if message == "stored_command":
            return bytes(self._tmcl.TMCLReply(host, *values.values()).to_buffer())
        value = values.get("value")
        if value is None:
            *_, unused, motor, type_, opcode = values.values()
            value = (unused << 24) + (motor << 16) + (type_ << 8) + opcode
        reply = self._tmcl.TMCLReply(host, values["address"], 100, READ_MEMORY, value)
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
        if case.message in STORED:
            return self._stored_in(case, reply)
        if case.message == "application_status":
            return dict(zip(case.values, divmod(reply.value, 1 << 24), strict=True))
        if case.message == "firmware_version":
            version = self._tmcl.GetInfo.FWVersion(reply.value)
            major, minor = divmod(version.minor, 256)
            return {"module": version.major, "major": major, "minor": minor}
        return {next(iter(case.values)): self._signed(case, reply.value)}

    def _stored_in(self, case: Case, reply: Any) -> Values:
        """What its example that fetches a program makes of replies, and the rest of them."""
        found = [reply.module_address, reply.status, reply.command, self._signed(case, reply.value)]
        if case.message == "stored_head":
            found[3:] = [reply.value >> shift & 0xFF for shift in (24, 16, 8, 0)]
        return dict(zip(case.values, found, strict=True))

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


class Samples:
    """Samples in bulk, as pytrinamic asks for them and reads them. It makes none."""

    def __init__(self) -> None:
        self._crc32: Any = peer_module("pytrinamic.helpers").crc32
        self._reader: Any = peer_module("pytrinamic.rd").Rd
        interface = peer_module("pytrinamic.connections.tmcl_interface").TmclInterface

        class Module(interface):  # type: ignore[misc, valid-type]
            samples = b""

            def _send(self, host_id: int, module_id: int, data: bytes) -> None:
                assert bytes(data[1:3]) == bytes((142, 22))

            def _recv(self, host_id: int, module_id: int) -> bytes:
                count = len(self.samples) // 4 - 1
                content = bytes((host_id, module_id, 100, 142)) + count.to_bytes(4, "big")
                return content + bytes((sum(content) % 256,))

            def _recv_bulk(self, incoming_bytes: int, host_id: int, module_id: int) -> bytes:
                return self.samples[:incoming_bytes]

        self._module = Module()

    def frame(self, case: Case) -> bytes:
        samples = case.values["samples"]
        data = pack(f"<{len(samples)}I", *samples)
        return data + pack("<I", self._crc32(data))

    def values(self, case: Case, frame: bytes) -> Values:
        self._module.samples = frame
        return {"samples": self._reader(self._module, 1).get_bulk_samples(0)}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        return iter(())


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


def test_both_make_and_read_the_same_instructions_of_a_program(pytrinamic: PyTrinamic) -> None:
    compare_frames("tmcl", pytrinamic, cases_of("tmcl", STORED))


def test_a_question_tells_what_its_answer_is(pytrinamic: PyTrinamic) -> None:
    module = module_at(FOLDER / "tmcl.yaml")
    # Reply to 2, command 5, type 4, motor 134, value 100. It looks like a refusal: status 4.
    answer = bytes.fromhex("02 05 04 86 00 00 00 64 F5")
    for question, name in [
        (module.ReadMemory(part=0, address=7), "stored_command"),
        (module.ReadMemory(part=2, address=7), "refused"),
        (module.GetAxisParameter(parameter=4, motor=0), "refused"),
    ]:
        decoder = module.Decoder("module")
        (asked,) = module.Decoder("host").feed(module.encode(question))
        decoder.hear(asked)
        (event,) = decoder.feed(answer)
        assert name == event.message.NAME


def test_it_reads_the_samples_that_we_make() -> None:
    dice = Random(1)
    counts = [8192, *(dice.randint(1, 16) for _ in range(FRAMES))]
    drawn = [
        Case(
            "samples", "bulk_samples", {"samples": [dice.getrandbits(32) for _ in range(count)]}, {}
        )
        for count in counts
    ]
    compare_frames("tmcl", Samples(), drawn)


def test_it_reads_the_version_as_a_text(pytrinamic: PyTrinamic) -> None:
    compare_frames("tmcl", pytrinamic, cases_of("tmcl", ["version_text"]))


def test_no_frame_is_lost_that_it_finds(pytrinamic: PyTrinamic) -> None:
    compare_recovery("tmcl", "host", pytrinamic, cases_of("tmcl", COMMANDS), begins_anew=False)
    compare_recovery("tmcl", "module", pytrinamic, cases_of("tmcl", REPLIES), begins_anew=False)
