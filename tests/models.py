"""Small protocols built by hand, for tests of what prints them."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from protogen.model.checksums import find_algorithm
from protogen.model.expressions import named
from protogen.model.frame import Frame
from protogen.model.framing import End, Framing, MessageFraming, StartLiteral
from protogen.model.meanings import Enum, Flags, NamedBit, NamedValue
from protogen.model.messages import Example, Message
from protogen.model.origin import About, Source
from protogen.model.parts import (
    ChecksumPart,
    CounterPart,
    IdentityPart,
    LengthPart,
    LiteralPart,
    PayloadPart,
    ValuePart,
)
from protogen.model.protocol import Endpoint, Link, Protocol, Sender
from protogen.model.sizes import SizeSet
from protogen.model.transparency import Base16, Escape, Substitution, Transparency
from protogen.model.types import Case, Field, Integer, Struct, Switch, Type, total
from protogen.passes.framing.frame_plan import plan_frame
from protogen.problems.span import Span

SPAN = Span("tiny.yaml", 1, 1, 1, 2)
UINT8 = Integer(bits=8)
UINT16 = Integer(bits=16)
UINT16_BIG = Integer(bits=16, byte_order="big")
SINT14 = Integer(bits=14, signed=True, byte_bits=7)
CHAR = Integer(bits=8, role="char")
UINT8_ENUM = Integer(
    bits=8,
    enum=Enum(
        name="mode",
        values=(NamedValue(name="idle", value=0), NamedValue(name="auto", value=2)),
    ),
)


def about(doc: str = "", lines: str | None = None) -> About:
    return About(doc=doc, source=None if lines is None else Source(lines=lines))


def fields(*pairs: tuple[str, Type] | tuple[str, Type, dict[str, Any]]) -> tuple[Field, ...]:
    """Fields one after another, from (name, type) or (name, type, further attributes)."""
    made: list[Field] = []
    for name, kind, *more in pairs:
        position = total(tuple(made)).fixed
        bounds = _bounds(kind) | (more[0] if more else {})
        made.append(Field(name=name, type=kind, position=position, **bounds))
    return tuple(made)


def _bounds(kind: Type) -> dict[str, Any]:
    if not isinstance(kind, Integer):
        return {}
    return {"least": Fraction(kind.least), "greatest": Fraction(kind.greatest)}


def message(name: str, identity: int | tuple[int, ...], *pairs: Any, **more: Any) -> Message:
    made = fields(*pairs)
    given: dict[str, Any] = {
        "title": name.upper(),
        "summary": "",
        "senders": ("pc",),
        "identity": identity if isinstance(identity, tuple) else (identity,),
        "fields": made,
        "sizes": total(made),
        "span": SPAN,
    }
    return Message(name=name, **(given | more))


def example(name: str, data: str, **more: Any) -> Example:
    given: dict[str, Any] = {
        "sender": "pc",
        "bytes": bytes.fromhex(data),
        "covers": None,
        "values": {},
        "parts": {},
        "span": SPAN,
    }
    return Example(name=name, **(given | more))


def flags_type() -> Integer:
    """Flags in 16 bits, two of them named."""
    bits = tuple(NamedBit(name=f"led_{bit}", bit=bit, about=about("Lamp.")) for bit in (0, 7))
    return Integer(bits=16, flags=Flags(name="leds", bits=bits))


def switch_message() -> Message:
    """An operation, and an argument that depends on it."""
    cases = (
        Case(value=0x41, name="baud", type=Struct(name="a", fields=fields(("rate", UINT16)))),
        Case(value=0x51, name="kill", type=Struct(name="b", fields=())),
        Case(value=7, name="case_7", type=UINT8),
    )
    switch = Switch(selector=named("op"), cases=cases, rest=4)
    return message("maintenance", 1, ("op", UINT8), ("argument", switch))


def simple_frame() -> Frame:
    """A start byte, an identity, the payload and an end byte."""
    return Frame(
        parts=(
            LiteralPart(name="start", bytes=b"\xaa"),
            IdentityPart(name="id", type=UINT8, least=0, greatest=255),
            PayloadPart(name="payload"),
            LiteralPart(name="end", bytes=b"\x0d\x0a"),
        )
    )


def robbus_frame() -> Frame:
    """Sync, then an escaped region with length, counter, command, payload and checksum."""
    checksum = find_algorithm("sum-8/negated")
    assert checksum is not None
    return Frame(
        parts=(
            LiteralPart(name="sync", bytes=b"\x55"),
            LengthPart(
                name="length",
                type=UINT8,
                least=2,
                greatest=123,
                counts=("counter", "command", "payload"),
            ),
            CounterPart(name="counter", type=UINT8, least=0, greatest=255),
            IdentityPart(name="command", type=CHAR, least=0, greatest=255),
            PayloadPart(name="payload"),
            ChecksumPart(
                name="crc",
                type=UINT8,
                algorithm=checksum,
                covers=("length", "counter", "command", "payload"),
            ),
        ),
        transparency=Transparency(
            first="length",
            last="crc",
            encoding=Escape(byte=0x56, of=(0x55, 0x56), xor=0xFF),
        ),
    )


def base16_frame() -> Frame:
    """`b`, then length, type and payload as hex digits, then `e`."""
    return Frame(
        parts=(
            LiteralPart(name="begin", bytes=b"b"),
            LengthPart(
                name="length",
                type=UINT8,
                least=2,
                greatest=255,
                counts=("length", "type", "payload"),
            ),
            IdentityPart(name="type", type=UINT8, least=0, greatest=255),
            PayloadPart(name="payload"),
            LiteralPart(name="end", bytes=b"e"),
        ),
        transparency=Transparency(first="length", last="payload", encoding=Base16()),
    )


def rflex_frame() -> Frame:
    """Two identity parts, a free number and a substitution table."""
    checksum = find_algorithm("xor-8")
    assert checksum is not None
    return Frame(
        parts=(
            LiteralPart(name="start", bytes=b"\x1b\x02"),
            IdentityPart(name="class_id", type=UINT8, least=0, greatest=255),
            ValuePart(name="number", type=UINT8, least=0, greatest=255, default=255),
            IdentityPart(name="subclass", type=UINT8, least=0, greatest=255),
            LengthPart(name="length", type=UINT8, least=0, greatest=255, counts=("payload",)),
            PayloadPart(name="payload"),
            ChecksumPart(name="checksum", type=UINT8, algorithm=checksum, covers=("payload",)),
            LiteralPart(name="end", bytes=b"\x1b\x03"),
        ),
        transparency=Transparency(
            first="class_id",
            last="checksum",
            encoding=Substitution(table=((0x1B, b"\x1b\x00"), (0x7C, b"\x7c\x1b\x01"))),
        ),
    )


def dagny_frame() -> Frame:
    """No start; a checksum that is absent without payload; an end that data can hold."""
    checksum = find_algorithm("xor-8")
    assert checksum is not None
    return Frame(
        parts=(
            IdentityPart(name="id", type=CHAR, least=0, greatest=255),
            PayloadPart(name="payload"),
            ChecksumPart(
                name="checksum",
                type=UINT8,
                algorithm=checksum,
                covers=("id", "payload"),
                when_payload=True,
            ),
            LiteralPart(name="end", bytes=b"\n", unprotected="newline_in_data"),
        )
    )


def framing(messages: Sequence[Message], overhead: int = 4, **more: Any) -> Framing:
    sizes = [
        MessageFraming(
            message=item.name,
            least=item.sizes.least + overhead,
            greatest=item.sizes.greatest + overhead,
            per_second=Fraction(11520, item.sizes.greatest + overhead),
        )
        for item in messages
    ]
    given: dict[str, Any] = {
        "start": StartLiteral(bytes=b"\xaa", protected=False),
        "end": End(bytes=b"\x0d\x0a", protected=False),
        "payload": SizeSet.between(0, 251),
        "least": min(item.least for item in sizes),
        "greatest": max(item.greatest for item in sizes),
        "overhead": SizeSet.exactly(overhead),
        "seven_bit": False,
        "cut_ambiguous": False,
        "self_synchronising": False,
        "why_synchronising": "0xAA can also occur inside a frame.",
        "finds_start": "by the literal AA",
        "finds_end": "by the size of the message",
        "undetected": ("Any change of a payload byte.",),
        "messages": tuple(sizes),
    }
    return Framing(**(given | more))


def sender(name: str, frame: Frame, found: Framing, messages: Sequence[Message]) -> Sender:
    return Sender(
        name=name,
        frame=frame,
        framing=found,
        messages=tuple(messages),
        overloads=(),
        plan=plan_frame(frame, found, messages, ()),
    )


def protocol(*messages: Message, frame: Frame | None = None, **more: Any) -> Protocol:
    """A protocol of one sender, `pc`, unless `senders` is given."""
    if "senders" not in more:
        more["senders"] = (sender("pc", frame or simple_frame(), framing(messages), messages),)
    given: dict[str, Any] = {
        "name": "tiny",
        "title": "Tiny protocol",
        "version": None,
        "source": Source(document="tiny.txt"),
        "about": about("A protocol for tests."),
        "files": ("tiny.yaml",),
        "link": Link(baud=115200),
        "byte_bits": 8,
        "endpoints": (Endpoint(name="pc", title="Computer"), Endpoint(name="mcu", title="Board")),
        "enums": (),
        "flags": (),
        "structs": (),
        "messages": messages,
        "exchanges": (),
        "decisions": (),
        "spec_hash": "0f1e2d3c4b5a69788796a5b4c3d2e1f00f1e2d3c4b5a69788796a5b4c3d2e1f0",
    }
    return Protocol(**(given | more))


def tiny_protocol(**more: Any) -> Protocol:
    """One message of one byte."""
    return protocol(message("ping", 1, ("token", UINT8)), **more)
