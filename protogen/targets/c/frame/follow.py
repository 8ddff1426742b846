"""Literals of several bytes, tracked byte by byte."""

from __future__ import annotations

import msgspec

from protogen.targets.c.frame.expressions import byte


class FollowStep(msgspec.Struct, frozen=True):
    """Bytes of a literal that the input ends with, behind one byte."""

    byte: str
    matched: int


class Followed(msgspec.Struct, frozen=True):
    """A literal that is tracked byte by byte."""

    name: str
    states: tuple[tuple[FollowStep, ...], ...]
    """For each size that was seen before: what the next byte makes of it."""


def followed(name: str, literal: bytes) -> Followed:
    """The states of a literal."""
    return Followed(name, tuple(_steps(literal, seen) for seen in range(len(literal) + 1)))


def _steps(literal: bytes, matched: int) -> tuple[FollowStep, ...]:
    """For each byte that goes on with some of the literal: how much of it stands there then."""
    found = []
    for value in dict.fromkeys(literal):
        seen = literal[:matched] + bytes((value,))
        sizes = range(min(len(seen), len(literal)), 0, -1)
        longest = next((size for size in sizes if seen.endswith(literal[:size])), 0)
        if longest:
            found.append(FollowStep(byte(value), longest))
    return tuple(found)
