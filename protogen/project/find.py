"""Finds a project's file: `protogen.toml`, or a `pyproject.toml` with `[tool.protogen]`."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

OWN_FILE = "protogen.toml"
SHARED_FILE = "pyproject.toml"
_SHARED_TABLE = ("tool", "protogen")


def find_project(start: Path | None = None) -> Path | None:
    """Return the nearest file with settings, in the working directory or above it.

    The path is relative to the working directory.
    """
    current = Path.cwd() if start is None else start
    found = filter(None, map(project_in, (current, *current.parents)))
    file = next(found, None)
    return None if file is None else Path(os.path.relpath(file))


def project_in(folder: Path) -> Path | None:
    """Return the file with settings that is in a folder itself."""
    own, shared = folder / OWN_FILE, folder / SHARED_FILE
    if own.is_file():
        return own
    return shared if shared.is_file() and _has_table(shared) else None


def table_of(file: Path) -> tuple[str, ...]:
    """Return the table of the file that the settings are in; empty where that is the whole file."""
    return _SHARED_TABLE if file.name == SHARED_FILE else ()


def section(data: Any, file: Path) -> Any:
    """Return the settings in a file's data; None where there are none."""
    for step in table_of(file):
        data = data.get(step) if isinstance(data, Mapping) else None
    return data


def _has_table(file: Path) -> bool:
    """True if the shared file has the table. One that is no TOML is for others to complain of."""
    try:
        data = tomllib.loads(file.read_text("utf-8"))
    except (OSError, ValueError):
        return False
    return section(data, file) is not None
