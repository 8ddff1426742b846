"""Compiled libraries in the user's folder for caches."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from protogen import cache_folder as caches
from protogen.native.errors import NativeError

SUFFIX = ".dll" if sys.platform == "win32" else ".so"


@contextmanager
def as_native_error() -> Iterator[None]:
    """Raise CacheErrors as NativeErrors."""
    try:
        yield
    except caches.CacheError as error:
        raise NativeError(str(error)) from None


@as_native_error()
def cache_folder() -> Path:
    """Folder of the libraries. Raises NativeError where the user has no folder for caches."""
    return caches.cache_folder("native")


def digest_of(content: bytes) -> str:
    """Hash of a library's content, as it is kept beside it."""
    return hashlib.sha256(content).hexdigest()


def digest_file(library: Path) -> Path:
    """The file with the hash of a library."""
    return library.with_name(f"{library.name}.sha256")


def is_whole(library: Path) -> bool:
    """True if a library is there and holds what was compiled: loading half of one can crash."""
    try:
        kept = digest_file(library).read_text(encoding="ascii")
        return kept == digest_of(library.read_bytes())
    except (OSError, ValueError):
        return False


def libraries() -> list[Path]:
    """The libraries that are kept."""
    folder = cache_folder()
    return sorted(folder.glob(f"*{SUFFIX}")) if folder.is_dir() else []


def clean() -> int:
    """Remove all libraries. Returns how many there were."""
    found = libraries()
    for library in found:
        library.unlink(missing_ok=True)
        digest_file(library).unlink(missing_ok=True)
    return len(found)
