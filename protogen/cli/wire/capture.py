"""Bytes from a file or standard input, in pieces, so that memory does not grow with the capture."""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from io import BufferedReader
from itertools import chain
from pathlib import Path
from typing import BinaryIO, Literal, cast

from protogen.cli.exits import UsageError
from protogen.cli.progress import progress
from protogen.cli.wire.tagged import Complain, Piece
from protogen.convert.inputs.hex_digits import HexReader
from protogen.convert.inputs.text_lines import decoded, lines_of
from protogen.convert.inputs.text_logs import log_lines
from protogen.recording import RecordKind, records

STANDARD_INPUT = Path("-")
InputFormat = Literal["raw", "hex", "tagged", "log", "record"]
"""Format of a capture: bytes, hex digits, lines of hex digits behind the name of the sender, or
behind a time, as `candump -l` writes them, or a recording."""

_PIECE = 1 << 16
"""The most bytes that are read at once."""


@contextmanager
def opened(source: Path) -> Iterator[Iterator[bytes]]:
    """Open a file, or standard input for `-`, as an iterator over its bytes as they come.

    Shows a progress bar meanwhile. Raises UsageError if the file can't be opened.
    """
    if source == STANDARD_INPUT:
        with progress("reading", None, shares_terminal=True, in_bytes=True) as advance:
            # read1 gives what is there, so that a live stream is shown as it comes.
            yield _pieces(cast(BufferedReader, sys.stdin.buffer).read1, advance)
        return
    try:
        stream = source.open("rb", buffering=0)
    except OSError as error:
        raise UsageError(f"{source}: {error.strerror}") from None
    with stream, progress("reading", _size(stream), shares_terminal=True, in_bytes=True) as advance:
        yield _pieces(stream.read, advance)


def _size(stream: BinaryIO) -> int | None:
    """Return the size of a file; None for a device or a pipe, which has none."""
    status = os.fstat(stream.fileno())
    return status.st_size if stat.S_ISREG(status.st_mode) else None


def _pieces(read: Callable[[int], bytes | None], advance: Callable[[int], None]) -> Iterator[bytes]:
    while piece := read(_PIECE):
        yield piece
        advance(len(piece))


def raw_pieces(pieces: Iterator[bytes], sender: str) -> Iterator[Piece]:
    """The pieces as they are."""
    return (Piece(sender, piece) for piece in pieces)


def begun(pieces: Iterator[bytes]) -> tuple[bytes, Iterator[bytes]]:
    """The first piece, and all of them."""
    head = next(pieces, b"")
    return head, chain([head] if head else [], pieces)


def recorded_pieces(
    pieces: Iterator[bytes], sender: str, senders: Collection[str], complain: Complain
) -> Iterator[Piece]:
    """Bytes of a recording: from the endpoint that a record names, or `sender`."""
    for record in records(pieces, complain):
        if record.kind is RecordKind.BYTES:
            named = record.source if record.source in senders else sender
            yield Piece(named, record.data, record.when)


def hex_pieces(pieces: Iterator[bytes], sender: str) -> Iterator[Piece]:
    """Bytes that the pieces say in hex. Raises HexError with line and column."""
    reader = HexReader()
    for text in decoded(pieces):
        yield Piece(sender, reader.feed(text))
    yield Piece(sender, reader.finish())


def timed_pieces(
    pieces: Iterator[bytes], sender: str, senders: Collection[str], complain: Complain
) -> Iterator[Piece]:
    """Bytes of the lines of a log with times: from the sender that a line names, or `sender`."""
    for line in log_lines(lines_of(pieces), complain):
        named = line.name if line.name is not None and line.name in senders else sender
        yield Piece(named, line.data, line.when)
