"""Lines of JSON from NumPy tables: the same as those of events, many at once.

Where encoding a line may give other bytes than those that came, the line says so with `raw`;
whether it has to is tried line by line, unless a sender's frames have only one spelling.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from protogen.capture.schema import InvalidReason, TableSchema
from protogen.convert import cells
from protogen.convert.arrays import Array, Lists, Nothing, Numbers
from protogen.convert.columns import ColumnBatch, Reading, Readings, payload_places
from protogen.convert.plain_rows import json_fields, plain_rows
from protogen.convert.printed_lines import PrintedLines
from protogen.model.types import Field, Struct
from protogen.native.errors import NativeError
from protogen.runtime.errors import EncodeError
from protogen.runtime.lines import encode_line
from protogen.runtime.sender import SenderSpec

Lines = tuple[Array, list[bytes]]
"""Offsets, and the line of each."""
Cell = Callable[[Any], Array]


@dataclass(frozen=True, slots=True)
class _Template:
    """The line of a message: fixed texts, and between them cells made of rows."""

    pieces: tuple[bytes | Cell, ...]
    doubtful: Callable[[Any], Array] | None
    """Which rows need a try: those with a float that is no number."""


class LineWriter:
    """Makes lines of batches: by C that prints them, or where there is no compiler by NumPy."""

    def __init__(
        self, readings: Readings, spec: SenderSpec[Any, Any], *, prints: bool = False
    ) -> None:
        """`prints`: whether C may print them."""
        self._prints = prints
        self._printed: PrintedLines | None = None
        self._readings = readings
        self._spec = spec
        one_spelling = readings.tables.sender.plan.has_one_spelling
        self._templates = {
            name: _template(reading, readings) if one_spelling else None
            for name, reading in readings.messages.items()
        }

    def write(self, batch: ColumnBatch) -> Iterable[bytes]:
        """The events of a batch as lines, in the order of the capture."""
        if self._prints and self._printed is None:
            try:
                self._printed = PrintedLines(self._readings, self)
            except NativeError:
                self._prints = False
        if self._printed is not None:
            return self._printed.write(batch)
        return self._joined(batch)

    def _joined(self, batch: ColumnBatch) -> Iterable[bytes]:
        found = list(self._of_messages(batch))
        if len(batch.filled.unknown):
            found.append(self.unknown(batch))
        if len(batch.filled.invalid):
            found.append(self._invalid(batch))
        if not found:
            return []
        if len(found) == 1:
            return found[0][1]
        offsets = np.concatenate([places for places, _ in found])
        lines = [line for _, some in found for line in some]
        return [lines[place] for place in np.argsort(offsets).tolist()]

    def _of_messages(self, batch: ColumnBatch) -> Iterator[Lines]:
        others = bool(len(batch.filled.unknown) or len(batch.filled.invalid))
        filled = [name for name, rows in batch.filled.messages.items() if len(rows)]
        for name in filled:
            reading, rows = self._readings.messages[name], batch.filled.messages[name]
            template = self._templates[name]
            if template is None:
                yield rows["offset"], self.one_by_one(batch, reading, rows)
                continue
            doubtful = None if template.doubtful is None else template.doubtful(rows)
            if doubtful is not None and doubtful.any():
                yield rows["offset"][doubtful], self.one_by_one(batch, reading, rows[doubtful])
                rows, others = rows[~doubtful], True
            if len(rows):
                texts = list(self._at_once(batch, template, rows))
                if len(filled) > 1 or others:
                    texts = [line for text in texts for line in text.splitlines(keepends=True)]
                yield rows["offset"], texts

    def _at_once(self, batch: ColumnBatch, template: _Template, rows: Any) -> Iterator[bytes]:
        pieces: list[bytes | Array] = [
            piece if isinstance(piece, bytes) else piece(rows) for piece in template.pieces
        ]
        if batch.start:
            offsets = rows["offset"] + np.uint64(batch.start)
            pieces[1] = cells.integers(offsets)
        times = batch.times_of(rows)
        if isinstance(times, Nothing):
            return cells.put_together([*pieces, b"}\n"], len(rows))
        stamps = cells.integers(times.values)
        label = np.tile(np.frombuffer(b', "t_ns": ', "u1"), (len(rows), 1))
        if times.missing is not None:
            stamps[times.missing] = label[times.missing] = 0
        return cells.put_together([*pieces, label, stamps, b"}\n"], len(rows))

    # --- one by one -------------------------------------------------------------------------------

    def one_by_one(self, batch: ColumnBatch, reading: Reading, rows: Any) -> list[bytes]:
        """The lines of a message's rows, each of which is tried."""
        message = reading.table.message
        assert message is not None
        plain = plain_rows(reading.held, rows)
        parts = _parts(reading.held, rows)
        lines = []
        for place, values in enumerate(plain):
            line = self._start(batch, rows[place], "message", message=message.name)
            line["parts"] = parts[place]
            line["fields"] = json_fields(message.fields, values)
            lines.append(self._tried(batch, line, rows[place]))
        return self._finished(batch, rows, lines)

    def unknown(self, batch: ColumnBatch) -> Lines:
        """The lines of the frames of unknown identity, each of which is tried."""
        rows = batch.filled.unknown
        schema = self._readings.schema.unknown
        places = payload_places(schema)
        starts, sizes = (
            rows[places["payload_offset"]].tolist(),
            rows[places["payload_size"]].tolist(),
        )
        payloads = batch.filled.payloads.tobytes()
        lines = []
        for place, (parts, start, size) in enumerate(
            zip(_parts(schema, rows), starts, sizes, strict=True)
        ):
            line = self._start(batch, rows[place], "unknown")
            line["parts"] = parts
            line["payload"] = payloads[start : start + size].hex()
            lines.append(self._tried(batch, line, rows[place]))
        return rows["offset"], self._finished(batch, rows, lines)

    def _invalid(self, batch: ColumnBatch) -> Lines:
        rows = batch.filled.invalid
        lines = []
        for row in rows:
            line = self._start(batch, row, "invalid")
            line["reason"] = InvalidReason(row["reason"]).word
            line["raw"] = batch.raw(int(row["offset"]), int(row["size"])).hex()
            lines.append(line)
        return rows["offset"], self._finished(batch, rows, lines)

    def _start(self, batch: ColumnBatch, row: Any, event: str, **named: str) -> dict[str, Any]:
        place = {"offset": int(row["offset"]) + batch.start, "size": int(row["size"])}
        return {**place, "event": event, **named, "sender": self._spec.name}

    def _tried(self, batch: ColumnBatch, line: dict[str, Any], row: Any) -> dict[str, Any]:
        raw = batch.raw(int(row["offset"]), int(row["size"]))
        try:
            gives_back = encode_line(self._spec, line) == raw
        except EncodeError:
            gives_back = False
        return line if gives_back else {**line, "raw": raw.hex()}

    def _finished(
        self, batch: ColumnBatch, rows: Any, lines: Sequence[dict[str, Any]]
    ) -> list[bytes]:
        times = batch.times_of(rows).tolist()
        found = []
        for line, when in zip(lines, times, strict=True):
            timed = line if when is None else {**line, "t_ns": when}
            text = json.dumps(timed, ensure_ascii=False) + "\n"
            found.append(text.encode("utf-8", "surrogatepass"))
        return found


