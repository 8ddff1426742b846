"""Compiled libraries in the user's folder for caches."""

from __future__ import annotations

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


def libraries() -> list[Path]:
    """The libraries that are kept."""
    folder = cache_folder()
    return sorted(folder.glob(f"*{SUFFIX}")) if folder.is_dir() else []


def clean() -> int:
    """Remove all libraries. Returns how many there were."""
    found = libraries()
    for library in found:
        library.unlink(missing_ok=True)
    return len(found)
