"""What one endpoint sends: its frame, and the messages that its frames can carry."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from protogen.runtime.constructs import prefix_size
from protogen.runtime.frame import FrameSpec
from protogen.runtime.layout import Layout
from protogen.runtime.message import Message

MessageT_co = TypeVar("MessageT_co", bound=Message, covariant=True)
PartsT_co = TypeVar("PartsT_co", covariant=True)

Identity = tuple[int, ...]

Cutter = Callable[[bytes, int, int, list[Any]], int]
"""Called with data, a place in them, the offset of the data in the input, and a list to which it
adds events. Gives the place of the first byte that it did not take."""

Waiter = Callable[[bytes, int], bool]
"""Called with data and a place in them where a frame may start. True: the rest of the data is the
beginning of a frame, and there can be no verdict on it before more bytes arrive."""


@dataclass(frozen=True, slots=True)
class Kin(Generic[MessageT_co]):
    """The messages that a receiver may find behind one identity: one, or more told by size."""

    messages: tuple[type[MessageT_co], ...]
    fixed: int | None = field(init=False)
    """The payload's size, where no message has another one."""
    greatest: int = field(init=False)
    """The greatest payload of these messages."""

    def __post_init__(self) -> None:
        sizes = {message.SIZES.fixed for message in self.messages}
        object.__setattr__(self, "fixed", sizes.pop() if len(sizes) == 1 else None)
        greatest = max(message.SIZES.greatest for message in self.messages)
        object.__setattr__(self, "greatest", greatest)

    def measure(self, start: bytes) -> int:
        """The size of the payload that starts so; PayloadError with `missing` if it is longer."""
        return prefix_size(self.messages[0].FORMAT, start)

    def read(self, payload: bytes) -> MessageT_co:
        """The message of a payload. Raises PayloadError: size, value or encoding."""
        fitting = (message for message in self.messages if len(payload) in message.SIZES)
        return next(fitting, self.messages[0]).parse_payload(payload)


@dataclass(frozen=True, slots=True)
class SenderSpec(Generic[MessageT_co, PartsT_co]):
    """What one endpoint sends.

    `parts` is the dataclass of the parts that events show: identity, counters and values. Of
    messages that nothing tells apart, all but the one that a receiver takes them for are
    `encode_only`.
    """

    name: str
    frame: FrameSpec
    parts: type[PartsT_co]
    messages: tuple[type[MessageT_co], ...]
    encode_only: tuple[type[MessageT_co], ...] = ()
    cut: Cutter | None = field(default=None, repr=False, compare=False)
    """Takes whole frames that are plainly in order; None where only the reference cuts them."""
    waits: Waiter | None = field(default=None, repr=False, compare=False)
    """Tells plain beginnings of frames; None where the reference takes all that is not whole."""
    layout: Layout = field(init=False, repr=False, compare=False)
    _kin: Mapping[Identity, Kin[MessageT_co]] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        kin: dict[Identity, tuple[type[MessageT_co], ...]] = {}
        for message in self.messages:
            kin[message.IDENTITY] = (*kin.get(message.IDENTITY, ()), message)
        object.__setattr__(self, "layout", Layout(self.frame))
        object.__setattr__(self, "_kin", {key: Kin(value) for key, value in kin.items()})

    def kin(self, identity: Identity) -> Kin[MessageT_co] | None:
        """The messages of an identity; None where it is unknown."""
        return self._kin.get(identity)

    def identity(self, numbers: Mapping[str, int]) -> Identity:
        """The identity among the values of a frame's parts."""
        return tuple(numbers[part.name] for part in self.layout.identity)

    def read(self, numbers: Mapping[str, int], payload: bytes) -> MessageT_co | None:
        """The message of a frame's parts; None where its identity is unknown.

        Raises PayloadError where the payload is not the message's: size, value or encoding.
        """
        kin = self.kin(self.identity(numbers))
        return None if kin is None else kin.read(payload)

    def named(self, name: str) -> type[MessageT_co] | None:
        """The message called `name`, if this endpoint sends one."""
        every: tuple[Any, ...] = (*self.messages, *self.encode_only)
        return next((message for message in every if name == message.NAME), None)
