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
_EXTRA = "extra"
_LENGTH = {"type": "uint8", "counts": "payload", "doc": "Number of bytes of the payload"}
_SENDER = {
    "seq": {"type": "uint8", "counter": True, "doc": "Counts the frames of the sender"},
    "sysid": {"type": "uint8", "default": 1, "doc": "System that sends it"},
    "compid": {"type": "uint8", "default": 1, "doc": "Component of it; 1 is an autopilot"},
}


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
    data: dict[str, Any] = {"endpoints": {ENDPOINT: endpoint}, "byte_order": "little"}
    if wire is Wire.V1:
        return data | {"frame": _head_1() | _tail({})}
    payload = {"trailing_zeros": "trimmed", "longer": "cut"}
    unsigned = _head_2("0x00", "Nothing that a receiver has to understand") | _tail(payload)
    signed = _head_2("0x01", "The frame is signed") | _tail(payload) | _signature()
    forms = {
        "unsigned": {"doc": "Without a signature.", "frame": unsigned},
        "signed": {"doc": "With a signature, which receivers check by a key.", "frame": signed},
    }
    return data | {"forms": forms}


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


def message_data(extra: int) -> dict[str, Any]:
    """Return what a message says about its frame: the CRC_EXTRA."""
    return {"parts": {_EXTRA: extra}}


def _head_1() -> dict[str, Any]:
    return {
        "magic": _magic("0xFE", Wire.V1),
        "len": _LENGTH,
        **_SENDER,
        "msgid": {"type": "uint8", "id": True, "doc": "Which message it is"},
    }


def _head_2(incompat: str, doc: str) -> dict[str, Any]:
    return {
        "magic": _magic("0xFD", Wire.V2),
        "len": _LENGTH,
        "incompat_flags": {"literal": Number(incompat), "doc": doc},
        "compat_flags": {"type": "uint8", "default": 0, "doc": "What a receiver may pass over"},
        **_SENDER,
        "msgid": {"type": "uint24", "id": True, "doc": "Which message it is"},
    }


def _magic(byte: str, wire: Wire) -> dict[str, Any]:
    doc = f"Begins a frame of MAVLink {wire}"
    return {"literal": Number(byte), "unprotected": _DECISION, "doc": doc}


def _tail(payload: dict[str, Any]) -> dict[str, Any]:
    extra = "CRC_EXTRA: whether both sides have the same definition of the message"
    return {
        "payload": payload | {"doc": "Fields of the message, the largest ones first"},
        _EXTRA: {"type": "uint8", "virtual": True, "doc": extra},
        "checksum": {
            "type": "uint16",
            "algorithm": "CRC-16/MCRF4XX",
            "covers": f"len..{_EXTRA}",
            "doc": "Of all bytes behind the first one, and CRC_EXTRA",
        },
    }


def _signature() -> dict[str, Any]:
    return {
        "link_id": {"type": "uint8", "doc": "Link on which it is sent"},
        "timestamp": {
            "type": "uint48",
            "doc": "Since 1 January 2015, in 10 us; greater in each frame",
        },
        "signature": {
            "type": "uint48",
            "byte_order": "big",
            "doc": "First bytes of the SHA-256 of the key and all in front of it",
        },
    }
