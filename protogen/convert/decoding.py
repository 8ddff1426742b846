"""Chooses what decodes: NumPy tables where NumPy is installed, else an object for each event."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, cast

from protogen.convert.batches import BatchDecoder, EventDecoder
from protogen.convert.tables import Tables
from protogen.runtime.sender import SenderSpec

if TYPE_CHECKING:
    from protogen.convert.columns import ColumnDecoder

EVENTS = "events"
"""The decoder that needs no other package."""


def open_decoder(
    tables: Tables, spec: SenderSpec[Any, Any], engine: str | None, start: int = 0
) -> BatchDecoder:
    """A decoder of bytes whose first has the offset `start`. Every engine gives the same rows."""
    if engine == EVENTS or (engine is None and find_spec("numpy") is None):
        return EventDecoder(tables, spec, start)
    return column_decoders(tables, spec, engine)(start)


def column_decoders(
    tables: Tables, spec: SenderSpec[Any, Any], engine: str | None
) -> Callable[[int], ColumnDecoder]:
    """What makes decoders that fill NumPy tables, each for bytes whose first has that offset.

    Raises CaptureError where there is no such engine.
    """
    from protogen.capture.engines import makers
    from protogen.capture.layout import capture_schema
    from protogen.convert.column_lines import LineWriter
    from protogen.convert.columns import ColumnDecoder, Readings

    readings = Readings(tables, capture_schema(tables.protocol, tables.sender))
    filler, _ = makers(tables.protocol, tables.sender, cast(Any, engine))
    lines = LineWriter(readings, spec, prints=engine != "python")

    def make(start: int) -> ColumnDecoder:
        return ColumnDecoder(readings, filler(), lines.write, start)

    return make
