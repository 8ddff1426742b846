"""What is found by the search of a page: names, units, values, identities and decisions."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.model.messages import Message
from protogen.model.parts import IdentityPart
from protogen.model.protocol import Protocol
from protogen.model.types import Field
from protogen.targets.markdown.fields.paths import named_fields
from protogen.targets.markdown.text.anchors import message_anchor

Entry = tuple[str, str, str, str]
"""Kind, name, more words that are looked through, and the anchor that it leads to."""

_MOST_IDENTITIES = 4
"""Identities of one message that are found by their bytes."""


def entries(protocol: Protocol) -> Iterator[Entry]:
    """All that can be looked for, in the order of the page."""
    for message in protocol.messages:
        words = (message.title, message.summary, *_identities(protocol, message))
        anchor = message_anchor(message.name)
        yield "message", message.name, _joined(words, message.name), anchor
        for path, field in named_fields(message.plan.steps):
            yield "field", f"{message.name}.{path}", _joined(_words(field)), anchor
            for name, value in _values(field):
                yield "value", name, f"{value} {message.name}.{path}", anchor
    for sender in protocol.senders:
        for part in sender.frame.declared:
            yield "part", part.name, f"{sender.name} {part.about.doc}".strip(), "frames"
    for decision in protocol.decisions:
        words = (decision.question, decision.choice)
        yield "decision", decision.name, _joined(words), f"decision-{decision.name}"


def _joined(words: tuple[str, ...], name: str = "") -> str:
    return " ".join(word for word in words if word and word != name)


def _words(field: Field) -> tuple[str, ...]:
    return field.type.label, field.unit or "", " ".join(field.about.doc.split())


def _identities(protocol: Protocol, message: Message) -> Iterator[str]:
    """The bytes of identities, as they are in a frame, and the values of each part."""
    frame = protocol.senders_of(message)[0].frame
    identity = message.identity
    data = [part.encode(value) for part, value in zip(frame.identity, identity, strict=True)]
    yield b"".join(data).hex(" ").upper()
    for index, part in enumerate(frame.identity[:_MOST_IDENTITIES]):
        yield _identity(part, identity[index])


def _identity(part: IdentityPart, value: int) -> str:
    return f"{part.shown(value)}" if part.type.is_text else f"0x{value:02X} {value}"


def _values(field: Field) -> Iterator[tuple[str, int]]:
    for item in field.special:
        yield item.name, item.value
    integer = field.integer
    if integer is None:
        return
    if integer.enum is not None:
        for item in integer.enum.values:
            yield item.name, item.value
    if integer.flags is not None:
        for flag in integer.flags.bits:
            yield flag.name, 1 << flag.bit
    for run in integer.bit_fields:
        yield run.name, run.low