def _parts(held: TableSchema, rows: Any) -> list[dict[str, int]]:
    """The parts of each row."""
    columns = [item for item in held.columns if item.role == "part"]
    values = [rows[item.name].tolist() for item in columns]
    names = [item.source for item in columns]
    if not names:
        return [{} for _ in range(len(rows))]
    return [dict(zip(names, row, strict=True)) for row in zip(*values, strict=True)]


# --- many at once ---------------------------------------------------------------------------------


def _template(reading: Reading, readings: Readings) -> _Template | None:
    if not reading.is_flat:
        return None
    assert reading.table.message is not None
    pieces: list[bytes | Cell] = [b'{"offset": ']
    pieces.append(_number("offset"))
    pieces.append(b', "size": ')
    pieces.append(_number("size"))
    name, sender = reading.table.message.name, readings.tables.sender.name
    fixed = f', "event": "message", "message": {json.dumps(name)}, "sender": {json.dumps(sender)}'
    pieces.append(f'{fixed}, "parts": {{'.encode())
    parts = [item for item in reading.held.columns if item.role == "part"]
    for place, item in enumerate(parts):
        comma = ", " if place else ""
        pieces += [f"{comma}{json.dumps(item.source)}: ".encode(), _number(item.name)]
    pieces.append(b'}, "fields": {')
    raw = {
        column.path: reader
        for column, reader in zip(reading.table.columns, reading.fields, strict=True)
        if column.derived is None
    }
    floats = [reader for path, reader in raw.items() if _is_float(reading, path)]
    pieces += _fields(reading.table.message.fields, (), raw)
    pieces.append(b"}")
    return _Template(_merged(pieces), _not_numbers(floats) if floats else None)


def _number(name: str) -> Cell:
    return lambda rows: cells.integers(np.ascontiguousarray(rows[name]))


def _fields(
    fields: Sequence[Field], prefix: tuple[str, ...], raw: dict[tuple[str, ...], Any]
) -> Iterator[bytes | Cell]:
    for place, item in enumerate(fields):
        yield f"{', ' if place else ''}{json.dumps(item.name)}: ".encode()
        path = (*prefix, item.name)
        if isinstance(item.type, Struct):
            yield b"{"
            yield from _fields(item.type.fields, path, raw)
            yield b"}"
        else:
            yield from _value(raw[path], item)


def _value(reader: Any, item: Field) -> Iterator[bytes | Cell]:
    kind = type(item.type).__name__
    match kind:
        case "Array":
            yield from (b"[", lambda rows: cells.lists(reader(rows)), b"]")
        case "Octets":
            yield from (b'"', lambda rows: cells.hexadecimal(reader(rows)), b'"')
        case "Text":
            yield lambda rows: cells.texts(reader(rows))
        case _:
            yield lambda rows: cells.numbers(reader(rows).values)


def _merged(pieces: Sequence[bytes | Cell]) -> tuple[bytes | Cell, ...]:
    """Join fixed texts that follow each other."""
    found: list[bytes | Cell] = []
    for piece in pieces:
        last = found[-1] if found else None
        if isinstance(piece, bytes) and isinstance(last, bytes):
            found[-1] = last + piece
        else:
            found.append(piece)
    return tuple(found)


def _is_float(reading: Reading, path: tuple[str, ...]) -> bool:
    column = next(item for item in reading.table.columns if item.path == path)
    leaf = getattr(column.type, "element", column.type)
    return str(getattr(leaf, "kind", "")).startswith("float")


def _not_numbers(readers: Sequence[Any]) -> Callable[[Any], Array]:
    def find(rows: Any) -> Array:
        found = np.zeros(len(rows), bool)
        for reader in readers:
            column: Numbers | Lists = reader(rows)
            here = np.isnan(column.values)
            found |= here if here.ndim == 1 else here.any(axis=1)
        return found

    return find
