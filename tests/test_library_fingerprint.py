"""Fingerprint sensors such as the R503, beside r503."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from struct import pack
from typing import Any

import pytest
from compiled import module_at
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

PEER = "r503"
NO_ANSWER = 99
"""What it has for a code where nothing came."""
BAUD, SECURITY, PACKET_SIZE = 4, 5, 6
COMMANDS: dict[str, Callable[[Any, Values], Any]] = {
    "take_image": lambda sensor, v: sensor.get_img(),
    "extract": lambda sensor, v: sensor.img2tz(v["buffer"]),
    "match": lambda sensor, v: sensor.match(),
    "search": lambda sensor, v: sensor.search(v["buffer"], v["first"], v["count"]),
    "combine": lambda sensor, v: sensor.reg_model(),
    "store": lambda sensor, v: sensor.store(v["buffer"], v["page"]),
    "load": lambda sensor, v: sensor.load_char(v["page"], v["buffer"]),
    "send_template": lambda sensor, v: sensor.up_char(),
    "take_template": lambda sensor, v: sensor.down_char([], v["buffer"]),
    "send_image": lambda sensor, v: sensor.up_image(),
    "take_other_image": lambda sensor, v: sensor.down_image([]),
    "delete": lambda sensor, v: sensor.delete_char(v["first"], v["count"]),
    "empty": lambda sensor, v: sensor.empty_finger_lib(),
    "write_register": lambda sensor, v: REGISTERS[v["register"]](sensor, v["value"]),
    "read_parameters": lambda sensor, v: sensor.read_sys_para(),
    "set_password": lambda sensor, v: sensor.set_pw(v["password"]),
    "verify_password": lambda sensor, v: sensor.verify_pw(v["password"]),
    "get_random": lambda sensor, v: sensor.get_random_code(),
    "read_information": lambda sensor, v: sensor.read_info_page(),
    "write_notepad": lambda sensor, v: sensor.write_notepad(
        v["page"], bytes.fromhex(v["content"]).decode()
    ),
    "read_notepad": lambda sensor, v: sensor.read_notepad(v["page"]),
    "count_templates": lambda sensor, v: sensor.ser_send(3, 0x1D),
    "read_index": lambda sensor, v: sensor.read_index_table(v["page"]),
    "take_good_image": lambda sensor, v: sensor.get_image_ex(),
    "cancel": lambda sensor, v: sensor.cancel(),
    "enroll": lambda sensor, v: sensor.auto_enroll(*v.values()),
    "identify": lambda sensor, v: sensor.auto_identify(*v.values()),
    "set_light": lambda sensor, v: sensor.led_control(*v.values()),
    "check": lambda sensor, v: sensor.check_sensor(),
    "get_algorithm": lambda sensor, v: sensor.get_alg_ver(),
    "get_firmware": lambda sensor, v: sensor.get_fw_ver(),
    "read_product": lambda sensor, v: sensor.read_prod_info(),
    "reset": lambda sensor, v: sensor.soft_reset(),
    "greet": lambda sensor, v: sensor.handshake(),
    # These it has no methods for, or, for the address, one that sends the new one.
    "set_address": lambda sensor, v: sensor.ser_send(7, 0x15, pkg=pack(">I", v["new"])),
    "search_fast": lambda sensor, v: sensor.ser_send(8, 0x1B, pkg=pack(">BHH", *v.values())),
    "echo": lambda sensor, v: sensor.ser_send(3, 0x53),
}
REGISTERS: dict[int, Callable[[Any, int], Any]] = {
    BAUD: lambda sensor, value: sensor.set_baud(value * 9600),
    SECURITY: lambda sensor, value: sensor.set_security(value),
    PACKET_SIZE: lambda sensor, value: sensor.set_pkg_length(32 << value),
}
VALUES = {BAUD: (1, 2, 4, 6, 12), SECURITY: (1, 2, 3, 4, 5), PACKET_SIZE: (0, 1, 2, 3)}
"""What it writes to each register."""
PACKED = {
    "answer": ">",
    "matched": ">H",
    "found": ">HH",
    "parameters": ">HHHHIHH",
    "random": ">I",
    "noted": ">32s",
    "template_count": ">H",
    "index": ">32s",
    "enrolled": ">BB",
    "identified": ">BHH",
    "algorithm": ">32s",
    "firmware": ">32s",
    "product": ">16s4s8sBB8sHHHH",
}
"""How it unpacks each answer behind the code."""
ANSWERS: dict[str, Callable[[Any, Values], Any]] = {
    "matched": lambda sensor, v: int.from_bytes(sensor.match()[1], "big"),
    "found": lambda sensor, v: named("page score", sensor.search()[1:]),
    "parameters": lambda sensor, v: dict(zip(v["values"], sensor.read_sys_para(), strict=True)),
    "random": lambda sensor, v: sensor.get_random_code(),
    "noted": lambda sensor, v: sensor.read_notepad(0)[1].hex(),
    "template_count": lambda sensor, v: sensor.read_valid_template_num(),
    "index": lambda sensor, v: table(sensor.read_index_table()),
    # It looks at neither what is behind the code, nor at the step.
    "enrolled": lambda sensor, v: named("step page", sensor.ser_send(3, 0x31)[5]),
    "identified": lambda sensor, v: (
        named("step", [v["at"]["step"]]) | named("page score", sensor.auto_identify())
    ),
    "algorithm": lambda sensor, v: text(sensor.get_alg_ver()[1].decode()),
    "firmware": lambda sensor, v: text(sensor.get_fw_ver()[1].decode()),
    "product": lambda sensor, v: product(list(sensor.read_prod_info_decode().values())),
}
"""What it reads behind the code, by the method that asks for it."""


def named(names: str, values: Iterable[int]) -> Values:
    return dict(zip(names.split(), values, strict=True))


def table(places: list[int]) -> str:
    """Bytes with a bit for each place."""
    return sum(1 << place for place in places).to_bytes(32, "little").hex()


def product(found: list[Any]) -> Values:
    texts = dict(zip(("model", "batch", "serial"), map(text, found[:3]), strict=True))
    sensor = {"hardware": {"major": found[3], "minor": found[4]}, "sensor": text(found[5])}
    return texts | sensor | named("width height template library", found[6:])


class Port:
    """A serial port as it has one, with what is there to read and what was written."""

    timeout = baudrate = 0

    def __init__(self, data: bytes = b"") -> None:
        self.data = data
        self.written = b""

    def read(self, size: int) -> bytes:
        return self.data

    def write(self, data: bytes) -> None:
        self.written = data


class R503:
    """Its sensor, of which the port is not opened."""

    def __init__(self) -> None:
        self._class: Any = peer_module("r503").R503

    def _sensor(self, port: Port, address: int = 0xFFFFFFFF) -> Any:
        sensor = self._class.__new__(self._class)
        sensor.ser, sensor.addr, sensor.recv_size = port, pack(">I", address), 128
        return sensor

    def frame(self, case: Case) -> bytes:
        port = Port()
        sensor = self._sensor(port, case.parts["address"])
        if case.message in COMMANDS:
            COMMANDS[case.message](sensor, case.values)
        elif case.message in PACKED:
            values = list(packed(case.values))
            content = pack(PACKED[case.message], *values) if values else b""
            sensor.ser_send(len(content) + 3, case.values["code"], pid=7, pkg=content)
        else:
            data = bytes.fromhex(case.values["data"])
            sensor.down_packet(data, end=case.message == "last_data")
        return port.written

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message in COMMANDS:
            return case.values  # it reads no command
        sensor = self._sensor(Port(frame), case.parts["address"])
        if case.message not in PACKED:
            done = self.frame(Case(case.sender, "answer", {"code": 0}, case.parts))
            sensor.ser.data = done + frame
            (data,) = sensor.up_char()
            return {"data": data.hex()}
        code, rest = sensor.read_msg(frame)[4:6]
        values = dict.fromkeys(case.values) | {"code": code}
        if rest is not None:
            values[list(values)[1]] = ANSWERS[case.message](sensor, case.values)
        return values

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What it reads at each header, if the checksum that it finds is right."""
        sensor = self._sensor(Port())
        at = data.find(sensor.header)
        while at >= 0:
            size = 9 + int.from_bytes(data[at + 7 : at + 9], "big")
            frame = data[at : at + size]
            is_whole = 12 <= len(frame) == size
            if is_whole and sensor.read_msg(frame)[6] == sum(frame[6:-2]):
                yield frame
                at += size - 1
            at = data.find(sensor.header, at + 1)


