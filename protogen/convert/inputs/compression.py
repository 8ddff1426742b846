"""Captures that gzip or zstd has compressed: their bytes, and whether any are missing at the end.

A robot that loses its power leaves a file whose compression does not end. What was compressed
before that is read, and the end that is missing is complained of.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from enum import StrEnum
from io import BufferedReader, RawIOBase
from typing import BinaryIO, Protocol, cast

from protogen.convert.errors import needed
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

_READ = 1 << 16
_MOST = 1 << 20
"""The most bytes that gzip unpacks at once."""
_SLICE = 1 << 10
"""Bytes of zstd that are unpacked at once. They may be blocks of 128 kB of one byte, each packed
into four."""


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


def unpacking(stream: BufferedReader, packing: Packing, complain: Complain) -> BinaryIO:
    """The bytes that a stream has compressed. Reading raises `zlib.error` or zstd's `ZstdError`."""
    match packing:
        case Packing.GZIP:
            return cast(BinaryIO, _Unpacked(stream, _Gzip, complain, padding=b"\0"))
        case Packing.ZSTD:
            zstandard = needed("zstandard", "a capture that zstd has compressed")
            decompressor = zstandard.ZstdDecompressor()
            return cast(
                BinaryIO,
                _Unpacked(stream, lambda: _Zstd(decompressor.decompressobj()), complain),
            )
        case Packing.NONE:
            return cast(BinaryIO, stream)


class _Member(Protocol):
    """One of the wholes that stand behind one another in a compressed file."""

    def feed(self, data: memoryview) -> tuple[bytes, int]:
        """Unpack some of the next bytes; the result, and how many of them were taken."""

    @property
    def is_whole(self) -> bool:
        """True once its end was seen."""


class _Gzip:
    def __init__(self) -> None:
        self._machine = zlib.decompressobj(wbits=16 + zlib.MAX_WBITS)  # 16: with gzip's head.

    def feed(self, data: memoryview) -> tuple[bytes, int]:
        unpacked = self._machine.decompress(data, _MOST)
        left = self._machine.unused_data or self._machine.unconsumed_tail
        return unpacked, len(data) - len(left)

    @property
    def is_whole(self) -> bool:
        return self._machine.eof


class _Frame(Protocol):
    """Decompressor that zstandard's `decompressobj` makes."""

    eof: bool
    unused_data: bytes

    def decompress(self, data: memoryview) -> bytes: ...


class _Zstd:
    def __init__(self, machine: _Frame) -> None:
        self._machine = machine

    def feed(self, data: memoryview) -> tuple[bytes, int]:
        some = data[:_SLICE]
        unpacked = self._machine.decompress(some)
        left = self._machine.unused_data if self.is_whole else b""
        return unpacked, len(some) - len(left)

    @property
    def is_whole(self) -> bool:
        return self._machine.eof


class _Unpacked(RawIOBase):
    """The bytes of all members, one behind the other."""

    def __init__(
        self,
        stream: BufferedReader,
        member: Callable[[], _Member],
        complain: Complain,
        padding: bytes = b"",
    ) -> None:
        """Skip `padding` behind a member, as tapes have it."""
        self._stream = stream
        self._padding = padding
        self._new = member
        self._complain = complain
        self._member: _Member | None = None
        self._packed = memoryview(b"")
        self._ready = memoryview(b"")

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: object, /) -> int:
        target = memoryview(cast(bytearray, buffer)).cast("B")
        while not self._ready and self._unpack():
            pass
        size = min(len(target), len(self._ready))
        target[:size] = self._ready[:size]
        self._ready = self._ready[size:]
        return size

    def _unpack(self) -> bool:
        """Unpack something more; False at the end."""
        if not self._packed:
            self._packed = memoryview(self._stream.read1(_READ))
        if not self._packed:
            return self._end()
        if self._member is None:
            if self._packed[:1] == self._padding:
                self._packed = memoryview(bytes(self._packed).lstrip(self._padding))
                return True
            self._member = self._new()
        unpacked, taken = self._member.feed(self._packed)
        self._packed = self._packed[taken:]
        self._ready = memoryview(unpacked)
        if self._member.is_whole:
            self._member = None
        return True

    def _end(self) -> bool:
        """The file is over: what its member still holds, then a complaint if its end is missing."""
        if self._member is not None:
            unpacked, _ = self._member.feed(memoryview(b""))
            self._ready = memoryview(unpacked)
            if unpacked:
                return True
            self._complain("its compressed bytes end too early; all before that was read")
            self._member = None
        return False
