"""Rows as lines of CSV, made by Python.

Bytes are hex digits, lists and what is in them JSON, and nothing stands for a missing value.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from typing import Any

from protogen.convert.columns.python_values import as_list, json_of_each
from protogen.convert.columns.rows import Rows
from protogen.convert.columns.tables import ColumnType, Listed, Record, Scalar


def csv_lines(rows: Iterable[Iterable[Any]]) -> bytes:
    """Lines of these values."""
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()


def csv_of(rows: Rows) -> bytes:
    """The lines of rows."""
    columns = zip(rows.table.all_columns, rows.columns, strict=True)
    cells = [_shown(column.type, as_list(values)) for column, values in columns]
    return csv_lines(zip(*cells, strict=True))


def cell_text(type: ColumnType, value: Any) -> str:
    """A value as it stands in a line."""
    # A second value, because one that is empty and alone is put in quotes.
    line = csv_lines([[*_shown(type, [value]), ""]])
    return line.decode().removesuffix(",\n")


def quoted_characters() -> list[int]:
    """ASCII characters for which a value is put in quotes."""
    each = ((code, csv_lines([[chr(code), ""]])) for code in range(128))
    return [code for code, line in each if line.startswith(b'"')]


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


def _hex(value: Any) -> str:
    return bytes(value).hex()
