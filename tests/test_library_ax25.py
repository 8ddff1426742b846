"""AX.25 in KISS, beside pyham-ax25 in pyham-kiss."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

import pytest
from compiled import protocol_of
from library_support import cases_of, compare_frames, compare_recovery, engine_of, peer_module
from test_library_kiss import FEND, PyhamKiss

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

PEER = "pyham_ax25"
AX25 = FOLDER / "ax25.yaml"
UNNUMBERED = (0x03, 0x0F, 0x2F, 0x43, 0x63, 0x6F, 0x87, 0xAF, 0xE3)
SUPERVISORY = (0x01, 0x05, 0x09, 0x0D)
WITH_INFORMATION = (0x03, 0x87, 0xAF, 0xE3)
"""Unnumbered frames that have some: UI, FRMR, XID and TEST."""
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
RESERVED = 0x60


class PyhamAx25(PyhamKiss):
    """Packets of pyham-ax25, in frames of pyham-kiss."""

    def __init__(self) -> None:
        super().__init__()
        self._ax25: Any = peer_module("ax25")

    def frame(self, case: Case) -> bytes:
        if case.message != "data":
            return super().frame(case)
        packet = self._packet(case.values).hex()
        return super().frame(replace(case, values={"packet": packet}))

    def _packet(self, values: Values) -> bytes:
        destination, source, *repeaters = (
            self._address(item, is_repeater=index > 1) for index, item in enumerate(values["path"])
        )
        data = None if values["info"] is None else bytes.fromhex(values["info"])
        control = self._ax25.Control.unpack(values["control"])
        pid = values["pid"] or 0
        made = self._ax25.Frame(destination, source, repeaters, control, pid, data)
        packet: bytes = made.pack()
        return packet

    def _address(self, values: Values, *, is_repeater: bool) -> Any:
        station, mark = (values["ssid"] >> 1) & 0xF, bool(values["ssid"] >> 7)
        address = self._ax25.Address(values["call"], station, repeater=is_repeater)
        if is_repeater:
            address.has_been_repeated = mark
        else:
            address.command_response = mark
        return address

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message != "data":
            return case.values  # It reads no command.
        (packet,) = self._read(frame)
        return self._values(packet)

    def _values(self, packet: bytes) -> Values:
        found = self._ax25.Frame.unpack(packet)
        path = [found.dst, found.src, *(found.via or ())]
        kind = found.control.frame_type
        has_pid = kind.is_I() or kind is self._ax25.FrameType.UI
        return {
            "path": [self._shown(item, is_last=item is path[-1]) for item in path],
            "control": found.control.pack(),
            "pid": found.pid if has_pid else None,
            "info": None if found.data is None else found.data.hex(),
        }

    def _shown(self, address: Any, *, is_last: bool) -> Values:
        mark = address.has_been_repeated if address.repeater else address.command_response
        ssid = mark << 7 | RESERVED | address.ssid << 1 | is_last
        return {"call": address.call, "ssid": ssid}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What it takes for packets between two FEND."""
        for frame in super().found(endpoint, data):
            (packet,) = self._read(frame)
            try:
                self._values(packet)
            except (ValueError, IndexError):
                continue
            yield frame


@pytest.fixture(scope="module")
def pyham_ax25() -> PyhamAx25:
    return PyhamAx25()


def drawn() -> list[Case]:
    """Packets that it can make, but not from port 12: see the decision of `kiss`."""
    dice = Random("ax25")
    cases = [case for case in cases_of("ax25", ["data"]) if case.parts["port"] != 12]
    return [replace(case, values=as_heard(case.values, dice)) for case in cases]


def as_heard(values: Values, dice: Random) -> Values:
    """The values with calls of stations, and a control field of a frame that there is."""
    control = values["control"]
    if control & 3 == 1:
        control = control & 0xF0 | dice.choice(SUPERVISORY)
    elif control & 1:
        control = control & 0x10 | dice.choice(UNNUMBERED)
    has_pid = not control & 1 or control & ~0x10 == 0x03
    has_info = not control & 1 or control & ~0x10 in WITH_INFORMATION
    size = dice.choice((0, 1, 255, 256, dice.randrange(257)))
    info = values["info"] or dice.randbytes(size).hex()
    return {
        "path": [_address_as_heard(item, dice) for item in values["path"]],
        "control": control,
        "pid": (values["pid"] or dice.randrange(256)) if has_pid else None,
        "info": info[:512] if has_info else None,
    }


def _address_as_heard(values: Values, dice: Random) -> Values:
    call = "".join(dice.choice(LETTERS) for _ in range(dice.randrange(2, 7)))
    return {"call": call, "ssid": values["ssid"] | RESERVED}


def test_both_make_and_read_the_same_packets(pyham_ax25: PyhamAx25) -> None:
    cases = drawn()
    assert {len(case.values["path"]) for case in cases} >= {2, 3, 10}
    assert {case.sender for case in cases} == {"host", "tnc"}
    kinds = {case.values["control"] & ~0x10 for case in cases}
    assert kinds >= {*UNNUMBERED}
    assert {kind & 0x0F for kind in kinds} >= {0x00, 0x0E, *SUPERVISORY}
    compare_frames("ax25", pyham_ax25, cases)


def test_unnumbered_frames_have_the_names_that_it_has() -> None:
    (message,) = (it for it in protocol_of(AX25).messages if it.name == "data")
    control = next(field.integer for field in message.fields if field.name == "control")
    assert control is not None
    enum = next(run.enum for run in control.bit_fields if run.name == "unnumbered")
    assert enum is not None
    kinds = peer_module("ax25").FrameType
    assert {item.value: item.name.upper() for item in enum.values} == {
        kind: kinds(kind).name for kind in UNNUMBERED
    }


def test_a_character_that_is_not_shifted_is_no_packet() -> None:
    frame = bytes.fromhex("C0 00 83 84 86 88 8A 8C 60 82 84 86 88 8A 8C 61 2F C0")
    (event,) = (event for event in engine_of("ax25").events("tnc", [frame], {}) if event.size > 1)
    assert event.kind == "invalid"


def test_the_commands_are_those_of_kiss(pyham_ax25: PyhamAx25) -> None:
    commands = ["tx_delay", "persistence", "slot_time", "tx_tail", "set_hardware", "exit"]
    compare_frames("ax25", pyham_ax25, cases_of("ax25", commands))


@pytest.mark.parametrize("endpoint", ["host", "tnc"])
def test_no_packet_is_lost_that_it_finds(pyham_ax25: PyhamAx25, endpoint: str) -> None:
    compare_recovery("ax25", endpoint, pyham_ax25, drawn(), shared=FEND)


def test_a_path_without_an_end_is_no_packet() -> None:
    address = "82 84 86 88 8A 8C 60"
    frame = bytes.fromhex(f"C0 00 {address} {address} 03 F0 41 C0")
    (event,) = (event for event in engine_of("ax25").events("tnc", [frame], {}) if event.size > 1)
    assert event.kind == "invalid"


def test_information_where_there_is_none_is_no_packet() -> None:
    path = "82 84 86 88 8A 8C 60 82 84 86 88 8A 8C 61"
    frames = [bytes.fromhex(f"C0 00 {path} {rest} C0") for rest in ("01", "01 41")]
    kinds = [next(iter(engine_of("ax25").events("tnc", [frame], {}))).kind for frame in frames]
    assert kinds == ["message", "invalid"]
