"""What is found by the search of a page: names, units, values, identities and decisions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from protogen.model.messages import Message
from protogen.model.parts import IdentityPart
from protogen.model.protocol import Protocol
from protogen.model.types import Field
from protogen.targets.markdown.fields.paths import named_fields

_MOST_IDENTITIES = 4
"""Identities of one message that are found by their bytes."""


def entries(protocol: Protocol) -> dict[str, Any]:
    """All that can be looked for, in the order of the page: names, with more words of each."""
    parts = {
        part.name: " ".join(part.about.doc.split())
        for sender in protocol.senders
        for part in sender.frame.declared
    }
    decisions = {
        item.name: _joined((" ".join(item.question.split()), " ".join(item.choice.split())))
        for item in protocol.decisions
    }
    messages = [_message(protocol, message) for message in protocol.messages]
    return {"messages": messages, "parts": parts, "decisions": decisions}


def _message(protocol: Protocol, message: Message) -> list[Any]:
    """A message: its name, words and fields; of each field, its path, words and values."""
    words = (message.title, " ".join(message.summary.split()), *_identities(protocol, message))
    fields = [
        [path.shown, _joined(_words(field)), dict(_values(field))]
        for path, field in named_fields(message.plan.steps)
    ]
    return [message.name, _joined(words, message.name), fields]


def _joined(words: tuple[str, ...], name: str = "") -> str:
    return " ".join(word for word in words if word and word != name)


def _words(field: Field) -> tuple[str, ...]:
    return field.unit or "", " ".join(field.about.doc.split())


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
