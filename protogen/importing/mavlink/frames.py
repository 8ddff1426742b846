"""The frames of MAVLink, as a schema has them."""

from __future__ import annotations

from enum import StrEnum
from typing import Any

from protogen.importing.mavlink.crc_extra import wire_order
from protogen.importing.mavlink.spec import FieldSpec, Message
from protogen.importing.schema_text import Number

LARGEST_PAYLOAD = 255
ENDPOINT = "component"
_DECISION = "start_in_data"
_PAYLOAD = {"doc": "Fields of the message, the largest ones first"}


class Wire(StrEnum):
    """Versions of the protocol."""

    V1 = "1"
    V2 = "2"

    @property
    def largest_id(self) -> int:
        """The greatest id that a frame can have."""
        return 0xFF if self is Wire.V1 else 0xFFFFFF

    def fields(self, message: Message) -> list[FieldSpec]:
        """Return the fields that a frame has, in wire order; version 1 has no extensions."""
        fields = wire_order(message)
        if self is Wire.V1:
            return [field for field in fields if not field.is_extension]
        return fields


def protocol_data(wire: Wire) -> dict[str, Any]:
    """Return what a schema says beside its messages: who speaks, and in which frames."""
    endpoint = {
        "title": "Component of a system",
        "doc": "An autopilot, a camera, a ground station: each sends and takes all messages.",
    }
    return {
        "endpoints": {ENDPOINT: endpoint},
        "byte_order": "little",
        "frame": _head(wire) | _tail(),
    }


def decisions() -> dict[str, Any]:
    """Return what is decided about frames."""
    return {
        _DECISION: {
            "question": "What if data hold the byte that starts a frame?",
            "document": "It says nothing; the byte is not escaped.",
            "choice": "A start is believed if length and checksum agree.",
            "because": "Receivers do so.",
        }
    }


def message_data(crc_extra: int) -> dict[str, Any]:
    """Return what a message says about its frame."""
    return {}


def _head(wire: Wire) -> dict[str, Any]:
    start = {"unprotected": _DECISION, "doc": f"Begins a frame of MAVLink {wire}"}
    length = {"type": "uint8", "counts": "payload", "doc": "Number of bytes of the payload"}
    sender = {
        "seq": {"type": "uint8", "counter": True, "doc": "Counts the frames of the sender"},
        "sysid": {"type": "uint8", "default": 1, "doc": "System that sends it"},
        "compid": {"type": "uint8", "default": 1, "doc": "Component of it; 1 is an autopilot"},
    }
    if wire is Wire.V1:
        return {
            "magic": {"literal": _hex(0xFE), **start},
            "len": length,
            **sender,
            "msgid": {"type": "uint8", "id": True, "doc": "Which message it is"},
        }
    return {
        "magic": {"literal": _hex(0xFD), **start},
        "len": length,
        "incompat_flags": {"literal": 0, "doc": "What a receiver has to understand: nothing"},
        "compat_flags": {"type": "uint8", "default": 0, "doc": "What it may pass over"},
        **sender,
        "msgid": {"type": "uint24", "id": True, "doc": "Which message it is"},
    }


def _tail() -> dict[str, Any]:
    return {
        "payload": _PAYLOAD,
        "checksum": {"type": "uint16", "algorithm": "CRC-16/MCRF4XX", "covers": "len..payload"},
    }


def _hex(number: int) -> Any:
    return Number(f"0x{number:02X}")
