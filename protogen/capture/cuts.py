"""Cuts tables at an event, so that stretches of a capture fit together."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from protogen.capture.arrays import numpy
from protogen.capture.tables import Tables, payload_column
from protogen.copying import replace

if TYPE_CHECKING:
    from protogen.capture.tables import Rows

_FEW = 1 << 6
"""Rows that are looked at at once."""

Frame = tuple[int, int]
"""Offset and size of a valid frame."""


def frames_of(tables: Tables, low: int, high: int | None = None) -> dict[Frame, int]:
    """The valid frames that start from `low` on, before `high` if given, and their numbers."""
    found: dict[Frame, int] = {}
    for rows in (*tables.messages.values(), tables.unknown):
        if len(rows):
            end = None if high is None else _place(rows, "offset", high)
            chosen = rows[_place(rows, "offset", low) : end]
            places = zip(chosen["offset"].tolist(), chosen["size"].tolist(), strict=True)
            found |= dict(zip(places, chosen["sequence"].tolist(), strict=True))
    return found


def until(tables: Tables, number: int, end: int) -> Tables:
    """The events up to that one, which ends in front of the byte `end`."""
    cut = _cut(tables, lambda rows: rows[: _behind(rows, number)])
    kept = 0
    if len(unknown := cut["unknown"]):
        column = payload_column(tables.schema)
        kept = int(unknown[-1][column]) + int(unknown[-1]["payload_size"])
    return replace(
        tables,
        **cut,
        payloads=tables.payloads[:kept],
        size=end - tables.offset,
        events=number + 1 - tables.sequence,
    )


def behind(tables: Tables, number: int, end: int) -> Tables:
    """The events behind that one, which ends in front of the byte `end`."""
    cut = _cut(tables, lambda rows: rows[_behind(rows, number) :])
    start = len(tables.payloads)
    if len(unknown := cut["unknown"]):
        column = payload_column(tables.schema)
        start = int(unknown[0][column])
        unknown[column] -= start
    return replace(
        tables,
        **cut,
        payloads=tables.payloads[start:],
        offset=end,
        size=tables.offset + tables.size - end,
        sequence=number + 1,
        events=tables.sequence + tables.events - number - 1,
    )


def renumbered(tables: Tables, more: int) -> Tables:
    """The same tables, whose events have numbers that are greater by `more`. Changes the rows."""
    if not more:
        return tables
    *events, _ = tables.every
    for rows in events:
        if len(rows):
            rows["sequence"] += numpy().uint64(more % (1 << 64))
    return replace(tables, sequence=tables.sequence + more)


def _behind(rows: Rows, number: int) -> int:
    return _place(rows, "sequence", number + 1)


def _place(rows: Rows, column: str, least: int) -> int:
    """The first row whose value is so great.

    It is mostly one of the first or last. Looks at a few, where NumPy would copy the column.
    """
    values = rows[column]
    few: list[int] = values[:_FEW].tolist()
    if len(rows) <= _FEW or few[-1] >= least:
        return bisect_left(few, least)
    few = values[-_FEW:].tolist()
    if few[0] < least:
        return len(rows) - len(few) + bisect_left(few, least)
    return bisect_left(range(len(rows)), least, key=lambda place: int(values[place]))


def _cut(tables: Tables, cut: Callable[[Rows], Rows]) -> dict[str, Any]:
    """Tables of events after the cut, by their names."""
    return {
        "messages": {
            name: cut(rows) if len(rows) else rows for name, rows in tables.messages.items()
        },
        "invalid": cut(tables.invalid),
        "unknown": cut(tables.unknown),
    }
