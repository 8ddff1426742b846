"""Transparency: encodings that keep delimiters out of the parts of a frame."""

from __future__ import annotations

import msgspec

from protogen.model.origin import NOTHING, About


class Substitution(msgspec.Struct, frozen=True, kw_only=True):
    """Each listed byte is replaced by a sequence."""

    table: tuple[tuple[int, bytes], ...]


class Insertion(msgspec.Struct, frozen=True, kw_only=True):
    """Wherever some bytes follow each other, one more is put in behind them.

    They do not end as they begin, and with the byte behind them they end with no beginning of
    themselves: so nothing is seen of them when it was put in, and none overlaps another.
    """

    sequence: bytes
    byte: int


class Escape(msgspec.Struct, frozen=True, kw_only=True):
    """A byte of `of` is written as the escape byte and itself XOR `xor` (0xFF inverts it)."""

    byte: int
    of: tuple[int, ...]
    xor: int


class Base16(msgspec.Struct, frozen=True, kw_only=True):
    """Two upper-case hex digits a byte."""


FULL_GROUP = 254
"""Bytes that one code byte of COBS can stand for."""


class Cobs(msgspec.Struct, frozen=True, kw_only=True):
    """Consistent overhead byte stuffing: the region holds no zero byte."""


Encoding = Substitution | Insertion | Escape | Base16 | Cobs


class Transparency(msgspec.Struct, frozen=True, kw_only=True):
    """Encoding that keeps delimiters out of the parts `first` to `last`."""

    first: str
    last: str
    encoding: Encoding
    preset: str | None = None
    lenient: bool = False
    about: About = NOTHING
