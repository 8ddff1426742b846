"""Markdown texts on their way to a template: views of sections, and tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import compress

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
    used = [any(cells) for cells in zip(*made, strict=True)] or [False] * len(header)
    return Table(tuple(compress(header, used)), tuple(tuple(compress(row, used)) for row in made))
