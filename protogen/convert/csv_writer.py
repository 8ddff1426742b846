"""CSV: a file for each table, with a line of names first.

Bytes are hex digits, lists and what is in them JSON, and nothing stands for a missing value. What
CSV has no place for, units and names of values, is in `NAME.columns.json` beside the table.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterable
from contextlib import ExitStack, closing
from typing import TYPE_CHECKING, Any

from protogen.convert.batches import Batch, Rows
from protogen.convert.draining import DrainedFile
from protogen.convert.outputs import Pending
from protogen.convert.tables import Column, ColumnType, Listed, Record, Scalar, Table
from protogen.convert.values import as_list, json_of_each

if TYPE_CHECKING:
    from protogen.convert.printed_csv import CsvPrinter

Show = Callable[[Any], Any]


class CsvWriter:
    """Writes a file for each table that has rows."""

    def __init__(self, name: str, pending: Pending) -> None:
        self._printer: CsvPrinter | None = None
        self._prints = True
        self._name = name
        self._pending = pending
        self._files = ExitStack()
        self._open_files: dict[str, DrainedFile] = {}

    def write(self, batch: Batch) -> None:
        """Write the rows of a batch."""
        for rows in batch.rows():
            file = self._open_files.get(rows.table.name) or self._open(rows.table)
            printer = self._printer_of(rows)
            if printer is not None:
                file.writelines(printer.lines(rows))
            else:
                file.write(_lines(zip(*_cells(rows), strict=True)))

    def _printer_of(self, rows: Rows) -> CsvPrinter | None:
        """What prints rows in NumPy arrays, where there is a compiler."""
        if self._printer is None and self._prints and hasattr(rows.columns[0], "to_arrow"):
            from protogen.convert.printed_csv import CsvPrinter
            from protogen.native.errors import NativeError

            try:
                self._printer = CsvPrinter(_texts)
            except NativeError:
                self._prints = False
        return self._printer

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
        file.write(_lines([[column.name for column in table.all_columns]]))
        self._open_files[table.name] = file
        return file


def _lines(rows: Iterable[Iterable[Any]]) -> bytes:
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()


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
            texts = iter(json_of_each([value for value in values if value is not None], _hex))
            return [None if value is None else next(texts) for value in values]
        case _:
            return values


def _texts(column: Column, values: Any) -> list[str]:
    """The cells of a column as texts."""
    if isinstance(column.type, Listed) and hasattr(values, "counts"):
        from protogen.convert.printed_csv import json_texts

        return json_texts(values, _hex)
    cells = _shown(column.type, as_list(values))
    return ["" if cell is None else str(cell) for cell in cells]


def _hex(value: Any) -> str:
    return bytes(value).hex()
