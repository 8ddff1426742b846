"""Fills tables in Python: rows that were read in bulk, and rows from the decoder's events."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from protogen.capture.arrays import dtype_of, numpy
from protogen.capture.bulk.cutter import LEAST, BulkCutter
from protogen.capture.bulk.stretch import Bulk, Run, rows_of_runs
from protogen.capture.schema import (
    CaptureSchema,
    Choice,
    Column,
    Dimension,
    InvalidReason,
    Number,
    Record,
    Shape,
    TableSchema,
    Text,
)
from protogen.capture.tables import Tables, chosen, concatenated, empty_rows, rows
from protogen.runtime.decoder import Decoder

if TYPE_CHECKING:
    from protogen.capture.tables import Rows
    from protogen.runtime.sender import SenderSpec

Values = Sequence[Any]
Scope = ChainMap[str, Values]
"""What the columns in front hold, for each row: it counts and selects."""


class Reading:
    """What the bytes of one endpoint are read with. It takes a while to make, and never changes."""

    def __init__(
        self, schema: CaptureSchema, spec: SenderSpec[Any, Any], bulk: Bulk | None = None
    ) -> None:
        """Without `bulk` all rows come from events."""
        self.schema = schema
        self.spec = spec
        self.bulk = bulk
        self.empty = empty_rows(schema)
        self.invalid = rows(dtype_of(schema.invalid))
        self.unknown = rows(dtype_of(schema.unknown))


class PythonEngine:
    """A stream that becomes tables, some bytes at a time.

    What is plainly in order becomes rows in bulk, and the decoder's events tell the rest.
    """

    name = "python"

    def __init__(self, reading: Reading, least: int = LEAST) -> None:
        """The rows of fewer bytes than `least` come from events."""
        self._reading = reading
        spec, bulk = reading.spec, reading.bulk
        self._cutter = BulkCutter(bulk, spec, least) if bulk is not None else None
        self._decoder = Decoder(spec.cut_by(self._cutter or spec.cut))
        self._fed = 0
        self._offset = 0
        self._sequence = 0

    def feed(self, data: bytes | memoryview) -> Iterator[Tables]:
        """Take the next bytes of the stream."""
        self._fed += len(data)
        yield self._tables(self._decoder.feed(data))

    def flush(self) -> Iterator[Tables]:
        """Take the end of the stream."""
        yield self._tables(self._decoder.flush())

    def _tables(self, found: Sequence[Any]) -> Tables:
        if self._cutter is not None:
            self._cutter.forget()
        numbered, runs, count = _numbered(found, self._sequence)
        offset, sequence = self._offset, self._sequence
        self._offset = self._fed - self._decoder.pending
        self._sequence += count
        unknown: list[tuple[int, Any]] = [item for item in numbered if item[1].kind == "unknown"]
        return Tables(
            schema=self._reading.schema,
            engine=self.name,
            messages=self._messages(numbered, runs),
            invalid=_invalid(self._reading, numbered),
            unknown=_unknown(self._reading, unknown),
            payloads=_octets(b"".join(event.payload for _, event in unknown)),
            offset=offset,
            size=self._offset - offset,
            sequence=sequence,
            events=count,
        )

    def _messages(
        self, numbered: Sequence[tuple[int, Any]], runs: Sequence[tuple[int, Run]]
    ) -> dict[str, Rows]:
        by_name: dict[str, list[tuple[int, Any]]] = {}
        for item in numbered:
            if item[1].kind == "message":
                by_name.setdefault(item[1].message.NAME, []).append(item)
        pieces = rows_of_runs(runs)
        for name, items in by_name.items():
            found = _filled(self._reading.schema.messages[name], items)
            pieces.setdefault(name, []).append(found)
        others = {name: _in_order(items) for name, items in pieces.items()}
        return self._reading.empty | others


def _numbered(
    found: Sequence[Any], first: int
) -> tuple[list[tuple[int, Any]], list[tuple[int, Run]], int]:
    """Events and runs with their numbers, and how many events that makes."""
    events: list[tuple[int, Any]] = []
    runs: list[tuple[int, Run]] = []
    number = first
    for item in found:
        if isinstance(item, Run):
            runs.append((number, item))
            number += item.stop - item.first
        else:
            events.append((number, item))
            number += 1
    return events, runs, number - first


def _in_order(pieces: Sequence[Rows]) -> Rows:
    """All rows, by their numbers."""
    if len(pieces) == 1:
        return pieces[0]
    together = concatenated(pieces)
    return chosen(together, numpy().argsort(together["sequence"]))


def _octets(data: bytes) -> Rows:
    found: Rows = numpy().frombuffer(data, "u1")
    return found


def _framed(table: TableSchema, numbered: Sequence[tuple[int, Any]]) -> Rows:
    """Rows with what tells about an event and its frame."""
    found = rows(dtype_of(table), len(numbered))
    found["offset"] = [event.offset for _, event in numbered]
    found["sequence"] = [number for number, _ in numbered]
    found["size"] = [event.size for _, event in numbered]
    for column in table.columns:
        if column.role == "part":
            found[column.name] = [getattr(event.parts, column.source) for _, event in numbered]
    return found


def _invalid(reading: Reading, numbered: Sequence[tuple[int, Any]]) -> Rows:
    invalid = [item for item in numbered if item[1].kind == "invalid"]
    if not invalid:
        return reading.invalid
    found = _framed(reading.schema.invalid, invalid)
    found["reason"] = [InvalidReason[event.reason.upper()] for _, event in invalid]
    return found


def _unknown(reading: Reading, numbered: Sequence[tuple[int, Any]]) -> Rows:
    if not numbered:
        return reading.unknown
    table = reading.schema.unknown
    found = _framed(table, numbered)
    sizes = [len(event.payload) for _, event in numbered]
    places = {"payload_size": sizes, "payload_offset": [0, *_running(sizes)][: len(sizes)]}
    for column in table.columns:
        if column.role == "payload":
            found[column.name] = places[column.source]
    return found


def _running(sizes: Sequence[int]) -> Iterator[int]:
    total = 0
    for size in sizes:
        total += size
        yield total


def _filled(table: TableSchema, numbered: Sequence[tuple[int, Any]]) -> Rows:
    found = _framed(table, numbered)
    _fill(found, table.fields, [event.message for _, event in numbered], ChainMap())
    return found


# --- columns --------------------------------------------------------------------------------------


def _fill(found: Rows, columns: Sequence[Column], records: Values, scope: Scope) -> None:
    """Fill columns with the fields of these records."""
    for column in columns:
        values = [getattr(record, column.source) for record in records]
        if column.role == "count":
            found[column.name] = [len(value) for value in values]
        else:
            found[column.name] = _array(column, column.dimensions, values, scope)
        scope[column.name] = values


def _array(column: Column, dimensions: Sequence[Dimension], values: Values, scope: Scope) -> Rows:
    """The values of a column, or of the arrays in it."""
    if isinstance(column.shape, Text) and len(dimensions) == 1:
        texts = [text.encode("latin-1") for text in values]
        return numpy().array(texts, f"S{column.shape.size}")  # type: ignore[no-any-return]
    if not dimensions:
        return _plain(column.shape, values, scope)
    sizes = numpy().array([len(value) for value in values], "i8")
    inner = [element for value in values for element in value]
    elements = _array(column, dimensions[1:], inner, _around(column.shape, scope, sizes))
    capacity = dimensions[0].capacity
    found = numpy().zeros((len(values), capacity, *elements.shape[1:]), elements.dtype)
    found[numpy().arange(capacity) < sizes[:, None]] = elements
    return found  # type: ignore[no-any-return]


def _around(shape: Shape, scope: Scope, sizes: Values) -> Scope:
    """What each element sees of the row around it."""
    if isinstance(shape, Number | Text):
        return Scope()
    return Scope({name: _repeated(item, sizes) for name, item in scope.items()})


def _repeated(values: Values, sizes: Values) -> Values:
    return [value for value, size in zip(values, sizes, strict=True) for _ in range(size)]


def _plain(shape: Shape, values: Values, scope: Scope) -> Rows:
    match shape:
        case Number(code=code):
            return numpy().array(values, code)  # type: ignore[no-any-return]
        case Record(columns=columns):
            found = rows(dtype_of(TableSchema(row=shape)), len(values))
            _fill(found, columns, values, scope.new_child())
            return found
        case Choice():
            return _chosen(shape, values, scope)
        case _:
            raise AssertionError("text has a dimension")


def _chosen(choice: Choice, values: Values, scope: Scope) -> Rows:
    """The values of a switch: each row has that of its case."""
    whole = Column(name="it", role="field", source="it", shape=choice)
    found = rows(dtype_of(TableSchema(row=Record((whole,), choice.size, 1))), len(values))["it"]
    selector = choice.selector
    chosen = [selector] * len(values) if isinstance(selector, int) else scope[selector]
    known: Mapping[int, Column] = dict(choice.cases)
    for value in dict.fromkeys(map(int, chosen)):
        places = [place for place, number in enumerate(chosen) if number == value]
        inner = [values[place] for place in places]
        seen = Scope({name: [item[place] for place in places] for name, item in scope.items()})
        if value in known:
            case = known[value]
            found[case.name][places] = _array(case, case.dimensions, inner, seen)
        elif value not in choice.empty and choice.rest is not None:
            found[choice.rest.name][places] = _rest(choice.rest, inner)
    return found


def _rest(rest: Column, values: Values) -> Rows:
    assert isinstance(rest.shape, Record)
    found = rows(dtype_of(TableSchema(row=rest.shape)), len(values))
    held = rest.shape.column("bytes")
    found["size"] = [len(value) for value in values]
    found["bytes"] = _array(held, held.dimensions, values, Scope())
    return found
