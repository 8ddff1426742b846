"""Record of the last run, so that a run that has nothing to do need not compile.

A record is kept in `.protogen_cache` beside the project's file, as pytest, mypy and ruff keep
theirs: it goes away with the project, and a `.gitignore` of its own keeps it out of commits. It
holds hashes of contents, so that nothing can change unseen:

* the options, the list of schemas, and the program itself: every file of the package, and which
  releases of the libraries below it are installed;
* each schema and each file that one extends, and the folder that it may not reach out of;
* each generated file and each page with marked blocks. Files of ours that should not be there are
  looked for as in any run.

A record that is missing, damaged or of another program only means that the run compiles.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from hashlib import sha256
from pathlib import Path, PurePosixPath
from typing import Any

import msgspec

from protogen.problems.sources import SourceMap
from protogen.program import program
from protogen.schema.dialects.project_folder import project_folder
from protogen.targets.output import File, expected_files, is_current

FOLDER = ".protogen_cache"
_IGNORE = "# Made by protogen. May be deleted at any time.\n*\n"
_BYTE_ORDER_MARK = "\ufeff".encode()

Job = tuple[Sequence[File], Path, bool]
"""The files of a target, their folder, and whether others of ours in it are stale."""


class Made(msgspec.Struct, frozen=True):
    """Contents of one target's folder."""

    folder: str
    prune: bool
    files: int
    """Number of files that the target makes."""
    expected: dict[str, str | None]
    """The hash of each; None where any content will do."""

    @property
    def written(self) -> int:
        """Number of files that a run has to look after."""
        return sum(digest is not None for digest in self.expected.values())


class Record(msgspec.Struct, frozen=True):
    """One run. Paths are relative to the folder of the project."""

    key: str
    inputs: dict[str, str]
    """The hash of each schema, of each one that it extends, and of each page with blocks."""
    made: tuple[Made, ...]
    pages: int


class Keeper(msgspec.Struct, frozen=True):
    """Reads and writes the record of a run with certain options."""

    root: Path
    """The folder of the project."""
    options: Mapping[str, object]
    """Other things that the output depends on, as JSON has them."""
    schemas: Sequence[Path]
    pages: Sequence[Path]
    program: str = msgspec.field(default_factory=program)
    """Identity of this program, asked once: it may change while it runs."""

    def current(self) -> Record | None:
        """Return the record of the last run if a run would change nothing now."""
        record = self._read()
        if record is None or record.key != self._key():
            return None
        seen = all(_digest(self.root, path) == digest for path, digest in record.inputs.items())
        return record if seen and all(map(self._stands, record.made)) else None

    def keep(
        self, sources: Iterable[SourceMap], jobs: Iterable[Job], pages: Mapping[Path, str]
    ) -> None:
        """Remember a run that has written everything. What can't be remembered is not."""
        read = [
            (self._relative(Path(file)), source.text(file))
            for source in sources
            for file in source.files
        ]
        read += [(self._relative(path), text) for path, text in pages.items()]
        digests = {path: _digest(self.root, path, text) for path, text in read}
        inputs = {path: digest for path, digest in digests.items() if digest is not None}
        if len(inputs) < len(digests):
            return  # Something has changed since.
        made = tuple(self._made(*job) for job in jobs)
        try:
            record = Record(self._key(), inputs, made, len(pages))
            self._write(json.dumps(msgspec.to_builtins(record)))
        except OSError:
            return  # Then the next run compiles.

    def _made(self, files: Sequence[File], folder: Path, prune: bool) -> Made:
        expected = expected_files(files, folder, prune=prune)
        hashes = {str(path): digest for path, digest in expected.items()}
        return Made(self._relative(folder), prune, len(files), hashes)

    def _stands(self, made: Made) -> bool:
        expected = {PurePosixPath(path): digest for path, digest in made.expected.items()}
        return is_current(expected, self.root / made.folder, prune=made.prune)

    def _relative(self, path: Path) -> str:
        return Path(os.path.relpath(path, self.root)).as_posix()

    # --- the record as a file -------------------------------------------------------------------

    def _key(self) -> str:
        paths = [*map(self._relative, self.schemas), "", *map(self._relative, self.pages)]
        return _hash(json.dumps([self.options, paths, self.program], sort_keys=True))

    @property
    def _file(self) -> Path:
        """One for each set of options, so that runs with others do not forget each other."""
        name = _hash(json.dumps(self.options, sort_keys=True))[:16]
        return self.root / FOLDER / f"{name}.json"

    def _read(self) -> Record | None:
        try:
            document: Any = json.loads(self._file.read_bytes())
            made = tuple(Made(**item) for item in document.pop("made"))
            return Record(**document, made=made)
        except (OSError, ValueError, TypeError, KeyError, AttributeError):
            return None

    def _write(self, text: str) -> None:
        folder = self._file.parent
        folder.mkdir(exist_ok=True)
        ignore = folder / ".gitignore"
        if not ignore.exists():
            ignore.write_text(_IGNORE, encoding="utf-8")
        temporary = self._file.with_suffix(f".{os.getpid()}.tmp")
        temporary.write_text(text, encoding="utf-8")
        temporary.replace(self._file)


def _digest(root: Path, path: str, text: str | None = None) -> str | None:
    """Return the hash of a file, of where it really is, and of how far it may reach.

    None if it can't be read, or holds something else than `text`.
    """
    file = root / path
    try:
        content = file.read_bytes()
    except OSError:
        return None
    if text is not None and content.removeprefix(_BYTE_ORDER_MARK) != text.encode("utf-8"):
        return None
    real = os.path.relpath(os.path.realpath(file), root)
    reach = os.path.relpath(project_folder(str(file)), root)
    return sha256(f"{real}\0{reach}\0".encode("utf-8", "surrogateescape") + content).hexdigest()


def _hash(text: str) -> str:
    return sha256(text.encode("utf-8", "surrogateescape")).hexdigest()
