"""Recorded captures: the bytes of a line, each piece with the time at which it came.

A file begins with `MAGIC`. Then records follow, one for each piece that was read from the line:

    bytes  type          meaning
    0..7   int64 LE      nanoseconds since 1970-01-01 UTC
    8..11  uint32 LE     bytes that follow
    12..   bytes

The joined bytes of all records are what was on the line; nothing is assumed of where a piece ends.
A file that ends inside a record, because the power failed, holds the bytes that are there.
"""

from __future__ import annotations

import os
import struct
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

MAGIC = b"PGREC\x00\x01\n"
"""The first bytes of a recorded capture: name, format 1."""
HEADER = struct.Struct("<qI")
"""Time and size of a record."""
GREATEST = 1 << 24
"""The most bytes of one record."""


class Recorder:
    """Writes a recorded capture.

    >>> with Recorder("run.pgrec") as recorder:  # doctest: +SKIP
    ...     while data := port.read(4096):
    ...         recorder.write(data)
    """

    def __init__(
        self,
        target: str | os.PathLike[str] | BinaryIO,
        clock: Callable[[], int] = time.time_ns,
    ) -> None:
        """Begin a capture in a file, which is made anew, or in a stream, which stays open.

        `clock` tells nanoseconds since 1970-01-01 UTC. Raises OSError.
        """
        self._owned = isinstance(target, str | os.PathLike)
        # The file lives as long as the recorder, which is the context manager.
        self._stream = (
            Path(target).open("wb")  # noqa: SIM115
            if isinstance(target, str | os.PathLike)
            else target
        )
        self._clock = clock
        self._stream.write(MAGIC)

    def write(self, data: bytes | bytearray | memoryview, t_ns: int | None = None) -> None:
        """Record what just came from the line, or came at `t_ns`. Raises OSError."""
        when = self._clock() if t_ns is None else t_ns
        view = memoryview(data).cast("B")  # Whatever its elements are.
        for start in range(0, len(view), GREATEST):
            piece = view[start : start + GREATEST]
            self._stream.write(HEADER.pack(when, len(piece)))
            self._stream.write(piece)

    def close(self) -> None:
        """End the capture; a file is closed."""
        if self._owned:
            self._stream.close()
        else:
            self._stream.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
