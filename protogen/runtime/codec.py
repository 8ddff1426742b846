"""Codec of a protocol: encode, decode, and an encoder that counts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, Generic

from protogen.runtime.decoder import BytesLike, Engine, check_engine, octets
from protogen.runtime.errors import DecodeError, EncodeError
from protogen.runtime.events import FrameEvent, UnknownEvent
from protogen.runtime.framing.assembly import encode_frame
from protogen.runtime.framing.frame import CounterPart
from protogen.runtime.framing.lines import encode_line as line_to_bytes
from protogen.runtime.framing.lines import split_parts
from protogen.runtime.framing.reading import read_frame
from protogen.runtime.framing.sender import MessageT_co, PartsT_co, SenderSpec
from protogen.runtime.payload.message import Message, build_payload


class Protocol(Generic[MessageT_co, PartsT_co]):
    """The codec of a protocol, made of what each endpoint sends."""

    def __init__(
        self, name: str, *senders: SenderSpec[MessageT_co, PartsT_co], spec_hash: str = ""
    ) -> None:
        self.name = name
        self.spec_hash = spec_hash
        """Hash of the layout, framing and meaning; both ends can compare it."""
        self.senders: Mapping[str, SenderSpec[MessageT_co, PartsT_co]] = {
            item.name: item for item in senders
        }

    def sender(self, name: str) -> SenderSpec[Any, Any]:
        """The sender called `name`. Raises ValueError if there is none."""
        found = self.senders.get(name)
        if found is None:
            names = " and ".join(self.senders)
            raise ValueError(f"{name!r} sends nothing in {self.name}; {names} do")
        return found

    def encode(
        self,
        message: Message,
        sender: str | None = None,
        strict: bool = True,
        engine: Engine = "construct",
        **parts: int | None,
    ) -> bytes:
        """The frame of a message, as the reference makes it.

        `sender` is needed only where several endpoints send the message in different frames;
        `parts` gives counters and other values of the frame. Raises EncodeError where a value is
        missing, out of range or does not fit; with `strict=False` only where it does not fit.
        """
        check_engine(engine)
        return _encode(self._sender_of(message, sender), message, parts, strict)

    def encode_unknown(self, sender: str, parts: Mapping[str, int], payload: bytes) -> bytes:
        """The frame of an unknown message; `parts` gives its identity, counters and values.

        Raises EncodeError where something is missing, or the identity belongs to a message.
        """
        spec = self.sender(sender)
        identity, given = split_parts(spec, parts)
        group = spec.group(identity)
        if group is not None:
            if not identity:
                problem = f"frames of {spec.name} have no identity, so none of them is unknown"
                raise EncodeError("message", problem)
            problem = f"{identity} is the identity of {group.messages[0].NAME}"
            raise EncodeError(spec.layout.identity[0].name, problem)
        return encode_frame(spec, identity, payload, given, strict=False)

    def encode_line(self, line: Mapping[str, Any]) -> bytes:
        """The bytes that a JSON line of a decoder stands for. Raises EncodeError."""
        if "sender" not in line:
            raise EncodeError("sender", f"is missing; it is one of {', '.join(self.senders)}")
        name = line["sender"]
        spec = self.senders.get(str(name))
        if spec is None:
            raise EncodeError("sender", f"{name!r} sends nothing; {', '.join(self.senders)} do")
        return line_to_bytes(spec, line)

    def read(self, frame: BytesLike, sender: str) -> FrameEvent[MessageT_co, PartsT_co]:
        """The event of exactly one valid frame. Raises DecodeError.

        Raises TypeError for what is not like bytes.
        """
        return read_frame(self.sender(sender), octets(frame))

    def decode(self, frame: BytesLike, sender: str, engine: Engine = "construct") -> MessageT_co:
        """The message of exactly one frame, as the reference reads it. Raises DecodeError.

        Raises TypeError for what is not like bytes.
        """
        check_engine(engine)
        event = self.read(frame, sender)
        if isinstance(event, UnknownEvent):
            raise DecodeError("unknown", f"no message has the identity of {event.parts}")
        return event.message

    def _sender_of(self, message: Message, name: str | None) -> SenderSpec[MessageT_co, PartsT_co]:
        senders = [item for item in self.senders.values() if _sends(item, message)]
        named = [item for item in senders if name in (item.name, None)]
        if not named:
            by = f"{name} does not send" if senders else f"{self.name} has no message"
            raise EncodeError("message", f"{by} {type(message).__name__}")
        if any(item.frame != named[0].frame for item in named):
            names = " or ".join(item.name for item in named)
            raise EncodeError("sender", f"{type(message).__name__} needs a sender: {names}")
        return named[0]


def _sends(sender: SenderSpec[Any, Any], message: Message) -> bool:
    return type(message) in sender.messages or type(message) in sender.encode_only


def _encode(
    sender: SenderSpec[Any, Any], message: Message, parts: Mapping[str, int | None], strict: bool
) -> bytes:
    payload = build_payload(message, strict)
    return encode_frame(sender, message.IDENTITY, payload, parts, strict)


class Encoder:
    """Makes the frames of one endpoint, one after another, and advances their counters."""

    def __init__(
        self, sender: SenderSpec[Any, Any], encode: Callable[..., bytes] | None = None
    ) -> None:
        """`encode` is the function of the generated module; else the reference encodes."""
        self._sender = sender
        self._name = sender.name
        self._encode = encode or self._encode_by_reference
        self._counters = {
            part.name: part for part in sender.layout.values if isinstance(part, CounterPart)
        }
        self._next = {
            name: part.least if part.default is None else part.default
            for name, part in self._counters.items()
        }

    def encode_next(self, message: Message, strict: bool = True, **parts: int | None) -> bytes:
        """The frame of a message, with the next value of each counter that `parts` does not give.

        A given value is used once and does not change the count, nor does an EncodeError.
        """
        if not _sends(self._sender, message):
            problem = f"{self._sender.name} does not send {type(message).__name__}"
            raise EncodeError("message", problem)
        counted = [name for name in self._counters if parts.get(name) is None]
        given = {**parts, **{name: self._next[name] for name in counted}}
        wire = self._encode(message, self._sender.name, strict, **given)
        self._count(counted)
        return wire

    def _count(self, counters: Iterable[str]) -> None:
        for name in counters:
            part, value = self._counters[name], self._next[name]
            self._next[name] = part.least if value >= part.greatest else value + 1

    def _encode_by_reference(
        self, message: Message, sender: str, strict: bool, **parts: int | None
    ) -> bytes:
        return _encode(self._sender, message, parts, strict)
