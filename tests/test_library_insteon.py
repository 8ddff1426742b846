"""Insteon modems, beside pyinsteon."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

COMMANDS = {
    "read_info": 0x60,
    "send_to_group": 0x61,
    "send": 0x62,
    "send_x10": 0x63,
    "start_linking": 0x64,
    "cancel_linking": 0x65,
    "set_category": 0x66,
    "reset": 0x67,
    "set_ack_byte": 0x68,
    "read_first_link": 0x69,
    "read_next_link": 0x6A,
    "set_configuration": 0x6B,
    "read_link_of_sender": 0x6C,
    "led_on": 0x6D,
    "led_off": 0x6E,
    "manage_link": 0x6F,
    "set_nak_byte": 0x70,
    "set_ack_bytes": 0x71,
    "sleep": 0x72,
    "read_configuration": 0x73,
    "read_database": 0x75,
    "write_database": 0x76,
}
MESSAGES = {
    "received": 0x50,
    "received_extended": 0x51,
    "received_x10": 0x52,
    "linked": 0x53,
    "button": 0x54,
    "was_reset": 0x55,
    "cleanup_failed": 0x56,
    "link": 0x57,
    "cleanup_status": 0x58,
    "database_record": 0x59,
    "info": 0x60,
    "group_sent": 0x61,
    "sent": 0x62,
    "x10_sent": 0x63,
    "linking_started": 0x64,
    "linking_cancelled": 0x65,
    "category_set": 0x66,
    "reset_done": 0x67,
    "ack_byte_set": 0x68,
    "first_link_found": 0x69,
    "next_link_found": 0x6A,
    "configuration_set": 0x6B,
    "link_of_sender_found": 0x6C,
    "led_switched_on": 0x6D,
    "led_switched_off": 0x6E,
    "link_managed": 0x6F,
    "nak_byte_set": 0x70,
    "ack_bytes_set": 0x71,
    "asleep": 0x72,
    "configuration": 0x73,
    "database_read": 0x75,
    "database_written": 0x76,
}
"""What it knows: all but six newer commands."""
SIZES = {"from": 3, "to": 3, "device": 3, "modem": 3, "place": 2}
"""Bytes of numbers; all others have one."""
EXTENDED = 0x10
"""The flag of messages that have data."""
NAK = 0x15
KNOWN = {
    "category": [*range(0x14), 0x15, 0x16, 0xFF],
    "mode": [0, 1, 3, 0xFF],
    "event": [0x02, 0x03, 0x04, 0x12, 0x13, 0x14, 0x22, 0x23, 0x24],
    "action": [0x00, 0x01, 0x20, 0x40, 0x41, 0x80],
    "kind": [0x00, 0x80],
}
"""Values of which it takes no others."""


class Insteon:
    """Its messages, which neither are sent nor handled."""

    def __init__(self) -> None:
        self._inbound: Any = peer_module("pyinsteon.protocol.messages.inbound")
        self._outbound: Any = peer_module("pyinsteon.protocol.messages.outbound")
        self._definitions: Any = peer_module("pyinsteon.protocol.messages.message_definitions")

    def frame(self, case: Case) -> bytes:
        definition = self._definition(case)
        content = payload(case.values)
        values, at = {}, 0
        for name, size, kind in definition.fields:
            piece = content[at : at + size]
            values[name] = kind(piece[0] if size == 1 else piece)
            at += size
        assert at == len(content)
        return bytes(self._outbound.Outbound(definition, **values))

    def _definition(self, case: Case) -> Any:
        definitions = self._definitions
        if case.message == "send" and case.values["flags"] & EXTENDED:
            return definitions.MessageDefinition(COMMANDS["send"], definitions.FLD_EXT_SEND)
        if case.message == "sent" and case.values["flags"] & EXTENDED:
            return definitions.MessageDefinition(MESSAGES["sent"], definitions.FLD_EXT_SEND_ACK)
        if case.message in COMMANDS:
            return definitions.OUTBOUND_MSG_DEF[COMMANDS[case.message]]
        return definitions.INBOUND_MSG_DEF[MESSAGES[case.message]]

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message in COMMANDS:
            return case.values  # it reads no command
        message, rest = self._inbound.create(bytearray(frame))
        assert (message.message_id, rest) == (MESSAGES[case.message], b"")
        return taken(case.values, bytes(message)[2:])

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        rest = data
        while rest:
            try:
                message, left = self._inbound.create(bytearray(rest))
            except ValueError:
                message, left = None, rest[1:]
            if len(left) == len(rest):
                return
            if message is not None:
                yield bytes(message)
            rest = bytes(left)


def payload(values: Values) -> bytes:
    content = b""
    for name, value in values.items():
        if isinstance(value, str):
            content += bytes.fromhex(value)
        elif isinstance(value, list):
            content += bytes(value)
        elif value is not None:
            content += value.to_bytes(SIZES.get(name, 1), "big")
    return content


def taken(values: Values, content: bytes) -> Values:
    """The values of a payload that has the sizes of others."""
    found: Values = {}
    for name, value in values.items():
        size = len(payload({name: value}))
        piece, content = content[:size], content[size:]
        if value is None:
            found[name] = None
        elif isinstance(value, str):
            found[name] = piece.hex()
        else:
            found[name] = list(piece) if isinstance(value, list) else int.from_bytes(piece, "big")
    assert content == b""
    return found


@pytest.fixture(scope="module")
def insteon() -> Insteon:
    return Insteon()


def as_known(case: Case) -> Case:
    """The case, with values that it knows, and an address that it does not take for a NAK."""
    values = dict(case.values)
    for name, known in KNOWN.items():
        if name in values:
            values[name] = known[values[name] % len(known)]
    if case.message in ("set_configuration", "configuration_set", "configuration"):
        values["flags"] &= 0xF0
    if case.message == "info" and values["modem"] >> 16 == NAK:
        values["modem"] = 0
    return replace(case, values=values)


def drawn(messages: dict[str, int]) -> list[Case]:
    return [as_known(case) for case in cases_of("insteon", messages)]


def test_both_make_the_same_commands(insteon: Insteon) -> None:
    compare_frames("insteon", insteon, drawn(COMMANDS))


def test_both_make_and_read_the_same_messages_of_a_modem(insteon: Insteon) -> None:
    compare_frames("insteon", insteon, drawn(MESSAGES))


def test_no_frame_is_lost_that_it_finds(insteon: Insteon) -> None:
    compare_recovery("insteon", "modem", insteon, drawn(MESSAGES))
