"""Velbus, beside velbus-aio."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "velbus_aio"
SIZE = 14
"""The most bytes of a packet."""


class Velbus:
    """Its raw messages."""

    def __init__(self) -> None:
        self._module: Any = peer_module("velbusaio.raw_message")

    def frame(self, case: Case) -> bytes:
        is_request = case.message == "request_type"
        data = b""
        if not is_request:
            data = bytes((case.values["command"],)) + bytes.fromhex(case.values["data"])
        parts = case.parts["priority"], case.parts["address"]
        return bytes(self._module.RawMessage(*parts, is_request, data).to_bytes())

    def values(self, case: Case, frame: bytes) -> Values:
        message, rest = self._module.create(bytearray(frame))
        assert rest == b""
        assert (message.priority, message.address) == (
            case.parts["priority"],
            case.parts["address"],
        )
        assert message.rtr == (case.message == "request_type")
        if message.rtr:
            assert message.command is None
            return {}
        return {"command": message.command, "data": (message.data_only or b"").hex()}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        at = 0
        while at < len(data):
            piece = data[at : at + SIZE]
            message, rest = self._module.create(bytearray(piece))
            at += len(piece) - len(rest)
            if message is not None:
                yield data[at - len(message.to_bytes()) : at]
            elif len(rest) == len(piece):
                at += 1  # It would wait for more than the most bytes.


@pytest.fixture(scope="module")
def velbus() -> Velbus:
    return Velbus()


def test_both_make_and_read_the_same_packets(velbus: Velbus) -> None:
    compare_frames("velbus", velbus, cases_of("velbus"))


def test_no_packet_is_lost_that_it_finds(velbus: Velbus) -> None:
    compare_recovery("velbus", "node", velbus, cases_of("velbus"))
