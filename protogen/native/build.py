"""Compiles drivers once, and keeps them in the user's cache."""

from __future__ import annotations

import hashlib
import platform
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec

from protogen.cache_folder import check, safe_folder
from protogen.native.cache import (
    SUFFIX,
    as_native_error,
    cache_folder,
    digest_file,
    digest_of,
    is_whole,
)
from protogen.native.compiler import Compiler, compilers, working
from protogen.native.driver import Driver
from protogen.native.errors import NativeError, NoCompilerError
from protogen.version import VERSION


class Built(msgspec.Struct, frozen=True):
    """A library, and whether it was compiled just now."""

    path: Path
    is_new: bool


def build(driver: Driver) -> Built:
    """The library of a driver; compiled unless it was before.

    Two processes may do this at once. Raises NativeError where it can't be done.
    """
    schema = driver.schema
    sender = f"{schema.sender}_{schema.form}" if schema.form else schema.sender
    return compiled(f"{schema.protocol}_{sender}", driver.text, (schema.spec_hash, sender))


@as_native_error()
def compiled(name: str, text: str, words: tuple[str, ...]) -> Built:
    """The library of a C source.

    `words`: what else it depends on. Raises NativeError.
    """
    made_from = (VERSION, *words, *_machine(), _digest(text))
    stem = f"{name}-{_digest(*made_from)[:24]}"
    try:
        found = compilers()
    except NoCompilerError:
        path = _built_ahead(stem)
        if path is None:
            raise
        return Built(path, False)
    folder = safe_folder(cache_folder())
    paths = [folder / f"{stem}-{_digest(item.identity)[:8]}{SUFFIX}" for item in found]
    path = next((path for path in paths if is_whole(path)), None)
    is_new = path is None
    if path is None:
        chosen = working(found)
        path = paths[found.index(chosen)]
        _compile(text, chosen, path)
    check(path)
    return Built(path, is_new)


def _machine() -> tuple[str, ...]:
    """Words for what loads a library: of several machines that share a cache, each has its own."""
    # A word such as `x86_64-linux-musl`: other C libraries, and fewer bits, are others, too.
    return sys.platform, platform.machine(), getattr(sys.implementation, "_multiarch", "")


def _built_ahead(stem: str) -> Path | None:
    """The library that a compiler made while there was one, the newest of several."""
    try:
        folder = cache_folder()
        if not folder.is_dir():
            return None
        built = filter(is_whole, safe_folder(folder).glob(f"{stem}-*{SUFFIX}"))
        path = max(built, key=lambda item: item.stat().st_mtime_ns, default=None)
    except OSError:  # Somebody cleans the cache, or does not let us look there.
        return None
    if path is not None:
        check(path)
    return path


def _digest(*words: str) -> str:
    return hashlib.sha256("\n".join(words).encode()).hexdigest()


def _compile(text: str, found: Compiler, path: Path) -> None:
    """Compile beside the library's place, and put it there at once."""
    try:
        with TemporaryDirectory(prefix=".build-", dir=path.parent) as name:
            source = Path(name, "source.c")
            library = Path(name, path.name)
            source.write_text(text, encoding="utf-8")
            found.build(source, library)
            library.chmod(0o700)
            digest = Path(name, "digest")
            digest.write_text(digest_of(library.read_bytes()), encoding="ascii")
            digest.replace(digest_file(path))
            library.replace(path)
    except OSError as error:
        raise NativeError(f"{path.parent}: {error.strerror}") from None
