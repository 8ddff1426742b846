"""Choice of the decoder: NumPy tables where NumPy is installed, else an object for each event."""

from __future__ import annotations

import warnings
from collections import deque
from collections.abc import Callable
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, cast

from protogen.convert.columns.batches import BatchDecoder, EventDecoder
from protogen.convert.columns.tables import Tables
from protogen.convert.formats import OutputFormat
from protogen.runtime.framing.sender import SenderSpec

if TYPE_CHECKING:
    from protogen.convert.columns.column_batches import ColumnDecoder, Readings
    from protogen.convert.writers.row_printer import RowPrinter

EVENTS = "events"
"""The decoder that needs no other package."""


def open_decoder(
    tables: Tables,
    spec: SenderSpec[Any, Any],
    format: OutputFormat,
    engine: str | None = None,
) -> BatchDecoder:
    """A decoder of a capture.

    Every engine gives the same rows and lines. Without a C compiler, lines are made of events.
    """
    if engine == EVENTS or (engine is None and find_spec("numpy") is None):
        return EventDecoder(tables, spec)
    if not format.is_printed:
        return column_decoders(tables, engine)(0)
    from protogen.capture.engines import makers
    from protogen.convert.columns.column_batches import ColumnDecoder

    maker, is_native = makers(tables.protocol, tables.sender, cast(Any, engine))
    printer = _printer(tables, format) if is_native else None
    if printer is None:
        return EventDecoder(tables, spec)
    return ColumnDecoder(printer.readings, maker(), printer=printer)


def column_decoders(tables: Tables, engine: str | None) -> Callable[[int], ColumnDecoder]:
    """A maker of decoders that fill NumPy tables, each for bytes whose first has that offset.

    Raises CaptureError where there is no such engine.
    """
    from protogen.capture.engines import makers
    from protogen.convert.columns.column_batches import ColumnDecoder

    readings = _readings(tables)
    maker, _ = makers(tables.protocol, tables.sender, cast(Any, engine))

    def make(start: int) -> ColumnDecoder:
        return ColumnDecoder(readings, maker(), start)

    return make


def _readings(tables: Tables) -> Readings:
    from protogen.capture.layout import capture_schema
    from protogen.convert.columns.column_batches import Readings

    return Readings(tables, capture_schema(tables.protocol, tables.sender))


def _printer(tables: Tables, format: OutputFormat) -> RowPrinter | None:
    """Printer of rows; None where Python has to do it."""
    from protogen.capture.errors import SlowCaptureWarning
    from protogen.convert.writers.row_printer import RowPrinter
    from protogen.native.errors import NativeError
    from protogen.native.print_steps import UnprintableError

    for known, of, printer in _PRINTERS:
        if known is tables and of is format:
            return printer
    try:
        found = RowPrinter(_readings(tables), format)
    except UnprintableError:
        return None
    except NativeError as error:
        warnings.warn(f"lines are made in Python, which is slow: {error}", SlowCaptureWarning, 3)
        return None
    _PRINTERS.append((tables, format, found))
    return found


_PRINTERS: deque[tuple[Tables, OutputFormat, RowPrinter]] = deque(maxlen=8)
"""Printers that were used last: a run converts many captures with one."""
