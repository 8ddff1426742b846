"""Feetech bus servos, beside ftservo-python-sdk."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module
from servo_port import Port

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "ftservo_python_sdk"
"""Its package is called scservo_sdk."""
ALL = 254
OTHERS = {"recover": 6, "reboot": 8, "backup": 9, "reset_turns": 10, "calibrate": 11}
"""Instructions that it has no function for."""
TO_ONE = ["ping", "read", "write", "reg_write", "action", *OTHERS]
TO_ALL = ["sync_read", "sync_write"]


class Sdk:
    """The packet handler, of the STS and SMS series."""

    def __init__(self) -> None:
        self._module: Any = peer_module("scservo_sdk.protocol_packet_handler")

    def _handler(self, port: Port) -> Any:
        return self._module.protocol_packet_handler(port, 0)

    def frame(self, case: Case) -> bytes:
        port = Port()
        servo, values = case.parts["id"], case.values
        if case.message == "status":
            data = bytes.fromhex(values["data"])
            self._complete(port, servo, [values["status"], *data])
        elif case.message in OTHERS:
            handler = self._handler(port)
            positions = [
                byte
                for position in values.get("position", [])
                for byte in (handler.scs_lobyte(position), handler.scs_hibyte(position))
            ]
            self._complete(port, servo, [OTHERS[case.message], *positions])
        elif case.message in TO_ALL:
            self._send_to_all(port, case.message, values)
        else:
            self._send(port, case.message, servo, values)
        return port.written

    def _send(self, port: Port, message: str, servo: int, values: Values) -> None:
        sdk = self._handler(port)
        data = list(bytes.fromhex(values.get("data", "")))
        match message:
            case "ping":
                sdk.ping(servo)
            case "read":
                sdk.readTx(servo, values["address"], values["size"])
            case "write":
                sdk.writeTxOnly(servo, values["address"], len(data), data)
            case "reg_write":
                sdk.regWriteTxOnly(servo, values["address"], len(data), data)
            case "action":
                sdk.action(servo)

    def _send_to_all(self, port: Port, message: str, values: Values) -> None:
        sdk, address, size = self._handler(port), values["address"], values["size"]
        if message == "sync_read":
            sdk.syncReadTx(address, size, values["servos"], len(values["servos"]))
        else:
            given = b""
            for each in values["servos"]:
                given += bytes((each["id"], *bytes.fromhex(each["data"])))
            sdk.syncWriteTxOnly(address, size, given, len(given))

    def _complete(self, port: Port, servo: int, content: list[int]) -> None:
        """Send a packet of its own making: header and checksum are the SDK's."""
        packet = [0, 0, servo, len(content) + 1, *content, 0]
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(self._module, "TXPACKET_MAX_LEN", 254)  # what it takes from a servo
            self._handler(port).txPacket(packet)

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message != "status":
            return case.values  # it reads no instruction
        data, result, status = self._handler(Port(frame)).readRx(case.parts["id"], len(frame) - 6)
        assert result == self._module.COMM_SUCCESS
        return {"status": status, "data": bytes(data).hex()}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """It looks for a header from the end of the packet before, whatever that was."""
        port = Port(data)
        while port.data:
            packet, result = self._handler(port).rxPacket()
            if result == self._module.COMM_SUCCESS:
                yield bytes(packet)


@pytest.fixture(scope="module")
def sdk() -> Sdk:
    return Sdk()


def test_both_make_the_same_instructions(sdk: Sdk) -> None:
    compare_frames("feetech", sdk, [answered(case) for case in cases_of("feetech", TO_ONE)])


def answered(case: Case) -> Case:
    """The case, to a servo that answers: of all at once, the SDK reads nothing."""
    if case.message != "read" or case.parts["id"] != ALL:
        return case
    return replace(case, parts={"id": 0})


@pytest.mark.parametrize("message", TO_ALL)
def test_both_make_the_same_instructions_to_all(sdk: Sdk, message: str) -> None:
    drawn = cases_of("feetech", [message])
    compare_frames("feetech", sdk, [replace(case, parts={"id": ALL}) for case in drawn])


def test_both_make_and_read_the_same_statuses(sdk: Sdk) -> None:
    compare_frames("feetech", sdk, cases_of("feetech", ["status"]))


@pytest.mark.parametrize("endpoint", ["host", "servo"])
def test_no_frame_is_lost_that_it_finds(sdk: Sdk, endpoint: str) -> None:
    # It reads status packets: what a host sends only where that looks like one.
    compare_recovery("feetech", endpoint, sdk, cases_of("feetech"), share=0.6)
