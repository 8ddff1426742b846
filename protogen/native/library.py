"""A compiled driver, loaded with ctypes. Its functions run without the GIL."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any
from weakref import finalize

from protogen.native.errors import NativeError
from protogen.native.source import Driver


class Table(ctypes.Structure):
    """`struct protogen_table`."""

    _fields_ = (
        ("rows", ctypes.c_void_p),
        ("count", ctypes.c_size_t),
        ("soft", ctypes.c_size_t),
        ("capacity", ctypes.c_size_t),
    )


class Library:
    """The functions of a driver. Raises NativeError unless its rows lie as the schema says."""

    def __init__(self, path: Path, driver: Driver) -> None:
        try:
            library = ctypes.CDLL(str(path))
        except OSError as error:
            raise NativeError(f"{path} can't be loaded: {error}") from None
        self.schema = driver.schema
        expected = driver.layout
        found = (ctypes.c_size_t * len(expected)).in_dll(library, "protogen_layout")
        if tuple(found) != expected:
            raise NativeError("the compiler lays structs out in a way of its own")
        self.tables = len(self.schema.messages) + 3
        pointer, size, long = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_uint64
        self.new = _function(library, "protogen_new", pointer, long)
        self.free = _function(library, "protogen_free", None, pointer)
        self.start = _function(library, "protogen_start", None, pointer, long, long)
        self.feed = _function(library, "protogen_feed", size, pointer, pointer, size)
        self.flush = _function(library, "protogen_flush", None, pointer)
        self.clear = _function(library, "protogen_clear", None, pointer)


def _function(library: ctypes.CDLL, name: str, result: Any, *arguments: Any) -> Any:
    function = getattr(library, name)
    function.restype, function.argtypes = result, arguments
    return function


class Decoder:
    """A stream that becomes rows in tables of C.

    A table is full at `budget` bytes; it then takes what the bytes at hand still bring, and `feed`
    returns.
    """

    def __init__(self, library: Library, budget: int) -> None:
        self._library = library
        self._pointer = library.new(budget)
        if not self._pointer:
            raise MemoryError
        finalize(self, library.free, self._pointer)
        self._state = _state(library.tables).from_address(self._pointer)

    def start(self, offset: int, sequence: int) -> None:
        """Begin a stream: offset of its first byte, number of its first event."""
        self._library.start(self._pointer, offset, sequence)

    def feed(self, address: int, size: int) -> int:
        """Take bytes at an address until a table is full. Returns how many were taken."""
        taken: int = self._library.feed(self._pointer, address, size)
        self._check()
        return taken

    def flush(self) -> None:
        """Take the end of the stream."""
        self._library.flush(self._pointer)
        self._check()

    def clear(self) -> None:
        """Forget the rows."""
        self._library.clear(self._pointer)

    @property
    def offset(self) -> int:
        """Of the first byte that no event covers yet."""
        return int(self._state.offset)

    @property
    def sequence(self) -> int:
        """The number of the next event."""
        return int(self._state.sequence)

    @property
    def tables(self) -> Any:
        """All tables: of the messages, invalid, unknown, payloads."""
        return self._state.tables

    def _check(self) -> None:
        if self._state.failed:
            raise MemoryError


def _state(tables: int) -> type[ctypes.Structure]:
    """What `struct protogen_capture` begins with."""

    class State(ctypes.Structure):
        _fields_ = (
            ("tables", Table * tables),
            ("offset", ctypes.c_uint64),
            ("sequence", ctypes.c_uint64),
            ("budget", ctypes.c_uint64),
            ("is_full", ctypes.c_uint32),
            ("failed", ctypes.c_uint32),
        )

    return State
