"""CSV: a file for each table, with a line of names first.

Bytes are hex digits, lists and what is in them JSON, and nothing stands for a missing value. What
CSV has no place for, units and names of values, is in `NAME.columns.json` beside the table.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

from protogen.convert.batches import Batch, Rows
from protogen.convert.outputs import Pending
from protogen.convert.tables import ColumnType, Listed, Record, Scalar, Table
from protogen.convert.values import as_list

Show = Callable[[Any], Any]


class CsvWriter:
    """Writes a file for each table that has rows."""

    def __init__(self, name: str, pending: Pending) -> None:
        self._name = name
        self._pending = pending
        self._files = ExitStack()
        self._writers: dict[str, Any] = {}

    def write(self, batch: Batch) -> None:
        """Write the rows of a batch."""
        for rows in batch.rows():
            writer = self._writers.get(rows.table.name) or self._open(rows.table)
            writer.writerows(zip(*_cells(rows), strict=True))

    def close(self) -> None:
        """Write what is left."""
        self._files.close()

    def _open(self, table: Table) -> Any:
        facts = {
            "table": dict(table.facts),
            "columns": {column.name: dict(column.facts) for column in table.all_columns},
        }
        text = json.dumps(facts, indent=2, ensure_ascii=False) + "\n"
        beside = f"{table.name}/{self._name}.columns.json"
        self._pending.path(beside).write_text(text, encoding="utf-8")
        path = self._pending.path(f"{table.name}/{self._name}.csv")
        file = self._files.enter_context(path.open("w", encoding="utf-8", newline=""))
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([column.name for column in table.all_columns])
        self._writers[table.name] = writer
        return writer


def _cells(rows: Rows) -> list[Any]:
    columns = zip(rows.table.all_columns, rows.columns, strict=True)
    return [_shown(column.type, as_list(values)) for column, values in columns]


def _shown(type: ColumnType, values: list[Any]) -> Any:
    match type:
        case Scalar("bytes"):
            return [None if value is None else value.hex() for value in values]
        case Scalar("bool"):
            return [None if value is None else str(value).lower() for value in values]
        case Listed() | Record():
            return [None if value is None else json.dumps(value, default=_hex) for value in values]
        case _:
            return values


def _hex(value: Any) -> str:
    return bytes(value).hex()
