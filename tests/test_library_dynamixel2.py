"""Dynamixel protocol 2.0, beside dynamixel-sdk."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module
from servo_port import Port

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

ALL = 254
INSTRUCTIONS = ["ping", "read", "write", "reg_write", "action", "factory_reset", "reboot", "clear"]
TO_ALL = ["sync_read", "sync_write", "fast_sync_read", "bulk_read", "bulk_write", "fast_bulk_read"]
STUFFED = b"\xff\xff\xfd\xfd"
PIECES = (b"\xff", b"\xff\xff", b"\xfd", b"\xfd\xfd", b"\x00", b"\xff\xff\xfd", b"\xff\xff\xfd\x00")
"""What data are made of, so that there is much to stuff."""


class Sdk:
    """The packet handler of protocol 2, which sends what it has stuffed."""

    def __init__(self) -> None:
        self._module: Any = peer_module("dynamixel_sdk.protocol2_packet_handler")
        self._handler: Any = self._module.Protocol2PacketHandler()
        stuffs = self._handler.addStuffing

        def stuff(packet: list[int]) -> list[int]:
            packet[:] = stuffs(packet)
            return packet

        self._handler.addStuffing = stuff

    def frame(self, case: Case) -> bytes:
        port = Port()
        servo, values = case.parts["id"], case.values
        data = list(bytes.fromhex(values.get("data", "")))
        if case.message == "status":
            self._complete(port, servo, [0x55, values["error"], *data])
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
                sdk.factoryReset(port, servo, values["keeps"])
            case "reboot":
                sdk.reboot(port, servo)
            case "clear":
                sdk.clearMultiTurn(port, servo)

    def _send_to_all(self, port: Port, message: str, values: Values) -> None:
        sdk, fast = self._handler, message.startswith("fast")
        given = [byte for each in values.get("servos", ()) for byte in parameters(message, each)]
        match message:
            case "sync_read" | "fast_sync_read":
                ids = values["ids"]
                sdk.syncReadTx(port, values["address"], values["size"], ids, len(ids), fast)
            case "sync_write":
                sdk.syncWriteTxOnly(port, values["address"], values["size"], given, len(given))
            case "bulk_write":
                sdk.bulkWriteTxOnly(port, given, len(given))
            case _:
                sdk.bulkReadTx(port, given, len(given), fast)

    def _complete(self, port: Port, servo: int, content: list[int]) -> None:
        """Send a packet of its own making: header, stuffing and CRC are the SDK's."""
        size = len(content) + 2
        packet = [0, 0, 0, 0, servo, size & 0xFF, size >> 8, *content, 0, 0]
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(self._module, "TXPACKET_MAX_LEN", 1024 + 7)  # what it takes from a servo
            self._handler.txPacket(port, packet)

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message != "status" or frame.count(STUFFED[1:]) > 1:
            return case.values  # it reads no instruction, and not all that is stuffed
        packet, result = self._handler.rxPacket(Port(frame), False)
        assert result == self._module.COMM_SUCCESS
        size = packet[5] | packet[6] << 8
        return {"error": packet[8], "data": bytes(packet[9 : 5 + size]).hex()}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """It looks for a header from the end of the packet before, whatever that was."""
        if endpoint == "host":
            yield from self._instructions(data)
            return
        port = Port(data)
        while port.data:
            packet, result = self._handler.rxPacket(port, True)
            if result == self._module.COMM_SUCCESS:
                yield bytes(packet)

    def _instructions(self, data: bytes) -> Iterator[bytes]:
        """As servos do: the SDK reads none, but its CRC tells what one is."""
        at = data.find(b"\xff\xff\xfd\x00")
        while 0 <= at < len(data) - 9:
            end = at + 7 + int.from_bytes(data[at + 5 : at + 7], "little")
            frame = data[at:end]
            crc = self._handler.updateCRC(0, frame, len(frame) - 2) if len(frame) > 9 else -1
            is_whole = end <= len(data) and crc == int.from_bytes(frame[-2:], "little")
            if is_whole:
                yield frame
            at = data.find(b"\xff\xff\xfd\x00", end if is_whole else at + 1)


def parameters(message: str, each: Values) -> bytes:
    """What an instruction says of one servo."""
    data = bytes.fromhex(each.get("data", ""))
    if message == "sync_write":
        return bytes((each["id"],)) + data
    numbers = each["address"].to_bytes(2, "little") + each["size"].to_bytes(2, "little")
    return bytes((each["id"],)) + numbers + data


@pytest.fixture(scope="module")
def sdk() -> Sdk:
    return Sdk()


def test_both_make_the_same_instructions(sdk: Sdk) -> None:
    drawn = cases_of("dynamixel2", INSTRUCTIONS)
    compare_frames("dynamixel2", sdk, [understood(case) for case in drawn])


def understood(case: Case) -> Case:
    """The case, as the SDK sends it: it asks one servo, and it clears nothing but turns."""
    if case.message == "clear":
        case = replace(case, values={**case.values, "what": 1})
    if case.message not in ("ping", "read") or case.parts["id"] != ALL:
        return case
    return replace(case, parts={"id": 0})


def test_both_make_the_same_instructions_to_all(sdk: Sdk) -> None:
    drawn = cases_of("dynamixel2", TO_ALL)
    compare_frames("dynamixel2", sdk, [replace(case, parts={"id": ALL}) for case in drawn])


def test_both_make_and_read_the_same_statuses(sdk: Sdk) -> None:
    compare_frames("dynamixel2", sdk, [of_one(case) for case in cases_of("dynamixel2", ["status"])])


def of_one(case: Case) -> Case:
    """The case, from one servo: what all send in one status, the SDK reads in another way."""
    return replace(case, parts={"id": min(case.parts["id"], 252)})


@pytest.mark.parametrize("message", ["write", "status"])
def test_both_stuff_the_same_bytes(sdk: Sdk, message: str) -> None:
    dice = Random(message)
    drawn = [of_one(with_sequences(case, dice)) for case in cases_of("dynamixel2", [message])]
    compare_frames("dynamixel2", sdk, drawn)
    assert sum(STUFFED in sdk.frame(case) for case in drawn) > len(drawn) / 2


def with_sequences(case: Case, dice: Random) -> Case:
    data = b"".join(dice.choices(PIECES, k=dice.randrange(1, 12)))
    return replace(case, values={**case.values, "data": data.hex()})


@pytest.mark.parametrize("endpoint", ["host", "servo"])
def test_no_frame_is_lost_that_it_finds(sdk: Sdk, endpoint: str) -> None:
    dice = Random(endpoint)
    drawn = [
        with_sequences(case, dice) if "data" in case.values else case
        for case in cases_of("dynamixel2")
    ]
    compare_recovery("dynamixel2", endpoint, sdk, drawn)
