"""Draft of the model: results of the passes so far."""

from __future__ import annotations

import msgspec

from protogen.model.frame import Frame
from protogen.model.framing import Framing
from protogen.model.messages import Exchange, Message, Overload
from protogen.model.protocol import Decision, Reserved
from protogen.passes.types.named_types import NamedTypes


class Draft(msgspec.Struct):
    """Results by pass; a later pass reads those of earlier ones and adds its own."""

    named: NamedTypes
    senders: tuple[str, ...] = ()
    """Endpoints that send something, in each of their forms of frame."""
    carried: dict[str, frozenset[str]] = msgspec.field(default_factory=dict)
    """The messages that each sender's frame carries."""
    frames: dict[str, Frame] = msgspec.field(default_factory=dict)
    messages: dict[str, Message] = msgspec.field(default_factory=dict)
    unidentified: set[str] = msgspec.field(default_factory=set)
    """Messages whose identity is wrong: no receiver could have them, so later passes don't."""
    too_large: set[str] = msgspec.field(default_factory=set)
    """Messages that no frame can hold."""
    used_types: frozenset[str] = frozenset()
    """The declared types that messages have."""
    overloads: dict[str, list[Overload]] = msgspec.field(default_factory=dict)
    """By sender."""
    framings: dict[str, Framing] = msgspec.field(default_factory=dict)
    decisions: tuple[Decision, ...] = ()
    exchanges: tuple[Exchange, ...] = ()
    reserved: Reserved = msgspec.field(default_factory=Reserved)

    def sent_by(self, sender: str) -> list[Message]:
        """The messages of a sender that have an identity, in the order of the schema."""
        carried = self.carried.get(sender, frozenset()) - self.unidentified
        return [message for message in self.messages.values() if message.name in carried]
