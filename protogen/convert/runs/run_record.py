"""Record of the captures that are done in a folder, so that an interrupted run can go on.

A capture is done when its files stand in their places and this record says so; it is written last.
What was not done is done again from the capture's start, so a resumed run gives what one run gives.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec

from protogen.convert.columns.batches import Tally
from protogen.convert.runs.folder_locks import one_after_another
from protogen.convert.writers.pending_files import write_whole

RECORD = ".protogen-convert.json"
"""The file's name in the output folder."""
_VERSION = 1


class Done(msgspec.Struct, frozen=True):
    """A capture that was converted: from what, to which files, and what was in it."""

    stamp: Mapping[str, Any]
    files: Sequence[str]
    tally: Tally
    format: str
    """Format of the capture, in words."""
    lost_lines: int = 0
    """Lines or records that could not be used."""


class _Record(msgspec.Struct):
    """The file."""

    version: int
    captures: dict[str, Done]


class State:
    """The record of a folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._path = folder / RECORD
        self._version = _version(self._path)
        self._done = _read(self._path)
        self._texts: dict[str, str] = {}
        """Text of those in `_done`, as it is written, where that is known."""

    def refresh(self) -> None:
        """Take note of what other runs have done."""
        version = _version(self._path)
        if version != self._version:
            self._version = version
            self._done = _read(self._path)
            self._texts = {}

    def finished(self, key: str, stamp: Mapping[str, Any]) -> Done | None:
        """Result of a capture, if nothing has changed since and its files are there.

        Whether what comes through a pipe has changed can't be seen: it has no size.
        """
        done = self._done.get(key)
        if done is None or dict(done.stamp) != dict(stamp) or stamp["size"] is None:
            return None
        return done if all((self._folder / file).is_file() for file in done.files) else None

    def files(self, key: str) -> Sequence[str]:
        """The files that an earlier run made of a capture."""
        return self._done[key].files if key in self._done else ()

    def origin(self, key: str) -> Mapping[str, Any]:
        """Stamp of what an earlier run made files of; of a run that did not end, some of it."""
        return self._done[key].stamp if key in self._done else {}

    def owns(self, file: str) -> bool:
        """True if an earlier run made a file."""
        return any(file in done.files for done in self._done.values())

    def is_of_another(self, key: str, file: str) -> bool:
        """True if an earlier run made a file of another capture."""
        others = (done for name, done in self._done.items() if name != key)
        return any(file in done.files for done in others)

    def record(self, key: str, done: Done) -> None:
        """Take note that a capture is done. Raises OSError."""
        self._folder.mkdir(parents=True, exist_ok=True)
        with one_after_another(self._folder):
            self.refresh()
            self._done[key] = done
            self._texts[key] = _text(done)
            write_whole(self._path, self._text().encode())
            self._version = _version(self._path)

    def _text(self) -> str:
        """The record, a line for each capture: there may be thousands, and one is new."""
        texts = self._texts
        for name in self._done.keys() - texts.keys():
            texts[name] = _text(self._done[name])
        lines = ",\n".join(f"{json.dumps(name)}: {texts[name]}" for name in sorted(self._done))
        return f'{{"version": {_VERSION}, "captures": {{\n{lines}\n}}}}\n'

    def expect(self, key: str, files: Sequence[str], origin: Mapping[str, Any]) -> None:
        """Take note that files are about to come, so that they are known to be ours if they do.

        Those of earlier runs stay ours until it is done, so that none is forgotten.
        """
        both = sorted({*files, *self.files(key)})
        self.record(key, Done(origin, both, Tally(), ""))


def _version(path: Path) -> tuple[int, int] | None:
    """Version of the record, which is a new file whenever somebody writes it."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_ino, status.st_mtime_ns


def _text(done: Done) -> str:
    # Names of files may hold what is no text, for which JSON of `msgspec` has no place.
    return json.dumps(msgspec.to_builtins(done))


def _read(path: Path) -> dict[str, Done]:
    """The record; nothing where there is none that can be read."""
    try:
        record = msgspec.convert(json.loads(path.read_text(encoding="utf-8")), _Record)
    except (OSError, ValueError):
        return {}
    return record.captures if record.version == _VERSION else {}
