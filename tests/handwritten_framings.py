"""Frames of every kind, to try the decoder on: those of the five documents, and common others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import handwritten_matty
import handwritten_rn1

from protogen.runtime import api as rt
from protogen.runtime import constructs as c
from protogen.runtime.checksum import Crc, Sum, Xor
from protogen.runtime.transparency import Base16Upper, Cobs, Escape, Substitution

CRC16 = Crc(16, poly=0x1021, init=0xFFFF)
BYTE = rt.Number(8)
WORD = rt.Number(16, order="little")


# --- messages -----------------------------------------------------------------------------------


def empty(*identity: int) -> type[rt.Message]:
    @dataclass(slots=True, kw_only=True)
    class Empty(rt.Message):
        NAME = "empty"
        SENDERS = ("a",)
        IDENTITY = identity
        SIZES = rt.Sizes(0, 0)
        FORMAT = c.Struct()
        RULES = ()

    return Empty


def pair(*identity: int, seven_bit: bool = False) -> type[rt.Message]:
    """A fixed size, and a closed first byte."""
    integer = c.SevenBit if seven_bit else c.Int

    @dataclass(slots=True, kw_only=True)
    class Pair(rt.Message):
        first: int
        second: int

        NAME = "pair"
        SENDERS = ("a",)
        IDENTITY = identity
        SIZES = rt.Sizes(3, 3)
        FORMAT = c.Struct(
            "first" / c.Closed(integer(7), range(100)), "second" / integer(13, signed=True)
        )
        RULES = (
            ("first", rt.IntegerRule(7)),
            ("second", rt.IntegerRule(13, signed=True)),
        )

    return Pair


def blob(*identity: int, seven_bit: bool = False) -> type[rt.Message]:
    """Up to six bytes, to the end of the payload."""

    @dataclass(slots=True, kw_only=True)
    class Blob(rt.Message):
        data: bytes

        NAME = "blob"
        SENDERS = ("a",)
        IDENTITY = identity
        SIZES = rt.Sizes(0, 6)
        FORMAT = c.Struct("data" / c.OctetsFill(6, seven_bit=seven_bit))
        RULES = (("data", rt.OctetsRule(greatest=6)),)

    return Blob


def tally(*identity: int, seven_bit: bool = False) -> type[rt.Message]:
    """A message that says itself where it ends: a count, so many numbers, and a chosen tail."""
    integer = c.SevenBit if seven_bit else c.Int

    @dataclass(slots=True, kw_only=True)
    class Tally(rt.Message):
        count: int
        items: list[int]
        kind: int
        tail: int | None = None

        NAME = "tally"
        SENDERS = ("a",)
        IDENTITY = identity
        SIZES = rt.Sizes(2, 9)
        FORMAT = c.Struct(
            "count" / c.Closed(integer(7), range(4)),
            "items" / c.Counted("count", integer(10)),
            "kind" / integer(7),
            "tail" / c.Cases("kind", {0: c.Pass, 1: c.Fixed(integer(7), 7)}),
        )
        RULES = (
            ("count", rt.IntegerRule(7)),
            ("items", rt.ArrayRule(rt.IntegerRule(10), count="count")),
            ("kind", rt.IntegerRule(7)),
            ("tail", rt.SwitchRule("kind", {0: None, 1: rt.IntegerRule(7, const=7)})),
        )

    return Tally


# --- frames -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Id:
    id: int


@dataclass(frozen=True, slots=True)
class ClassNumberSubclass:
    class_id: int
    number: int
    subclass: int


@dataclass(frozen=True, slots=True)
class NumberMark:
    number: int
    mark: int


@dataclass(frozen=True, slots=True)
class NumberIdMark:
    number: int
    id: int
    mark: int


Framing = rt.SenderSpec[Any, Any]
ID = rt.IdentityPart("id", BYTE)
PAYLOAD = rt.PayloadPart("payload")
XOR = rt.ChecksumPart("checksum", BYTE, algorithm=Xor(), covers=("id", "payload"))
CRC = rt.ChecksumPart("crc", WORD, algorithm=CRC16, covers=("id", "payload"))


def literal(value: bytes, name: str = "start") -> rt.LiteralPart:
    return rt.LiteralPart(name, value)


def length(*counts: str, least: int = 0, greatest: int = 255) -> rt.LengthPart:
    return rt.LengthPart("length", BYTE, counts=counts, least=least, greatest=greatest)


def framing(parts: tuple[Any, ...], greatest: int, *messages: type[rt.Message], **more: Any) -> Any:
    given: dict[str, Any] = {"end": None, "greatest_payload": 9}
    spec = rt.FrameSpec(parts=parts, least=1, greatest=greatest, **(given | more))
    return rt.SenderSpec("a", spec, Id, messages)


def every_message() -> tuple[type[rt.Message], ...]:
    return (empty(1), pair(2), blob(3), tally(4))


def self_delimiting() -> tuple[type[rt.Message], ...]:
    return (empty(1), pair(2), tally(4))


def rflex() -> Framing:
    checksum = XOR._replace(covers=("payload",))
    names = ("class_id", "number", "subclass", "length", "payload", "checksum")
    spec = rt.FrameSpec(
        parts=(
            literal(b"\x1b\x02"),
            rt.IdentityPart("class_id", BYTE),
            rt.ValuePart("number", BYTE, least=0, greatest=255, default=0xFF),
            rt.IdentityPart("subclass", BYTE),
            length("payload"),
            PAYLOAD,
            checksum,
            literal(b"\x1b\x03", "end"),
        ),
        start=rt.StartLiteral(b"\x1b\x02", protected=True),
        end=rt.End(b"\x1b\x03", protected=True),
        transparency=Substitution({0x1B: b"\x1b\x00", 0x7C: b"\x7c\x1b\x01"}),
        stuffed=names,
        least=9,
        greatest=46,
        greatest_payload=9,
    )
    messages = (empty(1, 0x1B), pair(1, 2), blob(2, 1), tally(0x7C, 0))
    return rt.SenderSpec("a", spec, ClassNumberSubclass, messages)


def uherobot() -> Framing:
    return framing(
        (
            literal(b"b"),
            length("length", "id", "payload", least=2),
            ID,
            PAYLOAD,
            literal(b"e", "end"),
        ),
        24,
        *every_message(),
        start=rt.StartLiteral(b"b", protected=True),
        end=rt.End(b"e", protected=True),
        transparency=Base16Upper(),
        stuffed=("length", "id", "payload"),
    )


def rn1_host() -> Framing:
    """7-bit payloads; the identity is the start, and 0xFF the end."""
    spec = handwritten_rn1.HOST_FRAME
    parts = (rt.IdentityPart("id", BYTE), *spec.parts[1:])
    messages = (
        empty(0x80),
        pair(0x81, seven_bit=True),
        blob(0x82, seven_bit=True),
        tally(0x83, seven_bit=True),
    )
    return rt.SenderSpec("a", spec._replace(parts=parts, greatest=12), Id, messages)


def rn1_brain() -> Framing:
    """The same without an end."""
    spec = handwritten_rn1.BRAIN_FRAME
    parts = (rt.IdentityPart("id", BYTE), *spec.parts[1:])
    messages = (empty(0x80), pair(0x81, seven_bit=True), tally(0x83, seven_bit=True))
    return rt.SenderSpec("a", spec._replace(parts=parts, greatest=12), Id, messages)


def dagny() -> Framing:
    return framing(
        (ID, PAYLOAD, XOR._replace(when_payload=True), literal(b"\n", "end")),
        12,
        *every_message(),
        start=rt.AfterEnd(),
        end=rt.End(b"\n", protected=False),
        ambiguous_cut=True,
    )


def dagny_crlf() -> Framing:
    """The same with an end of two bytes."""
    return framing(
        (ID, PAYLOAD, XOR._replace(when_payload=True), literal(b"\r\n", "end")),
        13,
        *every_message(),
        start=rt.AfterEnd(),
        end=rt.End(b"\r\n", protected=False),
        ambiguous_cut=True,
    )


def dagny_library() -> Framing:
    return framing(
        (ID, PAYLOAD, literal(b"\r", "end")),
        21,
        *every_message(),
        start=rt.AfterEnd(),
        end=rt.End(b"\r", protected=True),
        transparency=Escape(0x1B, frozenset(b"\r\x1b"), 0x1B),
        stuffed=("id", "payload"),
    )


def cobs_end_only() -> Framing:
    return framing(
        (ID, PAYLOAD, CRC, literal(b"\0", "end")),
        14,
        *every_message(),
        start=rt.AfterEnd(),
        end=rt.End(b"\0", protected=True),
        transparency=Cobs(),
        stuffed=("id", "payload", "crc"),
    )


def cobs_payload_only() -> Framing:
    """A stuffed payload between raw parts; only the length tells where it ends."""
    return framing(
        (literal(b"\xaa"), ID, length("payload"), PAYLOAD, CRC),
        15,
        *every_message(),
        start=rt.StartLiteral(b"\xaa", protected=False),
        transparency=Cobs(),
        stuffed=("payload",),
    )


def slip_both_ends() -> Framing:
    return framing(
        (literal(b"\xc0"), ID, PAYLOAD, XOR, literal(b"\xc0", "end")),
        24,
        *every_message(),
        start=rt.StartLiteral(b"\xc0", protected=True),
        end=rt.End(b"\xc0", protected=True),
        transparency=Substitution({0xC0: b"\xdb\xdc", 0xDB: b"\xdb\xdd"}),
        stuffed=("id", "payload", "checksum"),
    )


def hdlc_end_only() -> Framing:
    return framing(
        (ID, PAYLOAD, CRC, literal(b"\x7e", "end")),
        25,
        *every_message(),
        start=rt.AfterEnd(),
        end=rt.End(b"\x7e", protected=True),
        transparency=Escape(0x7D, frozenset((0x7D, 0x7E)), 0x20),
        stuffed=("id", "payload", "crc"),
    )


def ubx() -> Framing:
    """Sync, 16-bit length and CRC without stuffing."""
    size = rt.LengthPart("length", WORD, counts=("payload",), least=0, greatest=65535)
    crc = CRC._replace(covers=("id", "length", "payload"))
    return framing(
        (literal(b"\xb5\x62"), ID, size, PAYLOAD, crc),
        16,
        *every_message(),
        start=rt.StartLiteral(b"\xb5\x62", protected=False),
    )


def repeated_sync() -> Framing:
    """A sync that overlaps itself, and a header checksum in front of the payload."""
    header = rt.ChecksumPart("header", BYTE, algorithm=Sum(), covers=("id", "length"))
    return framing(
        (literal(b"\xaa\xaa"), ID, length("payload", greatest=9), header, PAYLOAD, CRC),
        16,
        *every_message(),
        start=rt.StartLiteral(b"\xaa\xaa", protected=False),
    )


def length_and_end() -> Framing:
    """A length that covers the whole frame, and an end that may occur inside."""
    counts = ("start", "length", "id", "payload", "mark", "end")
    return framing(
        (
            literal(b"\x02"),
            ID,
            length(*counts),
            PAYLOAD,
            literal(b"\x2a\x2b", "mark"),
            literal(b"\x03\x04", "end"),
        ),
        16,
        *every_message(),
        start=rt.StartLiteral(b"\x02", protected=False),
        end=rt.End(b"\x03\x04", protected=False),
        ambiguous_cut=True,
    )


def nmea_like() -> Framing:
    """A start and an end that may occur inside, and nothing else."""
    return framing(
        (literal(b"$"), ID, PAYLOAD, literal(b"*", "star"), XOR, literal(b"\r\n", "end")),
        15,
        *every_message(),
        start=rt.StartLiteral(b"$", protected=False),
        end=rt.End(b"\r\n", protected=False),
        ambiguous_cut=True,
    )


def next_start_ends() -> Framing:
    """Neither length nor end: known sizes; unknown messages end at the next start."""
    return framing(
        (literal(b"\x10\x20"), ID, PAYLOAD, XOR),
        14,
        *self_delimiting(),
        start=rt.StartLiteral(b"\x10\x20", protected=False),
    )


def next_protected_start_ends() -> Framing:
    """The same with stuffing that protects the start."""
    return framing(
        (literal(b"\x10\x20"), ID, PAYLOAD, XOR),
        24,
        *self_delimiting(),
        start=rt.StartLiteral(b"\x10\x20", protected=True),
        transparency=Substitution({0x10: b"\x10\x00"}),
        stuffed=("id", "payload", "checksum"),
    )


def several_syncs() -> Framing:
    """The same with two starts, the second of which also begins behind the first byte of one."""
    number = rt.Number(16, order="big")
    sync = rt.ValuePart("number", number, 0x1010, 0x1020, 0x1010, values=(0x1010, 0x1020))
    mark = rt.ValuePart("mark", BYTE, 1, 9, values=(9, 1))
    spec = rt.FrameSpec(
        parts=(sync, ID, mark, PAYLOAD, XOR),
        start=rt.StartWords((b"\x10\x10", b"\x10\x20"), protected=True),
        end=None,
        transparency=Substitution({0x10: b"\x10\x00"}),
        stuffed=("id", "mark", "payload", "checksum"),
        least=5,
        greatest=26,
        greatest_payload=9,
    )
    return rt.SenderSpec("a", spec, NumberIdMark, self_delimiting())


def several_syncs_in_data() -> Framing:
    """Three starts of three bytes that can also occur in the data, and an end."""
    number = rt.Number(24, order="big")
    words = (b"aab", b"aba", b"abb")
    values = tuple(map(number.decode, words))
    sync = rt.ValuePart("number", number, min(values), max(values), values=values)
    mark = rt.ValuePart("mark", BYTE, 0x61, 0x63, values=(0x63, 0x61))
    spec = rt.FrameSpec(
        parts=(sync, length("payload", greatest=9), ID, PAYLOAD, mark, XOR, literal(b"ab", "end")),
        start=rt.StartWords(words, protected=False),
        end=rt.End(b"ab", protected=False),
        least=9,
        greatest=18,
        greatest_payload=9,
        ambiguous_cut=True,
    )
    return rt.SenderSpec("a", spec, NumberIdMark, every_message())


def wire_checksum() -> Framing:
    """A checksum over the stuffed bytes, and a 7-bit counter."""
    crc = rt.ChecksumPart(
        "crc", WORD, algorithm=CRC16, covers=("length", "id", "payload"), over_wire=True
    )
    return framing(
        (literal(b"\x55"), length("id", "payload", least=1), ID, PAYLOAD, crc),
        28,
        *every_message(),
        start=rt.StartLiteral(b"\x55", protected=True),
        transparency=Escape(0x56, frozenset(b"\x55\x56"), "invert"),
        stuffed=("length", "id", "payload", "crc"),
    )


def lenient_by_size() -> Framing:
    """Stuffing that also lets bytes pass, in a frame that only its length ends."""
    return framing(
        (literal(b"\xaa"), length("payload"), ID, PAYLOAD, XOR),
        40,
        *every_message(),
        start=rt.StartLiteral(b"\xaa", protected=False),
        transparency=Substitution({0x7C: b"\x7c\x1b\x01", 0x1B: b"\x1b\x00"}, lenient=True),
        stuffed=("length", "id", "payload"),
    )


def lenient_with_end() -> Framing:
    """The same with an end, which decides, and the checksum under stuffing as well."""
    return framing(
        (ID, PAYLOAD, XOR, literal(b"\x1b\x03", "end")),
        40,
        *every_message(),
        start=rt.AfterEnd(),
        end=rt.End(b"\x1b\x03", protected=True),
        transparency=Substitution({0x7C: b"\x7c\x1b\x01", 0x1B: b"\x1b\x00"}, lenient=True),
        stuffed=("id", "payload", "checksum"),
    )


def only_one_message() -> Framing:
    """No identity; numbers with padding on both sides of a 7-bit payload of unknown size."""
    twelve = rt.Number(12, order="big")
    spec = rt.FrameSpec(
        parts=(
            literal(b"<"),
            rt.ValuePart("number", twelve, least=0, greatest=4095),
            PAYLOAD,
            literal(b"|", "bar"),
            rt.ValuePart("mark", rt.Number(7, seven_bit=True), least=0, greatest=127),
            literal(b">", "end"),
        ),
        start=rt.StartLiteral(b"<", protected=False),
        end=rt.End(b">", protected=False),
        least=6,
        greatest=12,
        greatest_payload=6,
        seven_bit=True,
        ambiguous_cut=True,
    )
    return rt.SenderSpec("a", spec, NumberMark, (blob(),))


def anywhere_length() -> Framing:
    crc = CRC._replace(covers=("length", "id", "payload"))
    return framing((length("payload"), ID, PAYLOAD, crc), 13, *every_message(), start=rt.Anywhere())


def anywhere_fixed() -> Framing:
    return framing((ID, PAYLOAD, CRC), 12, *self_delimiting(), start=rt.Anywhere())


FRAMINGS: dict[str, Callable[[], Framing]] = {
    "matty pc": lambda: handwritten_matty.PC_SENDER,
    "matty esp": lambda: handwritten_matty.ESP_SENDER,
    "rn1 host as in the document": lambda: handwritten_rn1.HOST_SENDER,
    "rn1 host": rn1_host,
    "rn1 brain": rn1_brain,
    "rflex": rflex,
    "uherobot": uherobot,
    "dagny": dagny,
    "dagny with cr lf": dagny_crlf,
    "dagny library": dagny_library,
    "cobs with an end only": cobs_end_only,
    "cobs of the payload only": cobs_payload_only,
    "slip with two ends": slip_both_ends,
    "hdlc with an end only": hdlc_end_only,
    "ubx": ubx,
    "repeated sync": repeated_sync,
    "length and end": length_and_end,
    "nmea": nmea_like,
    "next start ends": next_start_ends,
    "next protected start ends": next_protected_start_ends,
    "several syncs": several_syncs,
    "several syncs in data": several_syncs_in_data,
    "checksum over the wire": wire_checksum,
    "lenient stuffing and a length": lenient_by_size,
    "lenient stuffing and an end": lenient_with_end,
    "only one message": only_one_message,
    "anywhere with a length": anywhere_length,
    "anywhere with fixed sizes": anywhere_fixed,
}
