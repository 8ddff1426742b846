"""Puts the tables of stretches together, each into memory that is large enough for all of them."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from protogen.capture.arrays import numpy
from protogen.capture.tables import Tables, concatenated, payload_column

if TYPE_CHECKING:
    import numpy as np

    from protogen.capture.tables import Rows

_SLACK = 1.02
"""Rows beyond those that a capture would have if it went on as it began."""


_LITTLE = 1 << 20
"""Bytes that are copied sooner than a thread begins."""


class _Column:
    """The rows of one table, in as few blocks as their number allows to foresee."""

    def __init__(self, dtype: np.dtype[Any]) -> None:
        self._dtype = dtype
        self._blocks: list[Rows] = []
        self._used = 0  # Rows in the last block.
        self.count = 0

    def reserve(self, count: int, foreseen: float) -> Rows:
        """Room for the next rows, where so many more are foreseen with them."""
        if not self._blocks or self._used + count > len(self._blocks[-1]):
            if self._blocks:
                self._blocks[-1] = self._blocks[-1][: self._used]
            self._blocks.append(self._block(count, max(count, int(foreseen * _SLACK) + 16)))
            self._used = 0
        self._used += count
        self.count += count
        found: Rows = self._blocks[-1][self._used - count : self._used]
        return found

    def _block(self, least: int, wanted: int) -> Rows:
        """Pages that are never written to cost nothing, if the system lets them be asked for."""
        try:
            return numpy().empty(wanted, self._dtype)  # type: ignore[no-any-return]
        except MemoryError:
            return numpy().empty(least, self._dtype)  # type: ignore[no-any-return]

    @property
    def rows(self) -> Rows:
        """All rows."""
        if not self._blocks:
            return numpy().zeros(0, self._dtype)  # type: ignore[no-any-return]
        self._blocks[-1] = self._blocks[-1][: self._used]
        return self._blocks[0] if len(self._blocks) == 1 else concatenated(self._blocks)


def gathered(pieces: Iterable[Tables], total: int | None, workers: int) -> Tables:
    """All pieces as one, copied by so many threads. `total`: bytes that they cover, if known."""
    with ThreadPoolExecutor(workers, "protogen-gather") as pool:
        first: Tables | None = None
        columns: list[_Column] = []
        size = events = 0
        copies: list[Future[None]] = []
        for piece in pieces:
            if first is None:
                first = piece
                columns = [_Column(rows.dtype) for rows in _all(piece)]
            size += piece.size
            events += piece.events
            copies = [copy for copy in copies if not _is_done(copy)]
            copies += _add(piece, columns, (total or 2 * size) / max(1, size), pool)
        for copy in copies:
            copy.result()
    assert first is not None
    *messages, invalid, unknown, payloads = (column.rows for column in columns)
    return replace(
        first,
        messages=dict(zip(first.messages, messages, strict=True)),
        invalid=invalid,
        unknown=unknown,
        payloads=payloads,
        size=size,
        events=events,
    )


def _is_done(copy: Future[None]) -> bool:
    """Whether it is; raises what it raised."""
    if not copy.done():
        return False
    copy.result()
    return True


def _all(tables: Tables) -> tuple[Rows, ...]:
    return (*tables.messages.values(), tables.invalid, tables.unknown, tables.payloads)


def _add(
    piece: Tables, columns: list[_Column], whole: float, pool: ThreadPoolExecutor
) -> list[Future[None]]:
    """Copy a piece; `whole`: how many times as much as there is now there will be."""
    payloads = columns[-1].count
    copies = []
    for rows, column in zip(_all(piece), columns, strict=True):
        if len(rows):
            foreseen = (column.count + len(rows)) * whole - column.count
            place = column.reserve(len(rows), foreseen)
            more = payloads if rows is piece.unknown else 0
            work = (place, rows, payload_column(piece.schema), more)
            if rows.nbytes < _LITTLE:
                _copy(*work)
            else:
                try:
                    copies.append(pool.submit(_copy, *work))
                except RuntimeError:  # Python ends, and begins no threads any more.
                    _copy(*work)
    return copies


def _copy(place: Rows, rows: Rows, column: str, more: int) -> None:
    """Copy rows whole; those of unknown frames have payloads that lie further behind."""
    source = numpy().ascontiguousarray(rows)
    ctypes.memmove(place.ctypes.data, source.ctypes.data, source.nbytes)
    if more:
        place[column] += numpy().uint64(more)
