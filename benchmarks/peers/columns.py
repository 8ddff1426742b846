"""protogen's columns: one NumPy table for a message, in Python or by generated C."""

from __future__ import annotations

from typing import Any

from peers.cases import Case, Row
from peers.contender import Contender
from protogen.capture import batches, columns
from protogen.capture.errors import CaptureError
from protogen.capture.protocols import protocol_of

PURE, NATIVE = "protogen, Python columns", "protogen, native columns"
_KEPT = 1 << 20
"""Bytes of a stream whose tables are given back."""
_LOOPS = 256
"""A capture has megabytes: what a call costs once must not count."""


def pure(case: Case) -> Contender:
    """Without a compiler."""
    return _contender(case, PURE, "python", 1)


def native(case: Case) -> Contender:
    """By generated C. Raises ImportError where there is no compiler."""
    try:
        return _contender(case, NATIVE, "native", _LOOPS)
    except CaptureError as error:
        raise ImportError(str(error)) from None


def _contender(case: Case, name: str, engine: str, loops: int) -> Contender:
    sender, model = case.sender, protocol_of(case.protocol)

    def stream(data: bytes) -> Any:
        """The tables; of a long capture nothing is kept, as one reads what does not fit."""
        if len(data) <= _KEPT:
            return columns(data, model, sender, engine=engine)
        for _ in batches(data, model, sender, engine=engine):
            pass
        return None

    stream(case.frames[0])
    return Contender(
        name,
        rows=lambda tables: _rows(case, tables.messages[case.message]),
        data=case.stream * loops,
        stream=stream,
        loops=loops,
    )


def _rows(case: Case, table: Any) -> list[Row]:
    columns = [_column(table, name) for name in case.kind.__fields__]
    return list(zip(*columns, strict=True))


def _column(table: Any, name: str) -> list[Any]:
    if name == "readings":
        counts = table["readings_count"].tolist()
        values = table[name].tolist()
        return [tuple(row[:count]) for row, count in zip(values, counts, strict=True)]
    values = table[name].tolist()
    return [tuple(value) if isinstance(value, list) else value for value in values]
