"""Batches from NumPy tables: whole columns at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, Protocol

import msgspec
import numpy as np

from protogen.capture.engines import Engine
from protogen.capture.schema import CaptureSchema, InvalidReason, TableSchema, Text
from protogen.capture.tables import Tables as Filled
from protogen.convert.columns.arrays import Array, Codes, Nothing, Numbers, Spans
from protogen.convert.columns.batches import Messages, Tally
from protogen.convert.columns.composite_arrays import Same, Scattered
from protogen.convert.columns.nested_columns import nested
from protogen.convert.columns.physical_values import NameFinder, physical
from protogen.convert.columns.python_values import Values
from protogen.convert.columns.rows import Rows
from protogen.convert.columns.tables import REASONS, Column, Naming, Physical, Table, Tables
from protogen.convert.inputs.chunks import Chunk


class BatchPrinter(Protocol):
    """Printer of batches as text."""

    def lines(self, batch: ColumnBatch) -> Iterable[bytes]:
        """The rows of all tables in the order of the capture."""

    def table_lines(self, batch: ColumnBatch) -> Iterable[tuple[Table, Iterable[bytes]]]:
        """The rows of each table that has some."""

    def messages(self, batch: ColumnBatch) -> Iterable[Messages]:
        """The rows of all tables, in the order of the capture, as messages of MCAP."""


Reader = Callable[[Any], Values]
"""Takes a column out of rows."""

_REASON_CODES = np.array(
    [-1, *(REASONS.index(InvalidReason(number).word) for number in range(1, 9))], "i2"
)
"""The place in `REASONS` of each number of a reason."""


class Reading(msgspec.Struct, frozen=True):
    """Readers of a message's columns."""

    table: Table
    held: TableSchema
    frame: tuple[Reader, ...]
    fields: tuple[Reader, ...]


class Readings:
    """Readers of all tables of a sender."""

    def __init__(self, tables: Tables, schema: CaptureSchema) -> None:
        self.tables = tables
        self.schema = schema
        self.messages = {
            name: _reading(tables.messages[name], held) for name, held in schema.messages.items()
        }
        self.unknown = tuple(_frame_readers(tables.unknown, schema.unknown))
        self.invalid = tuple(_frame_readers(tables.invalid, schema.invalid))


def _reading(table: Table, held: TableSchema) -> Reading:
    frame = tuple(_frame_readers(table, held))
    fields = tuple(_field_reader(column, held) for column in table.columns)
    return Reading(table, held, frame, fields)


def _frame_readers(table: Table, held: TableSchema) -> Iterator[Reader]:
    """Readers of `offset`, `size` and the parts; the time is not in the rows."""
    for column in table.frame_columns:
        role = column.path[0]
        if role == "t_ns":
            continue
        source = column.path[-1]
        if role == "@":
            part = held.part(source)
            yield partial(_text if isinstance(part.shape, Text) else _number, part.name)
        else:
            own = next(it for it in held.columns if (it.role, it.source) == (role, source))
            yield partial(_number, own.name)


def _number(name: str, rows: Any) -> Numbers:
    return Numbers(np.ascontiguousarray(rows[name]))


def _text(name: str, rows: Any) -> list[str]:
    return [text.decode("latin-1") for text in rows[name].tolist()]


# --- the columns of fields ------------------------------------------------------------------------


def _field_reader(column: Column, held: TableSchema) -> Reader:
    """Reader of a column."""
    raw = partial(nested, column.path, held)
    match column.derived:
        case Physical() as meaning:
            return lambda rows: _derived(raw(rows), meaning, partial(physical, meaning))
        case Naming() as naming:
            finder = NameFinder(naming)
            return lambda rows: _derived(raw(rows), naming, finder.find)
    return raw


def _derived(raw: Values, meaning: Physical | Naming, derive: Callable[[Any], Values]) -> Values:
    match raw:
        case Scattered(values=values, places=places):
            return Scattered(_derived(values, meaning, derive), places)
        case Same(value=value, count=count):
            return Same(meaning.of(value), count)
    return derive(raw)


# --- batches --------------------------------------------------------------------------------------


class Times(msgspec.Struct):
    """Times of the bytes of a capture: runs of bytes, each with its end and its time."""

    ends: Array
    times: Array

    def of(self, rows: Any) -> Values:
        """Time of each row's last byte, in nanoseconds."""
        if not len(self.ends):
            return Nothing(len(rows))
        lasts = rows["offset"] + rows["size"] - np.uint64(1)
        places = np.searchsorted(self.ends, lasts, side="right")
        missing = places >= len(self.ends)
        found = self.times[np.minimum(places, len(self.ends) - 1)]
        return Numbers(found, missing if missing.any() else None)


