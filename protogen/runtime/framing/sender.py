"""An endpoint as a sender: its frame, and the messages that its frames can carry."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from protogen.runtime.errors import EncodeError
from protogen.runtime.framing.frame import (
    ChecksumPart,
    FrameSpec,
    IdentityPart,
    PayloadPart,
    ToldPart,
    VirtualPart,
)
from protogen.runtime.framing.layout import Layout
from protogen.runtime.identities import Identities, Identity, Runs
from protogen.runtime.payload.message import Message
from protogen.runtime.payload.number import Characters, given_number

if TYPE_CHECKING:
    from protogen.runtime.constructs import Measurer

MessageT_co = TypeVar("MessageT_co", bound=Message, covariant=True)
PartsT_co = TypeVar("PartsT_co", covariant=True)

Cutter = Callable[[bytes, int, int, list[Any]], int]
"""Called with data, a place in them, the offset of the data in the input, and a list to which it
adds events. Gives the place of the first byte that it did not take."""


_LISTED = 1024
"""A message with more identities than this is looked for by their bounds."""


class IdentityGroup(Generic[MessageT_co]):
    """The messages that a receiver may find behind one identity: one, or more told by size."""

    def __init__(self, messages: tuple[type[MessageT_co], ...], part: PayloadPart) -> None:
        self.messages = messages
        self._part = part
        sizes = {message.__known__() for message in messages}
        self._own = sizes.pop() if len(sizes) == 1 else None
        is_fixed = all(message.SIZES.fixed is not None for message in messages)
        self.fixed = self._own if is_fixed and not part.is_fitted else None
        """The payload's size, where no message has another one, and no frame."""
        self.greatest = max(message.SIZES.greatest for message in messages)
        """The greatest payload of these messages."""

    def holds(self, size: int) -> bool:
        """True if frames can carry a payload of one of these messages in that size."""
        own = self._own
        if own is None or not self._part.is_fitted:
            return any(
                size in message.SIZES or self._leaves(message, size) for message in self.messages
            )
        is_filled, is_cut = self._part.kept is not None, self._part.longest is not None
        if size > own:
            return is_cut
        return is_filled or any(size in message.SIZES for message in self.messages)

    def _leaves(self, message: type[MessageT_co], size: int) -> bool:
        """True if the fields of a message say where they end in more bytes than it has."""
        is_cut = self._part.longest is not None and message.TELLS_ITS_END
        return is_cut and size > message.SIZES.least

    def _known(self, payload: bytes, numbers: Mapping[str, int]) -> bytes:
        """What a frame has of a payload, cut or filled up to what is known of it."""
        message, size = self.messages[0], len(payload)
        if self._leaves(message, size):
            return self._part.fitted(payload, message.__known_of__(payload, numbers))
        return self._part.fitted(payload, self._own)

    def measurer(self, numbers: Mapping[str, int]) -> Measurer:
        """What tells the size of a payload that comes in, behind these numbers of the frame."""
        from protogen.runtime.constructs import Measurer  # It takes long to import.

        message = self.messages[0]
        return Measurer(message.FORMAT, message.__held__(numbers))

    def read(self, payload: bytes, numbers: Mapping[str, int]) -> MessageT_co:
        """The message of a frame's payload. Raises PayloadError: size, value or encoding."""
        payload = self._known(payload, numbers)
        fitting = (message for message in self.messages if len(payload) in message.SIZES)
        message = next(fitting, self.messages[0])
        return message.parse_payload(payload, **message.__held__(numbers))


