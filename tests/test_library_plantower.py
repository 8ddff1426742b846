"""Plantower particle sensors, beside plantower."""

from __future__ import annotations

import logging
import struct
from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

COMMANDS = ["set_mode", "read", "set_sleep"]
NAMES = {
    "pm1_0_standard": "pm10_cf1",
    "pm2_5_standard": "pm25_cf1",
    "pm10_standard": "pm100_cf1",
    "pm1_0": "pm10_std",
    "pm2_5": "pm25_std",
    "pm10": "pm100_std",
    "above_0_3_um": "gr03um",
    "above_0_5_um": "gr05um",
    "above_1_0_um": "gr10um",
    "above_2_5_um": "gr25um",
    "above_5_0_um": "gr50um",
    "above_10_um": "gr100um",
}
"""Values by its names; it has none for the version and the error at their end."""


class Serial:
    """A port as it has one, with what is there to read and what was written."""

    def __init__(self, data: bytes = b"") -> None:
        self.data = data
        self.at = 0
        self.written = b""

    def read(self, size: int = 1) -> bytes:
        if self.at + size > len(self.data):
            raise EOFError
        self.at += size
        return self.data[self.at - size : self.at]

    def write(self, data: bytes) -> None:
        self.written = data

    def flush(self) -> None:
        pass


class Plantower:
    """plantower, whose waits take no time."""

    def __init__(self) -> None:
        self._module: Any = peer_module("plantower.plantower")

    def _sensor(self, serial: Serial) -> Any:
        sensor = self._module.Plantower.__new__(self._module.Plantower)  # Else it opens a port.
        sensor.serial, sensor.read_timeout = serial, 60
        sensor.logger = logging.getLogger("plantower")
        sensor.logger.setLevel(logging.CRITICAL)
        return sensor

    def frame(self, case: Case) -> bytes:
        if case.message == "measurement":
            *values, version, error = case.values.values()
            frame = b"BM" + struct.pack(">13H2B", 28, *values, version, error)
            return frame + struct.pack(">H", sum(frame))
        serial = Serial()
        sensor = self._sensor(serial)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(self._module.time, "sleep", lambda _: None)
            match case.message:
                case "set_mode":
                    sensor.mode_change(case.values["mode"])
                case "set_sleep":
                    sensor.set_to_sleep(not case.values["state"])
                case "read":
                    with pytest.raises(EOFError):  # It waits for the measurement.
                        sensor.read_in_passive(perform_flush=False)
        return serial.written

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message != "measurement":
            return case.values  # it reads no command
        reading = self._sensor(Serial(frame)).read(perform_flush=False)
        return {
            name: getattr(reading, NAMES[name]) if name in NAMES else value
            for name, value in case.values.items()
        }

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """It goes on behind a frame that fails."""
        serial = Serial(data)
        sensor = self._sensor(serial)
        while True:
            try:
                sensor.read(perform_flush=False)
            except EOFError:
                return
            except self._module.PlantowerException:
                continue
            yield data[serial.at - 32 : serial.at]


@pytest.fixture(scope="module")
def plantower() -> Plantower:
    return Plantower()


@pytest.mark.filterwarnings("ignore:datetime.datetime.utcnow:DeprecationWarning")
class TestPlantower:
    def test_both_make_the_same_commands(self, plantower: Plantower) -> None:
        compare_frames("plantower", plantower, cases_of("plantower", COMMANDS))

    def test_it_reads_the_measurements_that_we_make(self, plantower: Plantower) -> None:
        compare_frames("plantower", plantower, cases_of("plantower", ["measurement"]))

    def test_no_frame_is_lost_that_it_finds(self, plantower: Plantower) -> None:
        compare_recovery("plantower", "sensor", plantower, cases_of("plantower", ["measurement"]))
