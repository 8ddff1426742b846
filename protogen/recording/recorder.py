"""Writes recordings. What was written stays, however the program ends."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

from protogen.recording.format import GREATEST, HEAD, MAGIC, MOST_SOURCES, RecordKind


class Recorder:
    """Writes a recording, without a buffer: a program that is killed loses no record.

    >>> with Recorder("run.pgrec") as recorder:  # doctest: +SKIP
    ...     while data := port.read(4096):
    ...         recorder.write(data)
    """

    def __init__(
        self,
        target: str | os.PathLike[str] | BinaryIO,
        clock: Callable[[], int] = time.time_ns,
        *,
        owned: bool = False,
    ) -> None:
        """Begin a recording in a file, which is made anew, or in a stream.

        A stream stays open, unless it is `owned`. `clock` tells nanoseconds since 1970-01-01 UTC.
        Raises OSError.
        """
        self._owned = owned or isinstance(target, str | os.PathLike)
        # The file lives as long as the recorder, which is the context manager.
        self._stream = (
            Path(target).open("wb", buffering=0)  # noqa: SIM115
            if isinstance(target, str | os.PathLike)
            else target
        )
        self._clock = clock
        self._sources: dict[str, int] = {"": 0}
        self.size = len(MAGIC)
        """Bytes that were written."""
        self._stream.write(MAGIC)

    def write(
        self, data: bytes | bytearray | memoryview, t_ns: int | None = None, source: str = ""
    ) -> None:
        """Record what just came from a source, or came at `t_ns`.

        Raises OSError, and ValueError where there are too many sources.
        """
        when = self._clock() if t_ns is None else t_ns
        number = self._number(source, when)
        view = memoryview(data).cast("B")  # Whatever its elements are.
        for start in range(0, len(view), GREATEST):
            self._record(view[start : start + GREATEST], when, RecordKind.BYTES, number)

    def note(self, text: str, t_ns: int | None = None) -> None:
        """Record what happened, such as a port that was lost. Raises OSError."""
        when = self._clock() if t_ns is None else t_ns
        self._record(text.encode()[:GREATEST], when, RecordKind.NOTE, 0)

    def sync(self) -> None:
        """Wait until the disk has all, so that a power failure loses nothing. Raises OSError."""
        os.fsync(self._stream.fileno())

    def close(self) -> None:
        """End the recording; a file is closed."""
        if self._owned:
            self._stream.close()
        else:
            self._stream.flush()

    def _number(self, source: str, when: int) -> int:
        """The number of a source, whose name is recorded in front of its first bytes."""
        number = self._sources.get(source)
        if number is None:
            number = len(self._sources)
            if number == MOST_SOURCES:
                raise ValueError(f"a recording has at most {MOST_SOURCES - 1} sources with names")
            self._sources[source] = number
            self._record(source.encode(), when, RecordKind.NAME, number)
        return number

    def _record(self, data: bytes | memoryview, when: int, kind: RecordKind, source: int) -> None:
        # At once, so that a file has the whole record or, where a disk is full, the front of it.
        left = memoryview(HEAD.pack(when, len(data), kind, source) + bytes(data))
        self.size += len(left)
        while left:
            written = self._stream.write(left)
            left = left[len(left) if written is None else written :]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
