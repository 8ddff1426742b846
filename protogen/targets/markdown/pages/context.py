"""Facts of the whole protocol that the sections of a page share."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import msgspec

from protogen.model.framing import MessageFraming
from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import NumberType
from protogen.targets.markdown.fields.paths import fields_inside
from protogen.targets.markdown.text.words import code


class Context(msgspec.Struct, frozen=True):
    """A protocol, with what is looked up in it again and again."""

    protocol: Protocol
    users: Mapping[str, list[NumberType]]
    """The integers that use an enum or flags, by its name."""
    shared: frozenset[str]
    """The enums and flags that several fields use: they are explained once."""
    framings: Mapping[tuple[str, str], MessageFraming]
    """The sizes and the rate of each message, by its sender and its name."""

    @classmethod
    def of(cls, protocol: Protocol) -> Context:
        """Look everything up once."""
        users = _users(protocol.messages)
        shared = frozenset(name for name, integers in users.items() if len(integers) > 1)
        framings = {
            (sender.name, framing.message): framing
            for sender in protocol.senders
            for framing in sender.framing.messages
        }
        return cls(protocol, users, shared, framings)


def _users(messages: Iterable[Message]) -> dict[str, list[NumberType]]:
    """The integers of the fields that use each enum and flags, by its name."""
    users: dict[str, list[NumberType]] = {}
    for message in messages:
        for field in fields_inside(message.plan.steps):
            integer = field.integer
            named = integer and (integer.enum or integer.flags)
            if integer and named:
                users.setdefault(named.name, []).append(integer)
    return users


def sender_code(sender: Sender) -> str:
    """Return a sender's name, with the form of its frames where its endpoint has several."""
    name = code(sender.endpoint)
    return name if sender.is_only_form else f"{name} ({code(sender.form)})"


def by_frame(senders: Iterable[Sender]) -> list[list[Sender]]:
    """Return the senders, those together whose frames are alike."""
    groups: list[list[Sender]] = []
    for sender in senders:
        alike = next((group for group in groups if group[0].frame == sender.frame), None)
        if alike is None:
            groups.append([sender])
        else:
            alike.append(sender)
    return groups