class VirtualBytes:
    """Bytes of a part that is not sent, by the identities of frames."""

    def __init__(self, part: VirtualPart) -> None:
        default = part.default
        self._default = None if default is None else part.number.encode(default)
        self._listed: dict[Identity, bytes] = {}
        self._wide: list[tuple[Identities, bytes]] = []
        for identity, value in part.values:
            data = part.number.encode(value)
            if not isinstance(identity, Identities):
                self._listed[identity] = data
            elif identity.count <= _LISTED:
                self._listed |= dict.fromkeys(identity, data)
            else:
                self._wide.append((identity, data))

    def of(self, identity: Identity) -> bytes | None:
        """The bytes in frames of this identity; None where they are not known."""
        found = self._listed.get(identity)
        if found is None and self._wide:
            found = next((data for known, data in self._wide if identity in known), None)
        return self._default if found is None else found


class SenderSpec(Generic[MessageT_co, PartsT_co]):
    """An endpoint as a sender.

    `parts` is the dataclass of the parts that events show: identity, counters and values. Of
    messages that nothing tells apart, all but the one that a receiver takes them for are
    `encode_only`.
    """

    def __init__(
        self,
        name: str,
        frame: FrameSpec | Callable[[], FrameSpec],
        parts: type[PartsT_co],
        messages: tuple[type[MessageT_co], ...],
        encode_only: tuple[type[MessageT_co], ...] = (),
        cut: Cutter | None = None,
        form: str = "",
    ) -> None:
        """`frame` may be what makes the frame's description, when it is first needed.

        `form` names the form of its frames, where the endpoint has several.
        """
        self.name = name
        self.form = form
        self._frame = frame
        self.parts = parts
        self.messages = messages
        self.encode_only = encode_only
        self.cut = cut
        """Takes whole frames that are plainly in order; None where only the reference cuts them."""
        self.prefix: Any = None
        """Judge of the beginnings of frames, made by the first decoder that needs one."""

    @cached_property
    def frame(self) -> FrameSpec:
        """Declaration of the frame."""
        return self._frame() if callable(self._frame) else self._frame

    @cached_property
    def layout(self) -> Layout:
        """Places of the frame's parts."""
        return Layout(self.frame)

    @cached_property
    def _groups(self) -> Mapping[Identity, IdentityGroup[MessageT_co]]:
        groups: dict[Identity, tuple[type[MessageT_co], ...]] = {}
        for message in self.messages:
            groups[message.IDENTITY] = (*groups.get(message.IDENTITY, ()), message)
        part = self.layout.payload
        found = {key: IdentityGroup(value, part) for key, value in groups.items()}
        for message in self.messages:
            identities = message.IDENTITIES
            if identities is not None and identities.count <= _LISTED:
                found |= dict.fromkeys(identities, found[message.IDENTITY])
        return found

    @cached_property
    def _wide(self) -> tuple[tuple[Identities, IdentityGroup[MessageT_co]], ...]:
        """Groups of too many identities for a table."""
        return tuple(
            (message.IDENTITIES, self._groups[message.IDENTITY])
            for message in self.messages
            if message.IDENTITIES is not None and message.IDENTITIES.count > _LISTED
        )

    @property
    def key(self) -> str:
        """The endpoint's name, with that of the form behind it where there are several."""
        return f"{self.name}_{self.form}" if self.form else self.name

    def _compared(self) -> tuple[Any, ...]:
        return self.key, self.frame, self.parts, self.messages, self.encode_only

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, SenderSpec):
            return NotImplemented
        return self is other or self._compared() == other._compared()

    def __hash__(self) -> int:
        return hash(self._compared())

    def __repr__(self) -> str:
        return f"<what {self.key} sends: {', '.join(item.NAME for item in self.messages)}>"

    def group(self, identity: Identity) -> IdentityGroup[MessageT_co] | None:
        """The messages of an identity; None where it is unknown."""
        found = self._groups.get(identity)
        if found is None and self._wide:
            return next((group for known, group in self._wide if identity in known), None)
        return found

    def identity(self, numbers: Mapping[str, int]) -> Identity:
        """The identity among the values of a frame's parts."""
        return tuple(numbers[part.name] for part in self.layout.identity)

    def virtual(self, numbers: Mapping[str, int]) -> dict[str, bytes]:
        """The bytes of parts that are not sent, in a frame with these numbers.

        Those that have no value, because the identity is unknown, are left out.
        """
        identity = self.identity(numbers)
        found = {name: value.of(identity) for name, value in self._virtual.items()}
        return {name: data for name, data in found.items() if data is not None}

    @cached_property
    def _virtual(self) -> Mapping[str, VirtualBytes]:
        return {part.name: VirtualBytes(part) for part in self.frame.virtual}

    def without_value(self, part: ChecksumPart, virtual: Mapping[str, bytes]) -> str:
        """The first part that a checksum covers, is not sent and has no value; empty if none."""
        missing = (item.name for item in self.frame.virtual if item.name not in virtual)
        return next((name for name in missing if name in part.covers), "")

    def read(self, numbers: Mapping[str, int], payload: bytes) -> MessageT_co | None:
        """The message of a frame's parts; None where its identity is unknown.

        Raises PayloadError where the payload is not the message's: size, value or encoding.
        """
        group = self.group(self.identity(numbers))
        return None if group is None else group.read(payload, numbers)

    def told_among(self, numbers: Sequence[int]) -> dict[str, int]:
        """The values of the identity parts that are not sent, which come first in an event."""
        told = self.layout.told_identity
        return {part.name: value for part, value in zip(told, numbers, strict=False)}

    def show(self, numbers: Sequence[int]) -> PartsT_co:
        """The parts that an event shows, of their numbers."""
        texts = self.layout.texts
        if not texts:
            return self.parts(*numbers)
        values: list[int | str] = [*numbers]
        for index, characters in texts:
            values[index] = characters.text(numbers[index])
        return self.parts(*values)

    def choose_identity(
        self, message: type[Message], parts: Mapping[str, Any]
    ) -> tuple[Identity, dict[str, Any]]:
        """The identity of a message's frame, and the parts that are no identity.

        Raises EncodeError where `parts` have an identity that is not the message's.
        """
        others, chosen = dict(parts), []
        for index, part in enumerate(self.layout.identity):
            default = message.IDENTITY[index]
            value = others.pop(part.name, None)
            chosen.append(default if value is None else _one_of(message, index, part, value))
        return tuple(chosen), others

    def named(self, name: str) -> type[MessageT_co] | None:
        """The message called `name`, if this endpoint sends one."""
        every: tuple[Any, ...] = (*self.messages, *self.encode_only)
        return next((message for message in every if name == message.NAME), None)


