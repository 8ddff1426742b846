"""Files that go to the disk while they are written, and do not stay in memory.

Whoever writes much more than there is memory for pays for each fresh page of the system's cache
and pushes out of it what others need; on a virtual machine, fresh pages cost several times what
copying into used ones does. Few read a large file at once that has just been written.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType
from typing import Self

_STRETCH = 16 << 20
"""Bytes after which the system is told. It begins to write a stretch when it is told the first
time, and forgets what was written when it is told again."""
_TOLD = 4
"""How often it is told of a stretch, unless the file ends before."""


class DrainedFile:
    """A file of bytes that is written from its start to its end. Raises OSError."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("wb")
        self._written = 0
        self._told = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def write(self, data: bytes) -> None:
        """Write some bytes."""
        self._file.write(data)
        self._written += len(data)
        if self._written - self._told >= _STRETCH:
            self._tell()

    def writelines(self, pieces: Iterable[bytes]) -> None:
        """Write one piece after the other."""
        for piece in pieces:
            self.write(piece)

    def close(self) -> None:
        """Write what is left."""
        self._file.close()

    def _tell(self) -> None:
        self._told = self._written
        if hasattr(os, "posix_fadvise"):  # Linux and most others have it, macOS and Windows not.
            start = max(0, self._written - _TOLD * _STRETCH)
            size = self._written - start
            os.posix_fadvise(self._file.fileno(), start, size, os.POSIX_FADV_DONTNEED)
