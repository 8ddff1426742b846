"""Forms of frame of examples that do not say theirs: told by what their bytes can be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from protogen.model.frame import Frame
from protogen.model.identities import Runs
from protogen.model.messages import Message
from protogen.model.numbers import codec
from protogen.model.parts import BitsPart, ChoicePart, LiteralPart, NumberPart, Part, PayloadPart
from protogen.passes.framing.capacity import head_literals, joined_words, tail_literals
from protogen.runtime.errors import ByteError


def likeliest_form(frames: Mapping[str, Frame], message: Message, data: bytes | None) -> str | None:
    """The sender whose frame these bytes can be; None where there are no frames.

    Of several, or where none is right, it is the first one that begins with the same literals.
    """
    if data is None:
        return next(iter(frames), None)
    right = [name for name, frame in frames.items() if _can_be(frame, message, data)]
    begun = [name for name, frame in frames.items() if _begins(frame, data)]
    return next(iter((*right, *begun, *frames)), None)


def _begins(frame: Frame, data: bytes) -> bool:
    """True if a frame can begin as these bytes do."""
    return data.startswith(joined_words(head_literals(frame)))


def _can_be(frame: Frame, message: Message, data: bytes) -> bool:
    """True if nothing in front of stuffing and payload says that it is no frame of the message."""
    names = [part.name for part in frame.identity]
    runs = dict(zip(names, message.told_by.runs, strict=False))
    offset = 0
    for part in frame.parts:
        if isinstance(part, PayloadPart) or part.name in frame.stuffed:
            break
        piece = data[offset : offset + part.size]
        if len(piece) < part.size or not _can_be_part(part, piece, runs):
            return False
        offset += part.size
    return data.endswith(joined_words(tail_literals(frame)))


def _can_be_part(part: Part, data: bytes, identity: Mapping[str, Runs]) -> bool:
    """True if a part can have these bytes, where the identity's parts have values of these runs."""
    match part:
        case LiteralPart():
            return data == part.bytes
        case ChoicePart():
            return data in part.words
        case BitsPart():
            bits = codec(part.type).decode(data)
            fixed = bits & part.mask == part.fixed
            return fixed and all(_holds(item, data, identity) for item in part.members)
        case NumberPart():
            return _holds(part, data, identity)
    return True


def _holds(part: NumberPart, data: bytes, identity: Mapping[str, Runs]) -> bool:
    try:
        value = codec(part.type).decode(data)
    except ByteError:
        return False
    runs: Sequence[tuple[int, int]] = identity.get(part.name, ((value, value),))
    return part.holds(value) and any(first <= value <= last for first, last in runs)
