"""RPLIDAR, beside pyrplidar."""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce
from operator import xor
from typing import Any

import pytest
from compiled import module_at
from library_support import (
    cases_of,
    compare_frames,
    compare_recovery,
    encoded,
    endpoint_of,
    peer_module,
)
from rplidar_sdk import HIGH_QUALITY, ULTRA_DENSE, Sdk

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

HEAD = 7
"""Bytes of an answer in front of its data."""
REQUESTS = [
    "scan",
    "force_scan",
    "stop",
    "reset",
    "get_info",
    "get_health",
    "get_sample_rate",
    "express_scan",
    "high_quality_scan",
    "get_setting",
    "set_setting",
    "confirm_baud",
    "set_motor_speed",
    "set_motor_pwm",
    "get_board",
]
ANSWERS = ["info", "health", "sample_rate", "setting", "setting_changed", "board"]
ANNOUNCEMENTS = [
    "nodes_follow",
    "capsules_follow",
    "high_quality_follows",
    "ultra_capsules_follow",
    "dense_capsules_follow",
    "ultra_dense_capsules_follow",
]
SCANNED = 60
"""Packets whose recovery is compared: each takes many bytes that are looked at one by one."""
MEASUREMENTS = ["node", "capsule", "dense_capsule", "ultra_capsule"]


class Line:
    """A serial line as pyrplidar has one, with what is there to read and what was written."""

    def __init__(self, data: bytes = b"") -> None:
        self.data = data
        self.written = b""

    def send_data(self, data: bytes) -> None:
        self.written = data

    def receive_data(self, size: int) -> bytes:
        piece, self.data = self.data[:size], self.data[size:]
        return piece

    def set_dtr(self, value: bool) -> None:
        pass

    def close(self) -> None:
        pass


class Lidar:
    """The driver, which sends requests and reads answers."""

    def __init__(self) -> None:
        self._protocol: Any = peer_module("pyrplidar_protocol")
        self._driver: Any = peer_module("pyrplidar").PyRPlidar()

    def frame(self, case: Case) -> bytes:
        """Of an answer it is ours: it makes none."""
        ours = encoded("rplidar", case)
        if case.message not in REQUESTS:
            return ours
        if case.message == "set_motor_pwm":
            line = self._driver.lidar_serial = Line()
            self._driver.set_motor_pwm(case.values["pwm"])
            self._driver.lidar_serial = None
            return line.written
        data = ours[3:-1] if len(ours) > 2 else None
        request: bytes = self._protocol.PyRPlidarCommand(ours[1:2], data).raw_bytes
        return request

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message in REQUESTS:
            return case.values  # it reads none
        if case.message == "node":
            return self._measured(case, frame)
        if case.message in MEASUREMENTS:
            return self._capsule(case, frame)
        data = self._content(frame)
        if case.message in ANNOUNCEMENTS:
            assert data is None
            return {}
        assert data == frame[HEAD:]
        match case.message:
            case "info":
                info = self._protocol.PyRPlidarDeviceInfo(data)
                return {
                    "model": info.model,
                    "firmware_minor": info.firmware_minor,
                    "firmware_major": info.firmware_major,
                    "hardware": info.hardware,
                    "serial_number": info.serialnumber.lower(),
                }
            case "health":
                health = self._protocol.PyRPlidarHealth(data)
                code = health.error_code  # read with its highest byte first
                swapped = int.from_bytes(code.to_bytes(2, "big"), "little")
                return {"status": health.status, "error_code": swapped}
            case "sample_rate":
                rate = self._protocol.PyRPlidarSamplerate(data)
                return {"standard": rate.t_standard, "express": rate.t_express}
        return case.values  # it reads no more of the others

    def _measured(self, case: Case, frame: bytes) -> Values:
        """What it reads in a measurement, of which the check bit is left to its callers."""
        found = self._protocol.PyRPlidarMeasurement(frame)
        assert {"start": found.start_flag, "quality": found.quality} == case.parts
        direction = {"check": frame[1] & 1, "angle": found.angle * 64}
        return {"direction": direction, "distance": found.distance * 4}

    def _capsule(self, case: Case, frame: bytes) -> Values:
        """What it reads in a capsule, of which it leaves the checksum to its callers."""
        kinds = {"capsule": "ScanCapsule", "dense_capsule": "ScanDenseCapsule"}
        kind = kinds.get(case.message, "ScanUltraCapsule")
        found = getattr(self._protocol, f"PyRPlidar{kind}")(frame)
        assert (found.sync_byte1, found.sync_byte2) == (0xA, 5)
        assert found.checksum == reduce(xor, frame[2:])
        direction = {"angle": found.start_angle_q6, "first": int(found.start_flag)}
        if case.message == "dense_capsule":
            swapped = (cabin.distance.to_bytes(2, "little") for cabin in found.cabins)
            distances = [int.from_bytes(item, "big") for item in swapped]  # highest byte first
            return {"direction": direction, "distances": distances}
        if case.message == "capsule":
            return {"direction": direction, "cabins": list(map(_cabin, found.cabins))}
        return {"direction": direction, "cabins": list(map(_ultra_cabin, found.ultra_cabins))}

    def _content(self, data: bytes) -> bytes | None:
        """Data of an answer, or None for what announces measurements. Raises what it raises."""
        self._driver.lidar_serial = Line(data)
        try:
            head = self._driver.receive_discriptor()
            content: bytes | None = self._driver.receive_data(head) if head.send_mode == 0 else None
        finally:
            self._driver.lidar_serial = None  # it says good-bye there
        return content

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """It reads an answer where it waits for one. In a stream, it tries at each byte."""
        assert endpoint == "lidar"
        at = 0
        while len(data) - at >= HEAD:
            try:
                content = self._content(data[at:])
            except (self._protocol.PyRPlidarProtocolError, IndexError):
                at += 1
                continue
            size = HEAD + len(content or b"")
            yield data[at : at + size]
            at += size


