"""Files of storages that fsspec knows. Each storage's package has errors of its own."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any, Protocol

from protogen.convert.errors import ConvertError, needed


class Stream(Protocol):
    """Bytes of a capture, as files have them."""

    def read(self, size: int, /) -> bytes | None:
        """The next bytes, at most so many: none at the end."""

    def seek(self, offset: int, /) -> Any:
        """Go to a byte."""


@contextmanager
def asked(url: str) -> Iterator[None]:
    """Raise ConvertError for what a storage's package says in its own way, as of credentials."""
    try:
        yield
    except (OSError, EOFError, MemoryError, zlib.error):
        raise
    except Exception as error:
        raise ConvertError(f"{url}: {str(error) or type(error).__name__}") from None


@contextmanager
def open_stored(url: str) -> Iterator[Stream]:
    """The bytes of a URL. Raises ConvertError and OSError, also while they are read."""
    fsspec = needed("fsspec", f"reading {url}")
    with ExitStack() as opening:
        with asked(url):
            file = opening.enter_context(fsspec.open(url, "rb"))
        yield _Stored(file, url)


class _Stored:
    """A file that asks its storage for each piece."""

    def __init__(self, file: Any, url: str) -> None:
        self._file = file
        self._url = url

    def read(self, size: int, /) -> bytes:
        with asked(self._url):
            data: bytes = self._file.read(size)
        return data

    def seek(self, offset: int, /) -> None:
        with asked(self._url):
            self._file.seek(offset)
