"""Streams to try a decoder on: frames, damaged frames, and noise made of telling bytes."""

from __future__ import annotations

import random
from typing import Any

from hypothesis import strategies as st

from protogen.runtime import api as rt
from protogen.runtime.framing.assembly import encode_frame


def telling_bytes(sender: Any) -> bytes:
    """Bytes that mean something in this framing, among a few others."""
    spec = sender.frame
    found = {0x00, 0x01, 0x02, 0x03, 0x05, 0x30, 0x31, 0x7F, 0x80, 0xFF}
    for part in spec.parts:
        if isinstance(part, rt.LiteralPart):
            found |= set(part.value)
    for message in sender.messages:
        for part, value in zip(sender.layout.identity, message.IDENTITY, strict=True):
            found |= set(part.number.encode(value))
    if isinstance(spec.start, rt.StartWords):
        found |= set(b"".join(spec.start.words))
    if spec.transparency is not None:
        found |= set(spec.transparency.encode(bytes(sorted(found))))
    return bytes(sorted(found))


def random_frame(sender: Any, source: random.Random) -> bytes:
    """A frame of a random payload, mostly of a known message, mostly a valid one."""
    telling = telling_bytes(sender)
    size = source.choice([0, 0, 1, 2, 3, 3, 3, 4, 5, 6])
    payload = bytes(source.choice(telling) for _ in range(size))
    if sender.frame.seven_bit:
        payload = bytes(byte & 0x7F for byte in payload)
    identity = source.choice([message.IDENTITY for message in sender.messages])
    if source.random() < 0.15:
        identity = tuple(source.choice(telling) for _ in identity)
    parts = {part.name: source.choice(part.values or telling) for part in sender.layout.values}
    try:
        return encode_frame(sender, identity, payload, parts, strict=False)
    except rt.EncodeError:
        return b""


def damaged(frame: bytes, source: random.Random, telling: bytes) -> bytes:
    """The frame with a changed, lost or added byte, or cut."""
    if not frame:
        return frame
    place = source.randrange(len(frame))
    kind = source.randrange(4)
    if kind == 0:
        return frame[:place] + bytes((source.choice(telling),)) + frame[place + 1 :]
    if kind == 1:
        return frame[:place] + frame[place + 1 :]
    if kind == 2:
        return frame[:place] + bytes((source.choice(telling),)) + frame[place:]
    return frame[:place]


def random_stream(sender: Any, source: random.Random, pieces: int = 6) -> bytes:
    telling = telling_bytes(sender)
    stream = b""
    for _ in range(pieces):
        kind = source.randrange(10)
        if kind < 5:
            stream += random_frame(sender, source)
        elif kind < 8:
            stream += damaged(random_frame(sender, source), source, telling)
        else:
            stream += bytes(source.choice(telling) for _ in range(source.randrange(12)))
    return stream


def streams(sender: Any) -> st.SearchStrategy[bytes]:
    """Random streams, and bytes that Hypothesis chooses itself."""
    telling = st.sampled_from(list(telling_bytes(sender)))
    chosen = st.lists(telling | st.integers(0, 255), max_size=40).map(bytes)
    made = st.builds(random_stream, st.just(sender), st.randoms(use_true_random=False))
    return made | chosen


def in_portions(data: bytes, source: random.Random) -> list[bytes]:
    """The data cut into portions, some of them empty."""
    cuts = sorted(source.randrange(len(data) + 1) for _ in range(source.randrange(8)))
    return [data[low:high] for low, high in zip([0, *cuts], [*cuts, len(data)], strict=True)]
