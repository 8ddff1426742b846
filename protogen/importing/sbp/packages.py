"""Files of definitions, and those that they include, in an order in which none comes too early."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import msgspec

from protogen.errors import UserError
from protogen.importing.remarks import DefinitionError, Kind, Remark
from protogen.importing.sbp.spec import Definition, Include, Package, is_package, read_package
from protogen.problems import Problems, SourceMap, hint_for
from protogen.schema.text.document import read_document

_SHAPE = "such a file has `package`, `description` and `definitions`"
_TWICE = "PG006"
"""Code of a key that stands twice, which other readers of definitions take."""


class Packages(msgspec.Struct, frozen=True):
    """Packages by the path of their file, each behind those that it includes."""

    by_file: dict[str, Package]
    included: dict[str, tuple[str, ...]]
    """Files that a file includes."""
    others: int
    """Number of files in the folder that hold something else."""

    def visible(self, file: str) -> Iterator[Package]:
        """Yield the package of a file and all that it includes, directly or not."""
        waiting, seen = [file], {file}
        while waiting:
            current = waiting.pop(0)
            yield self.by_file[current]
            new = [item for item in self.included[current] if item not in seen]
            seen.update(new)
            waiting += new

    def find_struct(self, file: str, name: str) -> tuple[str, Definition] | None:
        """Return the file and the definition of a struct that a file can refer to."""
        for package in self.visible(file):
            for definition in package.definitions:
                if definition.name == name and definition.id is None:
                    return package.file, definition
        return None

    def hint(self, file: str, name: str) -> str | None:
        """Return what is probably wrong where a file refers to an unknown type."""
        for other in self.by_file.values():
            if any(item.name == name and item.id is None for item in other.definitions):
                return f"{Path(other.file).name} defines it, and is not included"
        names = [item.name for package in self.visible(file) for item in package.definitions]
        return hint_for(name, names)


def read_packages(
    path: Path, problems: Problems, sources: SourceMap, remarks: list[Remark]
) -> Packages | None:
    """Read the definitions in a folder, or a file, and all that they include.

    Returns None if one of them is no YAML, which is reported. Raises UserError where there is no
    definition, and for a mistake in one.
    """
    reader = _Reader(problems, sources, remarks)
    for file in _files_at(path):
        reader.read(_normal(file), (), must_define=not path.is_dir())
    if problems.errors:
        return None
    if not reader.done:
        raise UserError(f"no file in `{path}` holds definitions of SBP", _SHAPE)
    return Packages(reader.done, reader.included, len(reader.included) - len(reader.done))


def _files_at(path: Path) -> tuple[Path, ...]:
    if not path.exists():
        raise UserError(f"there is no file or folder `{path}`")
    if not path.is_dir():
        return (path,)
    found = sorted(file for file in path.rglob("*.yaml") if file.is_file())
    if not found:
        raise UserError(f"the folder `{path}` holds no .yaml file")
    return tuple(found)


def _normal(file: Path) -> str:
    return os.path.normpath(file)


class _Reader:
    """Reads files, each once, those that it includes first."""

    def __init__(self, problems: Problems, sources: SourceMap, remarks: list[Remark]) -> None:
        self.done: dict[str, Package] = {}
        self.included: dict[str, tuple[str, ...]] = {}
        self._problems = problems
        self._sources = sources
        self._remarks = remarks

    def read(self, file: str, around: tuple[str, ...], *, must_define: bool = True) -> None:
        """Read a file that is included by those around.

        Raises DefinitionError if it defines nothing and has to.
        """
        if file in self.done or (file in self.included and not must_define):
            return
        package = self._parse(file, must_define=must_define)
        self.included[file] = ()
        if package is None:
            return
        below: list[str] = []
        for include in package.includes:
            target = _normal(Path(file).parent / include.path)
            self._check(include, target, (*around, file))
            self.read(target, (*around, file))
            below.append(target)
        self.included[file] = tuple(below)
        self.done[file] = package

    def _parse(self, file: str, *, must_define: bool) -> Package | None:
        found = Problems()
        document = read_document(file, found, self._sources)
        for problem in found:
            if problem.code == _TWICE and problem.span is not None:
                reason = f"{problem.message}; the first one counts"
                self._remarks.append(Remark(Kind.CHANGED, Path(file).name, reason, problem.span))
            else:
                self._problems.extend([problem])
        if document is None or not (must_define or is_package(document.root)):
            return None
        if not is_package(document.root):
            raise DefinitionError(document.root.span, "these are no definitions of SBP", _SHAPE)
        return read_package(document.root, file)

    def _check(self, include: Include, target: str, around: tuple[str, ...]) -> None:
        if target in around:
            circle = " -> ".join(Path(file).name for file in (*around, target))
            raise DefinitionError(include.span, f"this include closes a circle: {circle}")
        if target not in self.included and not Path(target).is_file():
            message = f"there is no file `{include.path}` beside this one"
            names = [item.name for item in sorted(Path(target).parent.glob("*.yaml"))]
            raise DefinitionError(include.span, message, hint_for(include.path, names))
