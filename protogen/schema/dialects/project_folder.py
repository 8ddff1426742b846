"""The folder that a schema and everything that it extends has to be in."""

from __future__ import annotations

import os
from pathlib import Path

_PROJECT_MARKS = (".git", "pyproject.toml", "protogen.toml")


def project_folder(file: str) -> Path:
    """Return the folder that ``file`` may not reach out of by `extends`.

    It is the nearest one above that holds ``.git``, ``pyproject.toml`` or ``protogen.toml``; else
    the current folder, if the file is inside; else the file's own. Symbolic links are followed.
    """
    own = Path(os.path.realpath(file)).parent
    for folder in (own, *own.parents):
        if any((folder / mark).exists() for mark in _PROJECT_MARKS):
            return folder
    current = Path.cwd().resolve()
    return current if own.is_relative_to(current) else own
