"""Reads captures: all of one at once, or batch by batch in constant memory."""

from __future__ import annotations

import os
from collections.abc import Iterator

from protogen.capture.arrays import numpy
from protogen.capture.engines import Engine, EngineName, engine_of
from protogen.capture.protocols import protocol_of, sender_of
from protogen.capture.source import Source, opened, pieces
from protogen.capture.tables import Tables, joined
from protogen.model.protocol import Protocol

CHUNK = 1 << 20
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
    is how many threads the native engine uses; the result is always the same.

    Raises CaptureError, SchemaError, and MissingPackageError where NumPy is not installed.
    """
    return joined(batches(source, protocol, sender, engine=engine))


def batches(
    source: Source,
    protocol: Protocol | str | os.PathLike[str],
    sender: str,
    *,
    chunk: int = CHUNK,
    engine: EngineName | None = None,
) -> Iterator[Tables]:
    """The same tables in stretches of at most about `chunk` bytes of the capture, in order.

    There is one at least. Joined they are what `columns` gives: offsets and sequence count on.
    """
    numpy()
    model = protocol_of(protocol)
    found = engine_of(model, sender_of(model, sender), engine)
    return _batches(source, found, chunk)


def _batches(source: Source, engine: Engine, chunk: int) -> Iterator[Tables]:
    with opened(source) as capture:
        for piece in pieces(capture, chunk):
            yield from engine.feed(piece)
        yield from engine.flush()
