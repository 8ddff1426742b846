"""Reads recordings of any format, however they end."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Iterator

from protogen.recording.format import (
    GREATEST,
    HEAD,
    HEAD_1,
    MAGIC,
    MAGIC_1,
    Record,
    RecordKind,
)

Complain = Callable[[str], None]
"""Takes a sentence on what is wrong in a recording."""

_KINDS = frozenset(map(int, RecordKind))
_HEADS: dict[bytes, struct.Struct] = {MAGIC: HEAD, MAGIC_1: HEAD_1}


def is_recording(head: bytes) -> bool:
    """True if a file that begins with these bytes is a recording."""
    return head[: len(MAGIC)] in _HEADS


def records(pieces: Iterable[bytes], complain: Complain) -> Iterator[Record]:
    """The records of a file. What is no record ends it and is complained of.

    Of a record that is torn off there is what there is.
    """
    reader = RecordReader(iter(pieces))
    head = _HEADS.get(begin := reader.take(len(MAGIC)))
    if head is None:
        complain(f"this is no recording: it begins with {begin.hex(' ').upper() or 'nothing'}")
        return
    names: dict[int, str] = {}
    while fixed := reader.take(head.size):
        if len(fixed) < head.size:
            complain(f"ends inside the head of a record, at byte {reader.place}")
            return
        when, size, *rest = head.unpack(fixed)
        kind, source = rest or (RecordKind.BYTES, 0)
        if size > GREATEST or kind not in _KINDS:
            complain(f"no record can stand at {reader.place - head.size}")
            return
        data = reader.take(size)
        if kind == RecordKind.NAME:
            names[source] = data.decode(errors="replace")
        else:
            yield Record(data, when, names.get(source, ""), RecordKind(kind))
        if len(data) < size:
            complain(f"ends inside a record, {size - len(data)} bytes too early")


class RecordReader:
    """Gives bytes of a stream of pieces in any portions."""

    def __init__(self, pieces: Iterator[bytes]) -> None:
        self._next: Callable[[], bytes] = lambda: next(pieces, b"")
        self._data = b""
        self._position = 0
        self.place = 0
        """Bytes that were taken so far."""

    def take(self, size: int) -> bytes:
        """The next `size` bytes; fewer at the end."""
        while len(self._data) - self._position < size:
            piece = self._next()
            if not piece:
                break
            self._data = self._data[self._position :] + piece
            self._position = 0
        taken = self._data[self._position : self._position + size]
        self._position += len(taken)
        self.place += len(taken)
        return taken
