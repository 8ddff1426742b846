"""Projects of older versions: the folder that one was in, and the patterns in its own file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from protogen.evolution.revisions import NoVersionError, Revision
from protogen.problems import Problems, SourceMap
from protogen.project.find import project_in
from protogen.project.read import read_project


def own_patterns(folder: Path, given: str) -> Sequence[str]:
    """Patterns of the schemas in a folder's own project file. Raises NoVersionError."""
    file = project_in(folder)
    if file is None:
        return ()
    problems = Problems()
    project = read_project(file, problems, SourceMap())
    if project is None:
        words = "; ".join(problem.message for problem in problems)
        message = f"{file.name} of {given} can't be read: {words}"
        raise NoVersionError(message)
    return project.settings.schemas


def folder_then(revision: Revision) -> Path:
    """Folder that the project was in, as a path below the top.

    That is where it is now, or else where its file was moved from, as git tells, or as just one
    project's file is gone. Raises NoVersionError where several may be meant.
    """
    here = revision.inside
    now = project_in(revision.top / here)
    gone = _gone(revision)
    if now is None or not gone or project_in(revision.folder / here) is not None:
        return here
    moved = revision.moved_projects()
    file = now.relative_to(revision.top)
    sources = [old for old in gone if moved.get(old) == file]
    # Git takes any of several files with one text.
    texts = [(revision.folder / old).read_bytes() for old in sources]
    meant = [old for old in gone if (revision.folder / old).read_bytes() in texts]
    meant = meant or [old for old in gone if old not in moved]
    if len(meant) > 1:
        message = f"`{file}` is not in {revision.name}, and may have been moved from several places"
        folders = ", ".join(old.parent.as_posix() for old in meant)
        hint = f"name the folder that it was in: --against git:{revision.name}:FOLDER ({folders})"
        raise NoVersionError(message, hint)
    return meant[0].parent if meant else here


def _gone(revision: Revision) -> list[Path]:
    """Project files of a revision in whose folders there is no project now, below the top."""
    files = [file.relative_to(revision.folder) for file in sorted(revision.folder.rglob("*.toml"))]
    return [
        file
        for file in files
        if project_in(revision.folder / file.parent) == revision.folder / file
        and project_in(revision.top / file.parent) is None
    ]