def with_held(message: Message, parts: Mapping[str, Any]) -> dict[str, Any]:
    """The parts of a message's frame: those given, and those that it has as fields.

    Raises EncodeError where one is given that differs from the field.
    """
    found = dict(parts)
    for part, value in message.__holds__().items():
        if found.get(part) not in (None, value):
            problem = f"is {value}, as the message says, and not {found[part]!r}"
            raise EncodeError(part, problem)
        found[part] = value
    return found


def _one_of(message: type[Message], index: int, part: IdentityPart | ToldPart, value: Any) -> int:
    """A value of an identity part that the message can have. Raises EncodeError."""
    try:
        number = given_number(part.number, value)
    except EncodeError as error:
        raise error.inside(part.name) from None
    default = message.IDENTITY[index]
    runs = message.IDENTITIES.runs[index] if message.IDENTITIES else ((default, default),)
    if any(first <= number <= last for first, last in runs):
        return number
    shown = _shown(part, runs)
    raise EncodeError(part.name, f"{value!r} is not {message.NAME}, whose {part.name} is {shown}")


def _shown(part: IdentityPart | ToldPart, runs: Runs) -> str:
    """Values of an identity part, in words."""

    def word(value: int) -> str:
        number = part.number
        return repr(number.text(value)) if isinstance(number, Characters) else str(value)

    texts = (word(one) if one == other else f"{word(one)}..{word(other)}" for one, other in runs)
    return " or ".join(texts)
