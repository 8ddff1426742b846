"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from contextlib import suppress
from itertools import chain, count
from pathlib import Path

_PARTIAL = ".partial"
_CONTINUED = re.compile(r"\.part-[0-9]{4,}(?=\.[^.]+$)")


def continuation(relative: str, number: int) -> str:
    """Name of the `number`th file that goes on where the first one ended; 0: that itself."""
    stem, dot, suffix = relative.rpartition(".")
    return f"{stem}.part-{number:04}{dot}{suffix}" if number else relative


class Pending:
    """Files of one capture. Until `commit` each stands under a name that nobody reads.

    The name is hidden and always the same, so that what a killed run left is overwritten.
    """

    def __init__(self, folder: Path, token: str = "") -> None:
        """Use hidden names that are of this run alone, where there is a `token`."""
        self._folder = folder
        self._token = token
        self._paths: list[Path] = []

    def path(self, relative: str) -> Path:
        """Path to write to what is to become the file at `relative`. Raises OSError."""
        path = self._folder / relative
        path.parent.mkdir(parents=True, exist_ok=True)
        self._paths.append(path)
        return _hidden(path, self._token)

    @property
    def relatives(self) -> list[str]:
        """The files, relative to the folder."""
        return [path.relative_to(self._folder).as_posix() for path in self._paths]

    def commit(self) -> list[str]:
        """Put every file in its place; their relative paths. Raises OSError."""
        for path in self._paths:
            hidden = _hidden(path, self._token)
            _settle(hidden)
            hidden.replace(path)
        for folder in dict.fromkeys(path.parent for path in self._paths):
            _settle(folder)
        return self.relatives

    def discard(self) -> None:
        """Remove what was written, as far as that can be done."""
        for path in self._paths:
            with suppress(OSError):  # What could not be written may have no name to remove.
                _hidden(path, self._token).unlink()
            _remove_empty(path.parent, self._folder)


def write_whole(path: Path, data: bytes, token: str = "") -> None:
    """Write a file that appears whole or not at all. Raises OSError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    hidden = _hidden(path, token)
    try:
        hidden.write_bytes(data)
        _settle(hidden)
        hidden.replace(path)
    except BaseException as error:
        name_place(error, path)
        with suppress(OSError):
            hidden.unlink()
        raise


def name_place(error: BaseException, place: Path) -> None:
    """Give an error of the system that tells no file this one, as when the disk is full."""
    if isinstance(error, OSError) and error.filename is None:
        error.filename = str(place)


def remove(folder: Path, relatives: Iterable[str]) -> None:
    """Remove files of an earlier run, and the folders that are empty then."""
    for relative in relatives:
        (folder / relative).unlink(missing_ok=True)
        _remove_empty((folder / relative).parent, folder)


def forget_torn(folder: Path, relatives: Iterable[str]) -> None:
    """Remove what runs that were killed left half written of files, and of those they go on in."""
    for relative in relatives:
        numbers = count()
        number = next(n for n in numbers if not (folder / continuation(relative, n)).exists())
        with suppress(FileNotFoundError):
            for following in chain([number], numbers):
                hidden = _hidden(folder / continuation(relative, following), "")
                hidden.unlink()
                _remove_empty(hidden.parent, folder)


def sweep(
    folder: Path,
    names: Iterable[str],
    keep: Iterable[str] = (),
    within: str = "*",
    torn: Iterable[str] = (),
) -> None:
    """Remove what attempts at files of these names left in the folder's folders, but for `keep`.

    Those go along in which such files go on. With `within`, only that folder's are removed. Of the
    names in `torn`, only what is half written goes.
    """
    ours, kept, half = set(names), set(keep), set(torn)
    for path in list(folder.glob(f"{within}/*")):
        name, is_partial = path.name, path.name.endswith(_PARTIAL)
        if is_partial:
            name = name[1:].removesuffix(_PARTIAL).rpartition(".")[0]
        relative = path.relative_to(folder).as_posix()
        first = _CONTINUED.sub("", name)
        is_ours = first in ours and (is_partial or relative not in kept)
        if is_ours or (is_partial and first in half):
            path.unlink(missing_ok=True)
            _remove_empty(path.parent, folder)


def _hidden(path: Path, token: str) -> Path:
    return path.with_name(f".{path.name}.{token}{_PARTIAL}" if token else f".{path.name}{_PARTIAL}")


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