class ColumnBatch(msgspec.Struct):
    """Rows of a stretch of a capture, in NumPy tables."""

    readings: Readings
    filled: Filled
    data: bytes
    """The bytes of the line that the rows cover, and maybe more behind them."""
    times: Times
    printer: BatchPrinter | None = None

    @property
    def tally(self) -> Tally:
        """Counts of what is in it."""
        filled = self.filled
        counts = {name: len(rows) for name, rows in filled.messages.items() if len(rows)}
        sizes = np.bincount(filled.invalid["reason"], filled.invalid["size"], 9)
        invalid: dict[str, int] = {it.word: int(sizes[it]) for it in InvalidReason if sizes[it]}
        return Tally(filled.size, counts, len(filled.unknown), invalid)

    def rows(self) -> Iterator[Rows]:
        """The rows of each table that has some."""
        for name, rows in self.filled.messages.items():
            if len(rows):
                yield self._message_rows(self.readings.messages[name], rows)
        if len(self.filled.unknown):
            yield self._unknown_rows()
        if len(self.filled.invalid):
            yield self._invalid_rows()

    def lines(self) -> Iterable[bytes]:
        """The events as lines of JSON."""
        assert self.printer is not None, "decoded for a format that has no lines"
        return self.printer.lines(self)

    def csv(self) -> Iterable[tuple[Table, Iterable[bytes]]]:
        """The rows of each table that has some, as lines of CSV."""
        assert self.printer is not None, "decoded for a format that has no lines"
        return self.printer.table_lines(self)

    def messages(self) -> Iterable[Messages] | None:
        """The rows as messages of MCAP; None where nothing prints them."""
        return None if self.printer is None else self.printer.messages(self)

    def _frame(self, readers: Sequence[Reader], rows: Any) -> list[Values]:
        offset, size, *parts = (reader(rows) for reader in readers)
        return [offset, size, self.times.of(rows), *parts]

    def _message_rows(self, reading: Reading, rows: Any) -> Rows:
        frame = self._frame(reading.frame, rows)
        return Rows(reading.table, [*frame, *(reader(rows) for reader in reading.fields)])

    def _unknown_rows(self) -> Rows:
        rows = self.filled.unknown
        places = payload_places(self.readings.schema.unknown)
        starts = rows[places["payload_offset"]].astype("i8")
        payload = Spans(
            self.filled.payloads.tobytes(), starts, starts + rows[places["payload_size"]]
        )
        return Rows(
            self.readings.tables.unknown, [*self._frame(self.readings.unknown, rows), payload]
        )

    def _invalid_rows(self) -> Rows:
        rows = self.filled.invalid
        starts = (rows["offset"] - np.uint64(self.filled.offset)).astype("i8")
        raw = Spans(self.data, starts, starts + rows["size"])
        reason = Codes(_REASON_CODES[rows["reason"]], REASONS)
        return Rows(
            self.readings.tables.invalid, [*self._frame(self.readings.invalid, rows), reason, raw]
        )


def payload_places(held: TableSchema) -> Mapping[str, str]:
    """The columns that say where the payload of an unknown frame is."""
    return {item.source: item.name for item in held.columns if item.role == "payload"}


# --- decoding -------------------------------------------------------------------------------------


class ColumnDecoder:
    """Decodes with an engine that fills NumPy tables."""

    def __init__(
        self,
        readings: Readings,
        engine: Engine,
        start: int = 0,
        printer: BatchPrinter | None = None,
    ) -> None:
        """Begin at offset `start`, that of the first byte that will be fed."""
        self._readings = readings
        self._engine = engine
        self._printer = printer
        self._data = b""
        self._offset = start
        self._fed = start
        engine.start(start)
        self._ends: Array = np.zeros(0, "u8")
        self._times: Array = np.zeros(0, "i8")

    def feed(self, chunk: Chunk) -> Iterator[ColumnBatch]:
        """Take the next bytes of the capture; what is certain now."""
        self._data += chunk.data
        if len(chunk.ends):
            moved = np.array(chunk.ends, "u8") + np.uint64(self._fed)
            self._ends = np.concatenate([self._ends, moved])
            self._times = np.concatenate([self._times, np.array(chunk.times, "i8")])
        self._fed += len(chunk.data)
        for filled in self._engine.feed(chunk.data):
            yield self._batch(filled)

    def flush(self) -> Iterator[ColumnBatch]:
        """Take the end of the capture; what remains."""
        for filled in self._engine.flush():
            yield self._batch(filled)

    def _batch(self, filled: Filled) -> ColumnBatch:
        times = Times(self._ends, self._times)
        data = self._data[filled.offset - self._offset :]
        batch = ColumnBatch(self._readings, filled, data, times, self._printer)
        covered = filled.offset + filled.size
        self._data = self._data[covered - self._offset :]
        self._offset = covered
        known = np.searchsorted(self._ends, covered, side="right")
        self._ends, self._times = self._ends[known:], self._times[known:]
        return batch
