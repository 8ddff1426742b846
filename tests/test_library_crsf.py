"""CRSF, beside elrs and rpycrsf."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from contextlib import suppress
from random import Random
from typing import Any

import pytest
from compiled import module_at
from library_support import (
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

HEADER = 3
"""Bytes in front of what a type holds."""


class Radio:
    """What elrs and rpycrsf know of CRSF."""

    def __init__(self) -> None:
        self._rc: Any = peer_module("elrs.rc")
        self._telemetry: Any = peer_module("elrs.telemetry")
        self._crc: Any = peer_module("elrs.crc")
        self._protocol: Any = peer_module("rpycrsf.protocol")

    def frame(self, case: Case) -> bytes:
        """Only of channels it makes the whole frame, else what is around the content."""
        if case.message == "rc_channels":
            frame: bytes = self._rc.build_rc_frame(case.values["channels"])
            assert frame == self._protocol.pack_rc_channels(case.values["channels"])
            return bytes((case.parts["sync"], *frame[1:]))  # its own is the one of the serial line
        ours = encoded("crsf", case)
        return self._around(ours[0], ours[2:-1])

    def _around(self, sync: int, content: bytes) -> bytes:
        return bytes((sync, len(content) + 1, *content, self._crc.crc8(content)))

    def known(self, case: Case) -> Case:
        """The case with a sync that elrs knows: three of them."""
        if case.parts["sync"] in self._telemetry.ADDRS_START:
            return case
        return replace(case, parts={**case.parts, "sync": 0xC8})

    def values(self, case: Case, frame: bytes) -> Values:
        ((sync, kind, content),) = self._telemetry.frames_from_bytes(deque(frame))
        assert (sync, kind, content) == (frame[0], frame[2], frame[HEADER:-1])
        match case.message:
            case "rc_channels":
                return {"channels": self._protocol.unpack_rc_channels(content)}
            case "battery":
                return battery(self._telemetry._DECODERS[kind](content))
            case "link_statistics":
                return link_statistics(self._telemetry._DECODERS[kind](content))
        return case.values  # it knows no more of the others

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        assert endpoint == "device"
        with suppress(IndexError):  # It takes a size of 0 for a frame, which it reads beyond.
            for sync, kind, content in self._telemetry.frames_from_bytes(deque(data)):
                yield self._around(sync, bytes((kind, *content)))


def battery(read: dict[str, float]) -> Values:
    """Raw values of what elrs reads: tenths it takes for hundredths, and a number turned around."""
    used = round(read["capacity"] * 1000)
    return {
        "voltage": signed(round(read["voltage"] * 10), 16),
        "current": signed(round(read["current"] * 100), 16),
        "capacity_used": int.from_bytes(used.to_bytes(3, "little"), "big"),
        "remaining": read["remain"],
    }


def link_statistics(read: dict[str, int]) -> Values:
    """What elrs reads, with the signs that the document has."""
    return {
        "up_rssi_1": read["rssi1_inv"],
        "up_rssi_2": read["rssi2_inv"],
        "up_link_quality": read["lq_up"],
        "up_snr": signed(read["snr_up"], 8),
        "active_antenna": read["ant"],
        "rf_profile": read["rf_mode"],
        "up_power": read["txpwr"],
        "down_rssi": read["rssi_d_inv"] % 256,
        "down_link_quality": read["lq_dn"] % 256,
        "down_snr": read["snr_dn"],
    }


def signed(number: int, bits: int) -> int:
    return number - (number >> bits - 1 << bits)


@pytest.fixture(scope="module")
def radio() -> Radio:
    return Radio()


@pytest.mark.parametrize("messages", [["rc_channels"], ["battery", "link_statistics"]])
def test_both_read_the_same_numbers(radio: Radio, messages: list[str]) -> None:
    compare_frames("crsf", radio, map(radio.known, cases_of("crsf", messages)))


def test_both_have_the_same_around_all_messages(radio: Radio) -> None:
    compare_frames("crsf", radio, map(radio.known, cases_of("crsf")))


POPUP = b"\1Bind\0Which?\0\x1e\1"
"""A pop-up with its header, its text, 30 s and a button to close it."""


def command(content: bytes) -> bytes:
    """A command for a screen, with both checksums worked out bit by bit."""
    inner = b"\x32\xea\xee\x22" + content
    inner += bytes([crc(inner, 0xBA)])
    return bytes((0xC8, len(inner) + 1, *inner, crc(inner, 0xD5)))


def crc(data: bytes, poly: int) -> int:
    found = 0
    for byte in data:
        found ^= byte
        for _ in range(8):
            found = found << 1 & 0xFF ^ (poly if found & 0x80 else 0)
    return found


def broadcast(content: bytes) -> bytes:
    """A frame for all, with its checksum worked out bit by bit."""
    return bytes((0xC8, len(content) + 1, *content, crc(content, 0xD5)))


def some_channels(first: int, layout: int, channels: list[int]) -> bytes:
    """Channels one bit at a time, each with its least significant bit first."""
    width = 10 + layout
    bits = "".join(f"{channel:0{width}b}"[::-1] for channel in channels)
    data = bytes(int(bits[at : at + 8][::-1], 2) for at in range(0, len(bits), 8))
    return broadcast(bytes((0x17, first | layout << 5)) + data)


def fields_of(module: Any, engine: str, frame: bytes) -> Values:
    (event,) = module.Decoder("device", engine).feed(frame)
    assert module.PROTOCOL.encode_line(event.as_json()) == frame
    fields: Values = event.as_json()["fields"]
    return fields


@pytest.mark.parametrize("engine", ["fast", "construct"])
@pytest.mark.parametrize("layout", range(4))
def test_some_channels_in_a_resolution_of_choice(engine: str, layout: int) -> None:
    module: Any = module_at(FOLDER / "crsf.yaml")
    random = Random(layout)
    for count in range(1 + 59 * 8 // (10 + layout)):
        first = random.randrange(32)
        channels = [random.getrandbits(10 + layout) for _ in range(count)]
        fields = fields_of(module, engine, some_channels(first, layout, channels))
        head = {"first": first, "layout": layout}
        assert fields == {"head": head, "channels": {"value": channels}}


@pytest.mark.parametrize("engine", ["fast", "construct"])
def test_channels_with_digital_switches_are_bytes(engine: str) -> None:
    module: Any = module_at(FOLDER / "crsf.yaml")
    fields = fields_of(module, engine, broadcast(b"\x17\xa4\1\2\3"))
    assert fields == {"head": {"first": 4, "layout": 5}, "channels": "010203"}


@pytest.mark.parametrize("engine", ["fast", "construct"])
@pytest.mark.parametrize(
    "content",
    [b"\x17\x20\0\0\0\0\0\x10", b"\x17\x20\0\0\0\0"],
    ids=["a bit that is left", "a byte that is left"],
)
def test_behind_some_channels_are_zeros_up_to_the_end_of_the_byte(
    engine: str, content: bytes
) -> None:
    module: Any = module_at(FOLDER / "crsf.yaml")
    (event,) = module.Decoder("device", engine).feed(broadcast(content))
    assert event.as_json()["event"] == "unknown"


@pytest.mark.parametrize("engine", ["fast", "construct"])
@pytest.mark.parametrize(
    ("content", "selection", "choices"),
    [
        (b"", None, None),
        (b"\0", {"first": 0, "number": None}, None),
        (b"\0yes;no\0", {"first": 0, "number": None}, "yes;no"),
        (
            b"Gain\0\5\0\x0a\3dB\0\0",
            {
                "first": ord("G"),
                "number": {
                    "text": "ain",
                    "value": 5,
                    "least": 0,
                    "greatest": 10,
                    "default": 3,
                    "unit": "dB",
                },
            },
            "",
        ),
    ],
    ids=["absent", "empty", "choices", "number"],
)
def test_what_a_pop_up_lets_choose(
    engine: str, content: bytes, selection: Values | None, choices: str | None
) -> None:
    module: Any = module_at(FOLDER / "crsf.yaml")
    frame = command(POPUP + content)
    (event,) = module.Decoder("device", engine).feed(frame)
    assert event.as_json()["fields"]["value"] == {
        "header": "Bind",
        "text": "Which?",
        "timeout": 30,
        "close_button": True,
        "selection": selection,
        "choices": choices,
    }
    assert module.PROTOCOL.encode_line(event.as_json()) == frame


@pytest.mark.parametrize("engine", ["fast", "construct"])
@pytest.mark.parametrize("content", [POPUP + b"\0yes;no\0", b"\2\1\1"], ids=["pop-up", "answer"])
def test_what_a_newer_device_adds_is_left(engine: str, content: bytes) -> None:
    module: Any = module_at(FOLDER / "crsf.yaml")
    (known,) = module.Decoder("device", engine).feed(command(content))
    (event,) = module.Decoder("device", engine).feed(command(content + b"\7new"))
    assert (event.message, event.payload) == (known.message, content)


def test_no_frame_is_lost_that_it_finds(radio: Radio) -> None:
    # It knows three of the messages.
    compare_recovery("crsf", "device", radio, cases_of("crsf"), share=0.1)
