"""Seeded streams: whole frames mixed with noise and damaged frames, and where the whole ones stand.

Everything follows from the frames and the seed, so that a stream can be made again from its seed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import islice
from pathlib import Path
from random import Random

from compiled import module_at, protocol_of

from protogen.fuzzing.samples import boundary_rounds, samples
from protogen.model.messages import Message
from protogen.model.parts import ChoicePart, NumberPart
from protogen.model.protocol import Sender
from protogen.runtime.attributes import arguments
from protogen.runtime.errors import EncodeError
from protogen.runtime.framing.frame import LiteralPart, StartSet, StartWords

WHOLE = "whole"
"""The kind of a piece that is an undamaged frame."""


@dataclass(frozen=True)
class Material:
    """Pieces of streams: frames, and bytes that a receiver could take for parts of them."""

    frames: tuple[bytes, ...]
    marks: bytes
    """Delimiters, escapes and identities, each as one byte."""


@dataclass(frozen=True)
class Piece:
    """Some bytes of a stream, and what they are."""

    kind: str
    data: bytes


@dataclass(frozen=True)
class Stream:
    """Bytes, and where in them undamaged frames stand: offset and bytes of each."""

    data: bytes
    frames: tuple[tuple[int, bytes], ...]


def joined(pieces: Sequence[Piece]) -> Stream:
    """The stream of these pieces."""
    data = bytearray()
    frames = []
    for piece in pieces:
        if piece.kind == WHOLE:
            frames.append((len(data), piece.data))
        data += piece.data
    return Stream(bytes(data), tuple(frames))


def stream_of(material: Material, dice: Random, count: int) -> Stream:
    """A stream of so many pieces: frames mostly, then damaged frames, then noise."""
    return joined(list(islice(pieces(material, dice), count)))


def pieces(material: Material, dice: Random) -> Iterator[Piece]:
    """Pieces without end."""
    while True:
        chance = dice.random()
        if chance < 0.55:
            yield Piece(WHOLE, dice.choice(material.frames))
        elif chance < 0.8:
            kind = dice.choice(list(DAMAGES))
            yield Piece(kind, damaged(kind, dice.choice(material.frames), material, dice))
        else:
            kind = dice.choice(list(NOISES))
            yield Piece(kind, NOISES[kind](material, dice))


# --- damage -------------------------------------------------------------------------------------

Damage = Callable[[bytes, Material, Random], bytes]


def damaged(kind: str, frame: bytes, material: Material, dice: Random) -> bytes:
    """The frame, damaged so that it can't be found whole in what is left."""
    for _ in range(20):
        found = DAMAGES[kind](frame, material, dice)
        if frame not in found:
            return found
    return frame[: len(frame) // 2]


def _flipped(frame: bytes, material: Material, dice: Random) -> bytes:
    """One to three bits are wrong, anywhere."""
    found = bytearray(frame)
    for _ in range(dice.randint(1, 3)):
        found[dice.randrange(len(found))] ^= 1 << dice.randrange(8)
    return bytes(found)


def _overwritten(frame: bytes, material: Material, dice: Random) -> bytes:
    """A byte has become one that means something."""
    place = dice.randrange(len(frame))
    return frame[:place] + _mark(material, dice) + frame[place + 1 :]


def _dropped(frame: bytes, material: Material, dice: Random) -> bytes:
    """One to three bytes are lost, as by a receiver that is too slow."""
    place = dice.randrange(len(frame))
    return frame[:place] + frame[place + dice.randint(1, 3) :]


def _inserted(frame: bytes, material: Material, dice: Random) -> bytes:
    """One to three bytes too many."""
    place = dice.randint(1, max(1, len(frame) - 1))
    return frame[:place] + _some(material, dice, 3) + frame[place:]


def _cut(frame: bytes, material: Material, dice: Random) -> bytes:
    """The tail is missing, perhaps just the last byte."""
    return frame[: max(dice.randrange(len(frame)), dice.randrange(len(frame)))]


def _headless(frame: bytes, material: Material, dice: Random) -> bytes:
    """The head is missing, as where a receiver is switched on."""
    return frame[dice.randint(1, len(frame)) :]


DAMAGES: dict[str, Damage] = {
    "flipped": _flipped,
    "overwritten": _overwritten,
    "dropped": _dropped,
    "inserted": _inserted,
    "cut": _cut,
    "headless": _headless,
}
"""Faults of frames on a bad line."""


# --- noise --------------------------------------------------------------------------------------


def _random_bytes(material: Material, dice: Random) -> bytes:
    return dice.randbytes(dice.randint(1, 24))


def _marks(material: Material, dice: Random) -> bytes:
    """Delimiters, escapes and the like without any sense."""
    return _some(material, dice, 12)


def _run(material: Material, dice: Random) -> bytes:
    """One byte again and again, as an idle or shorted line gives it."""
    return _mark(material, dice) * dice.randint(1, 40)


def _false_start(material: Material, dice: Random) -> bytes:
    """The beginning of a frame, and then something else."""
    frame = dice.choice(material.frames)
    most = max(1, min(8, len(frame) - 1))
    return frame[: dice.randint(1, most)] + dice.randbytes(dice.randrange(6))


NOISES: dict[str, Callable[[Material, Random], bytes]] = {
    "random bytes": _random_bytes,
    "marks": _marks,
    "run": _run,
    "false start": _false_start,
}
"""Bytes that stand between frames on a bad line."""


def _mark(material: Material, dice: Random) -> bytes:
    return bytes((dice.choice(material.marks),))


def _some(material: Material, dice: Random, most: int) -> bytes:
    """A few bytes, mostly marks."""
    count = dice.randint(1, most)
    return b"".join(
        _mark(material, dice) if dice.random() < 0.8 else dice.randbytes(1) for _ in range(count)
    )


# --- material of a schema -------------------------------------------------------------------------


@cache
def material_of(path: Path, sender: str, least: int = 0, greatest: int = 1 << 16) -> Material:
    """Frames of all messages of a sender, and of unknown ones, no smaller or greater than given."""
    model = protocol_of(path).sender(sender)
    frames = [*known_frames(path, model), *unknown_frames(path, model)]
    fitting = dict.fromkeys(frame for frame in frames if least <= len(frame) <= greatest)
    return Material(tuple(fitting), marks_of(path, sender))


def known_frames(path: Path, sender: Sender) -> Iterator[bytes]:
    """Frames of every message that a decoder can tell: boundary values first, then others."""
    module = module_at(path)
    decoded = {message.NAME for message in module.PROTOCOL.sender(sender.name).messages}
    for message in sender.messages:
        if message.name in decoded:
            yield from _frames_of(path, sender, message)


def _frames_of(path: Path, sender: Sender, message: Message) -> Iterator[bytes]:
    module = module_at(path)
    usual = samples(message, sender.frame, Random(f"{sender.name} {message.name}"))
    for values, parts in islice(usual, min(12, boundary_rounds(message, sender.frame)) + 4):
        record = module.MESSAGES[message.name].from_dict(values)
        try:
            yield module.encode(record, sender.name, **arguments(parts))
        except EncodeError:
            # Its own end stands in it, and nothing would tell a decoder so; or it is too long.
            assert sender.framing.cut_ambiguous or sender.framing.is_cut_off


def unknown_frames(path: Path, sender: Sender) -> Iterator[bytes]:
    """Frames of identities that belong to no message, where a decoder can tell where they end."""
    codec = module_at(path).PROTOCOL
    framing = sender.framing
    if sender.frame.length is None and framing.end is None:
        return
    dice = Random(sender.name)
    for _ in range(20):
        size = dice.choice([0, 1, framing.payload.least, framing.payload.least + 2])
        payload = bytes(dice.randrange(128) for _ in range(size))
        parts = {part.name: _any_value(part, dice) for part in sender.frame.identity}
        parts |= {part.name: _any_value(part, dice) for part in sender.frame.caller_parts}
        try:
            yield codec.encode_unknown(sender.name, parts, payload)
        except EncodeError:
            continue  # The identity is known, or no frame has so many bytes.


def _any_value(part: NumberPart, dice: Random) -> int | str:
    if isinstance(part, ChoicePart):
        return part.shown(dice.choice(part.values))
    any_of_them = dice.randint(part.least, part.greatest)
    return part.shown(dice.choice([part.least, part.greatest, any_of_them]))


@cache
def marks_of(path: Path, sender: str) -> bytes:
    """Delimiters, escapes, what stands for them, identities, and a few usual bytes."""
    spec = module_at(path).PROTOCOL.sender(sender)
    found = {0x00, 0x01, 0xFF}
    for part in spec.frame.parts:
        if isinstance(part, LiteralPart):
            found |= set(part.value)
    for message in spec.messages:
        found |= {value & 0xFF for value in message.IDENTITY}
    if isinstance(spec.frame.start, StartSet):
        found |= {spec.frame.start.least, spec.frame.start.greatest}
    if isinstance(spec.frame.start, StartWords):
        found |= set(b"".join(spec.frame.start.words))
    if spec.frame.transparency is not None:
        found |= set(spec.frame.transparency.encode(bytes(sorted(found))))
    return bytes(sorted(found))


def portions(data: bytes, dice: Random) -> list[bytes]:
    """The data cut at random places, into few or many portions, some of them empty."""
    cuts = sorted(dice.randint(0, len(data)) for _ in range(dice.choice([1, 3, 10, 60])))
    return [data[low:high] for low, high in zip([0, *cuts], [*cuts, len(data)], strict=True)]


def single_bytes(data: bytes) -> list[bytes]:
    """The data, one byte in each portion."""
    return [bytes((byte,)) for byte in data]
