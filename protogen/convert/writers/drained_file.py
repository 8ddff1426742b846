"""Files that go to the disk while they are written, and do not stay in memory.

Whoever writes much more than there is memory for pays for each fresh page of the system's cache
and pushes out of it what others need; on a virtual machine, fresh pages cost several times what
copying into used ones does. Few read a large file at once that has just been written.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

_STRETCH = 4 << 20
"""Bytes, or some more, after which the system is told. It begins to write a stretch when it is told
the first time, and forgets what was written when it is told again."""
_TOLD = 4
"""Times that it is told of a stretch, unless the file ends before."""


class Drain:
    """Tells the system how far a file has been written."""

    def __init__(self) -> None:
        self._told = deque([0], maxlen=_TOLD)
        """Bytes up to which it was told, the last times."""

    def reach(self, descriptor: int, written: int) -> None:
        """Tell that so many bytes are written: the system may drop them from its cache."""
        if written - self._told[-1] < _STRETCH:
            return
        start = self._told[0]
        self._told.append(written)
        if hasattr(os, "posix_fadvise"):  # Linux and most others have it, macOS and Windows not.
            # It is no more than advice: where a kernel or a file system takes none, all is well.
            with suppress(OSError):
                os.posix_fadvise(descriptor, start, written - start, os.POSIX_FADV_DONTNEED)


class DrainedFile:
    """A file of bytes that is written from its start to its end. Raises OSError."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("wb")
        self._drain = Drain()
        self._written = 0

    def write(self, data: bytes) -> None:
        """Write some bytes."""
        self._file.write(data)
        self._written += len(data)
        self._drain.reach(self._file.fileno(), self._written)

    def writelines(self, pieces: Iterable[bytes]) -> None:
        """Write one piece after the other."""
        for piece in pieces:
            self.write(piece)

    def close(self) -> None:
        """Write what is left."""
        self._file.close()
