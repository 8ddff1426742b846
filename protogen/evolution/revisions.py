"""Revisions in git: a folder with the schemas of one, and why one can't be had."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory

import msgspec

from protogen.errors import UserError
from protogen.project.find import OWN_FILE, SHARED_FILE

_SUFFIXES = (".yaml", ".yml")
_LINK = "120000"
"""Mode of a symbolic link in a tree."""
_GITLINK = "160000"
"""Mode of a submodule in a tree: git keeps its commit there, and none of its files."""


class NoVersionError(UserError):
    """A version that can't be had; the message says why."""


class Revision(msgspec.Struct, frozen=True):
    """A revision's schemas and project files, extracted to a folder."""

    name: str
    top: Path
    """The repository."""
    folder: Path
    inside: Path
    """Path in the folder of what was asked for."""
    submodules: tuple[str, ...]

    def label(self, file: str) -> str:
        """The name of an extracted file in messages: `main:schemas/rover.yaml`."""
        path = Path(file)
        within = path.relative_to(self.folder) if path.is_relative_to(self.folder) else path
        return f"{self.name}:{within.as_posix()}"

    def check_no_submodule(self, path: Path) -> None:
        """Raise NoVersionError if a path in the working tree is in a submodule."""
        inside = _inside(path, self.top)
        for name in self.submodules:
            if inside.is_relative_to(name):
                message = f"`{name}` is a submodule: {self.name} keeps its commit, not its files"
                hint = f"compare inside of it, in the folder {name}, with a revision of its own"
                raise NoVersionError(message, hint)

    def moved_projects(self) -> dict[Path, Path]:
        """Project files that git finds in another place now: old and new paths below the top."""
        files = [f":(top,glob)**/{name}" for name in (OWN_FILE, SHARED_FILE)]
        moves = ("diff", "--find-renames", "--diff-filter=R", "--name-status", "-z")
        fields = _git(*moves, self.name, "--", *files, folder=self.top).decode().split("\0")
        return {Path(old): Path(new) for old, new in zip(fields[1::3], fields[2::3], strict=True)}


@contextmanager
def extracted(name: str, wanted: Path) -> Iterator[Revision]:
    """A revision of the repository that a path is in. Raises NoVersionError."""
    top = Path(_git("rev-parse", "--show-toplevel", folder=_folder(wanted)).decode().strip())
    inside = _inside(wanted, top)
    with TemporaryDirectory(prefix="protogen-") as temporary:
        folder = Path(temporary)
        submodules = _extract(name, top, folder)
        (folder / ".git").touch()  # What marks a project, whose files extend each other.
        yield Revision(name, top, folder, inside, submodules)


def path_in_repository(file: str) -> str:
    """The path of a file below the top of its repository; as it is given where there is none."""
    path = Path(file)
    try:
        done = _run("rev-parse", "--show-toplevel", folder=_folder(path.parent))
    except NoVersionError:
        return file
    top, resolved = Path(done.stdout.decode().strip()), path.resolve()
    if done.returncode or not resolved.is_relative_to(top):
        return file
    return resolved.relative_to(top).as_posix()


def is_revision(name: str, folder: Path) -> bool:
    """True if git knows a revision by this name in a folder."""
    done = _run("rev-parse", "--verify", "--quiet", f"{name}^{{commit}}", folder=folder)
    return done.returncode == 0


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


def _extract(revision: str, top: Path, folder: Path) -> tuple[str, ...]:
    """Write every YAML file of a revision, as schemas extend each other, and project files.

    Returns the submodules. `HEAD` of a repository without commits holds nothing.
    """
    if revision == "HEAD" and not _git("rev-list", "-n", "1", "--all", folder=top):
        return ()
    if not is_revision(revision, top):
        raise _missing(revision, top)
    listed = _git("ls-tree", "-r", "-z", revision, folder=top).decode().split("\0")
    entries = [entry.partition("\t") for entry in listed if entry]
    names = [name for mode, _, name in entries if mode.startswith(_LINK) or _is_wanted(name)]
    # Not by `git archive`, which leaves out what attributes keep from releases.
    index = {"GIT_INDEX_FILE": str(folder / ".index")}
    _git("read-tree", revision, folder=top, settings=index)
    written = ("checkout-index", "-z", "--stdin", f"--prefix={folder}/")
    _git(*written, folder=top, settings=index, text="\0".join(names).encode())
    _keep_links_inside(folder, top)
    return tuple(name for mode, _, name in entries if mode.startswith(_GITLINK))


def _keep_links_inside(folder: Path, top: Path) -> None:
    """Let links into the repository lead into the revision; those that lead out of it go."""
    links = [path for path in folder.rglob("*") if path.is_symlink()]
    for link in links:
        target = link.readlink()
        if target.is_absolute() and target.is_relative_to(top):
            link.unlink()
            link.symlink_to(folder / target.relative_to(top))
    for link in links:
        # Path.resolve raises errors for links that lead to themselves.
        place = Path(os.path.realpath(link))
        if not (place.exists() and place.is_relative_to(os.path.realpath(folder))):
            link.unlink()


def _is_wanted(name: str) -> bool:
    return name.endswith(_SUFFIXES) or PurePosixPath(name).name in (OWN_FILE, SHARED_FILE)


def _missing(revision: str, top: Path) -> NoVersionError:
    """The error for a revision that git does not know here, with the command that gets it."""
    remote, slash, branch = revision.partition("/")
    remotes = _git("remote", folder=top).decode().split()
    fetch = f"git fetch {remote} {branch}" if slash and remote in remotes else "git fetch --all"
    if _git("rev-parse", "--is-shallow-repository", folder=top).strip() == b"true":
        hint = f"this clone is shallow: `{fetch} --unshallow`, or clone with the whole history"
        return NoVersionError(f"git has no revision `{revision}` here", hint)
    return NoVersionError(f"git has no revision `{revision}` here", f"`{fetch}` gets new ones")


def _git(
    *arguments: str, folder: Path, settings: Mapping[str, str] | None = None, text: bytes = b""
) -> bytes:
    done = _run(*arguments, folder=folder, settings=settings, text=text)
    if done.returncode:
        message = f"git: {done.stderr.decode(errors='replace').strip()}"
        raise NoVersionError(message)
    return done.stdout


def _run(
    *arguments: str, folder: Path, settings: Mapping[str, str] | None = None, text: bytes = b""
) -> subprocess.CompletedProcess[bytes]:
    command = ["git", *arguments]
    environment = {**os.environ, **(settings or {})}
    try:
        return subprocess.run(
            command, capture_output=True, check=False, cwd=folder, env=environment, input=text
        )
    except FileNotFoundError:
        message = "git is not installed"
        raise NoVersionError(message) from None
