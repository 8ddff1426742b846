"""KISS, beside pyham-kiss."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, engine_of, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "pyham_kiss"
"""Its package is called kiss."""
FEND = b"\xc0"
COMMANDS: dict[str, Callable[[Any, Values, int], None]] = {
    "data": lambda tnc, v, port: tnc.send_data(bytes.fromhex(v["packet"]), port),
    "tx_delay": lambda tnc, v, port: tnc.set_tx_delay(v["delay"], port),
    "persistence": lambda tnc, v, port: tnc.set_persistence(v["p"], port),
    "slot_time": lambda tnc, v, port: tnc.set_slot_time(v["slot"], port),
    "tx_tail": lambda tnc, v, port: tnc.set_tx_tail(v["tail"], port),
    "full_duplex": lambda tnc, v, port: tnc.set_full_duplex(bool(v["duplex"]), port),
    "set_hardware": lambda tnc, v, port: tnc.set_hardware(bytes.fromhex(v["setting"]), port),
    "exit": lambda tnc, v, port: tnc.send_return(),
}


class Socket:
    """A connection as it has one, with what is there to read and what was written."""

    def __init__(self, data: bytes = b"") -> None:
        self.data = data
        self.written = b""

    def send(self, frame: bytearray) -> None:
        self.written = bytes(frame)

    def recv(self, size: int) -> bytes:
        piece, self.data = self.data, b""
        return piece


class PyhamKiss:
    """The client of pyham-kiss: it sends commands, and reads data."""

    def __init__(self) -> None:
        self._module: Any = peer_module("kiss")

    def frame(self, case: Case) -> bytes:
        client = self._module.Connection(None)
        client._sock = Socket()
        COMMANDS[case.message](client, case.values, case.parts.get("port", 0))
        frame: bytes = client._sock.written
        return frame

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message != "data":
            return case.values  # it reads no command
        (packet,) = self._read(frame)
        return {"packet": packet.hex()}

    def _read(self, data: bytes) -> list[bytes]:
        packets: list[bytes] = []
        client = self._module.Connection(lambda port, packet: packets.append(bytes(packet)))
        client._sock = Socket(data)
        client._receive_data()
        return packets

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What it takes for data between two FEND."""
        for piece in data.split(FEND):
            frame = FEND + piece + FEND
            try:
                packets = self._read(frame)
            except TypeError:  # Its exception is none.
                continue
            if packets:
                yield frame


@pytest.fixture(scope="module")
def pyham_kiss() -> PyhamKiss:
    return PyhamKiss()


def drawn() -> list[Case]:
    """Cases that it can send: half or full duplex, and not data of port 12: see the decision."""
    cases = [
        case for case in cases_of("kiss") if case.message != "data" or case.parts["port"] != 12
    ]
    return [
        replace(case, values={"duplex": case.values["duplex"] % 2})
        if case.message == "full_duplex"
        else case
        for case in cases
    ]


def test_both_make_and_read_the_same_frames(pyham_kiss: PyhamKiss) -> None:
    cases = drawn()
    assert {case.parts["port"] for case in cases if case.message == "data"} > {0, 11, 13, 15}
    compare_frames("kiss", pyham_kiss, cases)


@pytest.mark.parametrize("endpoint", ["host", "tnc"])
def test_no_frame_is_lost_that_it_finds(pyham_kiss: PyhamKiss, endpoint: str) -> None:
    # Of what a host sends, it reads data and no settings.
    share = 0.09 if endpoint == "host" else 0.9
    compare_recovery("kiss", endpoint, pyham_kiss, cases_of("kiss"), shared=FEND, share=share)


def test_data_of_port_12_are_told_by_an_escape() -> None:
    engine = engine_of("kiss")
    frame = engine.frame("host", "data", {"packet": "41"}, {"port": 12})
    assert frame.hex(" ") == "c0 db dc 41 c0"


def test_frames_may_share_a_delimiter() -> None:
    stream = bytes.fromhex("C0 C0 C0 00 41 C0 10 42 C0 C0 20 43 C0")
    events = list(engine_of("kiss").events("tnc", [stream]))
    assert [event.values["packet"] for event in events if event.kind == "message"] == [
        "41",
        "42",
        "43",
    ]
