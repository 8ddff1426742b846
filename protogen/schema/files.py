"""Schema files among files and folders."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from protogen.errors import UserError
from protogen.library import PREFIX, library_file, library_names

SUFFIX = ".yaml"


class NoSchemaError(UserError, ValueError):
    """A path where no schema is; the text says what is wrong with it."""


def schema_path(written: str | os.PathLike[str]) -> Path:
    """The path of a schema, which may be written `library:NAME`. Raises NoSchemaError."""
    text = os.fspath(written)
    if not text.startswith(PREFIX):
        return Path(text)
    name = text.removeprefix(PREFIX)
    found = library_file(name)
    if found is None:
        from protogen.problems import hint_for

        hint = hint_for(name, library_names()) or f"there are {', '.join(library_names())}"
        raise NoSchemaError(f"the library has no schema `{name}`", hint)
    return found


def schema_files(paths: Iterable[Path]) -> tuple[Path, ...]:
    """Return the files among `paths`, and the schemas in the folders among them, each once.

    Hidden files and folders are passed over, and pipes in folders. Raises NoSchemaError if a path
    is not there, or a folder holds no schema.
    """
    found: dict[Path, None] = {}
    for path in paths:
        found |= dict.fromkeys(_files_at(path))
    return tuple(found)


def _files_at(path: Path) -> Sequence[Path]:
    if not path.exists():
        raise NoSchemaError(f"there is no file or folder `{path}`")
    if not path.is_dir():
        return (path,)
    named = (file for file in path.rglob(f"*{SUFFIX}") if not _is_hidden(file, path))
    files = sorted(file for file in named if not file.is_fifo())
    if not files:
        raise NoSchemaError(f"the folder `{path}` holds no {SUFFIX} file")
    return files


def _is_hidden(file: Path, folder: Path) -> bool:
    return any(name.startswith(".") for name in file.relative_to(folder).parts)
