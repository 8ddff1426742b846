"""Reads captures: all of one at once, or batch by batch in constant memory."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import BinaryIO

import msgspec

from protogen.capture.arrays import numpy
from protogen.capture.engines import Engine, EngineName, Maker, makers
from protogen.capture.errors import CaptureError
from protogen.capture.gather import Gathering, gathered
from protogen.capture.memory import Lender
from protogen.capture.parallel import Parts
from protogen.capture.protocols import protocol_of, sender_of
from protogen.capture.source import Source, opened, pieces
from protogen.capture.tables import Tables
from protogen.model.protocol import Protocol

CHUNK = 2 << 20
"""Bytes of a capture that are decoded at once."""


def columns(
    source: Source,
    protocol: Protocol | str | os.PathLike[str],
    sender: str,
    *,
    engine: EngineName | None = None,
    workers: int = 1,
) -> Tables:
    """All events of a capture of what `sender` sends.

    `source` is a path, whose file is mapped into memory, bytes, or an open binary file. `protocol`
    is a schema's name or path, or the resolved protocol. `engine` is `native`, generated C that the
    system's compiler compiles once, or `python`; None: native where there is a compiler. `workers`
    is how many threads decode, the caller's among them, where the engine is native and the capture
    is in memory or in a file; the result is always the same.

    Raises CaptureError, SchemaError, and MissingPackageError where NumPy is not installed.
    """
    _check(workers=workers)
    with _reading(source, protocol, sender, engine) as reading:
        if workers > 1:
            return gathered(reading.tables(None, workers), reading.total, workers)
        found = Gathering(reading.total)
        for piece in reading.tables(None, workers, found):
            found.add(piece)
        return found.tables


def batches(
    source: Source,
    protocol: Protocol | str | os.PathLike[str],
    sender: str,
    *,
    chunk: int | None = None,
    engine: EngineName | None = None,
    workers: int = 1,
) -> Iterator[Tables]:
    """The same tables in stretches of at most about `chunk` bytes of the capture, in order.

    There is one at least. Put together they are what `columns` gives: offsets and numbers count
    on. Memory stays bounded, whatever the capture; a stretch is kept only as long as the caller
    keeps it.
    """
    _check(chunk=CHUNK if chunk is None else chunk, workers=workers)
    with _reading(source, protocol, sender, engine) as reading:
        yield from reading.tables(chunk, workers)


def _check(**counts: int) -> None:
    """Raise CaptureError unless there is one at least of what is counted."""
    for name, count in counts.items():
        if count < 1:
            raise CaptureError(f"{name} has to be at least 1, not {count}")


@contextmanager
def _reading(
    source: Source,
    protocol: Protocol | str | os.PathLike[str],
    sender: str,
    name: EngineName | None,
) -> Iterator[_Reading]:
    numpy()
    model = protocol_of(protocol)
    maker, in_parts = makers(model, sender_of(model, sender), name)
    with opened(source) as capture:
        yield _Reading(capture, maker, in_parts)


class _Reading(msgspec.Struct, frozen=True):
    """A capture, and what decodes it."""

    capture: memoryview | BinaryIO
    maker: Maker
    in_parts: bool

    @property
    def total(self) -> int | None:
        """Bytes of the capture, if that is known."""
        return len(self.capture) if isinstance(self.capture, memoryview) else None

    def tables(
        self, chunk: int | None, workers: int, memory: Lender | None = None
    ) -> Iterator[Tables]:
        """All tables, in order. `memory`: where one decoder is to write rows, if it can."""
        if workers > 1 and self.in_parts and isinstance(self.capture, memoryview):
            # While each decodes a part, another may wait for whoever takes the tables.
            engines = [self.maker() for _ in range(2 * workers)]
            yield from Parts(self.capture, engines, chunk).tables(workers)
            return
        is_lent = memory is not None and self.in_parts
        engine: Engine = self.maker(memory=memory) if is_lent else self.maker()
        for piece in pieces(self.capture, chunk or CHUNK):
            yield from engine.feed(piece)
        yield from engine.flush()
