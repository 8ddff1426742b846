"""Sources of the bytes of a capture."""

from __future__ import annotations

import io
import mmap
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from protogen.capture.errors import CaptureError

Source = str | os.PathLike[str] | bytes | bytearray | memoryview | mmap.mmap | BinaryIO
"""A file by its path, bytes, or an open binary file, which is read from where it is."""


@contextmanager
def opened(source: Source) -> Iterator[memoryview | BinaryIO]:
    """The bytes, where they are in memory or in a file; else what they are read from."""
    if isinstance(source, str | os.PathLike):
        with _file(Path(source)) as file:
            yield _mapped(file)
    elif isinstance(source, io.BufferedReader | io.FileIO):
        yield _mapped(source)
    elif isinstance(source, bytes | bytearray | memoryview | mmap.mmap):
        yield _octets(memoryview(source))
    elif hasattr(source, "read"):
        yield source
    else:
        kind = type(source).__name__
        raise CaptureError(f"a capture is a path, bytes or a binary file, not {kind}")


def _octets(view: memoryview) -> memoryview:
    """The bytes of a memoryview, whatever its items are."""
    if not view.c_contiguous:
        raise CaptureError("the bytes of this memoryview do not lie side by side")
    return view.cast("B") if view.nbytes else memoryview(b"")


def pieces(source: memoryview | BinaryIO, size: int) -> Iterator[bytes | memoryview]:
    """The bytes, so many at a time at most."""
    if isinstance(source, memoryview):
        for start in range(0, len(source), size):
            yield source[start : start + size]
            forget(source, start, start + size)
        return
    while True:
        piece: object = source.read(size)
        if piece is None:
            raise CaptureError("the capture does not wait for bytes: its file is non-blocking")
        if not isinstance(piece, bytes):
            raise CaptureError("the capture was opened as text; open it with mode 'rb'")
        if not piece:
            return
        yield piece


class _Mapping(mmap.mmap):
    """A file that was mapped here: only to be read, and by nobody else."""


def forget(source: memoryview, start: int, stop: int) -> None:
    """Give back the memory of bytes that were read. What is read again comes from the file again.

    Else the pages of a mapped file count as the process's memory, until all of it does.
    """
    mapping = source.obj
    if not isinstance(mapping, _Mapping) or not hasattr(mmap, "MADV_DONTNEED"):
        return
    before = len(mapping) - len(source)
    first = (before + start) // mmap.PAGESIZE * mmap.PAGESIZE
    last = min(len(mapping), before + stop) // mmap.PAGESIZE * mmap.PAGESIZE
    if last > first:
        mapping.madvise(mmap.MADV_DONTNEED, first, last - first)


def _file(path: Path) -> io.FileIO:
    try:
        return io.FileIO(path)
    except OSError as error:
        raise CaptureError(f"{path}: {error.strerror}") from None


def _mapped(file: io.BufferedReader | io.FileIO) -> memoryview | BinaryIO:
    """The rest of a file as memory; a pipe, a device or an empty file as it is."""
    try:
        start = file.tell()
        mapping = _Mapping(file.fileno(), 0, access=mmap.ACCESS_READ)
    except (OSError, ValueError):
        return file
    # Whoever still looks at a piece keeps the mapping; the last of them ends it.
    return memoryview(mapping)[start:]
