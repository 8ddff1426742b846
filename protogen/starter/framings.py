"""The kinds of frames that a starter schema can have, and what each changes in the messages."""

from __future__ import annotations

from enum import StrEnum

import msgspec


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


class Framing(StrEnum):
    """Ways for a receiver to find a frame."""

    summary: str
    """The way in a few words."""
    set_mode: str
    """The frame of an example, as a schema has it."""
    report: str

    def __new__(cls, value: str, summary: str, set_mode: str, report: str) -> Framing:
        """Make a member: its value, and what stands behind it."""
        framing = str.__new__(cls, value)
        framing._value_ = value
        framing.summary, framing.set_mode, framing.report = summary, set_mode, report
        return framing

    COBS = (
        "cobs",
        "a zero ends each frame, COBS keeps zeros out of it; CRC-16",
        "{hex: 04 02 01 64 03 9F 61 00}",
        "{hex: 05 81 01 66 08 01 02 55 04 88 13 7E 03 A7 88 00}",
    )
    SLIP = (
        "slip",
        "RFC 1055: C0 around each frame, bytes escaped with DB; CRC-16",
        "{hex: C0 02 01 64 00 9F 61 C0}",
        "{hex: C0 81 01 66 08 00 00 55 00 88 13 7E 00 A7 88 C0}",
    )
    HDLC = (
        "hdlc",
        "RFC 1662: 7E around each frame, bytes escaped with 7D; CRC-16",
        "{hex: 7E 02 01 64 00 41 9D 7E}",
        "{hex: 7E 81 01 66 08 00 00 55 00 88 13 7D 5E 00 79 E8 7E}",
    )
    ESCAPED = (
        "escaped",
        "start byte, length, checksum; an escape keeps the start byte unique",
        "{hex: 55 04 02 01 64 00 95}",
        "{hex: 55 0C 81 01 66 08 00 00 56 75 00 88 13 7E 00 96}",
    )
    LENGTH = (
        "length",
        "sync bytes, length, CRC-16, and nothing escaped, as UBX and MAVLink have it",
        "{hex: B5 62 02 03 00 01 64 00 5C 9B}",
        "{hex: B5 62 81 0B 00 01 66 08 00 00 55 00 88 13 7E 00 9F D2}",
    )
    SEVEN_BIT = (
        "seven-bit",
        "start bytes have their highest bit set, data bytes have not, as in MIDI",
        "{hex: 81 01 64 00}",
        "{hex: 90 01 66 10 00 00 55 00 08 27 7E 00}",
    )
    HEX_LINES = (
        "hex-lines",
        "lines of text: a colon, hex digits, a checksum, CR LF",
        '{text: ":0201640099\\r\\n"}',
        '{text: ":810166080000550088137E00A2\\r\\n"}',
    )

    @property
    def numbers(self) -> Numbers:
        """Look of numbers."""
        return SEVEN_BITS if self is Framing.SEVEN_BIT else WHOLE_BYTES


def extending_schema(name: str, base: str, file: str) -> str:
    """Return a schema that extends one of the library; `file` is how its comments call it."""
    from protogen.targets.printing import environment

    template = environment("protogen.starter").get_template("extending.yaml.j2")
    return template.render(name=name, base=base, file=file)


def starter_schema(name: str, framing: Framing, file: str) -> str:
    """Return a schema that compiles as it is; `file` is how its comments call it."""
    from protogen.targets.printing import environment

    title = name.replace("_", " ").capitalize()
    template = environment("protogen.starter").get_template("schema.yaml.j2")
    return template.render(name=name, title=title, file=file, framing=framing)
