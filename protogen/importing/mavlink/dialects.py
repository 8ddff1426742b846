"""Files of dialects, and those that they include, in an order in which none comes too early."""

from __future__ import annotations

import os
from pathlib import Path

import msgspec

from protogen.errors import UserError
from protogen.importing.mavlink.spec import Dialect, Include, read_dialect
from protogen.importing.remarks import DefinitionError
from protogen.importing.xml_text import read_xml
from protogen.problems import hint_for

_SUFFIX = ".xml"


class Dialects(msgspec.Struct, frozen=True):
    """Dialects by the path of their file, each behind those that it includes."""

    by_file: dict[str, Dialect]
    included: dict[str, tuple[str, ...]]
    """Files that a file includes."""

    def closure(self, file: str) -> list[str]:
        """Return a file and all that it includes, directly or not, in the order of `by_file`."""
        needed, waiting = {file}, [file]
        while waiting:
            new = [item for item in self.included[waiting.pop()] if item not in needed]
            needed.update(new)
            waiting += new
        return [item for item in self.by_file if item in needed]


def read_dialects(path: Path) -> Dialects:
    """Read a file of definitions, or those of a folder, and all that they include.

    Raises UserError where there is none, and for a mistake in one.
    """
    reader = _Reader()
    for file in _files_at(path):
        reader.read(os.path.normpath(file), ())
    return Dialects(reader.done, reader.included)


def _files_at(path: Path) -> tuple[Path, ...]:
    if not path.exists():
        raise UserError(f"there is no file or folder `{path}`")
    if not path.is_dir():
        return (path,)
    found = sorted(file for file in path.glob(f"*{_SUFFIX}") if file.is_file())
    if not found:
        raise UserError(f"the folder `{path}` holds no {_SUFFIX} file")
    return tuple(found)


class _Reader:
    """Reads files, each once, those that it includes first."""

    def __init__(self) -> None:
        self.done: dict[str, Dialect] = {}
        self.included: dict[str, tuple[str, ...]] = {}

    def read(self, file: str, around: tuple[str, ...]) -> None:
        """Read a file that is included by those around."""
        if file in self.done:
            return
        dialect = read_dialect(read_xml(Path(file)), file)
        below: list[str] = []
        for include in dialect.includes:
            target = os.path.normpath(Path(file).parent / include.path)
            self._check(include, target, (*around, file))
            self.read(target, (*around, file))
            below.append(target)
        self.included[file] = tuple(below)
        self.done[file] = dialect

    def _check(self, include: Include, target: str, around: tuple[str, ...]) -> None:
        if target in around:
            circle = " -> ".join(Path(file).name for file in (*around, target))
            hint = "a file that others include does not include them"
            raise DefinitionError(include.span, f"this include closes a circle: {circle}", hint)
        if not Path(target).is_file():
            message = f"there is no file `{include.path}` beside this one"
            names = [item.name for item in sorted(Path(target).parent.glob(f"*{_SUFFIX}"))]
            hint = hint_for(include.path, names) or "it has to lie there"
            raise DefinitionError(include.span, message, hint)
