"""Codec of a protocol: encode, decode, and an encoder that counts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Generic

from protogen.runtime.attributes import arguments, schema_name
from protogen.runtime.decoder import BytesLike, Engine, check_engine, octets
from protogen.runtime.errors import DecodeError, EncodeError
from protogen.runtime.events import FrameEvent, UnknownEvent
from protogen.runtime.framing.assembly import encode_frame, first_that_fits
from protogen.runtime.framing.frame import CounterPart
from protogen.runtime.framing.lines import encode_line as line_to_bytes
from protogen.runtime.framing.lines import split_parts
from protogen.runtime.framing.reading import read_frame
from protogen.runtime.framing.sender import MessageT_co, PartsT_co, SenderSpec, with_held
from protogen.runtime.framing.told import Told
from protogen.runtime.line import Exchange, Line
from protogen.runtime.payload.message import Message, build_payload
from protogen.runtime.payload.number import GivenValue


class Protocol(Generic[MessageT_co, PartsT_co]):
    """The codec of a protocol, made of what each endpoint sends."""

    def __init__(
        self,
        name: str,
        *senders: SenderSpec[MessageT_co, PartsT_co],
        spec_hash: str = "",
        line: Line | None = None,
        exchanges: tuple[Exchange, ...] = (),
    ) -> None:
        self.name = name
        self.spec_hash = spec_hash
        """Hash of the layout, framing and meaning; both ends can compare it."""
        self.senders: Mapping[str, SenderSpec[MessageT_co, PartsT_co]] = {
            item.key: item for item in senders
        }
        """Endpoints as senders; one with several forms of frame is there once for each of them."""
        self.endpoints = tuple(dict.fromkeys(item.name for item in senders))
        """Names of the endpoints that send."""
        self.line = Line(self.endpoints) if line is None else line
        """Settings of the line."""
        self.exchanges = exchanges
        """Which message answers which."""

    def sender(self, name: str, form: str | None = None) -> SenderSpec[Any, Any]:
        """The sender called `name`, in one form of frame.

        Raises ValueError if there is none, or if there are several and none is chosen.
        """
        found = self.forms(name, form)
        if len(found) > 1:
            forms = ", ".join(item.form for item in found)
            raise ValueError(f"{name} sends frames of several forms: {forms}")
        return found[0]

    def forms(
        self, name: str | None = None, form: str | None = None
    ) -> tuple[SenderSpec[Any, Any], ...]:
        """An endpoint as a sender, in each form of its frames or in one; without a name all.

        Raises ValueError if there is none.
        """
        of_name = [item for item in self.senders.values() if name in (None, item.name, item.key)]
        if not of_name:
            names = " and ".join(self.endpoints)
            raise ValueError(f"{name!r} sends nothing in {self.name}; {names} do")
        found = tuple(item for item in of_name if form in (None, item.form))
        if not found:
            forms = ", ".join(item.form for item in of_name if item.form) or "only one"
            raise ValueError(f"{name} has no form of frame {form!r}; it has {forms}")
        return found

    def encode(
        self,
        message: Message,
        sender: str | None = None,
        strict: bool = True,
        engine: Engine = "construct",
        form: str | None = None,
        **parts: GivenValue,
    ) -> bytes:
        """The frame of a message, as the reference makes it.

        `sender` is needed only where several endpoints send the message in different frames;
        `parts` gives counters and other values of the frame; one called `class` or `message` is
        given as `class_` or `message_`. Of several forms of frame, the first that fits is taken
        unless `form` names one. Raises EncodeError where a value is missing, out of range or does
        not fit; with `strict=False` only where it does not fit.
        """
        check_engine(engine)
        return _encode(self._senders_of(message, sender, form), message, _named(parts), strict)

    def encode_unknown(
        self, sender: str, parts: Mapping[str, GivenValue], payload: bytes, form: str | None = None
    ) -> bytes:
        """The frame of an unknown message; `parts` gives its identity, counters and values.

        Raises EncodeError where something is missing, or the identity belongs to a message.
        """
        spec = self.sender(sender, form)
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
        senders = self._senders_of_line(line)
        return first_that_fits(senders, lambda item: line_to_bytes(item, line))

    def _senders_of_line(self, line: Mapping[str, Any]) -> Sequence[SenderSpec[Any, Any]]:
        if "sender" not in line:
            if line.get("event") == "invalid":
                return tuple(self.senders.values())
            raise EncodeError("sender", f"is missing; it is one of {', '.join(self.endpoints)}")
        name, form = line["sender"], line.get("form")
        specs = [item for item in self.senders.values() if item.name == name]
        if not specs:
            raise EncodeError("sender", f"{name!r} sends nothing; {', '.join(self.endpoints)} do")
        named = [item for item in specs if form in (None, item.form)]
        if not named:
            forms = ", ".join(item.form for item in specs if item.form) or "only one"
            raise EncodeError("form", f"{form!r} is no form of frame of {name}; it has {forms}")
        return named

    def read(
        self,
        frame: BytesLike,
        sender: str | None = None,
        told: Mapping[str, int] | None = None,
    ) -> FrameEvent[MessageT_co, PartsT_co]:
        """The event of exactly one valid frame. Raises DecodeError.

        Without `sender`, any endpoint may have sent it. `told` has the parts that are not sent, by
        their names; without a length it is that of these bytes. Raises TypeError for what is not
        like bytes, ValueError for what can't be told.
        """
        senders = self.forms(sender)
        given = Told(senders)
        given.tell(told or {})
        return read_frame(senders, octets(frame), given.of_one_frame(told or {}))

    def decode(
        self,
        frame: BytesLike,
        sender: str | None = None,
        engine: Engine = "construct",
        told: Mapping[str, int] | None = None,
    ) -> MessageT_co:
        """The message of exactly one frame, as the reference reads it. Raises DecodeError.

        Without `sender`, any endpoint may have sent it. `told` has the parts that are not sent, by
        their names; without a length it is that of these bytes. Raises TypeError for what is not
        like bytes, ValueError for what can't be told.
        """
        check_engine(engine)
        event = self.read(frame, sender, told)
        if isinstance(event, UnknownEvent):
            raise DecodeError("unknown", f"no message has the identity of {event.parts}")
        return event.message

    def _senders_of(
        self, message: Message, name: str | None, form: str | None
    ) -> Sequence[SenderSpec[MessageT_co, PartsT_co]]:
        """An endpoint that sends the message, in the forms that carry it."""
        senders = [item for item in self.senders.values() if _sends(item, message)]
        named = [item for item in senders if name in (item.name, item.key, None)]
        if not named:
            by = f"{name} does not send" if senders else f"{self.name} has no message"
            raise EncodeError("message", f"{by} {type(message).__name__}")
        by_name: dict[str, list[SenderSpec[MessageT_co, PartsT_co]]] = {}
        for item in named:
            by_name.setdefault(item.name, []).append(item)
        first, *others = by_name.values()
        frames = [item.frame for item in first]
        if any([item.frame for item in other] != frames for other in others):
            names = " or ".join(by_name)
            raise EncodeError("sender", f"{type(message).__name__} needs a sender: {names}")
        chosen = [item for item in first if form in (None, item.form)]
        if not chosen:
            forms = ", ".join(item.form for item in first if item.form) or "only one"
            name = type(message).__name__
            raise EncodeError("form", f"{form!r} is no form of frame for {name}; there is {forms}")
        return chosen


def _named(parts: Mapping[str, GivenValue]) -> dict[str, GivenValue]:
    """Arguments by the schema's names of the parts."""
    return {schema_name(name): value for name, value in parts.items()}


