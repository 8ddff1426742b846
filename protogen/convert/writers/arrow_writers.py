"""Parquet and Arrow files: one for each table that has rows."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from protogen.convert.columns.arrow_tables import batch_of, schema_of
from protogen.convert.columns.batches import Batch
from protogen.convert.columns.rows import Rows
from protogen.convert.columns.tables import Names, Table
from protogen.convert.errors import ConvertError, needed
from protogen.convert.writers.drained_file import Drain
from protogen.convert.writers.parquet_encodings import spelling_of
from protogen.convert.writers.pending_files import Pending, continuation

if TYPE_CHECKING:
    import pyarrow as pa

_MOST_ROWS = 1 << 17
"""Rows of a group of rows, or some more."""
_MOST_KEPT = 32 << 20
"""Bytes of rows of all tables together that wait for their group to fill."""
_MOST_BATCHES = 64
"""Batches of a table that wait. One takes kilobytes, even if it has a single row."""
_MOST_PIECES = 1 << 13
"""Columns of groups of rows, in all files that are being written. Parquet keeps a record of one or
two kilobytes of each, and writes it when a file ends."""
_PAGE = 1 << 17
"""Bytes of a page of a column: what the processor's cache still holds when it is compressed."""
_AT_ONCE = 1 << 16
"""Numbers that Parquet takes between two looks at how full the page is."""


class Sink(Protocol):
    """A file that is being written."""

    def write_table(self, rows: pa.Table, /) -> None:
        """Write a group of rows."""

    def close(self) -> None:
        """Write what tells where the groups are."""


class _Kept:
    """A table: where its rows go, and those that wait."""

    def __init__(self, table: Table, schema: pa.Schema) -> None:
        self.table = table
        self.schema = schema
        self.batches: list[pa.RecordBatch] = []
        self.rows = 0
        self.bytes = 0
        self.sink: Sink | None = None
        self.files = 0
        """Number of files, with the one that is being written."""
        self.pieces = 0
        """Record of the file that is being written."""

    def take(self, rows: Rows) -> None:
        """Keep rows."""
        taken = batch_of(rows, self.schema)
        self.batches.append(taken)
        self.rows += taken.num_rows
        self.bytes += taken.nbytes
        if len(self.batches) >= _MOST_BATCHES:
            self.batches = self._joined().combine_chunks().to_batches()

    def release(self) -> pa.Table:
        """The rows that waited."""
        found = self._joined()
        self.batches, self.rows, self.bytes = [], 0, 0
        return found

    def _joined(self) -> pa.Table:
        import pyarrow as pa

        return pa.Table.from_batches(self.batches, self.schema)


class ArrowWriter:
    """Gathers rows, and writes those of a table when there are enough."""

    SUFFIX = "arrow"

    def __init__(self, name: str, pending: Pending, capture: str | None = None) -> None:
        """Write files called `name`; `capture` is the name in the metadata, where it differs."""
        needed("pyarrow", f"writing {self.SUFFIX} files")
        self._name = name
        self._capture = name if capture is None else capture
        self._pending = pending
        self._kept: dict[str, _Kept] = {}

    def write(self, batch: Batch) -> None:
        """Take the rows of a batch."""
        for rows in batch.rows():
            kept = self._kept.get(rows.table.name) or self._begin(rows.table)
            kept.take(rows)
            if kept.rows >= _MOST_ROWS:
                self._write(kept)
        while sum(kept.bytes for kept in self._kept.values()) > _MOST_KEPT:
            self._write(max(self._kept.values(), key=lambda kept: kept.bytes))

    def close(self) -> None:
        """Write what is left."""
        with ExitStack() as files:
            for kept in self._kept.values():
                files.callback(self._end, kept)
            for kept in self._kept.values():
                if kept.rows:
                    self._write(kept)

    def _begin(self, table: Table) -> _Kept:
        schema = schema_of(table, {"protogen.capture": self._capture})
        self._kept[table.name] = kept = _Kept(table, schema)
        return kept

    def _write(self, kept: _Kept) -> None:
        rows = kept.release()
        if kept.sink is None:
            first = f"{kept.table.name}/{self._name}.{self.SUFFIX}"
            path = self._pending.path(continuation(first, kept.files))
            kept.sink = self._sink(path, kept.table, rows)
            kept.files += 1
        kept.sink.write_table(rows)

    def _end(self, kept: _Kept) -> None:
        """End the file that is being written."""
        sink, kept.sink, kept.pieces = kept.sink, None, 0
        if sink is not None:
            sink.close()

    def _sink(self, path: Path, table: Table, first: pa.Table) -> Sink:
        """A new file, whose first rows these will be."""
        import pyarrow as pa

        return _File(path, lambda file: _Combining(pa.ipc.new_file(file, first.schema)))


class _Combining:
    """Writes the rows of a group as one record batch."""

    def __init__(self, writer: Any) -> None:
        self._writer = writer
        self.close = writer.close

    def write_table(self, rows: pa.Table) -> None:
        """Write a group of rows."""
        self._writer.write_table(rows.combine_chunks())


class _File:
    """A file that goes to the disk while it is written."""

    def __init__(self, path: Path, open_writer: Callable[[Any], Any]) -> None:
        import pyarrow as pa

        self._drain = Drain()
        with ExitStack() as files:
            self._file = files.enter_context(pa.OSFile(str(path), "wb"))
            # Arrow does not tell its own.
            self._descriptor = os.open(path, os.O_RDONLY)
            files.callback(os.close, self._descriptor)
            self._writer = open_writer(self._file)
            self._files = files.pop_all()

    def write_table(self, rows: pa.Table) -> None:
        """Write a group of rows."""
        self._writer.write_table(rows)
        self._drain.reach(self._descriptor, self._file.tell())

    def close(self) -> None:
        """Write what tells where the groups are."""
        with self._files:
            self._writer.close()


class ParquetWriter(ArrowWriter):
    """The same in Parquet. A table that has many groups of rows goes on in another file."""

    SUFFIX = "parquet"

    def _write(self, kept: _Kept) -> None:
        super()._write(kept)
        kept.pieces += len(kept.schema)
        if sum(other.pieces for other in self._kept.values()) > _MOST_PIECES:
            self._end(max(self._kept.values(), key=lambda other: other.pieces))

    def _sink(self, path: Path, table: Table, first: pa.Table) -> Sink:
        from pyarrow import parquet

        spelling = spelling_of(first)
        options: dict[str, Any] = {
            "compression": spelling.compression,
            "data_page_size": _PAGE,
            "write_batch_size": _AT_ONCE,
            # Values of sensors seldom come back; looking for those that do takes most of the time.
            "use_dictionary": [
                column.name for column in table.all_columns if isinstance(column.type, Names)
            ],
            "column_encoding": spelling.encodings or None,
            # A reader looks for places and times; bounds of all else cost more than they help.
            "write_statistics": [table.frame_columns[0].name, table.frame_columns[2].name],
        }
        try:
            return _File(path, lambda file: parquet.ParquetWriter(file, first.schema, **options))
        except NotImplementedError as error:  # It has no structs without members.
            raise ConvertError(
                f"Parquet has no place for what {table.name} holds: {error}",
                "convert to another format, such as arrow",
            ) from None
