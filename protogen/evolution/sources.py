"""Sources of versions of a schema: files, folders, and what git or a lock keeps of them."""

from __future__ import annotations

import io
import os
import subprocess
import tarfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import msgspec

from protogen.compiler import Compilation, compile_file
from protogen.errors import UserError
from protogen.evolution.lock import LockError, read_lock
from protogen.problems import SourceMap
from protogen.project.schemas import schemas_below

GIT = "git:"
"""Prefix of a version of a file in git: `git:main:schemas/rn1.yaml`."""
LOCK = "lock:"
"""Prefix of a lock file: `lock:protogen.lock`."""
_SUFFIXES = (".yaml", ".yml")


class NoVersionError(UserError):
    """A version that can't be had; the message says why."""


class _AbsentError(NoVersionError):
    """A place where no schema is."""


class Version(msgspec.Struct, frozen=True):
    """The schemas of one side, by their paths below what was given."""

    title: str
    compilations: dict[str, Compilation]


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
        try:
            found = _version(given, path, stack)
        except _AbsentError:
            if not may_lack:
                raise
            found = Version(given, {})
        yield found


def _version(given: str, path: Path | None, stack: ExitStack) -> Version:
    if given.startswith(LOCK):
        return _locked(Path(given.removeprefix(LOCK)), path)
    return _revised(given, path, stack) if given.startswith(GIT) else _compiled(given, Path(given))


def _revised(given: str, path: Path | None, stack: ExitStack) -> Version:
    revision, _, named = given.removeprefix(GIT).partition(":")
    if not named and path is None:
        message = f"`{given}` names no file: write `{given}:PATH`"
        raise NoVersionError(message)
    wanted = Path(named) if named else path
    assert wanted is not None
    folder, inside = stack.enter_context(_extracted(revision, wanted))
    if named and not (folder / inside).exists() and _is_below(wanted):
        inside = wanted
    return _compiled(f"{revision}:{inside.as_posix()}", folder / inside)


@contextmanager
def opened_project(
    folder: Path, patterns: Sequence[str], given: str | None = None
) -> Iterator[Version]:
    """The schemas that patterns name below a project's folder, as they are now.

    With `given` as they were: in `git:REV`, in `lock:FILE`, or in another folder. There may be
    none. Raises NoVersionError.
    """
    if given is None:
        yield _below(str(folder), folder, patterns)
    elif given.startswith(LOCK):
        yield _locked(Path(given.removeprefix(LOCK)), folder, may_lack=True)
    elif not given.startswith(GIT):
        if not Path(given).is_dir():
            message = f"there is no folder `{given}`, to compare the project's schemas with"
            raise NoVersionError(message)
        yield _below(given, Path(given), patterns)
    else:
        revision, _, named = given.removeprefix(GIT).partition(":")
        with _extracted(revision, Path(named) if named else folder) as (whole, inside):
            yield _below(revision, whole / inside, patterns)


@contextmanager
def _extracted(revision: str, wanted: Path) -> Iterator[tuple[Path, Path]]:
    """A folder with the YAML files of a revision, and where `wanted` is in it."""
    top = Path(_git("rev-parse", "--show-toplevel", folder=_folder(wanted)).decode().strip())
    with TemporaryDirectory(prefix="protogen-") as name:
        folder = Path(name)
        _extract(revision, top, folder)
        (folder / ".git").touch()  # What marks a project, whose files extend each other.
        yield folder, _inside(wanted, top)


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


def _compiled(title: str, path: Path) -> Version:
    if path.is_file():
        return Version(title, {"": compile_file(path)})
    if not path.is_dir():
        message = f"there is no `{title}`"
        raise _AbsentError(message)
    found = _below(title, path, ["."])
    if not found.compilations:
        message = f"the folder `{title}` holds no schema"
        raise _AbsentError(message)
    return found


def _below(title: str, folder: Path, patterns: Sequence[str]) -> Version:
    files = schemas_below(folder, patterns)
    names = {Path(os.path.relpath(file, folder)).as_posix(): file for file in files}
    return Version(title, {name: compile_file(file) for name, file in names.items()})


def _folder(path: Path) -> Path:
    """The nearest folder that is there, to ask git in."""
    here = path.resolve()
    return next(folder for folder in (here, *here.parents) if folder.is_dir())


def _inside(path: Path, top: Path) -> Path:
    """The path below the top of a repository of what is below the working directory."""
    resolved = path.resolve()
    if not resolved.is_relative_to(top):
        message = f"`{path}` is not in the repository `{top}`"
        raise NoVersionError(message)
    return resolved.relative_to(top)


def _is_below(path: Path) -> bool:
    """True if a path may be meant from the top of a repository, as git has them."""
    return not path.is_absolute() and ".." not in path.parts


def _extract(revision: str, top: Path, folder: Path) -> None:
    """Write every YAML file of a revision: schemas extend each other.

    `HEAD` of a repository without commits holds none.
    """
    if revision == "HEAD" and not _git("rev-list", "-n", "1", "--all", folder=top):
        return
    listed = _git("ls-tree", "-r", "-z", "--name-only", revision, folder=top).decode().split("\0")
    names = [name for name in listed if name.endswith(_SUFFIXES)]
    if not names:
        return
    data = _git("archive", "--format=tar", revision, "--", *names, folder=top)
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        # Python before 3.11.4 has no filters.
        filters: Any = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}
        archive.extractall(folder, **filters)  # noqa: S202 - git's paths do not lead outside


def _git(*arguments: str, folder: Path) -> bytes:
    try:
        done = subprocess.run(
            ["git", *arguments],
            capture_output=True,
            check=False,
            cwd=folder,
        )
    except FileNotFoundError:
        message = "git is not installed"
        raise NoVersionError(message) from None
    if done.returncode:
        message = f"git: {done.stderr.decode(errors='replace').strip()}"
        raise NoVersionError(message)
    return done.stdout
