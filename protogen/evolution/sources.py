"""Sources of versions of a schema: files, folders, and what git or a lock keeps of them."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import msgspec

from protogen.compiler import Compilation, compile_file
from protogen.copying import replace
from protogen.evolution.lock import LockError, read_lock
from protogen.evolution.projects import folder_then, own_patterns
from protogen.evolution.revisions import NoVersionError, Revision, extracted, is_revision
from protogen.problems import Problem, SourceMap, Span
from protogen.project.schemas import schemas_below
from protogen.schema.files import SUFFIX, schema_path

GIT = "git:"
"""Prefix of a version of a file in git: `git:main:schemas/rn1.yaml`."""
LOCK = "lock:"
"""Prefix of a lock file: `lock:protogen.lock`."""
_PROTOCOL = re.compile(rb"^protocol[ \t]*:[ \t]*(['\"]?)(\w+)\1", re.MULTILINE)
"""The line that names a schema's protocol."""


class Version(msgspec.Struct, frozen=True):
    """The schemas of one side, by their paths below what was given."""

    title: str
    compilations: dict[str, Compilation]
    revision: Revision | None = None

    def elsewhere(self) -> dict[str, str]:
        """The revision's schemas that are not among these: paths, and the protocols' names.

        A file is a schema by the line that names its protocol; none is compiled here.
        """
        if self.revision is None:
            return {}
        folder = self.revision.folder
        known = {Path(item.path) for item in self.compilations.values()}
        files = [file for file in sorted(folder.rglob(f"*{SUFFIX}")) if file not in known]
        found = {file: _PROTOCOL.search(file.read_bytes()) for file in files}
        return {
            file.relative_to(folder).as_posix(): named[2].decode()
            for file, named in found.items()
            if named is not None
        }

    def compiled(self, path: str) -> Compilation:
        """Compile a schema that is elsewhere in the revision."""
        assert self.revision is not None
        return _one(self.revision.folder / path, self.revision)


def names_no_path(given: str) -> bool:
    """True if a version is one of whatever path: `git:REV`, or a lock."""
    return given.startswith(LOCK) or (given.startswith(GIT) and ":" not in given.removeprefix(GIT))


@contextmanager
def opened(given: str, path: Path | None = None, *, may_lack: bool = False) -> Iterator[Version]:
    """The schemas of a file, a folder, `git:REV:path` or `lock:FILE`.

    `git:REV` alone is that version of `path`, and a lock what it holds of it. Where nothing is
    there, raises NoVersionError, or with `may_lack` yields a version without schemas.
    """
    with ExitStack() as stack:
        if given.startswith(LOCK):
            yield _locked(Path(given.removeprefix(LOCK)), path, may_lack=may_lack)
        elif given.startswith(GIT):
            yield _revised(given, path, stack, may_lack=may_lack)
        else:
            yield _compiled(given, schema_path(given), may_lack=may_lack)


def _revised(given: str, path: Path | None, stack: ExitStack, *, may_lack: bool) -> Version:
    name, _, named = given.removeprefix(GIT).partition(":")
    if not named and path is None:
        message = f"`{given}` names no file: write `{given}:PATH`"
        raise NoVersionError(message)
    wanted = Path(named) if named else path
    assert wanted is not None
    revision = stack.enter_context(extracted(name, wanted))
    inside = _inside(revision, named)
    revision.check_no_submodule(revision.top / inside)
    title = f"{name}:{inside.as_posix()}"
    return _compiled(title, revision.folder / inside, revision, may_lack=may_lack)


def _inside(revision: Revision, named: str) -> Path:
    """Path in a revision of what is named, from the working directory, or else from the top."""
    wanted = Path(named)
    from_top = named and not wanted.is_absolute() and ".." not in wanted.parts
    is_there = (revision.folder / revision.inside).exists()
    return wanted if from_top and not is_there else revision.inside


