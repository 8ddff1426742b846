"""Lines of JSON from NumPy tables, printed by C: the same as those of `column_lines.py`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from protogen.capture.native import library_of
from protogen.capture.schema import InvalidReason
from protogen.convert.arrays import Array, Nothing
from protogen.convert.columns import ColumnBatch, Readings
from protogen.convert.line_programs import (
    UnprintableError,
    copy_program,
    invalid_program,
    message_program,
    unknown_program,
)
from protogen.convert.programs import Programs
from protogen.native.library import Library
from protogen.native.printer import Printer, Table

if TYPE_CHECKING:
    from protogen.convert.column_lines import Lines, LineWriter

_NONE = bytes(8)
"""A column of zeros."""


class PrintedLines:
    """Prints lines of batches. Raises NativeError where there is no compiler."""

    def __init__(self, readings: Readings, plain: LineWriter) -> None:
        """`plain` makes the lines for which there is no program."""
        self._readings = readings
        self._plain = plain
        sender = readings.tables.sender
        self._library: Library | None = None
        if not sender.plan.has_one_spelling:
            self._library = library_of(readings.tables.protocol, sender)
        self._numbers = {name: number for number, name in enumerate(readings.messages)}
        programs = Programs()
        self._messages = _message_programs(programs, readings)
        reasons = [reason.word for reason in InvalidReason]
        self._invalid = invalid_program(
            programs, readings.schema.invalid, sender.name, ["", *reasons]
        )
        self._unknown = unknown_program(programs, readings.schema.unknown, sender.name)
        self._copy = copy_program(programs)
        self._printer = Printer(programs.script())

    def write(self, batch: ColumnBatch) -> Iterable[bytes]:
        """The events of a batch as lines, in the order of the capture."""
        return self._printer.texts(list(self._tables(batch)), batch.start, batch.filled.offset)

    def _tables(self, batch: ColumnBatch) -> Iterator[Table]:
        filled = batch.filled
        for name, rows in filled.messages.items():
            if not len(rows):
                continue
            program = self._messages.get(name)
            if program is None:
                lines = self._plain.one_by_one(batch, self._readings.messages[name], rows)
                yield self._copied((rows["offset"], lines))
            else:
                yield _rows(batch, rows, program, self._differs(batch, name, rows))
        if len(filled.unknown):
            yield self._of_unknown(batch)
        if len(filled.invalid):
            yield _rows(batch, filled.invalid, self._invalid, _NONE)

    def _differs(self, batch: ColumnBatch, name: str, rows: Any) -> Array | bytes:
        if self._library is None:
            return _NONE
        line, start = batch.data, batch.filled.offset
        return self._library.differs(self._numbers[name], rows, line, start)

    def _of_unknown(self, batch: ColumnBatch) -> Table:
        filled = batch.filled
        differs: Array | bytes = _NONE
        if self._library is not None:
            data, start = batch.data, filled.offset
            differs = self._library.unknown_differ(filled.unknown, filled.payloads, data, start)
        payloads = filled.payloads.tobytes()
        return _rows(batch, filled.unknown, self._unknown, differs, payloads)

    def _copied(self, lines: Lines) -> Table:
        offsets, texts = lines
        sizes = np.array([len(text) for text in texts], "i8")
        starts = np.cumsum(sizes) - sizes
        columns = (np.ascontiguousarray(offsets), starts, sizes, b"".join(texts))
        return Table(columns, self._copy, len(texts))


def _message_programs(programs: Programs, readings: Readings) -> Mapping[str, int]:
    found = {}
    for name, held in readings.schema.messages.items():
        try:
            found[name] = message_program(programs, held, readings.tables.sender.name)
        except UnprintableError:
            continue
    return found


def _rows(
    batch: ColumnBatch, rows: Any, program: int, differs: Array | bytes, payloads: bytes = _NONE
) -> Table:
    times: Array | bytes = _NONE
    timed: Array | bytes = _NONE
    found = batch.times_of(rows)
    if not isinstance(found, Nothing):
        times = found.values
        timed = b"\1" if found.missing is None else (~found.missing).view("u1")
    return Table((rows, differs, times, timed, batch.data, payloads), program, len(rows))
