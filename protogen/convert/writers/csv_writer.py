"""CSV: a file for each table, with a line of names first.

What CSV has no place for, units and names of values, is in `NAME.columns.json` beside the table.
"""

from __future__ import annotations

import json
from contextlib import ExitStack, closing

from protogen.convert.columns.batches import Batch
from protogen.convert.columns.csv_text import csv_lines
from protogen.convert.columns.tables import Table
from protogen.convert.writers.drained_file import DrainedFile
from protogen.convert.writers.pending_files import Pending


class CsvWriter:
    """Writes a file for each table that has rows."""

    def __init__(self, name: str, pending: Pending) -> None:
        self._name = name
        self._pending = pending
        self._files = ExitStack()
        self._open_files: dict[str, DrainedFile] = {}

    def write(self, batch: Batch) -> None:
        """Write the rows of a batch."""
        for table, lines in batch.csv():
            file = self._open_files.get(table.name) or self._open(table)
            file.writelines(lines)

    def close(self) -> None:
        """Write what is left."""
        self._files.close()

    def _open(self, table: Table) -> DrainedFile:
        facts = {
            "table": dict(table.facts),
            "columns": {column.name: dict(column.facts) for column in table.all_columns},
        }
        text = json.dumps(facts, indent=2, ensure_ascii=False) + "\n"
        beside = f"{table.name}/{self._name}.columns.json"
        self._pending.path(beside).write_text(text, encoding="utf-8")
        path = self._pending.path(f"{table.name}/{self._name}.csv")
        file = self._files.enter_context(closing(DrainedFile(path)))
        file.write(csv_lines([[column.name for column in table.all_columns]]))
        self._open_files[table.name] = file
        return file
