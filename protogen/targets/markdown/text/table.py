"""A table of Markdown texts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import msgspec


class Table(msgspec.Struct, frozen=True):
    """A header and rows; every text is one line of Markdown."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> Table:
    """Make a table, without the columns in which no row says anything."""
    made = [tuple(row) for row in rows]
    used = [index for index in range(len(header)) if any(row[index] for row in made)]
    return Table(
        tuple(header[index] for index in used),
        tuple(tuple(row[index] for index in used) for row in made),
    )
