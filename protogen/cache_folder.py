"""The user's folder for caches, which nobody else can put anything into."""

from __future__ import annotations

import os
import stat
import sys
from pathlib import Path


class CacheError(Exception):
    """A cache can't be used: the text says why."""


_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


def cache_folder(name: str) -> Path:
    """The folder of a cache: `$XDG_CACHE_HOME/protogen/NAME`, or the platform's like.

    Raises CacheError where the user has no folder for caches.
    """
    given = os.environ.get("XDG_CACHE_HOME", "")
    if given and Path(given).is_absolute():
        return Path(given, "protogen", name)
    try:
        return _of_platform(Path.home()) / "protogen" / name
    except RuntimeError:
        raise CacheError("there is no home folder to keep compiled code in") from None


def _of_platform(home: Path) -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    return home / "Library" / "Caches" if sys.platform == "darwin" else home / ".cache"


def safe_folder(folder: Path) -> Path:
    """Make the folder, unless it is there. Raises CacheError where others could write into it."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        real = folder.resolve(strict=True)
    except OSError as error:
        raise CacheError(f"{folder}: {error.strerror}") from None
    check(real)
    for outer in real.parents:
        check(outer, is_above=True)
    return real


def check(path: Path, *, is_above: bool = False) -> None:
    """Raise CacheError unless this user alone decides what stands there.

    What lies above may be the administrator's, and anybody's where only owners can remove things.
    """
    if sys.platform == "win32":
        return  # The folders of a user are the user's there.
    try:
        status = path.lstat()
    except OSError as error:
        raise CacheError(f"{path}: {error.strerror}") from None
    owners = (os.geteuid(), 0) if is_above else (os.geteuid(),)
    if status.st_uid not in owners:
        raise CacheError(f"{path} belongs to somebody else, and code from there is not loaded")
    is_sticky = is_above and bool(status.st_mode & stat.S_ISVTX)
    if status.st_mode & _OTHERS_WRITE and not is_sticky:
        raise CacheError(f"others can write to {path}, and code from there is not loaded")
