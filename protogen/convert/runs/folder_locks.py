"""Runs that write into one folder at the same time, and do not get into each other's way.

The system lets go of the locks of a process that ends, however it ends. Where it or the file system
has none, as Windows, two such runs are the user's care.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from protogen.convert.errors import ConvertError

try:
    import fcntl
except ImportError:  # pragma: no cover - on Windows
    _HAS_LOCKS = False
else:
    _HAS_LOCKS = True


@contextmanager
def one_after_another(folder: Path) -> Iterator[None]:
    """Wait until no other run is doing here what the caller is about to do. Raises OSError."""
    with _opened(folder, os.O_RDONLY) as descriptor:
        _lock(descriptor, wait=True)
        yield


@contextmanager
def alone(folder: Path, key: str) -> Iterator[None]:
    """Keep other runs from the files that `key` stands for. Raises ConvertError and OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f".{key}.lock"
    with ExitStack() as files:
        while True:
            descriptor = files.enter_context(_opened(path, os.O_RDWR | os.O_CREAT))
            if not _lock(descriptor, wait=False):
                raise ConvertError(
                    f"another run is writing {key} in {folder}",
                    "wait for it, or name another folder with --output",
                )
            if _is_still(path, descriptor):
                break
        try:
            yield
        finally:
            path.unlink(missing_ok=True)


@contextmanager
def _opened(path: Path, flags: int) -> Iterator[int]:
    descriptor = os.open(path, flags, 0o666)
    try:
        yield descriptor
    finally:
        os.close(descriptor)


def _lock(descriptor: int, *, wait: bool) -> bool:
    """True if no other process has the lock now."""
    if _HAS_LOCKS:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            return False
        except OSError:
            pass  # A file system without locks.
    return True


def _is_still(path: Path, descriptor: int) -> bool:
    """True unless the run that had the lock removed the file before it was locked."""
    try:
        return os.path.samestat(path.stat(), os.fstat(descriptor))
    except FileNotFoundError:
        return False
