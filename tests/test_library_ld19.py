"""LD19, beside lds2d."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, encoded, peer_module

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case


class Line:
    """A serial line that keeps what is written. What can be read is there at once."""

    def __init__(self, data: bytes = b"") -> None:
        self.data = data
        self.written = b""

    def read(self, size: int) -> bytes:
        if not self.data:
            raise EOFError
        piece, self.data = self.data[:size], self.data[size:]
        return piece

    def write(self, data: bytes) -> None:
        self.written += data


class Lds2d:
    """lds2d. It reads measurements and writes commands."""

    def __init__(self) -> None:
        self._driver: Any = peer_module("lds2d.drivers.ldrobot_ld14p")
        self._crc: Any = peer_module("lds2d.crc").crc8

    def frame(self, case: Case) -> bytes:
        if case.message == "measurement":
            return self._measurement(case.values)
        line = Line()
        lidar = self._driver.LD19(line)
        if case.message == "set_scan_speed":
            lidar.set_scan_freq(case.values["speed"] / 360)
        else:
            {"start_scan": lidar.start, "stop_scan": lidar.stop}[case.message]()
        return line.written

    def _measurement(self, values: Values) -> bytes:
        """A packet as the manual shows it: lds2d has nothing that makes one."""
        packet = b"\x54\x2c" + struct.pack("<HH", values["speed"], values["start_angle"])
        for point in values["points"]:
            packet += struct.pack("<HB", point["distance"], point["intensity"])
        packet += struct.pack("<HH", values["end_angle"], values["timestamp"])
        return packet + bytes((self._crc(packet),))

    def values(self, case: Case, frame: bytes) -> Values:
        """Angles of the first and the last point are those of the packet."""
        if case.message != "measurement":
            return case.values  # it reads no command
        hertz, points = self._driver.parse_packet(frame)
        return {
            "speed": round(hertz * 360),
            "start_angle": round(points[0].angle_deg * 100),
            "points": [{"distance": at.dist_mm, "intensity": at.quality} for at in points],
            "end_angle": round(points[-1].angle_deg * 100) % 36000,
            "timestamp": case.values["timestamp"],  # it skips that
        }

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """Packets that its driver takes from a line, as they were."""
        assert endpoint == "lidar"
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(self._driver, "parse_packet", bytes)
            packets = self._driver.LD19(Line(data))._packets()
            try:
                yield from packets
            except EOFError:
                return


@pytest.fixture(scope="module")
def lds2d() -> Lds2d:
    return Lds2d()


@pytest.mark.parametrize("message", ["measurement", "set_scan_speed"])
def test_both_make_and_read_the_same_frames(lds2d: Lds2d, message: str) -> None:
    compare_frames("ld19", lds2d, cases_of("ld19", [message]))


@pytest.mark.parametrize("message", ["start_scan", "stop_scan"])
def test_both_start_and_stop_the_motor_alike(lds2d: Lds2d, message: str) -> None:
    case = cases_of("ld19", [message])[0]
    assert encoded("ld19", case) == lds2d.frame(case)


def test_no_frame_is_lost_that_it_finds(lds2d: Lds2d) -> None:
    # It reads measurements and no answers.
    compare_recovery("ld19", "lidar", lds2d, cases_of("ld19"), share=0.2)
