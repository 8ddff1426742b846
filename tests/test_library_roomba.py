"""Roomba Open Interface, beside pycreate2 and pyroombaadapter."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any, cast

import pytest
from compiled import module_at, protocol_of
from library_support import (
    FRAMES,
    cases_of,
    compare_frames,
    compare_recovery,
    encoded,
    peer_module,
)

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

ALL_SENSORS = 100
PACKETS = {
    message.name: message.identity[0]
    for message in protocol_of(FOLDER / "roomba.yaml").messages
    if message.name.startswith("answer_")
}
"""Answers, and the packets that they are."""
COMMANDS = {
    "start": "Start",
    "safe": "Safe",
    "full": "Full",
    "power": "Power",
    "spot": "Spot",
    "clean": "Clean",
    "max": "Max",
    "seek_dock": "Seek Dock",
}
"""Commands without data, and their names in pyroombaadapter."""
MOVES = [
    "drive",
    "motors",
    "song",
    "play",
    "pwm_motors",
    "drive_direct",
    "drive_pwm",
    "ask_stream",
    "press",
]
"""Commands that pyroombaadapter makes of numbers."""
SHOWN = ["reset", "stop", "leds", "sensors", "digit_characters"]
"""Commands of pycreate2."""


class Line:
    """A serial line: what is there to read, how much of it was, and what was written."""

    def __init__(self, data: bytes = b"") -> None:
        self.data = data
        self.at = 0

        self.written = b""

    def write(self, data: bytes) -> None:
        self.written += data

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


class Answers:
    """Answers of single packets as pyroombaadapter has them in a stream."""

    def __init__(self, stream: Stream) -> None:
        self._stream = stream

    def is_known(self, case: Case) -> bool:
        """True for a packet that it knows."""
        return PACKETS[case.message] in self._stream.single

    def _streamed(self, case: Case) -> Case:
        packet = {"id": PACKETS[case.message], "value": case.values}
        return replace(case, values={"packets": [packet]})

    def frame(self, case: Case) -> bytes:
        return self._stream.frame(self._streamed(case))[3:-1]

    def values(self, case: Case, frame: bytes) -> Values:
        packet = bytes((19, len(frame) + 1, PACKETS[case.message])) + frame
        streamed = packet + bytes((-sum(packet) % 256,))
        return cast(
            Values, self._stream.values(self._streamed(case), streamed)["packets"][0]["value"]
        )

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        return iter(())


class Host:
    """Commands as pyroombaadapter and pycreate2 make them. Neither reads any."""

    def __init__(self) -> None:
        self._made: Any = peer_module("pyroombaadapter").PyRoombaAdapter
        self._create: Any = peer_module("pycreate2.create2api")

    def frame(self, case: Case) -> bytes:
        line = Line()
        if case.message in SHOWN:
            self._show(line, case.message, case.values)
            return line.written
        adapter = self._made.__new__(self._made)  # it would open a port, and wait
        adapter.serial_con = line
        try:
            if case.message in COMMANDS:
                adapter._send_cmd(self._made.CMD[COMMANDS[case.message]])
            else:
                self._move(adapter, case.message, case.values)
        finally:
            adapter.serial_con = None  # it says good-bye there
        return line.written

    def _move(self, adapter: Any, message: str, values: Values) -> None:
        match message:
            case "drive":
                adapter.send_drive_cmd(values["velocity"], values["radius"])
            case "motors":
                on = bits(values["motors"], 5)
                adapter.send_moters_cmd(on[2], not on[4], on[0], not on[3], on[1])
            case "song":
                notes = [note["note"] for note in values["notes"]]
                durations = [note["duration"] for note in values["notes"]]
                adapter.send_song_cmd(values["number"], len(notes), notes, durations)
            case "play":
                adapter.send_play_cmd(values["number"])
            case "pwm_motors":
                adapter.send_pwm_moters(*values.values())
            case "drive_direct":
                adapter.send_drive_direct(values["right"], values["left"])
            case "drive_pwm":
                adapter.send_drive_pwm(values["right"], values["left"])
            case "ask_stream":
                numbers = {number: name for name, (number, *_) in self._made.SENSOR.items()}
                adapter.data_stream_start([numbers[number] for number in values["packets"]])
            case "press":
                adapter.send_buttons_cmd(*bits(values["buttons"], 8))

    def _show(self, line: Line, message: str, values: Values) -> None:
        commands = self._create.SerialCommandInterface()
        commands.ser = SimpleNamespace(write=line.write, is_open=False)
        host = SimpleNamespace(SCI=commands)
        match message:
            case "leds":
                self._create.Create2.led(host, *values.values())
            case "digit_characters":
                text = "".join(map(chr, values["characters"]))
                self._create.Create2.digit_led_ascii(host, text)
            case "sensors":
                commands.write(self._create.OPCODES.SENSORS, (values["packet"],))
            case _:
                commands.write(getattr(self._create.OPCODES, message.upper()))

    def known(self, case: Case) -> Case:
        """The case as far as they go: with a radius that they allow, packets that they know."""
        values = dict(case.values)
        match case.message:
            case "drive":
                values["radius"] = max(-2000, min(values["radius"], 2000))
            case "motors":
                values["motors"] &= 0x1F
            case "digit_characters":
                values["characters"] = [ord(chr(code).upper()) for code in values["characters"]]
            case "ask_stream":
                known = {number for number, *_ in self._made.SENSOR.values()}
                packets = [number for number in values["packets"] if number in known]
                packets = packets or [min(known)]
                values = {"size": len(packets), "packets": packets}
        return replace(case, values=values)

    def values(self, case: Case, frame: bytes) -> Values:
        return case.values

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        return iter(())


@pytest.fixture(scope="module")
def stream() -> Stream:
    return Stream()


def test_both_make_and_read_the_same_packets_of_a_stream(stream: Stream) -> None:
    def single(case: Case) -> Case:
        packets = [packet for packet in case.values["packets"] if packet["id"] in stream.single]
        return replace(case, values={"packets": packets})

    compare_frames("roomba", stream, map(single, cases_of("roomba", ["stream"])))


def test_both_make_the_same_commands() -> None:
    host = Host()
    drawn = cases_of("roomba", [*COMMANDS, *MOVES, *SHOWN])
    compare_frames("roomba", host, map(host.known, drawn))


def test_no_frame_is_lost_that_it_finds(stream: Stream) -> None:
    # It does not know all packets that a stream may have.
    compare_recovery("roomba", "robot", stream, cases_of("roomba", ["stream"]), share=0.45)


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


def test_both_make_and_read_the_same_answers(stream: Stream) -> None:
    answers = Answers(stream)
    both = [*cases_of("roomba", PACKETS), *cases_of("roomba", PACKETS, seed=2)]
    drawn = list(filter(answers.is_known, both))
    assert len(drawn) >= FRAMES
    compare_frames("roomba", answers, drawn)


def test_what_it_asks_for_is_read_as_it_reads_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its question tells our decoder what the answer is."""
    api: Any = peer_module("pycreate2.create2api")
    monkeypatch.setattr(api.time, "sleep", lambda _: None)
    module = module_at(FOLDER / "roomba.yaml")
    asked, answers = module.Decoder("host"), module.Decoder("answers")
    commands = api.SerialCommandInterface()
    for case in cases_of("roomba", ["answer_group_7_to_58"]):
        answer = encoded("roomba", case)
        line = Line(answer)
        commands.ser = SimpleNamespace(write=line.write, read=line.read, is_open=True)
        theirs = api.Create2.get_sensors(SimpleNamespace(SCI=commands))
        commands.ser.is_open = False  # it would close it
        (question,) = asked.feed(line.written)
        answers.hear(question)
        (event,) = answers.feed(answer)
        assert event.message.to_dict() == case.values
        assert as_pycreate2(case.values) == numbers(theirs)


def test_packets_have_its_sizes() -> None:
    sizes = peer_module("pycreate2.OI").RESPONSE_SIZES
    ours = {
        PACKETS[case.message]: len(encoded("roomba", case)) for case in cases_of("roomba", PACKETS)
    }
    together = {32: 1, 33: 2}  # It has 3 bytes for each of them, which both have together.
    assert ours == sizes | together


def test_a_list_of_packets_is_answered_in_its_order() -> None:
    module = module_at(FOLDER / "roomba.yaml")
    asked, answers = module.Decoder("host"), module.Decoder("answers")
    # 149: two packets, 29 and 13. Then 537 and 0, and a byte that nobody asked for.
    for event in asked.feed(bytes.fromhex("95 02 1D 0D")):
        answers.hear(event)
    found = [*answers.feed(bytes.fromhex("02 19 00 13")), *answers.flush()]
    assert [item.message.value for item in found[:2]] == [537, 0]
    assert [item.kind for item in found] == ["message", "message", "invalid"]


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
