"""Finds the schemas that a project's file names."""

from __future__ import annotations

import glob
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from protogen.problems import Problems
from protogen.schema.files import SUFFIX, schema_files

if TYPE_CHECKING:
    from protogen.project.read import Project

_GLOB = frozenset("*?[")


def named_paths(
    project: Project, key: str, patterns: Iterable[str], problems: Problems
) -> Iterator[Path]:
    """Yield the paths that a setting names; one that leads nowhere is reported."""
    for pattern in patterns:
        paths = list(matches(project.folder, pattern))
        if not paths:
            place = project.place(key, value=pattern)
            problems.add("PG033", place, f"there is nothing at `{pattern}`")
        yield from paths


def matches(folder: Path, pattern: str) -> Iterator[Path]:
    """Yield what a path or a glob below a folder leads to."""
    if (folder / pattern).exists():
        yield folder / pattern
    elif _GLOB.intersection(pattern):
        # Unlike that of pathlib, this one passes hidden files over and takes any path.
        names = glob.glob(pattern, root_dir=folder, recursive=True)  # noqa: PTH207
        paths = (folder / name for name in sorted(names))
        yield from (path for path in paths if not path.is_fifo())


def schemas_below(folder: Path, patterns: Iterable[str]) -> tuple[Path, ...]:
    """Return the schemas that patterns lead to below a folder; there may be none."""
    paths = [path for pattern in patterns for path in matches(folder, pattern)]
    return schema_files(path for path in paths if path.is_file() or any(path.rglob(f"*{SUFFIX}")))