@contextmanager
def opened_project(
    folder: Path, patterns: Sequence[str], given: str | None = None
) -> Iterator[Version]:
    """The schemas of a project as they are now, by the patterns in its file.

    With `given` as they were: in `git:REV`, in `lock:FILE`, or in another folder, each by the
    patterns in its own project's file if it has one. There may be none. In a revision, the project
    may be in another folder: in the one that is named, or that its file was moved from. Raises
    NoVersionError.
    """
    if given is None:
        yield _below(str(folder), folder, patterns)
    elif given.startswith(LOCK):
        yield _locked(Path(given.removeprefix(LOCK)), folder, may_lack=True)
    elif not given.startswith(GIT):
        if not Path(given).is_dir():
            message = f"there is no folder `{given}`, to compare the project's schemas with"
            raise NoVersionError(message, hint_for_revision(given))
        yield _below(given, Path(given), own_patterns(Path(given), given) or patterns)
    else:
        name, _, named = given.removeprefix(GIT).partition(":")
        with extracted(name, Path(named) if named else folder) as revision:
            inside = _inside(revision, named) if named else folder_then(revision)
            place = revision.folder / inside
            place.mkdir(parents=True, exist_ok=True)  # Else `..` in patterns leads nowhere.
            patterns = own_patterns(place, given) or patterns
            for pattern in patterns:
                revision.check_no_submodule(revision.top / inside / pattern)
            yield _below(name, place, patterns, revision)


def hint_for_revision(given: str) -> str | None:
    """What to do where a path is not there that is a revision of git's."""
    if is_revision(given, Path.cwd()):
        return f"`{given}` is a revision: write {GIT}{given}"
    return None


def _locked(lock: Path, path: Path | None, *, may_lack: bool = False) -> Version:
    """Content of a lock for a schema, or for those in a folder; for all without a path."""
    try:
        kept = read_lock(lock)
    except LockError as error:
        raise NoVersionError(str(error)) from None
    found = {}
    for name, protocol in kept.items():
        place = (lock.parent / name).resolve()
        compilation = Compilation(name, protocol, (), SourceMap())
        if path is None:
            found[name] = compilation
        elif place == path.resolve():
            found[""] = compilation
        elif place.is_relative_to(path.resolve()):
            found[place.relative_to(path.resolve()).as_posix()] = compilation
    if not found and not may_lack:
        message = f"`{lock}` does not hold `{path}`; `protogen lock` writes it"
        raise NoVersionError(message)
    return Version(str(lock), found)


def _compiled(
    title: str, path: Path, revision: Revision | None = None, *, may_lack: bool
) -> Version:
    if path.is_file():
        return Version(title, {"": _one(path, revision)}, revision)
    found = Version(title, {}, revision)
    if path.is_dir():
        found = _below(title, path, ["."], revision)
    if not found.compilations and not may_lack:
        words = f"there is no `{title}`"
        if path.is_dir():
            words = f"the folder `{title}` holds no schema"
        raise NoVersionError(words, hint_for_revision(title) if revision is None else None)
    return found


def _below(
    title: str, folder: Path, patterns: Sequence[str], revision: Revision | None = None
) -> Version:
    files = schemas_below(folder, patterns)
    names = {Path(os.path.relpath(file, folder)).as_posix(): file for file in files}
    return Version(title, {name: _one(file, revision) for name, file in names.items()}, revision)


def _one(file: Path, revision: Revision | None) -> Compilation:
    """Compile a schema; problems of one in a revision name the revision, not where it lies now."""
    compilation = compile_file(file)
    if revision is None or compilation.protocol is not None:
        return compilation
    sources = SourceMap()
    for path in compilation.sources.files:
        sources.add(revision.label(path), compilation.sources.text(path) or "")
    problems = tuple(_labelled(item, revision) for item in compilation.problems)
    return Compilation(compilation.path, None, problems, sources)


def _labelled(problem: Problem, revision: Revision) -> Problem:
    def labelled(span: Span | None) -> Span | None:
        return None if span is None else replace(span, file=revision.label(span.file))

    notes = tuple((labelled(span), words) for span, words in problem.notes)
    return replace(problem, span=labelled(problem.span), notes=notes)
