"""Where versions of a schema come from: files, folders, and what git or a lock keeps of them."""

from __future__ import annotations

import io
import subprocess
import tarfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from protogen.compiler import Compilation, compile_file
from protogen.evolution.lock import LockError, read_lock
from protogen.problems import SourceMap
from protogen.schema.files import schema_files

GIT = "git:"
"""What a version of a file in git begins with: `git:main:schemas/rn1.yaml`."""
LOCK = "lock:"
"""What a lock file begins with: `lock:protogen.lock`."""
_SUFFIXES = (".yaml", ".yml")


class NoVersionError(Exception):
    """A version that can't be had; the message says why."""


@dataclass(frozen=True, slots=True)
class Version:
    """The schemas of one side, by their paths below what was given."""

    title: str
    compilations: dict[str, Compilation]


@contextmanager
def opened(given: str, path: Path | None = None) -> Iterator[Version]:
    """The schemas of a file, a folder, `git:REV:path` or `lock:FILE`.

    `git:REV` alone is that version of `path`, and a lock what it holds of it. Raises
    NoVersionError.
    """
    if given.startswith(LOCK):
        yield _locked(Path(given.removeprefix(LOCK)), path)
        return
    if not given.startswith(GIT):
        yield _compiled(given, Path(given))
        return
    revision, _, named = given.removeprefix(GIT).partition(":")
    if not named and path is None:
        message = f"`{given}` names no file: write `{given}:PATH`"
        raise NoVersionError(message)
    wanted = Path(named) if named else path
    assert wanted is not None
    top = Path(_git("rev-parse", "--show-toplevel", folder=_folder(wanted)).decode().strip())
    with TemporaryDirectory(prefix="protogen-") as folder:
        _extract(revision, top, Path(folder))
        inside = _inside(wanted, top)
        if named and not (Path(folder) / inside).exists() and _is_below(wanted):
            inside = wanted
        (Path(folder) / ".git").touch()  # What marks a project, whose files extend each other.
        yield _compiled(f"{revision}:{inside.as_posix()}", Path(folder) / inside)


def _locked(lock: Path, path: Path | None) -> Version:
    """What a lock keeps of a schema, or of those in a folder; of all without a path."""
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
    if not found:
        message = f"`{lock}` does not hold `{path}`; `protogen lock` writes it"
        raise NoVersionError(message)
    return Version(str(lock), found)


def _compiled(title: str, path: Path) -> Version:
    if path.is_file():
        return Version(title, {"": compile_file(path)})
    if not path.is_dir():
        message = f"there is no `{title}`"
        raise NoVersionError(message)
    files = schema_files([path])
    return Version(title, {file.relative_to(path).as_posix(): compile_file(file) for file in files})


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
    """Whether a path may be meant from the top of a repository, as git has them."""
    return not path.is_absolute() and ".." not in path.parts


def _extract(revision: str, top: Path, folder: Path) -> None:
    """Write every YAML file of a revision: schemas extend each other."""
    listed = _git("ls-tree", "-r", "-z", "--name-only", revision, folder=top).decode().split("\0")
    names = [name for name in listed if name.endswith(_SUFFIXES)]
    if not names:
        return
    data = _git("archive", "--format=tar", revision, "--", *names, folder=top)
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        archive.extractall(folder, filter="data")


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
