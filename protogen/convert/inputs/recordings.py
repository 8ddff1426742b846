"""Reads recorded captures: see `protogen/capture/record.py` for what is in them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from protogen.capture.record import GREATEST, HEADER, MAGIC
from protogen.convert.inputs.text_logs import Complain


def record_pieces(pieces: Iterable[bytes], complain: Complain) -> Iterator[tuple[bytes, int]]:
    """The bytes of each record with its time in nanoseconds.

    What is no record ends the capture and is complained of; of a torn one there is what there is.
    """
    reader = _Reader(iter(pieces))
    if reader.take(len(MAGIC)) != MAGIC:
        complain(f"this is no recorded capture: it does not begin with {MAGIC.hex(' ').upper()}")
        return
    while head := reader.take(HEADER.size):
        if len(head) < HEADER.size:
            complain(f"ends inside the head of a record, at byte {reader.place}")
            return
        when, size = HEADER.unpack(head)
        if size > GREATEST:
            complain(f"no record of {size} bytes can stand at byte {reader.place - HEADER.size}")
            return
        data = reader.take(size)
        yield data, when
        if len(data) < size:
            complain(f"ends inside a record, {size - len(data)} bytes too early")


class _Reader:
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
