"""Text of NumPy tables, printed by C that is compiled for a schema."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from protogen.capture.native import library_of
from protogen.convert.columns.arrays import Array, Nothing
from protogen.convert.columns.batches import Messages
from protogen.convert.columns.column_batches import ColumnBatch, Readings
from protogen.convert.columns.tables import Table
from protogen.convert.formats import OutputFormat
from protogen.convert.writers.printer_library import built_printer
from protogen.native.library import Library
from protogen.native.printer import Piece, PrintedRows, Printer


class RowPrinter:
    """Prints the rows of batches in one format."""

    def __init__(self, readings: Readings, format: OutputFormat) -> None:
        """Raises NativeError and UnprintableError."""
        tables = readings.tables
        self.readings = readings
        self._printer = Printer(built_printer(tables, format, readings.schema))
        self._numbers = {name: number for number, name in enumerate(readings.messages)}
        others = (tables.invalid.name, tables.unknown.name)
        self._channels = [tables.channels[name] for name in (*readings.messages, *others)]
        self._library: Library | None = None
        if format is OutputFormat.JSONL and not tables.sender.plan.has_one_spelling:
            self._library = library_of(tables.protocol, tables.sender)

    def lines(self, batch: ColumnBatch) -> Iterable[bytes]:
        """The rows of all tables in the order of the capture."""
        each = [rows for _, rows in self._tables(batch)]
        return self._texts(batch, each)

    def table_lines(self, batch: ColumnBatch) -> Iterator[tuple[Table, Iterable[bytes]]]:
        """The rows of each table that has some."""
        for table, rows in self._tables(batch):
            yield table, self._texts(batch, [rows])

    def messages(self, batch: ColumnBatch) -> Iterator[Messages]:
        """The rows of all tables, in the order of the capture, as messages of MCAP."""
        each = [rows for _, rows in self._tables(batch)]
        for piece in self._printer.pieces(each, batch.data, batch.filled.offset):
            entries = piece.entries.astype("<u8", copy=False)
            places = {
                self._channels[number]: _of(number, piece, entries) for number in piece.present
            }
            times = piece.entries[:, 0]
            yield Messages(piece.text, places, int(times.min()), int(times.max()))

    def _texts(self, batch: ColumnBatch, each: list[PrintedRows]) -> Iterator[bytes]:
        return self._printer.texts(each, batch.data, batch.filled.offset)

    def _tables(self, batch: ColumnBatch) -> Iterator[tuple[Table, PrintedRows]]:
        filled, tables = batch.filled, self.readings.tables
        invalid = len(self._numbers)
        for name, rows in filled.messages.items():
            if len(rows):
                differs = self._differs(batch, name, rows)
                yield tables.messages[name], _printed(batch, self._numbers[name], rows, differs)
        if len(filled.unknown):
            differs, payloads = self._unknown_differ(batch), filled.payloads.tobytes()
            unknown = _printed(batch, invalid + 1, filled.unknown, differs, payloads)
            yield tables.unknown, unknown
        if len(filled.invalid):
            yield tables.invalid, _printed(batch, invalid, filled.invalid)

    def _differs(self, batch: ColumnBatch, name: str, rows: Any) -> Array | None:
        """Mask of the rows of which an encoder makes other bytes."""
        if self._library is None:
            return None
        line, start = batch.data, batch.filled.offset
        return self._library.differs(self._numbers[name], rows, line, start)

    def _unknown_differ(self, batch: ColumnBatch) -> Array | None:
        if self._library is None:
            return None
        filled = batch.filled
        return self._library.unknown_differ(
            filled.unknown, filled.payloads, batch.data, filled.offset
        )


def _of(table: int, piece: Piece, entries: Array) -> bytes:
    """The entries of an index for the rows of one table, as bytes."""
    own: bytes = (entries if len(piece.present) == 1 else entries[piece.tables == table]).tobytes()
    return own


def _printed(
    batch: ColumnBatch, table: int, rows: Any, differs: Array | None = None, payloads: bytes = b""
) -> PrintedRows:
    found = batch.times.of(rows)
    if isinstance(found, Nothing):
        return PrintedRows(table, rows, differs, payloads=payloads)
    missing = found.missing
    timed = np.ones(len(rows), "u1") if missing is None else (~missing).view("u1")
    return PrintedRows(table, rows, differs, found.values, timed, payloads)
