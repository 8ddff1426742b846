"""Promises of the generated codec of any schema; each function checks one."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from types import ModuleType
from typing import Any

import pytest

from protogen.model.framing import Anywhere, StartLiteral, StartSet
from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender
from protogen.runtime.api import EncodeError
from protogen.runtime.attributes import arguments, attribute, held_arguments
from protogen.runtime.constructs import PayloadError, Whole
from schema_fuzzing.held import held_of, held_parts
from schema_fuzzing.reference import frame_bytes, payload_bytes
from schema_fuzzing.values import all_parts


def check_payload(module: ModuleType, message: Message, values: dict[str, Any]) -> Any:
    """values -> payload -> values; the payload is the reference's. Returns the message.

    None where the payload is larger than all frames allow, as several fields that fill it can be.
    """
    made = module.MESSAGES[message.name].from_dict(values)
    assert made.to_dict() == values
    expected = payload_bytes(message.fields, values, {})
    if len(expected) > message.sizes.greatest:
        return None
    payload = made.to_payload()
    assert payload == expected
    assert len(payload) in message.sizes
    held = held_arguments(held_of(message, values))
    check_format(type(made).FORMAT, payload, held, one_spelling=message.plan.has_one_spelling)
    read = type(made).from_payload(payload, **held)
    assert read == made
    assert read.to_dict() == values
    assert not [violation for violation in made.violations() if violation.forbidden]
    return made


def check_format(
    format: Any, payload: bytes, held: Mapping[str, int], *, one_spelling: bool
) -> None:
    """Values that `FORMAT` parses build the same bytes; other bytes are an error with its place.

    Where values have several spellings, they build bytes that have the same values.
    """
    assert format.build(Whole(format).parse(payload, **held)) == payload
    for wire in (payload[:-1], payload[1:], payload + b"\1"):
        try:
            parsed = Whole(format).parse(wire, **held)
        except PayloadError as error:
            assert 0 <= error.offset <= len(wire)
        else:
            built = format.build(parsed)
            same = built == wire if one_spelling else Whole(format).parse(built, **held) == parsed
            assert same or "nan" in repr(parsed)


def shown_parts(
    sender: Sender, message: Message, made: Any, parts: dict[str, int | str]
) -> dict[str, int | str]:
    """The parts that an event shows of a frame for which these were given."""
    return all_parts(sender.frame, message, parts | held_parts(message, made.to_dict()))


def encode(
    module: ModuleType, sender: Sender, message: Message, made: Any, parts: dict[str, int | str]
) -> bytes | None:
    """The frame, which is the reference's; None where the schema allows that there is none.

    An end that nothing protects may stand in the payload: then a decoder would cut the frame there.
    """
    try:
        frame: bytes = module.encode(made, sender.name, engine="construct", **arguments(parts))
    except EncodeError as error:
        with pytest.raises(EncodeError, match=re.escape(str(error))):
            module.encode(made, sender.name, **arguments(parts))
        # Of several forms of frame, this one may be for other sizes.
        too_large = len(made.to_payload()) not in sender.framing.payload
        shown = shown_parts(sender, message, made, parts)
        wire = frame_bytes(sender.frame, message, made.to_payload(), shown)
        limit = sender.frame.limit
        too_large |= limit is not None and len(wire) > limit
        length = sender.frame.length
        too_large |= length is not None and length.over_wire and "makes " in str(error)
        assert too_large or (sender.framing.cut_ambiguous and "decoder" in str(error)), error
        return None
    assert module.encode(made, sender.name, **arguments(parts)) == frame
    shown = shown_parts(sender, message, made, parts)
    assert frame == frame_bytes(sender.frame, message, made.to_payload(), shown)
    return frame


def check_frame(sender: Sender, message: Message, frame: bytes) -> None:
    """The sizes of the model hold, and protected delimiters stand only in their places."""
    framing = sender.framing
    bounds = next(item for item in framing.messages if item.message == message.name)
    assert framing.least <= bounds.least <= len(frame) <= bounds.greatest <= framing.greatest
    start, end = framing.start, framing.end
    ends = {len(frame) - len(end.bytes)} if end is not None else set()
    if end is not None:
        assert frame.endswith(end.bytes)
    if end is not None and end.protected:
        assert _places(frame, end.bytes) <= ends | {0}
    if isinstance(start, StartLiteral):
        assert frame.startswith(start.bytes)
        if start.protected:
            assert _places(frame, start.bytes) <= ends | {0}
    if isinstance(start, StartSet):
        assert frame.startswith(start.words)
        assert not (start.protected and any(word in frame[1:] for word in start.words))


def _places(data: bytes, literal: bytes) -> set[int]:
    return {place for place in range(len(data)) if data.startswith(literal, place)}


def check_decoded(
    module: ModuleType,
    sender: Sender,
    message: Message,
    frame: bytes,
    made: Any,
    shown: dict[str, int | str],
) -> None:
    """frame -> message, as one event and by `decode`."""
    told = sender.plan.told_before(message, shown, len(frame))
    (event,) = events_of(module, sender, [frame], told=told)
    assert event.kind == "message", event
    assert (event.offset, event.raw, event.message) == (0, frame, made)
    assert {name: getattr(event.parts, attribute(name)) for name in shown} == shown
    given = {"told": told} if told else {}
    assert module.decode(frame, sender.name, **given) == made
    assert module.decode(frame, sender.name, engine="construct", **given) == made
    assert event.payload == made.to_payload()


def events_of(
    module: ModuleType,
    sender: Sender,
    data: Iterable[bytes],
    engine: str = "fast",
    told: Mapping[str, int] | None = None,
) -> list[Any]:
    """The events of portions of a stream, with its end; what is told is so in front of it."""
    decoder = module.Decoder(sender.name, engine)
    decoder.tell(**arguments(told or {}))
    return _events(decoder, data, _most_kept(sender))


def events_of_several(
    module: ModuleType, name: str | None, data: Iterable[bytes], most: int, engine: str = "fast"
) -> list[Any]:
    """The events of all forms of an endpoint's frames; without a name, of all endpoints.

    Raises ValueError where the frames of endpoints are not found in one way.
    """
    return _events(module.Decoder(name, engine), data, most)


def _events(decoder: Any, data: Iterable[bytes], most: int) -> list[Any]:
    events: list[Any] = []
    for portion in data:
        events += decoder.feed(portion)
        assert decoder.pending <= most
    events += decoder.flush()
    return events


def most_kept(senders: Iterable[Sender]) -> int:
    """The bytes that a decoder of several forms may keep: what one of them may, or the next."""
    return max(map(_most_kept, senders))


def _most_kept(sender: Sender) -> int:
    """The bytes that a decoder may keep between calls.

    That is one greatest frame; but behind noise or a failed candidate of about that size the
    beginning of a start may stand, and where those end is not known before the start is decided.
    Where a silence ends it, it is one byte more, and where nothing marks its start either, the
    noise of one more frame may stand in front.
    """
    if sender.plan.ends_idle and isinstance(sender.framing.start, Anywhere):
        return 2 * sender.plan.given_up_at
    start = sender.framing.start
    beginning = len(start.bytes) - 2 if isinstance(start, StartLiteral) else 0
    if isinstance(start, StartSet):
        beginning = len(start.words[0]) - 2
    return sender.plan.given_up_at + max(0, beginning)


def check_lossless(
    module: ModuleType, senders: Sequence[Sender], data: bytes, events: Sequence[Any]
) -> None:
    """The raw bytes of the events are the input, and each can be made again from its line."""
    assert b"".join(event.raw for event in events) == data
    offset = 0
    for event in events:
        assert event.offset == offset
        offset += event.size
        line = event.as_json()
        assert module.PROTOCOL.encode_line(line) == event.raw
        may_differ = any(_may_differ(sender, line) for sender in senders)
        assert event.kind == "invalid" or "raw" not in line or may_differ


def _may_differ(sender: Sender, line: dict[str, Any]) -> bool:
    """True if encoding may give other bytes.

    That is so for stuffing that was accepted although no encoder makes it, for the payload of a
    NaN, for numbers that an encoder writes in another way, for texts that are not ASCII, and for a
    frame whose start is the end of the frame before.
    """
    if not str(line.get("parts", "")).isascii():
        return True
    if not all(message.plan.has_one_spelling for message in sender.messages):
        return True
    if sender.plan.is_fitted:
        return True
    start, end, transparency = sender.framing.start, sender.framing.end, sender.frame.transparency
    is_shared = isinstance(start, StartLiteral) and end is not None and start.bytes == end.bytes
    return is_shared or (transparency is not None and transparency.lenient) or "nan" in str(line)


def senders_of(protocol: Protocol, message: Message) -> list[Sender]:
    """The senders of a message that decode to it: not those that take it for another one."""
    return [
        sender
        for sender in protocol.senders
        if sender.sends(message)
        and not any(
            overload.yields not in (None, message.name)
            for overload in sender.overloads
            if message.name in overload.messages
        )
    ]
