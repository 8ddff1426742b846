"""Roomba Open Interface, beside pycreate2 and pyroombaadapter."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, encoded, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

ALL_SENSORS = 100


class Line:
    """A serial line: what is there to read, and how much of it was."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0

    def read(self, size: int) -> bytes:
        piece = self.data[self.at : self.at + size]
        self.at += len(piece)
        return piece


class Stream:
    """Packets of a stream as pyroombaadapter reads them: as integers, one behind another.

    It has no groups of packets; their sizes are those of pycreate2.
    """

    def __init__(self) -> None:
        made: Any = peer_module("pyroombaadapter").PyRoombaAdapter
        sizes = {
            number: (size, False)
            for number, size in peer_module("pycreate2.OI").RESPONSE_SIZES.items()
        }
        self.single = {number: rest for number, *rest in made.SENSOR.values()}
        self._adapter = made.__new__(made)  # it would open a port, and wait
        self._adapter.stream_sensors = {**sizes, **self.single}

    def _read(self, line: Line) -> list[int]:
        self._adapter.serial_con = line
        try:
            numbers: list[int] = self._adapter.data_stream_read()
        finally:
            self._adapter.serial_con = None  # it says good-bye there
        return numbers

    def frame(self, case: Case) -> bytes:
        """A packet as the specification shows it: neither package has one that makes it."""
        content = b""
        for packet in case.values["packets"]:
            size, signed = self.single[packet["id"]]
            content += bytes((packet["id"],))
            content += packet["value"]["value"].to_bytes(size, "big", signed=signed)
        packet = bytes((19, len(content), *content))
        return packet + bytes((-sum(packet) % 256,))

    def values(self, case: Case, frame: bytes) -> Values:
        numbers = self._read(Line(frame))
        asked = [packet["id"] for packet in case.values["packets"]]
        found = zip(asked, numbers, strict=True)
        return {"packets": [{"id": id, "value": {"value": number}} for id, number in found]}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """It tries at each byte once, and goes on behind what it took for a packet."""
        assert endpoint == "robot"
        line = Line(data)
        while line.at < len(data):
            begin = line.at
            try:
                numbers = self._read(line)
            except KeyError:  # an unknown number in a packet that checks by chance
                continue
            if numbers:
                yield data[begin : line.at]


@pytest.fixture(scope="module")
def stream() -> Stream:
    return Stream()


def test_both_make_and_read_the_same_packets_of_a_stream(stream: Stream) -> None:
    def single(case: Case) -> Case:
        packets = [packet for packet in case.values["packets"] if packet["id"] in stream.single]
        return replace(case, values={"packets": packets})

    compare_frames("roomba", stream, map(single, cases_of("roomba", ["stream"])))


def test_no_frame_is_lost_that_it_finds(stream: Stream) -> None:
    compare_recovery("roomba", "robot", stream, cases_of("roomba"))


def test_both_read_the_same_in_all_sensors() -> None:
    decode = peer_module("pycreate2.packets").SensorPacketDecoder
    compared = 0
    for case in cases_of("roomba", ["stream"]):
        for packet in case.values["packets"]:
            if packet["id"] == ALL_SENSORS:
                alone = replace(case, values={"packets": [packet]})
                data = encoded("roomba", alone)[3:-1]
                assert as_pycreate2(packet["value"]) == numbers(decode(data))
                compared += 1
    assert compared > 50


def numbers(sensors: Any) -> list[int]:
    """What pycreate2 reads, with tuples of bits in one row with the rest."""
    row = []
    for value in sensors:
        row += map(int, value) if isinstance(value, tuple) else [int(value)]
    return row


def as_pycreate2(value: Values) -> list[int]:
    """Our values in its order and with its faults, which the schema's decisions tell."""
    row: list[int] = []
    for name, number in leaves(value):
        match name:
            case "unused_16" | "unused_32" | "unused_33":
                pass
            case "bumps_and_wheel_drops" | "stasis" | "charging_sources":
                row += bits(number, 4 if name == "bumps_and_wheel_drops" else 2)
            case "wheel_overcurrents":
                row += bits(number, 4)  # one lower than they are, from the main brush on
            case "buttons":
                row += bits(number, 8)
            case "light_bumper":
                row += bits(number, 6)
            case "dirt_detect":
                row.append(number - 256 * (number > 127))
            case "left_encoder" | "right_encoder":
                row.append(number % 65536)
            case _:
                row.append(number)
    return row


def leaves(value: Values) -> Iterator[tuple[str, int]]:
    for name, inner in value.items():
        if isinstance(inner, dict):
            yield from leaves(inner)
        else:
            yield name, inner


def bits(number: int, count: int) -> list[int]:
    return [number >> bit & 1 for bit in range(count)]
