"""Wrong ends that join two frames into one that checks.

Behind a frame and its checksum, many algorithms stand where they started: an exclusive or is 0, a
negated sum as well, and so is a CRC without `init` and `xorout`. If the wrong end leaves it at
that, the next frame checks as if it were alone. Instead of proving this for each algorithm, a few
pairs of frames are joined here by every possible wrong end.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from functools import partial
from random import Random

from protogen.model.frame import Frame
from protogen.model.framing import End, Start, StartLiteral, StartSet
from protogen.model.messages import Message
from protogen.model.parts import ChoicePart, LiteralPart, PayloadPart
from protogen.model.transparency import Base16, Cobs
from protogen.passes.framing.capacity import tail_literals
from protogen.passes.proofs.contents import has_checksum, put_checksum
from protogen.passes.proofs.wire_code import ByteSet, code_of

_PAIRS = 6
"""So many pairs of frames: that a wrong end joins all of them is no accident."""


def joined_frames(
    frame: Frame, start: Start, end: End | None, messages: list[Message], payload: ByteSet
) -> str:
    """The sentence about wrong ends; empty where none joins frames for sure."""
    if end is None or not frame.checksums or not _may_join(frame, start, messages):
        return ""
    ends = dict(_wrong_ends(frame, end, payload))
    dice = Random(0)  # noqa: S311 - the same samples each time
    some = partial(_frame, frame, payload, messages, dice)
    pairs = [(some(), some()) for _ in range(_PAIRS)]
    joining = [
        {wrong for wrong, read in ends.items() if _checks(frame, one, read, other)}
        for one, other in pairs
    ]
    always = set.intersection(*joining)
    if always:
        words = " or ".join(wrong.hex(" ").upper() for wrong in sorted(always)[:3])
        return f"a wrong end of {words} joins two frames into one that checks"
    if all(joining):
        return "a wrong end of one value, another for each frame, joins two into one that checks"
    return ""


def _may_join(frame: Frame, start: Start, messages: list[Message]) -> bool:
    """True if nothing but the end, and the checksum, tells two frames from one."""
    if frame.length is not None or isinstance(frame.encoding, Base16):
        return False
    if isinstance(start, StartLiteral | StartSet) and start.protected:
        return False
    if frame.encoding is not None and any(part.over_wire for part in frame.checksums):
        return False
    return _sizes_join(frame, messages)


def _sizes_join(frame: Frame, messages: list[Message]) -> bool:
    """True if some message can be as long as it and another one are together."""
    between = sum(part.size for part in frame.parts)
    filled = {sizes for message in messages if (sizes := message.sizes.within(1, 1 << 20))}
    groups = defaultdict(list)
    for message in messages:
        groups[message.told_by].append(message.sizes)
    for group in groups.values():
        for one in group:
            for other in filled:
                least = max(one.least, 1) + between + other.least
                if any(sizes.within(least, sizes.greatest) for sizes in group):
                    return True
    return False


def _wrong_ends(frame: Frame, end: End, payload: ByteSet) -> Iterator[tuple[bytes, bytes]]:
    """Each end with one wrong byte that can be data, and what it is read as."""
    if isinstance(frame.encoding, Cobs):
        # The code byte of an empty block; the one in front of it was the last of its frame.
        yield from [(b"\x01", b"\0\0")] if end.bytes == b"\0" else []
        return
    code = code_of(frame.encoding) or {}
    plain = frozenset(byte for byte in payload if code[byte] == bytes((byte,)))
    for place, right in enumerate(end.bytes):
        rest = end.bytes[:place] + end.bytes[place + 1 :]
        if plain.issuperset(rest):
            for byte in plain - {right}:
                wrong = end.bytes[:place] + bytes((byte,)) + end.bytes[place + 1 :]
                yield wrong, wrong


def _frame(
    frame: Frame, payload: ByteSet, messages: list[Message], dice: Random
) -> dict[str, bytes]:
    """The parts of some frame, the end left out, and what is not sent."""
    parts: dict[str, bytes] = {}
    for part in frame.parts:
        if isinstance(part, LiteralPart):
            parts[part.name] = part.bytes
        elif isinstance(part, ChoicePart):
            parts[part.name] = dice.choice(part.words)
        else:
            size = dice.randrange(3, 9) if isinstance(part, PayloadPart) else part.size
            parts[part.name] = bytes(dice.choices(sorted(payload), k=size))
    for virtual in frame.virtual:
        parts[virtual.name] = virtual.encode(dice.choice(messages).virtual_value(virtual) or 0)
    for checksum in frame.checksums:
        put_checksum(frame, checksum, parts)
    return parts


def _checks(frame: Frame, one: dict[str, bytes], between: bytes, other: dict[str, bytes]) -> bool:
    """True if two frames are one: what is between their payloads is payload then."""
    payload, ends = frame.payload.name, tail_literals(frame)
    tail = b"".join(one[part.name] for part in frame.tail if part not in ends)
    head = b"".join(other[part.name] for part in frame.head)
    joined = one | {part.name: other[part.name] for part in frame.tail}
    joined[payload] = one[payload] + tail + between + head + other[payload]
    return all(has_checksum(frame, checksum, joined) for checksum in frame.checksums)
