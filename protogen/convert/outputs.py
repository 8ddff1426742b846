"""Files that appear whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

_PARTIAL = ".partial"


class Pending:
    """Files of one capture. Until `commit` each stands under a name that nobody reads.

    The name is hidden and always the same, so that what a killed run left is overwritten.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._paths: list[Path] = []

    def path(self, relative: str) -> Path:
        """Where to write what is to become the file at `relative`. Raises OSError."""
        path = self._folder / relative
        path.parent.mkdir(parents=True, exist_ok=True)
        self._paths.append(path)
        return _hidden(path)

    @property
    def relatives(self) -> list[str]:
        """The files, relative to the folder."""
        return [path.relative_to(self._folder).as_posix() for path in self._paths]

    def commit(self) -> list[str]:
        """Put every file in its place; their relative paths. Raises OSError."""
        for path in self._paths:
            _settle(_hidden(path))
            _hidden(path).replace(path)
        for folder in dict.fromkeys(path.parent for path in self._paths):
            _settle(folder)
        return self.relatives

    def discard(self) -> None:
        """Remove what was written."""
        for path in self._paths:
            _hidden(path).unlink(missing_ok=True)
            _remove_empty(path.parent, self._folder)


def write_whole(path: Path, data: bytes) -> None:
    """Write a file that appears whole or not at all. Raises OSError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    hidden = _hidden(path)
    hidden.write_bytes(data)
    _settle(hidden)
    hidden.replace(path)


def remove(folder: Path, relatives: Iterable[str]) -> None:
    """Remove files of an earlier run, and the folders that are empty then."""
    for relative in relatives:
        (folder / relative).unlink(missing_ok=True)
        _remove_empty((folder / relative).parent, folder)


def _hidden(path: Path) -> Path:
    return path.with_name(f".{path.name}{_PARTIAL}")


def _settle(path: Path) -> None:
    """Have the contents on the disk before the name says so."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _remove_empty(folder: Path, top: Path) -> None:
    if folder != top:
        with suppress(OSError):
            folder.rmdir()