def packed(values: Values) -> Iterator[Any]:
    """The values behind the code, as struct takes them."""
    for name, value in values.items():
        if isinstance(value, dict):
            yield from packed(value)
        elif isinstance(value, str):
            yield bytes.fromhex(value) if name in ("content", "places") else value.encode()
        elif name != "code" and value is not None:
            yield value


def text(value: str) -> str:
    return value.rstrip("\0")


@pytest.fixture(scope="module")
def r503() -> R503:
    return R503()


def as_sent(case: Case) -> Case:
    """The case, as it sends it."""
    values = dict(case.values)
    if case.message == "write_register":
        values["register"] = BAUD + values["register"] % 3
        possible = VALUES[values["register"]]
        values["value"] = possible[values["value"] % len(possible)]
    elif case.message == "send_template":
        values["buffer"] = 1
    elif case.message == "write_notepad":
        content = bytes(byte & 0x7F for byte in bytes.fromhex(values["content"]))
        values["content"] = content.hex()
    return replace(case, values=values)


def is_read(case: Case) -> bool:
    """False where it takes the code for none, or drops zeros inside of a text."""
    return case.values.get("code") != NO_ANSWER and all(
        each.isascii() and "\0" not in each for each in texts_in(case.values)
    )


def texts_in(values: Values) -> Iterator[str]:
    for value in values.values():
        if isinstance(value, dict):
            yield from texts_in(value)
        elif isinstance(value, str):
            yield value


