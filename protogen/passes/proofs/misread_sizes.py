"""Wrong bytes that make a receiver look for the checksum in another place, and find one there.

What is there checks by chance, once in 2^w for a checksum of w bits.
"""

from __future__ import annotations

from protogen.model.frame import ChecksumPart, Frame, LengthPart
from protogen.model.framing import End
from protogen.model.messages import Message
from protogen.model.sizes import SizeSet
from protogen.passes.framing.capacity import payload_range

_BY_CHANCE = "where the bytes there happen to check"


def misread_size(frame: Frame, end: End | None, messages: list[Message]) -> str:
    """The sentence about wrong sizes; empty where none goes unnoticed."""
    if end is not None and end.protected:
        return ""  # It then stands in the wrong place.
    if frame.length is not None:
        return _wrong_length(frame, frame.length, messages)
    return _wrong_field(frame, messages) if end is None else ""


def misread_absence(frame: Frame, messages: list[Message]) -> str:
    """The sentence about lengths that claim that there is no payload, and so no checksum."""
    length = frame.length
    optional = any(part.when_payload for part in frame.checksums)
    always = any(not part.when_payload for part in frame.checksums)
    if length is None or not optional or always:
        return ""
    if not any(0 in sizes and sizes.fixed is None for sizes in _acceptable(frame, messages)):
        return ""
    return f"a wrong `{length.name}` that says that there is no payload: then nothing is checked"


def _wrong_length(frame: Frame, length: LengthPart, messages: list[Message]) -> str:
    if all(sizes.fixed is not None for sizes in _acceptable(frame, messages)):
        return ""  # Its message can't have that size.
    if _settled_early(frame, length):
        return ""
    behind = [part for part in frame.checksums if part in frame.tail]
    if not frame.checksums:
        return f"a wrong `{length.name}`: nothing checks it"
    if not behind:
        return f"a wrong `{length.name}`, where so many bytes happen to check"
    return f"a wrong `{length.name}`, which moves where {_names(behind)} is read, {_BY_CHANCE}"


def _wrong_field(frame: Frame, messages: list[Message]) -> str:
    """Identity and fields tell the size here, and a wrong one another size."""
    behind = [part for part in frame.checksums if part in frame.tail]
    sizes = {message.sizes for message in messages}
    one_size = len(sizes) < 2 and all(item.fixed is not None for item in sizes)
    if not behind or one_size:
        return ""
    return f"a wrong byte that moves where {_names(behind)} is read, {_BY_CHANCE}"


def _acceptable(frame: Frame, messages: list[Message]) -> list[SizeSet]:
    """The payload sizes that a receiver takes from a sender, for each identity that it has read.

    Behind the payload, another size makes another identity of it.
    """
    first = set(frame.identity) <= set(frame.head)
    groups: dict[tuple[int, ...], SizeSet] = {}
    for message in messages:
        key = message.identity if first else ()
        groups[key] = groups[key] | message.sizes if key in groups else message.sizes
    stated = payload_range(frame)
    bounded = (
        sizes if stated is None else sizes.within(stated.least, stated.greatest) or sizes
        for sizes in groups.values()
    )
    return list(bounded)


def _settled_early(frame: Frame, length: LengthPart) -> bool:
    """True if a checksum of the header alone covers the length."""
    return any(
        length.name in part.covers
        and not part.when_payload
        and part in frame.head
        and frame.payload.name not in part.covers
        for part in frame.checksums
    )


def _names(parts: list[ChecksumPart]) -> str:
    return " and ".join(f"`{part.name}`" for part in parts)
