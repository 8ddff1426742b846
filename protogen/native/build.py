"""Compiles drivers once, and keeps them in the user's cache."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from protogen.model.protocol import Protocol, Sender
from protogen.native.cache import SUFFIX, cache_folder, check, safe_folder
from protogen.native.compiler import Compiler, compiler
from protogen.native.errors import NativeError
from protogen.native.source import Driver, driver_of
from protogen.version import VERSION


@dataclass(frozen=True, slots=True)
class Built:
    """A library, and whether it was compiled just now."""

    driver: Driver
    path: Path
    is_new: bool


def build(protocol: Protocol, sender: Sender) -> Built:
    """The library for what `sender` sends; compiled unless it was before.

    Two processes may do this at once. Raises NativeError where it can't be done.
    """
    driver = driver_of(protocol, sender)
    found = compiler()
    folder = safe_folder(cache_folder())
    path = folder / f"{protocol.name}_{sender.name}-{_key(protocol, driver, found)}{SUFFIX}"
    is_new = not path.exists()
    if is_new:
        _compile(driver, found, path)
    check(path)
    return Built(driver, path, is_new)


def _key(protocol: Protocol, driver: Driver, found: Compiler) -> str:
    """Of everything that the library is made from."""
    text = hashlib.sha256(driver.text.encode()).hexdigest()
    words = (VERSION, protocol.spec_hash, driver.sender, found.identity, text)
    return hashlib.sha256("\n".join(words).encode()).hexdigest()[:24]


def _compile(driver: Driver, found: Compiler, path: Path) -> None:
    """Compile beside the library's place, and put it there at once."""
    try:
        with TemporaryDirectory(prefix=".build-", dir=path.parent) as name:
            source = Path(name, f"{driver.protocol}.c")
            library = Path(name, path.name)
            source.write_text(driver.text, encoding="utf-8")
            found.build(source, library)
            library.chmod(0o700)
            library.replace(path)
    except OSError as error:
        raise NativeError(f"{path.parent}: {error.strerror}") from None
