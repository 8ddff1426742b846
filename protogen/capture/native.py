"""Fills tables by generated C."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from protogen.capture.arrays import dtype_of, numpy
from protogen.capture.schema import CaptureSchema
from protogen.capture.tables import Tables
from protogen.model.protocol import Protocol, Sender
from protogen.native.build import build
from protogen.native.library import Decoder, Library

if TYPE_CHECKING:
    import numpy as np

    from protogen.capture.tables import Rows

BUDGET = 8 << 20
"""Bytes of a table that is full. A batch ends there."""


_LIBRARIES: dict[Path, Library] = {}
"""Those that were loaded: nobody unloads them."""


def library_of(protocol: Protocol, sender: Sender) -> Library:
    """The library for what `sender` sends. Raises NativeError."""
    built = build(protocol, sender)
    if built.path not in _LIBRARIES:
        _LIBRARIES[built.path] = Library(built.path, built.driver)
    return _LIBRARIES[built.path]


def address_of(data: bytes | memoryview) -> int:
    """Where the bytes lie, which have to stay there."""
    found: int = numpy().frombuffer(data, "u1").ctypes.data
    return found


class Dtypes:
    """The dtypes of all tables, in the library's order, and empty tables."""

    def __init__(self, schema: CaptureSchema) -> None:
        tables = [*schema.messages.values(), schema.invalid, schema.unknown]
        self.each: list[np.dtype[Any]] = [*map(dtype_of, tables), numpy().dtype("u1")]
        self.empty: list[Rows] = [numpy().zeros(0, dtype) for dtype in self.each]


class NativeEngine:
    """A stream that becomes tables, some bytes at a time."""

    name = "native"

    def __init__(self, library: Library, budget: int = BUDGET) -> None:
        self._schema = library.schema
        self._decoder = Decoder(library, budget)
        self._dtypes = Dtypes(library.schema)
        self._offset = 0
        self._sequence = 0

    def feed(self, data: bytes | memoryview) -> Iterator[Tables]:
        """Take the next bytes of the stream."""
        if not len(data):
            return
        address, taken = address_of(data), 0
        while taken < len(data):
            taken += self._decoder.feed(address + taken, len(data) - taken)
            yield self._tables()

    def flush(self) -> Iterator[Tables]:
        """Take the end of the stream."""
        self._decoder.flush()
        yield self._tables()

    def _tables(self) -> Tables:
        decoder = self._decoder
        every = [
            copied(table, dtype) if table.count else empty
            for table, dtype, empty in zip(
                decoder.tables, self._dtypes.each, self._dtypes.empty, strict=True
            )
        ]
        found = tables_of(
            self._schema,
            every,
            (self._offset, decoder.offset),
            (self._sequence, decoder.sequence),
        )
        self._offset, self._sequence = decoder.offset, decoder.sequence
        decoder.clear()
        return found


def tables_of(
    schema: CaptureSchema, every: list[Rows], offsets: tuple[int, int], numbers: tuple[int, int]
) -> Tables:
    """Tables in the library's order: first and next offset, first and next number."""
    *messages, invalid, unknown, payloads = every
    return Tables(
        schema=schema,
        engine=NativeEngine.name,
        messages=dict(zip(schema.messages, messages, strict=True)),
        invalid=invalid,
        unknown=unknown,
        payloads=payloads,
        offset=offsets[0],
        size=offsets[1] - offsets[0],
        sequence=numbers[0],
        events=numbers[1] - numbers[0],
    )


def copied(table: Any, dtype: np.dtype[Any]) -> Rows:
    """The rows of a table of C."""
    found: Rows = numpy().empty(table.count, dtype)
    ctypes.memmove(found.ctypes.data, table.rows, found.nbytes)
    return found
