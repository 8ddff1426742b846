"""Analysis of a sender's frames: how a receiver cuts them."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import msgspec

from protogen.model.sizes import SizeSet


def are_run(numbers: Sequence[int]) -> bool:
    """True if numbers that are in order are all from the first to the last."""
    return len(numbers) == numbers[-1] - numbers[0] + 1


class StartLiteral(msgspec.Struct, frozen=True, kw_only=True):
    """A frame starts with these bytes. Protected: they occur nowhere else in a valid frame."""

    bytes: bytes
    protected: bool


class StartSet(msgspec.Struct, frozen=True, kw_only=True):
    """A frame starts with one of these words, which are in order and of one size.

    Protected: they occur nowhere else in a valid frame.
    """

    words: tuple[bytes, ...]
    protected: bool

    @property
    def is_run(self) -> bool:
        """True if the words are single bytes, all from the first to the last."""
        return len(self.words[0]) == 1 and are_run([word[0] for word in self.words])


class AfterEnd(msgspec.Struct, frozen=True, kw_only=True):
    """A frame starts behind an end, or where the stream starts."""


class Anywhere(msgspec.Struct, frozen=True, kw_only=True):
    """Nothing marks the start: sizes and the checksum tell whether a frame starts at a byte.

    Without a checksum, it starts where the frame before ends, as some decision accepts.
    """

    checked: bool = True
    """True if a checksum tells frames from other bytes."""


Start = StartLiteral | StartSet | AfterEnd | Anywhere


class End(msgspec.Struct, frozen=True, kw_only=True):
    """The literal that closes a frame. Protected: it occurs nowhere else in a valid frame."""

    bytes: bytes
    protected: bool


class MessageFraming(msgspec.Struct, frozen=True, kw_only=True):
    """Frame sizes on the wire and rate of one message."""

    message: str
    least: int
    greatest: int
    is_cut_off: bool = False
    """True if the protocol's greatest frame has no room for some of its values."""
    per_second: Fraction | None
    """Frames of the greatest size per second at the link's rate; None where that is not known."""


class Framing(msgspec.Struct, frozen=True, kw_only=True):
    """The framing properties of one sender, for decoders, and in words for people."""

    start: Start
    end: End | None
    payload: SizeSet
    """Payload sizes that a frame can carry (unknown messages included)."""
    least: int
    """Wire bytes of the smallest frame."""
    greatest: int
    """Wire bytes that no frame exceeds; a decoder needs no more memory than that."""
    overhead: SizeSet
    """Wire bytes that are not payload, before any stuffing."""
    seven_bit: bool
    """True if every payload byte has its most significant bit clear."""
    cut_ambiguous: bool
    """True if an encoder has to check that a decoder cuts its frame where it ends."""
    is_cut_off: bool = False
    """True if some payload, or some way to stuff it, makes a frame longer than the greatest."""
    self_synchronising: bool
    why_synchronising: str
    finds_start: str
    finds_end: str
    undetected: tuple[str, ...]
    """Single-byte errors that go unnoticed, one sentence each; empty: none."""
    messages: tuple[MessageFraming, ...]