def test_both_make_the_same_commands(r503: R503) -> None:
    compare_frames("fingerprint", r503, map(as_sent, cases_of("fingerprint", COMMANDS)))


def test_both_make_and_read_the_same_answers(r503: R503) -> None:
    compare_frames("fingerprint", r503, filter(is_read, cases_of("fingerprint", PACKED)))


def test_both_make_and_read_the_same_data(r503: R503) -> None:
    compare_frames("fingerprint", r503, cases_of("fingerprint", ["data", "last_data"]))


@pytest.mark.parametrize("endpoint", ["host", "sensor"])
def test_no_frame_is_lost_that_it_finds(r503: R503, endpoint: str) -> None:
    compare_recovery("fingerprint", endpoint, r503, cases_of("fingerprint"))


def test_a_command_tells_what_its_answer_is() -> None:
    """The same bytes are a number behind GetRandomCode, and a place behind Search."""
    answer = bytes.fromhex("EF 01 FF FF FF FF 07 00 07 00 00 05 00 64 00 77")
    random = bytes.fromhex("EF 01 FF FF FF FF 01 00 03 14 00 18")
    search = bytes.fromhex("EF 01 FF FF FF FF 01 00 08 04 01 00 00 00 C8 00 D6")
    decoder = module_at(FOLDER / "fingerprint.yaml").Decoder()
    events = decoder.feed(answer + random + answer + search + answer)
    assert [event.kind for event in events] == ["unknown", *["message"] * 4]
    assert events[2].message.number == 0x00050064
    assert (events[4].message.best.page, events[4].message.best.score) == (5, 100)
