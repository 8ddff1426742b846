"""Events of a decoder: each covers some bytes of the input.

The raw bytes of all events, joined, are the input.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Generic, Literal, Self

from protogen.runtime.attributes import attribute
from protogen.runtime.errors import EncodeError, Reason
from protogen.runtime.framing.extraction import payload_of
from protogen.runtime.framing.lines import encode_line
from protogen.runtime.framing.machine import Cut
from protogen.runtime.framing.sender import MessageT_co, PartsT_co, SenderSpec
from protogen.runtime.values import Frozen, Value


class MessageEvent(Value, Generic[MessageT_co, PartsT_co]):
    """A valid frame of a known message."""

    __slots__ = ("codec", "kept_parts", "message", "numbers", "offset", "raw")
    __fields__ = ("offset", "raw", "numbers", "message", "codec")

    kind: ClassVar[Literal["message"]] = "message"

    offset: int
    """Of the first byte, counted from the start of the input."""
    raw: bytes
    """The bytes on the wire."""
    numbers: tuple[int, ...]
    """The values of `parts`, in their order."""
    message: MessageT_co
    codec: SenderSpec[Any, Any]
    kept_parts: PartsT_co | None
    """The `parts`, from when they are first asked for; None before."""

    # Not frozen, without a constructor, and what the raw bytes tell worked out when it is asked
    # for: of some streams a second holds millions.

    def __replace__(self, /, **changes: Any) -> Self:
        event = type(self)()
        event.kept_parts = None
        for name in self.__fields__:
            setattr(event, name, changes.pop(name) if name in changes else getattr(self, name))
        if changes:
            raise TypeError(f"a message event has no field {next(iter(changes))!r}")
        return event

    def __hash__(self) -> int:
        return hash((self.offset, self.raw))  # A message may be changed, and has no hash.

    @property
    def sender(self) -> str:
        """The endpoint whose bytes are decoded."""
        return self.codec.name

    @property
    def form(self) -> str:
        """The form of the frame; empty where the endpoint has only one."""
        return self.codec.form

    @property
    def parts(self) -> PartsT_co:
        """The frame's identity, counters and values."""
        parts = self.kept_parts
        if parts is None:
            parts = self.kept_parts = self.codec.show(self.numbers)
        return parts

    @property
    def payload(self) -> bytes:
        """The message's bytes: with zeros that a frame leaves out, without what is not known."""
        told = self.codec.told_among(self.numbers)
        payload, part = payload_of(self.codec, self.raw, told), self.codec.layout.payload
        if not part.is_fitted:
            return payload
        numbers = dict(zip(self.codec.layout.shown, self.numbers, strict=True))
        return part.fitted(payload, self.message.__known_of__(payload, numbers))

    def __repr__(self) -> str:
        shown = ("offset", "raw", "sender", "parts", "message")
        return f"MessageEvent({', '.join(f'{name}={getattr(self, name)!r}' for name in shown)})"

    @property
    def size(self) -> int:
        """Bytes on the wire."""
        return len(self.raw)

    def as_json(self) -> dict[str, Any]:
        """A line for JSON. It has `raw` where encoding it would give other bytes."""
        line = _line(self, message=self.message.NAME)
        line["parts"] = _parts(self.parts, self.codec)
        line["fields"] = self.message.to_dict()
        return _exact(line, self.raw, self.codec)


class UnknownEvent(Frozen, Generic[PartsT_co]):
    """A valid frame whose identity belongs to no message."""

    __slots__ = ("codec", "offset", "parts", "payload", "raw", "sender")
    __compared__ = ("offset", "raw", "sender", "parts", "payload")

    kind: ClassVar[Literal["unknown"]] = "unknown"

    offset: int
    raw: bytes
    sender: str
    parts: PartsT_co
    payload: bytes
    codec: SenderSpec[Any, Any]

    def __init__(
        self,
        offset: int,
        raw: bytes,
        sender: str,
        parts: PartsT_co,
        payload: bytes,
        codec: SenderSpec[Any, Any],
    ) -> None:
        self._set(offset, raw, sender, parts, payload, codec)

    @property
    def form(self) -> str:
        """The form of the frame; empty where the endpoint has only one."""
        return self.codec.form

    @property
    def size(self) -> int:
        """Bytes on the wire."""
        return len(self.raw)

    def as_json(self) -> dict[str, Any]:
        """A line for JSON. It has `raw` where encoding it would give other bytes."""
        line = _line(self)
        line["parts"] = _parts(self.parts, self.codec)
        line["payload"] = self.payload.hex()
        return _exact(line, self.raw, self.codec)


class InvalidEvent(Frozen):
    """Bytes that are no frame."""

    __slots__ = ("offset", "problem", "raw", "reason", "sender")
    __compared__ = ("offset", "raw", "sender", "reason")

    kind: ClassVar[Literal["invalid"]] = "invalid"

    offset: int
    raw: bytes
    sender: str
    """The endpoint whose bytes are decoded; empty where there are several."""
    form: ClassVar[str] = ""
    reason: Reason
    problem: str
    """The reason in more words."""

    def __init__(
        self, offset: int, raw: bytes, sender: str, reason: Reason, problem: str = ""
    ) -> None:
        set_field = object.__setattr__  # Faster than `_set`: a damaged stream has many of these.
        set_field(self, "offset", offset)
        set_field(self, "raw", raw)
        set_field(self, "sender", sender)
        set_field(self, "reason", reason)
        set_field(self, "problem", problem)

    @property
    def size(self) -> int:
        """Bytes on the wire."""
        return len(self.raw)

    def as_json(self) -> dict[str, Any]:
        """A line for JSON, with the reason and the bytes."""
        line = _line(self)
        line["reason"] = self.reason
        line["raw"] = self.raw.hex()
        return line


FrameEvent = MessageEvent[MessageT_co, PartsT_co] | UnknownEvent[PartsT_co]
Event = MessageEvent[MessageT_co, PartsT_co] | UnknownEvent[PartsT_co] | InvalidEvent


def frame_event(
    sender: SenderSpec[MessageT_co, PartsT_co],
    cut: Cut,
    message: MessageT_co | None,
    raw: bytes,
    offset: int,
) -> FrameEvent[MessageT_co, PartsT_co]:
    """The event of a complete frame; no message: its identity is unknown."""
    numbers = tuple(cut.numbers[name] for name in sender.layout.shown)
    if message is None:
        parts = sender.show(numbers)
        return UnknownEvent(offset, raw, sender.name, parts, cut.payload, sender)
    event: MessageEvent[MessageT_co, PartsT_co] = MessageEvent()
    event.offset, event.raw, event.numbers = offset, raw, numbers
    event.message, event.codec, event.kept_parts = message, sender, None
    return event


def _line(event: Any, **named: str) -> dict[str, Any]:
    line = {"offset": event.offset, "size": event.size, "event": event.kind, **named}
    if event.sender:
        line["sender"] = event.sender
    if event.form:
        line["form"] = event.form
    return line


def _parts(parts: Any, codec: SenderSpec[Any, Any]) -> dict[str, int]:
    return {name: getattr(parts, attribute(name)) for name in codec.layout.shown}


def _exact(line: dict[str, Any], raw: bytes, codec: SenderSpec[Any, Any]) -> dict[str, Any]:
    if not _gives_back(line, raw, codec):
        line["raw"] = raw.hex()
    return line


def _gives_back(line: Mapping[str, Any], raw: bytes, codec: SenderSpec[Any, Any]) -> bool:
    try:
        return encode_line(codec, line) == raw
    except EncodeError:
        return False
