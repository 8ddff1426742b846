"""Dynamixel protocol 1.0, beside dynamixel-sdk."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module
from servo_port import Port

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

ALL = 254
INSTRUCTIONS = ["ping", "read", "write", "reg_write", "action", "factory_reset", "reboot"]
TO_ALL = ["sync_write", "bulk_read"]


class Sdk:
    """The packet handler of protocol 1."""

    def __init__(self) -> None:
        self._module: Any = peer_module("dynamixel_sdk.protocol1_packet_handler")
        self._handler: Any = self._module.Protocol1PacketHandler()

    def frame(self, case: Case) -> bytes:
        port = Port()
        servo, values = case.parts["id"], case.values
        data = list(bytes.fromhex(values.get("data", "")))
        if case.message == "status":
            self._complete(port, servo, [values["error"], *data])
        elif case.message == "reboot":
            self._complete(port, servo, [8])  # its own does nothing in this protocol
        elif case.message in TO_ALL:
            self._send_to_all(port, case.message, values)
        else:
            self._send(port, case.message, servo, values, data)
        return port.written

    def _send(self, port: Port, message: str, servo: int, values: Values, data: list[int]) -> None:
        sdk = self._handler
        match message:
            case "ping":
                sdk.ping(port, servo)
            case "read":
                sdk.readTx(port, servo, values["address"], values["size"])
            case "write":
                sdk.writeTxOnly(port, servo, values["address"], len(data), data)
            case "reg_write":
                sdk.regWriteTxOnly(port, servo, values["address"], len(data), data)
            case "action":
                sdk.action(port, servo)
            case "factory_reset":
                sdk.factoryReset(port, servo)

    def _send_to_all(self, port: Port, message: str, values: Values) -> None:
        given = b""
        if message == "sync_write":
            for each in values["servos"]:
                given += bytes((each["id"], *bytes.fromhex(each["data"])))
            size = values["size"]
            self._handler.syncWriteTxOnly(port, values["address"], size, given, len(given))
        else:
            for each in values["servos"]:
                given += bytes((each["size"], each["id"], each["address"]))
            self._handler.bulkReadTx(port, given, len(given))

    def _complete(self, port: Port, servo: int, content: list[int]) -> None:
        """Send a packet of its own making: header and checksum are the SDK's."""
        packet = [0, 0, servo, len(content) + 1, *content, 0]
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(self._module, "TXPACKET_MAX_LEN", 254)  # what it takes from a servo
            self._handler.txPacket(port, packet)

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message != "status":
            return case.values  # it reads no instruction
        length = len(frame) - 6
        data, result, error = self._handler.readRx(Port(frame), case.parts["id"], length)
        assert result == self._module.COMM_SUCCESS
        return {"error": error, "data": bytes(data).hex()}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """It looks for a header from the end of the packet before, whatever that was."""
        port = Port(data)
        while port.data:
            packet, result = self._handler.rxPacket(port)
            if result == self._module.COMM_SUCCESS:
                yield bytes(packet)


@pytest.fixture(scope="module")
def sdk() -> Sdk:
    return Sdk()


def test_both_make_the_same_instructions(sdk: Sdk) -> None:
    drawn = cases_of("dynamixel1", INSTRUCTIONS)
    compare_frames("dynamixel1", sdk, [answered(case) for case in drawn])


def answered(case: Case) -> Case:
    """The case, to a servo that answers: of all at once, the SDK asks nothing."""
    if case.message not in ("ping", "read") or case.parts["id"] != ALL:
        return case
    return replace(case, parts={"id": 0})


@pytest.mark.parametrize("message", TO_ALL)
def test_both_make_the_same_instructions_to_all(sdk: Sdk, message: str) -> None:
    drawn = cases_of("dynamixel1", [message])
    compare_frames("dynamixel1", sdk, [replace(case, parts={"id": ALL}) for case in drawn])


def test_both_make_and_read_the_same_statuses(sdk: Sdk) -> None:
    compare_frames("dynamixel1", sdk, cases_of("dynamixel1", ["status"]))


@pytest.mark.parametrize("endpoint", ["host", "servo"])
def test_no_frame_is_lost_that_it_finds(sdk: Sdk, endpoint: str) -> None:
    # It reads status packets: what a host sends only where that looks like one.
    compare_recovery("dynamixel1", endpoint, sdk, cases_of("dynamixel1"), share=0.6)
