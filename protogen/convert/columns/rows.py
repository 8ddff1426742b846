"""Rows of a table, column by column."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import msgspec

from protogen.convert.columns.tables import Table


class Rows(msgspec.Struct, frozen=True):
    """Rows of one table, column by column, in the order of `table.all_columns`."""

    table: Table
    columns: Sequence[Any]

    def __len__(self) -> int:
        return len(self.columns[0])
