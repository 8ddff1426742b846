"""Tables: the events of a capture as NumPy columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import msgspec

from protogen.capture.arrays import dtype_of, numpy
from protogen.capture.schema import CaptureSchema

if TYPE_CHECKING:
    import numpy as np

    Rows = np.ndarray[Any, np.dtype[Any]]


class Tables(msgspec.Struct, frozen=True, kw_only=True):
    """The events of a capture, or of a stretch of it: a table for each kind.

    Every row begins with `offset` (of its first byte in the capture), `sequence` (the number of
    the event among all events, from 0) and `size` (bytes on the wire).
    """

    schema: CaptureSchema
    """Meaning of the columns."""
    engine: str
    """Engine that filled them: `native` or `python`."""
    messages: dict[str, Rows]
    """A table for every message: the parts of its frame, then its fields as raw values."""
    invalid: Rows
    """Bytes that are no frame; `reason` is an `InvalidReason`."""
    unknown: Rows
    """Valid frames whose identity belongs to no message."""
    payloads: Rows
    """The bytes of the unknown payloads; `payload_offset` and `payload_size` say where."""
    offset: int
    """Of the first byte that these events cover."""
    size: int
    """Number of bytes that they cover, without gaps."""
    sequence: int
    """The number of the first event."""
    events: int
    """Number of events."""

    @property
    def every(self) -> tuple[Rows, ...]:
        """All rows: of messages, of invalid and unknown frames, and the payloads of these."""
        return (*self.messages.values(), self.invalid, self.unknown, self.payloads)

    @property
    def nbytes(self) -> int:
        """Bytes of all rows."""
        return sum(rows.nbytes for rows in self.every)

    def payload(self, row: Any) -> bytes:
        """The payload of a row of `unknown`."""
        start, size = int(row["payload_offset"]), int(row["payload_size"])
        return self.payloads[start : start + size].tobytes()


def empty_rows(schema: CaptureSchema) -> dict[str, Rows]:
    """Of each message, no rows."""
    return {name: rows(dtype_of(table)) for name, table in schema.messages.items()}


def rows(dtype: np.dtype[Any], count: int = 0) -> Rows:
    """Rows of zeros."""
    found: Rows = numpy().zeros(count, dtype)
    return found


def concatenated(pieces: Sequence[Rows]) -> Rows:
    """One behind another. Rows are copied whole, with what lies between their members."""
    dtype = pieces[0].dtype
    filled = [numpy().ascontiguousarray(item).view(f"V{dtype.itemsize}") for item in pieces]
    found: Rows = numpy().concatenate(filled).view(dtype)
    return found


def payload_column(schema: CaptureSchema) -> str:
    """The column of unknown frames that says where their payloads begin."""
    columns = schema.unknown.columns
    return next(item.name for item in columns if item.source == "payload_offset")
