"""Parquet and Arrow files: one for each table that has rows."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from protogen.convert.arrow_tables import batch_of, schema_of
from protogen.convert.batches import Batch
from protogen.convert.errors import ConvertError, needed
from protogen.convert.outputs import Pending
from protogen.convert.tables import Names, Table

if TYPE_CHECKING:
    import pyarrow as pa

_MOST_ROWS = 1 << 17
"""Rows of a group of rows."""
_MOST_KEPT = 32 << 20
"""Bytes of rows of all tables together that wait for their group to fill."""

Sink = Callable[["pa.Table"], None]


class ArrowWriter:
    """Gathers rows, and writes those of a table when there are enough."""

    SUFFIX = "arrow"

    def __init__(self, name: str, pending: Pending) -> None:
        needed("pyarrow", f"writing {self.SUFFIX} files")
        self._name = name
        self._pending = pending
        self._files = ExitStack()
        self._sinks: dict[str, Sink] = {}
        self._schemas: dict[str, pa.Schema] = {}
        self._kept: dict[str, list[pa.RecordBatch]] = {}
        self._rows: dict[str, int] = {}
        self._sizes: dict[str, int] = {}

    def write(self, batch: Batch) -> None:
        """Take the rows of a batch."""
        for rows in batch.rows():
            name = rows.table.name
            if name not in self._sinks:
                self._open(rows.table)
            taken = batch_of(rows, self._schemas[name])
            self._kept[name].append(taken)
            self._rows[name] += taken.num_rows
            self._sizes[name] += taken.nbytes
            if self._rows[name] >= _MOST_ROWS:
                self._write(name)
        while sum(self._sizes.values()) > _MOST_KEPT:
            self._write(max(self._sizes, key=lambda name: self._sizes[name]))

    def close(self) -> None:
        """Write what is left."""
        with self._files:
            for name in self._sinks:
                if self._rows[name]:
                    self._write(name)

    def _open(self, table: Table) -> None:
        schema = schema_of(table, {"protogen.capture": self._name})
        path = self._pending.path(f"{table.name}/{self._name}.{self.SUFFIX}")
        self._schemas[table.name] = schema
        self._sinks[table.name] = self._sink(path, table, schema)
        self._kept[table.name] = []
        self._rows[table.name] = self._sizes[table.name] = 0

    def _write(self, name: str) -> None:
        import pyarrow as pa

        self._sinks[name](pa.Table.from_batches(self._kept[name], self._schemas[name]))
        self._kept[name] = []
        self._rows[name] = self._sizes[name] = 0

    def _sink(self, path: Path, table: Table, schema: pa.Schema) -> Sink:
        import pyarrow as pa

        file = self._files.enter_context(pa.OSFile(str(path), "wb"))
        writer = self._files.enter_context(pa.ipc.new_file(file, schema))
        return lambda rows: writer.write_table(rows.combine_chunks())


class ParquetWriter(ArrowWriter):
    """The same in Parquet."""

    SUFFIX = "parquet"

    def _sink(self, path: Path, table: Table, schema: pa.Schema) -> Sink:
        from pyarrow import parquet

        options: dict[str, Any] = {
            "compression": "snappy",
            # Values of sensors seldom come back; looking for those that do takes most of the time.
            "use_dictionary": [
                column.name for column in table.all_columns if isinstance(column.type, Names)
            ],
            # A reader looks for places and times; bounds of all else cost more than they help.
            "write_statistics": [table.frame_columns[0].name, table.frame_columns[2].name],
        }
        try:
            writer = parquet.ParquetWriter(str(path), schema, **options)
        except NotImplementedError as error:  # It has no structs without members.
            raise ConvertError(
                f"Parquet has no place for what {table.name} holds: {error}",
                "convert to another format, such as arrow",
            ) from None
        self._files.enter_context(writer)
        return lambda rows: writer.write_table(rows, row_group_size=_MOST_ROWS)
