"""Puts the tables of stretches together, each into memory that is large enough for all of them."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from protogen.capture.arrays import numpy
from protogen.capture.tables import Tables, concatenated, payload_column
from protogen.copying import replace

if TYPE_CHECKING:
    import numpy as np

    from protogen.capture.tables import Rows

_SLACK = 1.02
"""Rows beyond those that a capture would have if it went on as it began."""
_LITTLE = 1 << 20
"""Bytes that are copied sooner than a thread begins."""
_WAITING = 2
"""Copies for each thread that may wait for it: the rows of each take memory until then."""


class _Column:
    """The rows of one table, in as few blocks as their number allows to foresee."""

    def __init__(self, dtype: np.dtype[Any]) -> None:
        self._dtype = dtype
        self._blocks: list[Rows] = []
        self._used = 0  # Rows in the last block.
        self.count = 0

    def room(self, count: int, whole: float) -> Rows:
        """Room for up to so many more rows, the next ones of the table; it may be for some fewer.

        `whole`: how many times as much as there is now there will be. However few are left, they
        may be enough, and all rows are copied in the end if there is another block.
        """
        if not self._left:
            self._begin(count, whole)
        found: Rows = self._blocks[-1][self._used : self._used + count]
        return found

    def add(self, count: int, whole: float) -> Rows:
        """The place of so many more rows, which may be where they are, in the room for them."""
        if self._left < count:
            self._begin(count, whole)
        self._used += count
        self.count += count
        found: Rows = self._blocks[-1][self._used - count : self._used]
        return found

    @property
    def _left(self) -> int:
        """Rows that the last block has room for."""
        return len(self._blocks[-1]) - self._used if self._blocks else 0

    def _begin(self, count: int, whole: float) -> None:
        """Begin a block with room for so many rows, and for what is foreseen with them."""
        if self._blocks:
            self._blocks[-1] = self._blocks[-1][: self._used]
        foreseen = (self.count + count) * whole - self.count
        self._blocks.append(self._block(count, max(count, int(foreseen * _SLACK) + 16)))
        self._used = 0

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


class Gathering:
    """The tables that pieces of a capture become.

    It lends memory to one decoder: rows that lie where they stay need not be copied.
    """

    def __init__(self, total: int | None) -> None:
        """`total`: bytes that all pieces will cover, if known."""
        self.rates: dict[int, float] = {}
        self._total = total
        self._first: Tables | None = None
        self._columns: list[_Column] = []
        self._size = 0
        self._events = 0

    def rows(self, number: int, dtype: np.dtype[Any], count: int) -> Rows:
        """Room for the next rows of a table; for some fewer where the table ends.

        There is a piece already: without one, no rates are known, and a decoder asks for none.
        """
        return self._columns[number].room(count, self._whole)

    def add(self, piece: Tables, pool: ThreadPoolExecutor | None = None) -> list[Future[None]]:
        """Take a piece. What threads copy, if there are some, has to be waited for."""
        if self._first is None:
            self._first = piece
            self._columns = [_Column(rows.dtype) for rows in piece.every]
        self._size += piece.size
        self._events += piece.events
        payloads, column = self._columns[-1].count, payload_column(piece.schema)
        copies = []
        for rows, table in zip(piece.every, self._columns, strict=True):
            if len(rows):
                more = payloads if rows is piece.unknown else 0
                work = (table.add(len(rows), self._whole), rows, column, more)
                copies += _copied(work, None if rows.nbytes < _LITTLE else pool)
        return copies

    @property
    def _whole(self) -> float:
        """Ratio of what there will be to what there is now."""
        return (self._total or 2 * self._size) / max(1, self._size)

    @property
    def tables(self) -> Tables:
        """All pieces as one."""
        assert self._first is not None
        *messages, invalid, unknown, payloads = (column.rows for column in self._columns)
        return replace(
            self._first,
            messages=dict(zip(self._first.messages, messages, strict=True)),
            invalid=invalid,
            unknown=unknown,
            payloads=payloads,
            size=self._size,
            events=self._events,
        )


def gathered(pieces: Iterable[Tables], total: int | None, workers: int) -> Tables:
    """All pieces as one, copied by so many threads. `total`: bytes that they cover, if known."""
    found = Gathering(total)
    with ThreadPoolExecutor(workers, "protogen-gather") as pool:
        copies: list[Future[None]] = []
        for piece in pieces:
            copies = [copy for copy in copies if not _is_done(copy)]
            copies += found.add(piece, pool if len(copies) < workers * _WAITING else None)
        for copy in copies:
            copy.result()
    return found.tables


def _is_done(copy: Future[None]) -> bool:
    """True if it is; raises what it raised."""
    if not copy.done():
        return False
    copy.result()
    return True


_Work = tuple["Rows", "Rows", str, int]
"""Arguments of `_copy`."""


def _copied(work: _Work, pool: ThreadPoolExecutor | None) -> list[Future[None]]:
    """Copy rows, in a thread if there are any, which has to be waited for then."""
    if pool is not None:
        try:
            return [pool.submit(_copy, *work)]
        except RuntimeError:  # Python ends, and begins no threads any more.
            pass
    _copy(*work)
    return []


def _copy(place: Rows, rows: Rows, column: str, more: int) -> None:
    """Copy rows whole, unless they are in place; payloads of unknown frames lie further behind."""
    source = numpy().ascontiguousarray(rows)
    if source.ctypes.data != place.ctypes.data:
        ctypes.memmove(place.ctypes.data, source.ctypes.data, source.nbytes)
    if more:
        place[column] += numpy().uint64(more)
