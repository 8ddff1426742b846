"""S.BUS, beside rfrx, and rpycrsf for channels."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

SIZE = 25
STATE = 23
"""Where the byte of the state is in a frame."""


class Reader:
    """The decoder of rfrx, which takes whole frames."""

    def __init__(self) -> None:
        self._module: Any = peer_module("rfrx.sbus")
        self._pack: Any = peer_module("rpycrsf.protocol").pack_rc_channels

    def frame(self, case: Case) -> bytes:
        channels = self._pack(case.values["channels"])[3:-1]
        return bytes((0x0F, *channels, case.values["state"], 0))

    def values(self, case: Case, frame: bytes) -> Values:
        """It counts the bits of the state from the highest one, so that it gets them reversed."""
        turned = bytearray(frame)
        turned[STATE] = int(f"{frame[STATE]:08b}"[::-1], 2)
        read = self._module.SbusDecoder(bytes(turned), 16)
        bits = (read.ch17, read.ch18, read.frame_lost, read.failsafe)
        state = sum(1 << number for number, bit in enumerate(bits) if bit)
        return {"channels": read.chans, "state": state | frame[STATE] & 0xF0}  # the rest it skips

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """Its reader begins behind a silence. Without those, it tries at each byte."""
        assert endpoint == "receiver"
        at = 0
        while at < len(data):
            piece = data[at : at + SIZE]
            try:
                self._module.SbusDecoder(piece, 16)
            except self._module.SbusError:
                at += 1
            else:
                yield piece
                at += SIZE


@pytest.fixture(scope="module")
def reader() -> Reader:
    return Reader()


def test_both_make_and_read_the_same_channels(reader: Reader) -> None:
    compare_frames("sbus", reader, cases_of("sbus"))


def test_no_frame_is_lost_that_it_finds(reader: Reader) -> None:
    compare_recovery("sbus", "receiver", reader, cases_of("sbus"))
