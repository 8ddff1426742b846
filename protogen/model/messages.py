"""Messages, and what a document shows of them."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from typing import Any

import msgspec

from protogen.model.frame import Frame
from protogen.model.identities import Identities, Identity
from protogen.model.nesting import always_fills
from protogen.model.origin import NOTHING, About
from protogen.model.parts import NumberPart, VirtualPart
from protogen.model.payload_builder import plan_of
from protogen.model.payload_plan import PayloadPlan
from protogen.model.sizes import SizeSet
from protogen.model.types import Field
from protogen.problems.span import Span


class Contradiction(msgspec.Struct, frozen=True, kw_only=True):
    """Difference of an example from the schema."""

    fails: str
    why: str
    reads: dict[str, Any] | None = None


class Example(msgspec.Struct, frozen=True, kw_only=True):
    """Bytes and what they mean. `covers` names the parts that they hold; None: a whole frame."""

    name: str
    sender: str
    bytes: bytes
    covers: tuple[str, ...] | None
    values: dict[str, Any] | None
    parts: dict[str, int | str]
    """Values of parts, as events show them."""
    contradicts: Contradiction | None = None
    about: About = NOTHING
    span: Span


class Message(msgspec.Struct, frozen=True, kw_only=True, dict=True):
    """One message."""

    name: str
    title: str
    summary: str
    senders: tuple[str, ...]
    """The endpoints that send it."""
    identity: tuple[int, ...]
    """Raw value of each identity part, in wire order; of several, those that encoders write."""
    fields: tuple[Field, ...]
    sizes: SizeSet
    """Payload sizes."""
    unspecified: bool = False
    """The document does not say what the payload holds: one field `data` of bytes."""
    identities: Identities | None = None
    """Where it has several."""
    examples: tuple[Example, ...] = ()
    spec_hash: str = ""
    """SHA-256, in hex, of identity, layout and meaning of values."""
    renamed_from: str | None = None
    """Name in the version before, where that was another one."""
    forms: tuple[str, ...] = ()
    """The forms of frame that carry it; none are named where all of its senders' do."""
    rate: Fraction | None = None
    """How often each of its senders sends it by itself, in Hz; None: it is not said."""
    virtual: tuple[tuple[str, int], ...] = ()
    """Raw values of parts that are not sent, by their names, where they are not the default."""
    about: About = NOTHING
    span: Span

    @cached_property
    def plan(self) -> PayloadPlan:
        """The steps that read, check and write the payload."""
        return plan_of(self.fields)

    @cached_property
    def held(self) -> tuple[Field, ...]:
        """The fields that are parts of the frame; they come first."""
        return tuple(field for field in self.fields if field.part)

    @property
    def cut_size(self) -> int | None:
        """Bytes that receivers know of a longer payload; None where its fields say how long it is.

        Beside those of a fixed size, these are messages whose size varies by what is left out.
        """
        if all(field.sizes_in_front.fixed is not None for field in self.fields):
            return self.sizes.greatest
        return self.sizes.fixed

    @property
    def tells_its_end(self) -> bool:
        """True if its size varies, and what its fields hold says where they end.

        At least where they choose nothing that takes all that is left of a payload.
        """
        return self.cut_size is None and not any(map(always_fills, self.fields))

    @property
    def can_be_cut(self) -> bool:
        """True if receivers can tell what is behind its fields, and leave it."""
        return self.cut_size is not None or self.tells_its_end

    @property
    def told_by(self) -> Identities:
        """All identities that it has."""
        return self.identities or Identities.only(self.identity)

    def virtual_value(self, part: VirtualPart) -> int | None:
        """Raw value of a part that is not sent; None if nothing gives it one."""
        return dict(self.virtual).get(part.name, part.default)

    def is_told_by(self, identity: Identity) -> bool:
        """True if it is one of its identities."""
        if self.identities is None:
            return identity == self.identity
        return identity in self.identities

    def chooses(self, index: int) -> bool:
        """True if the identity part of this index has several values."""
        return self.identities is not None and self.identities.values(index) > 1


def given_parts(frame: Frame, message: Message) -> tuple[NumberPart, ...]:
    """The parts of a message's frames that a caller gives: identities first, if it has several."""
    chosen = (part for index, part in enumerate(frame.identity) if message.chooses(index))
    return (*chosen, *frame.caller_parts)


class Overload(msgspec.Struct, frozen=True, kw_only=True):
    """Messages of one sender that share an identity."""

    name: str
    sender: str
    identity: tuple[int, ...]
    messages: tuple[str, ...]
    yields: str | None
    """Told apart by payload size where None; else not at all, and this one is yielded."""
    decision: str | None = None
    about: About = NOTHING

    @property
    def hidden(self) -> frozenset[str]:
        """Names of the messages that no receiver yields."""
        return frozenset() if self.yields is None else frozenset(self.messages) - {self.yields}


class Step(msgspec.Struct, frozen=True, kw_only=True):
    """One message of an exchange."""

    message: str
    example: str | None
    about: About = NOTHING


class Exchange(msgspec.Struct, frozen=True, kw_only=True):
    """A named sequence of messages, or requests with what answers them."""

    name: str
    title: str
    steps: tuple[Step, ...] = ()
    requests: tuple[str, ...] = ()
    """The messages that ask; empty where it is a sequence."""
    replies: tuple[str, ...] = ()
    """The messages of which any settles a request."""
    refusals: tuple[str, ...] = ()
    match: tuple[tuple[str, str], ...] = ()
    """Parts or fields of the request and of its reply that are equal; else order decides."""
    is_refusal_matched: bool = True
    """False if a refusal does not say of which request it is."""
    timeout: Fraction | None = None
    """Seconds after which a request is lost; None where the schema does not say."""
    retries: int = 0
    about: About = NOTHING
