"""FlySky's iBus, beside flyskyibus."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "flyskyibus"
SIZE = 32
"""Bytes of a frame."""


class Port:
    """A serial port as it has one, with what is there to read and what was written."""

    def __init__(self, data: bytes = b"") -> None:
        self._data = data
        self.at = 0
        self.written = b""

    def read(self, size: int) -> bytes:
        piece = self._data[self.at : self.at + size]
        self.at += size
        if len(piece) < size:
            raise EOFError
        return piece

    def write(self, data: bytes) -> None:
        self.written = data


class FlySky:
    """Its receiver, of which the port is not opened."""

    def __init__(self) -> None:
        module: Any = peer_module("flySkyiBus.IBus")
        self._receiver = module.IBus.__new__(module.IBus)

    def frame(self, case: Case) -> bytes:
        self._receiver.serial = port = Port()
        self._receiver.write(list(case.values["slots"]))
        return port.written

    def values(self, case: Case, frame: bytes) -> Values:
        self._receiver.serial = Port(frame)
        return {"slots": list(self._receiver.read()[2:-1])}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        self._receiver.serial = port = Port(data)
        while True:
            try:
                self._receiver.read()
            except EOFError:
                return
            yield data[port.at - SIZE : port.at]


@pytest.fixture(scope="module")
def flysky() -> FlySky:
    return FlySky()


def test_both_make_and_read_the_same_frames(flysky: FlySky) -> None:
    compare_frames("ibus", flysky, cases_of("ibus"))


def test_no_frame_is_lost_that_it_finds(flysky: FlySky) -> None:
    compare_recovery("ibus", "receiver", flysky, cases_of("ibus"))
