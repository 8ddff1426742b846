"""Captures that gzip or zstd has compressed: their bytes, and whether any are missing at the end.

A robot that loses its power leaves a file whose compression does not end. What was compressed
before that is read, and the end that is missing is complained of.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator
from enum import StrEnum
from typing import Protocol

from protogen.convert.errors import needed
from protogen.convert.inputs.chunks import PIECE
from protogen.convert.inputs.text_logs import Complain


class Packing(StrEnum):
    """Compressions of files."""

    NONE = ""
    GZIP = "gzip"
    ZSTD = "zstd"


_MAGIC = {Packing.GZIP: b"\x1f\x8b", Packing.ZSTD: b"\x28\xb5\x2f\xfd"}
_SKIPPED = struct.Struct("<II")
"""The head of a frame of zstd that holds no data: a magic, of which four bits are free, and the
bytes that follow. `pzstd` has one in front of each frame."""
_SKIPPED_MAGIC = 0x184D2A50
SUFFIXES = {".gz": Packing.GZIP, ".zst": Packing.ZSTD}

_SLICE = 1 << 10
"""Bytes that are unpacked at once: of gzip to a megabyte at most. Those of zstd may be blocks of
128 kB of one byte, each packed into four."""


def packing_of(head: bytes) -> Packing:
    """Compression of a file that begins with these bytes."""
    start = _skipped(head)
    if start:
        # Alone they say too little: what is behind them has to be zstd.
        return Packing.ZSTD if head.startswith(_MAGIC[Packing.ZSTD], start) else Packing.NONE
    return next(
        (packing for packing, magic in _MAGIC.items() if head.startswith(magic)), Packing.NONE
    )


def _skipped(head: bytes) -> int:
    """Number of bytes in front that are frames of zstd without data."""
    place = 0
    while len(head) - place >= _SKIPPED.size:
        magic, size = _SKIPPED.unpack_from(head, place)
        if magic & ~0xF != _SKIPPED_MAGIC:
            break
        place += _SKIPPED.size + size
    return place


class _Member(Protocol):
    """Decompressor of one of the wholes that stand behind one another in a compressed file."""

    @property
    def eof(self) -> bool: ...

    @property
    def unused_data(self) -> bytes: ...

    def decompress(self, data: memoryview, /) -> bytes: ...


def unpacked(pieces: Iterator[bytes], packing: Packing, complain: Complain) -> Iterator[bytes]:
    """The bytes that pieces of a file have compressed. Raises `zlib.error` or zstd's `ZstdError`.

    `complain` is told of a file whose end is missing.
    """
    match packing:
        case Packing.GZIP:
            # 16: with gzip's head. Behind a member, zeros may follow, as tapes have them.
            window = 16 + zlib.MAX_WBITS
            return _unpacked(pieces, lambda: zlib.decompressobj(window), complain, padding=b"\0")
        case Packing.ZSTD:
            zstandard = needed("zstandard", "a capture that zstd has compressed")
            return _unpacked(pieces, zstandard.ZstdDecompressor().decompressobj, complain)
        case Packing.NONE:
            return pieces


def _unpacked(
    pieces: Iterator[bytes], new: Callable[[], _Member], complain: Complain, padding: bytes = b""
) -> Iterator[bytes]:
    """The bytes of all members, one behind the other, without `padding` behind a member."""
    member: _Member | None = None
    for piece in pieces:
        left = memoryview(piece)
        ready = bytearray()
        while left:
            if member is None and left[:1] == padding:
                left = memoryview(bytes(left).lstrip(padding))
                continue
            member = member or new()
            some = left[:_SLICE]
            ready += member.decompress(some)
            left = left[len(some) - len(member.unused_data) :]
            if member.eof:
                member = None
            if len(ready) >= PIECE:
                yield bytes(ready)
                ready.clear()
        if ready:
            yield bytes(ready)
    if member is not None:
        if rest := member.decompress(memoryview(b"")):
            yield rest
        complain("its compressed bytes end too early; all before that was read")
