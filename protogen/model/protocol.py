"""The root of the model."""

from __future__ import annotations

from fractions import Fraction

import msgspec

from protogen.model.frame import Frame
from protogen.model.frame_plan import FramePlan
from protogen.model.framing import Framing
from protogen.model.meanings import Enum, Flags
from protogen.model.messages import Exchange, Message, Overload
from protogen.model.origin import NOTHING, About, Source
from protogen.model.types import Struct


class Link(msgspec.Struct, frozen=True, kw_only=True):
    """The line. `baud` is in bits per second, `idle_timeout` in seconds."""

    baud: int | None = None
    data_bits: int = 8
    parity: str = "none"
    stop_bits: int = 1
    idle_timeout: Fraction | None = None
    about: About = NOTHING

    @property
    def bits_per_byte(self) -> int:
        """Bit times of one character: start bit, data, parity, stop bits."""
        return 1 + self.data_bits + (self.parity != "none") + self.stop_bits


class Endpoint(msgspec.Struct, frozen=True, kw_only=True):
    """A named side of the link."""

    name: str
    title: str
    doc: str = ""


class Decision(msgspec.Struct, frozen=True, kw_only=True):
    """A choice where the document does not say, or says two things."""

    name: str
    question: str
    document: str
    choice: str
    because: str
    source: Source | None = None


class Sender(msgspec.Struct, frozen=True, kw_only=True):
    """An endpoint that sends: its frame, the framing and the plan of it, and its messages."""

    name: str
    frame: Frame
    framing: Framing
    messages: tuple[Message, ...]
    overloads: tuple[Overload, ...]
    plan: FramePlan

    @property
    def received(self) -> tuple[Message, ...]:
        """The messages that a decoder yields, in the order of the schema."""
        names = {message.name for group in self.plan.groups for message in group.messages}
        return tuple(message for message in self.messages if message.name in names)

    def received_as(self, message: str) -> str:
        """Name of the message that a decoder takes this one for, where nothing tells them apart."""
        for overload in self.overloads:
            if message in overload.hidden:
                assert overload.yields is not None
                return overload.yields
        return message


class ReservedIdentity(msgspec.Struct, frozen=True, kw_only=True):
    """The identity of a message that is no longer sent."""

    sender: str
    identity: tuple[int, ...]
    doc: str = ""


class ReservedNames(msgspec.Struct, frozen=True, kw_only=True):
    """Field names that a message may not use again."""

    message: str
    names: tuple[str, ...]


class ReservedValues(msgspec.Struct, frozen=True, kw_only=True):
    """Raw values that the enum at `path`, MESSAGE.FIELD or a type, may not use again."""

    path: str
    values: tuple[int, ...]


class Reserved(msgspec.Struct, frozen=True, kw_only=True):
    """All that is reserved in a protocol."""

    identities: tuple[ReservedIdentity, ...] = ()
    fields: tuple[ReservedNames, ...] = ()
    values: tuple[ReservedValues, ...] = ()


class Protocol(msgspec.Struct, frozen=True, kw_only=True):
    """A serial protocol, resolved."""

    name: str
    title: str
    version: str | None
    source: Source | None
    about: About
    files: tuple[str, ...]
    """The schema's file name, then those that it extends."""
    link: Link
    byte_bits: int
    endpoints: tuple[Endpoint, ...]
    senders: tuple[Sender, ...]
    """In the order of the endpoints; an endpoint that sends nothing is left out."""
    enums: tuple[Enum, ...]
    flags: tuple[Flags, ...]
    structs: tuple[Struct, ...]
    """Named types in the order of their first use, inner ones first."""
    messages: tuple[Message, ...]
    exchanges: tuple[Exchange, ...]
    decisions: tuple[Decision, ...]
    reserved: Reserved = Reserved()
    spec_hash: str
    """SHA-256, in hex, of layout, framing and meaning of values."""

    def sender(self, name: str) -> Sender:
        """The sender called `name`; raises KeyError."""
        for sender in self.senders:
            if sender.name == name:
                return sender
        raise KeyError(name)

    def message(self, name: str) -> Message:
        """The message called `name`; raises KeyError."""
        for message in self.messages:
            if message.name == name:
                return message
        raise KeyError(name)
