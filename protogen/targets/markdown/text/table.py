"""Markdown texts on their way to a template: views of sections, and tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import msgspec

View = Mapping[str, object]
"""A section: its texts, tables and views of what is inside, by their names in the template."""


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
