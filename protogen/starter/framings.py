"""The kinds of frames that a starter schema can have, and what each changes in the messages."""

from __future__ import annotations

from enum import StrEnum

import msgspec


class Framing(StrEnum):
    """Ways for a receiver to find a frame."""

    COBS = "cobs"
    SLIP = "slip"
    HDLC = "hdlc"
    ESCAPED = "escaped"
    LENGTH = "length"
    SEVEN_BIT = "seven-bit"
    HEX_LINES = "hex-lines"

    @property
    def summary(self) -> str:
        """Say in a few words what it is."""
        return _SUMMARIES[self]


_SUMMARIES = {
    Framing.COBS: "a zero ends each frame, COBS keeps zeros out of it; CRC-16",
    Framing.SLIP: "RFC 1055: C0 around each frame, bytes escaped with DB; CRC-16",
    Framing.HDLC: "RFC 1662: 7E around each frame, bytes escaped with 7D; CRC-16",
    Framing.ESCAPED: "start byte, length, checksum; an escape keeps the start byte unique",
    Framing.LENGTH: "sync bytes, length, CRC-16, and nothing escaped, as UBX and MAVLink have it",
    Framing.SEVEN_BIT: "start bytes have their highest bit set, data bytes have not, as in MIDI",
    Framing.HEX_LINES: "lines of text: a colon, hex digits, a checksum, CR LF",
}


class Numbers(msgspec.Struct, frozen=True):
    """Look of numbers on the wire of a framing."""

    small: str
    unsigned: str
    signed: str
    missing: str
    """The raw value of a temperature that was not measured."""
    identities: tuple[str, str, str]


WHOLE_BYTES = Numbers("uint8", "uint16", "sint16", "0x7FFF", ("0x01", "0x02", "0x81"))
SEVEN_BITS = Numbers("uint7", "uint14", "sint14", "0x1FFF", ("0x80", "0x81", "0x90"))


class Bytes(msgspec.Struct, frozen=True):
    """The frames of the examples, as a schema has them."""

    set_mode: str
    report: str


def numbers_of(framing: Framing) -> Numbers:
    """Return what numbers look like."""
    return SEVEN_BITS if framing is Framing.SEVEN_BIT else WHOLE_BYTES


def bytes_of(framing: Framing) -> Bytes:
    """Return the frames of the examples."""
    return _BYTES[framing]


_BYTES = {
    Framing.COBS: Bytes(
        "{hex: 04 02 01 64 03 9F 61 00}",
        "{hex: 05 81 01 66 08 01 02 55 04 88 13 7E 03 A7 88 00}",
    ),
    Framing.SLIP: Bytes(
        "{hex: C0 02 01 64 00 9F 61 C0}",
        "{hex: C0 81 01 66 08 00 00 55 00 88 13 7E 00 A7 88 C0}",
    ),
    Framing.HDLC: Bytes(
        "{hex: 7E 02 01 64 00 41 9D 7E}",
        "{hex: 7E 81 01 66 08 00 00 55 00 88 13 7D 5E 00 79 E8 7E}",
    ),
    Framing.ESCAPED: Bytes(
        "{hex: 55 04 02 01 64 00 95}",
        "{hex: 55 0C 81 01 66 08 00 00 56 75 00 88 13 7E 00 96}",
    ),
    Framing.LENGTH: Bytes(
        "{hex: B5 62 02 03 00 01 64 00 5C 9B}",
        "{hex: B5 62 81 0B 00 01 66 08 00 00 55 00 88 13 7E 00 9F D2}",
    ),
    Framing.SEVEN_BIT: Bytes(
        "{hex: 81 01 64 00}",
        "{hex: 90 01 66 10 00 00 55 00 08 27 7E 00}",
    ),
    Framing.HEX_LINES: Bytes(
        '{text: ":0201640099\\r\\n"}',
        '{text: ":810166080000550088137E00A2\\r\\n"}',
    ),
}
