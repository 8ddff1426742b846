"""Recordings in several files, none of which grows without end."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Self

from protogen.recording.recorder import Recorder

_SECOND = 10**9


class RotatingRecorder:
    """Writes recordings `run-0001.pgrec`, `run-0002.pgrec` and so on, each of them whole.

    A file ends when it has `most_bytes`, or `most_seconds` after its first byte. A number that is
    taken by an older recording is not used again.
    """

    def __init__(
        self,
        path: Path,
        most_bytes: int | None,
        most_seconds: float | None,
        clock: Callable[[], int] = time.time_ns,
    ) -> None:
        """Begin the first file. Raises OSError."""
        self._path = path
        self._most_bytes = most_bytes
        self._most_seconds = most_seconds
        self._clock = clock
        self._number = 0
        self._begun: int | None = None
        self.files: list[Path] = []
        """The files so far."""
        self._recorder = self._next()

    def write(self, data: bytes, t_ns: int | None = None, source: str = "") -> None:
        """Record what came from a source. Raises OSError."""
        when = self._clock() if t_ns is None else t_ns
        if self._is_full(len(data), when):
            self._recorder.close()
            self._recorder = self._next()
        self._begun = when if self._begun is None else self._begun
        self._recorder.write(data, when, source)

    def note(self, text: str, t_ns: int | None = None) -> None:
        """Record what happened. Raises OSError."""
        self._recorder.note(text, self._clock() if t_ns is None else t_ns)

    def sync(self) -> None:
        """Wait until the disk has all. Raises OSError."""
        self._recorder.sync()

    def close(self) -> None:
        """End the last file."""
        self._recorder.close()

    def _is_full(self, size: int, when: int) -> bool:
        if self._begun is None:
            return False
        is_long = self._most_seconds is not None and (
            when - self._begun >= self._most_seconds * _SECOND
        )
        return is_long or (
            self._most_bytes is not None and self._recorder.size + size > self._most_bytes
        )

    def _next(self) -> Recorder:
        while True:
            self._number += 1
            file = self._path.with_name(f"{self._path.stem}-{self._number:04}{self._path.suffix}")
            try:
                stream = file.open("xb", buffering=0)
            except FileExistsError:
                continue
            self.files.append(file)
            self._begun = None
            return Recorder(stream, self._clock, owned=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
