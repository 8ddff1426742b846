"""Sonars of Blue Robotics, beside bluerobotics-ping."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from compiled import protocol_of
from library_support import cases_of, compare_frames, compare_recovery, endpoint_of, peer_module

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

PEER = "bluerobotics_ping"
ACK = 1
TEXTS = ("nack_message", "ascii_message")
VECTORS = ("profile_data", "data")


class Ping:
    """Its messages and its parser."""

    def __init__(self) -> None:
        self._module: Any = peer_module("brping.pingmessage")
        known = peer_module("brping.definitions")
        self._known = known.payload_dict_common | known.payload_dict_ping1d
        self._known |= known.payload_dict_ping360

    def frame(self, case: Case) -> bytes:
        message = self._message(case)
        message.src_device_id = case.parts["source"]
        message.dst_device_id = case.parts["destination"]
        assert set(message.payload_field_names) == set(case.values)
        for name, value in case.values.items():
            if name in TEXTS:
                setattr(message, name, value.encode("latin-1"))
            else:
                setattr(message, name, bytes(value) if name in VECTORS else value)
        return bytes(message.pack_msg_data())

    def _message(self, case: Case) -> Any:
        kind = self._module.PingMessage
        if not set(TEXTS) & set(case.values):
            return kind(number(case), payload_dict=self._known)
        message = kind(ACK, payload_dict=self._known)  # it fails to begin one with a text
        message.message_id = number(case)
        message.payload_field_names = message.payload_dict[message.message_id]["field_names"]
        return message

    def values(self, case: Case, frame: bytes) -> Values:
        (message,) = self._read(frame)
        assert (message.message_id, message.name) == (number(case), name_of(case))
        assert message.src_device_id == case.parts["source"]
        assert message.dst_device_id == case.parts["destination"]
        return {name: as_json(name, getattr(message, name, b"")) for name in case.values}

    def _read(self, data: bytes) -> list[Any]:
        parser = self._module.PingParser(self._known)
        messages = []
        for byte in data:
            try:
                if parser.parse_byte(byte) == parser.NEW_MESSAGE:
                    messages.append(parser.rx_msg)
            except (KeyError, AttributeError):  # it does not know the message
                parser.state = parser.WAIT_START
        return messages

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        for message in self._read(data):
            yield bytes(message.msg_data)


def number(case: Case) -> int:
    """The number of the message of a case."""
    protocol = protocol_of(FOLDER / "ping.yaml")
    (identity,) = next(each.identity for each in protocol.messages if each.name == case.message)
    return int(identity)


def name_of(case: Case) -> str:
    """Its name of the message, which is not unique there."""
    return case.message.removeprefix("ping1d_").removeprefix("ping360_")


def as_json(name: str, value: Any) -> Any:
    if name in TEXTS:
        return bytes(value or b"").decode("latin-1")
    return list(value) if name in VECTORS else value


@pytest.fixture(scope="module")
def ping() -> Ping:
    return Ping()


def sent_by(endpoint: str) -> list[Case]:
    messages = protocol_of(FOLDER / "ping.yaml").messages
    drawn = cases_of("ping", [each.name for each in messages if endpoint in each.senders])
    return [case for case in drawn if endpoint_of("ping", case) == endpoint and is_made(case)]


def is_made(case: Case) -> bool:
    """False for a text or data of no byte, which it fails to pack."""
    return all(case.values[name] for name in (*TEXTS, *VECTORS) if name in case.values)


@pytest.mark.parametrize("endpoint", ["host", "device"])
def test_both_make_and_read_the_same_frames(ping: Ping, endpoint: str) -> None:
    compare_frames("ping", ping, sent_by(endpoint))


@pytest.mark.parametrize("endpoint", ["host", "device"])
def test_no_frame_is_lost_that_it_finds(ping: Ping, endpoint: str) -> None:
    compare_recovery("ping", endpoint, ping, sent_by(endpoint))