def _sends(sender: SenderSpec[Any, Any], message: Message) -> bool:
    return type(message) in sender.messages or type(message) in sender.encode_only


def _encode(
    senders: Sequence[SenderSpec[Any, Any]],
    message: Message,
    parts: Mapping[str, GivenValue],
    strict: bool,
) -> bytes:
    """The frame in the first form that fits."""
    payload = build_payload(message, strict)
    return first_that_fits(senders, lambda item: _frame(item, message, payload, parts, strict))


def _frame(
    sender: SenderSpec[Any, Any],
    message: Message,
    payload: bytes,
    parts: Mapping[str, GivenValue],
    strict: bool,
) -> bytes:
    identity, given = sender.choose_identity(type(message), with_held(message, parts))
    carried = sender.layout.payload.trimmed(payload)
    return encode_frame(sender, identity, carried, given, strict)


class Encoder:
    """Makes the frames of one endpoint, one after another, and advances their counters."""

    def __init__(
        self,
        sender: SenderSpec[Any, Any] | Sequence[SenderSpec[Any, Any]],
        encode: Callable[..., bytes] | None = None,
    ) -> None:
        """`sender` may be an endpoint in several forms of its frames.

        `encode` is the function of the generated module; else the reference encodes.
        """
        self._senders = (sender,) if isinstance(sender, SenderSpec) else tuple(sender)
        self._name = self._senders[0].name
        self._encode: Callable[..., bytes] = encode or self._encode_by_reference
        self._counters = {part.name: part for item in self._senders for part in _counters(item)}
        self._next = {
            name: part.least if part.default is None else part.default
            for name, part in self._counters.items()
        }

    def encode_next(self, message: Message, strict: bool = True, **parts: GivenValue) -> bytes:
        """The frame of a message, with the next value of each counter that `parts` does not give.

        Of several forms, it is of the first that fits. A given value is used once and does not
        change the count, nor does an EncodeError.
        """
        senders = [sender for sender in self._senders if _sends(sender, message)]
        if not senders:
            problem = f"{self._name} does not send {type(message).__name__}"
            raise EncodeError("message", problem)
        named = _named(parts)
        return first_that_fits(senders, lambda item: self._frame(item, message, strict, named))

    def preview(self, message: Message, strict: bool = True, **parts: GivenValue) -> bytes:
        """The frame that `encode_next` would make now. Nothing is counted."""
        kept = dict(self._next)
        try:
            return self.encode_next(message, strict, **parts)
        finally:
            self._next = kept

    def _frame(
        self,
        sender: SenderSpec[Any, Any],
        message: Message,
        strict: bool,
        parts: Mapping[str, GivenValue],
    ) -> bytes:
        counted = [part.name for part in _counters(sender) if parts.get(part.name) is None]
        given = arguments({**parts, **{name: self._next[name] for name in counted}})
        form: dict[str, Any] = {"form": sender.form} if sender.form else {}
        wire = self._encode(message, self._name, strict, **form, **given)
        self._count(counted)
        return wire

    def _count(self, counters: Iterable[str]) -> None:
        for name in counters:
            part, value = self._counters[name], self._next[name]
            self._next[name] = part.least if value >= part.greatest else value + 1

    def _encode_by_reference(
        self,
        message: Message,
        sender: str,
        strict: bool,
        form: str = "",
        **parts: GivenValue,
    ) -> bytes:
        own = [item for item in self._senders if item.form == form]
        return _encode(own, message, _named(parts), strict)


def _counters(sender: SenderSpec[Any, Any]) -> list[CounterPart]:
    return [part for part in sender.layout.values if isinstance(part, CounterPart)]
