"""Files of storages that fsspec knows. Each storage's package has errors of its own."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from io import SEEK_SET, RawIOBase
from typing import Any, BinaryIO, cast

from protogen.convert.errors import ConvertError, needed


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
def open_stored(url: str) -> Iterator[BinaryIO]:
    """The bytes of a URL. Raises ConvertError and OSError, also while they are read."""
    fsspec = needed("fsspec", f"reading {url}")
    with ExitStack() as opening:
        with asked(url):
            file = opening.enter_context(fsspec.open(url, "rb"))
        yield cast(BinaryIO, _Stored(file, url))


class _Stored(RawIOBase):
    """A file that asks its storage for each piece."""

    def __init__(self, file: Any, url: str) -> None:
        self._file = file
        self._url = url

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return bool(self._file.seekable())

    def readinto(self, buffer: object, /) -> int:
        target = memoryview(cast(bytearray, buffer)).cast("B")
        with asked(self._url):
            data = self._file.read(len(target))
        target[: len(data)] = data
        return len(data)

    def seek(self, offset: int, whence: int = SEEK_SET, /) -> int:
        with asked(self._url):
            self._file.seek(offset, whence)  # Some, as those of SFTP, do not say where they are.
        return self.tell()

    def tell(self) -> int:
        with asked(self._url):
            place: int = self._file.tell()
        return place
