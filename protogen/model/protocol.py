"""The root of the model."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property

import msgspec

from protogen.model.frame import Frame
from protogen.model.frame_plan import FramePlan
from protogen.model.framing import Framing
from protogen.model.identities import Identities
from protogen.model.meanings import Enum, Flags
from protogen.model.messages import Exchange, Message, Overload
from protogen.model.origin import NOTHING, About, Source
from protogen.model.parts import IdentityPart, NumberPart
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

    @property
    def byte_time(self) -> Fraction | None:
        """Seconds that one character takes; None where the rate is not known."""
        return Fraction(self.bits_per_byte, self.baud) if self.baud else None


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


class Sender(msgspec.Struct, frozen=True, kw_only=True, dict=True):
    """An endpoint that sends: its frame, the framing and the plan of it, and its messages.

    An endpoint with several forms of frame is a sender in each of them.
    """

    name: str
    """The endpoint's, with that of the form behind it where there are several."""
    frame: Frame
    framing: Framing
    messages: tuple[Message, ...]
    overloads: tuple[Overload, ...]
    plan: FramePlan
    form: str = ""
    """Name of the form; empty where the schema has none."""
    is_only_form: bool = True
    """True if the endpoint has no other form of frame."""
    behind: str | None = None
    """The decision that accepts that bytes can be a frame of an earlier form, too."""

    @property
    def endpoint(self) -> str:
        """The endpoint that sends."""
        return self.name if self.is_only_form else self.name.removesuffix(f"_{self.form}")

    def sends(self, message: Message) -> bool:
        """True if the endpoint sends the message in this form of frame."""
        return message.name in self._sent

    @cached_property
    def given_identity(self) -> tuple[IdentityPart, ...]:
        """The identity parts of which some message has several values, so that callers choose."""
        return tuple(
            part
            for index, part in enumerate(self.frame.identity)
            if any(message.chooses(index) for message in self.messages)
        )

    @property
    def given_parts(self) -> tuple[NumberPart, ...]:
        """The parts whose values callers give, of some message at least."""
        return (*self.given_identity, *self.frame.caller_parts)

    @property
    def looks_ahead(self) -> bool:
        """True if what stands in front in a frame may need what stands behind it.

        What is not sent follows from the identity, and a field may be a part behind the payload.
        """
        held = (field.part for message in self.messages for field in message.held)
        return bool(self.frame.virtual) or not all(map(self.frame.is_known_early, held))

    @cached_property
    def _sent(self) -> frozenset[str]:
        return frozenset(message.name for message in self.messages)

    @property
    def received(self) -> tuple[Message, ...]:
        """The messages that a decoder yields, in the order of the schema."""
        names = {message.name for group in self.plan.groups for message in group.messages}
        return tuple(message for message in self.messages if message.name in names)

    @property
    def encode_only(self) -> tuple[Message, ...]:
        """The messages that no decoder yields, as nothing tells them from others."""
        names = {message.name for message in self.received}
        return tuple(message for message in self.messages if message.name not in names)

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
    identities: Identities | None = None
    """Where several are reserved together."""
    doc: str = ""

    @property
    def told_by(self) -> Identities:
        """All identities that are reserved."""
        return self.identities or Identities.only(self.identity)


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
    """In the order of the endpoints, and of the forms of each; what sends nothing is left out."""
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

    def sender(self, name: str, form: str = "") -> Sender:
        """The sender called `name`, or the endpoint of that name in a form; raises KeyError."""
        for sender in self.senders:
            if sender.name == name or (form and (sender.endpoint, sender.form) == (name, form)):
                return sender
        raise KeyError(name)

    @property
    def told(self) -> tuple[str, ...]:
        """Names of the parts that are not sent, and that receivers are told."""
        parts = (part for sender in self.senders for part in sender.frame.told)
        return tuple(dict.fromkeys(part.name for part in parts))

    def is_told_length(self, name: str) -> bool:
        """True if the part called so is a length that receivers are told."""
        lengths = (sender.frame.told_length for sender in self.senders)
        return any(part is not None and part.name == name for part in lengths)

    @property
    def is_told(self) -> bool:
        """True if there are such parts."""
        return bool(self.told)

    @property
    def frame_silences(self) -> dict[str, Fraction]:
        """The silence in seconds that ends a frame of each endpoint whose frames one ends."""
        silences: dict[str, Fraction] = {}
        for sender in self.senders:
            silence = sender.frame.silence
            if silence is not None:
                known = silences.get(sender.endpoint, silence.seconds)
                silences[sender.endpoint] = min(known, silence.seconds)
        return silences

    @property
    def silence(self) -> Fraction | None:
        """Seconds without bytes that end what receivers have begun; None: they never do."""
        timeout = self.link.idle_timeout
        ends = [*self.frame_silences.values(), *(() if timeout is None else (timeout,))]
        return min(ends, default=None)

    @property
    def sending(self) -> tuple[str, ...]:
        """Names of the endpoints that send, in their order."""
        return tuple(dict.fromkeys(sender.endpoint for sender in self.senders))

    def forms(self, endpoint: str) -> tuple[Sender, ...]:
        """An endpoint as a sender, in each of its forms of frame; empty if it sends nothing."""
        return tuple(sender for sender in self.senders if sender.endpoint == endpoint)

    @property
    def alike(self) -> tuple[tuple[str, ...], ...]:
        """Names of endpoints whose frames are alike, so that one encoder does for all of them."""
        found: dict[tuple[object, ...], list[str]] = {}
        for endpoint in self.sending:
            frames = tuple(
                (item.frame, item.framing.greatest, item.framing.payload)
                for item in self.forms(endpoint)
            )
            found.setdefault(frames, []).append(endpoint)
        return tuple(tuple(group) for group in found.values() if len(group) > 1)

    def senders_of(self, message: Message) -> tuple[Sender, ...]:
        """The senders of a message, in their order."""
        return tuple(item for item in self.senders if item.sends(message))

    def message(self, name: str) -> Message:
        """The message called `name`; raises KeyError."""
        for message in self.messages:
            if message.name == name:
                return message
        raise KeyError(name)