def _cabin(cabin: Any) -> Values:
    return {
        "angle_1_high": cabin.d_theta1 >> 4,
        "distance_1": cabin.distance1,
        "angle_2_high": cabin.d_theta2 >> 4,
        "distance_2": cabin.distance2,
        "angle_1": cabin.d_theta1 & 15,
        "angle_2": cabin.d_theta2 & 15,
    }


def _ultra_cabin(cabin: Any) -> Values:
    """Differences are 32 bits with the sign in all above the tenth."""
    one, two = (
        item - (1 << 32) if item >> 31 else item for item in (cabin.predict1, cabin.predict2)
    )
    return {"distance": cabin.major, "difference_1": one, "difference_2": two}


@pytest.fixture(scope="module")
def lidar() -> Lidar:
    return Lidar()


@pytest.mark.parametrize("messages", [REQUESTS, ANSWERS, ANNOUNCEMENTS, MEASUREMENTS])
def test_both_make_and_read_the_same(lidar: Lidar, messages: list[str]) -> None:
    compare_frames("rplidar", lidar, cases_of("rplidar", messages))


@pytest.mark.parametrize(
    ("name", "wrong"),
    [("start_not", "BF 8B 46 34 10"), ("start_not", "BC 8B 46 34 10"), ("check", "BD 8A 46 34 10")],
)
def test_measurements_are_told_by_three_bits(name: str, wrong: str) -> None:
    module: Any = module_at(FOLDER / "rplidar.yaml")
    right = bytes.fromhex("BD 8B 46 34 10")  # 0x2345 / 64 degrees, 0x1034 / 4 mm, 47, start
    decoder = module.Decoder("nodes")
    events = [*decoder.feed(bytes.fromhex(wrong) + right), *decoder.flush()]
    (event,) = (event for event in events if event.kind == "message")
    assert (event.raw, event.parts.start, event.parts.quality) == (right, 1, 47)
    assert event.message.direction.angle == 0x2345
    assert event.message.distance == 0x1034


def test_a_capsule_is_found_behind_others_that_are_damaged() -> None:
    module: Any = module_at(FOLDER / "rplidar.yaml")
    # Each begins with A in its high bits, and so do two bytes of the distances.
    data = bytes.fromhex("34 12 A7 00 AF 05") + bytes(76)  # 34 ^ 12 ^ A7 ^ AF ^ 05 = 2B
    right = bytes.fromhex("AB 52") + data
    wrong = [bytes.fromhex("AA 52") + data, bytes.fromhex("AB 51") + data, right[:50]]
    decoder = module.Decoder("dense_capsules")
    events = [*decoder.feed(b"".join([*wrong, right, right])), *decoder.flush()]
    assert [event.raw for event in events if event.kind == "message"] == [right, right]
    reasons = {event.reason for event in events if event.kind == "invalid"}
    assert "checksum" in reasons
    assert events[-1].message.distances[:2] == [0xA7, 0x5AF]


def test_no_answer_is_lost_that_it_finds(lidar: Lidar) -> None:
    compare_recovery("rplidar", "lidar", lidar, cases_of("rplidar"))


@pytest.fixture(scope="module")
def packets() -> list[Case]:
    return cases_of("rplidar", [HIGH_QUALITY, ULTRA_DENSE])


def test_packets_laid_out_by_hand_are_the_same(packets: list[Case]) -> None:
    compare_frames("rplidar", Sdk(), packets)


@pytest.mark.parametrize(("message", "errors"), [(HIGH_QUALITY, 0.001), (ULTRA_DENSE, 0.01)])
def test_no_packet_is_lost_that_a_scan_byte_by_byte_finds(
    packets: list[Case], message: str, errors: float
) -> None:
    drawn = [case for case in packets if case.message == message][:SCANNED]
    compare_recovery("rplidar", endpoint_of("rplidar", drawn[0]), Sdk(), drawn, errors=errors)
