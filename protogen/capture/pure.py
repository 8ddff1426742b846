"""Fills tables in Python, with rows from the decoder's events."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterator, Mapping, Sequence
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from protogen.capture.arrays import dtype_of, numpy
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
from protogen.capture.tables import Tables, empty_rows, rows
from protogen.model.expressions import Expression, operands, value_of
from protogen.runtime.attributes import attribute
from protogen.runtime.decoder import Decoder

if TYPE_CHECKING:
    from protogen.capture.tables import Rows
    from protogen.runtime.framing.sender import SenderSpec

Values = Sequence[Any]
Scope = ChainMap[str, Values]
"""Contents of the columns in front, for each row: it counts and selects."""


class Reading:
    """Schema, specification and empty tables of one endpoint. Takes a while to make; immutable."""

    def __init__(self, schema: CaptureSchema, spec: SenderSpec[Any, Any]) -> None:
        self.schema = schema
        self.spec = spec
        self.empty = empty_rows(schema)
        self.invalid = rows(dtype_of(schema.invalid))
        self.unknown = rows(dtype_of(schema.unknown))


class PythonEngine:
    """A stream that becomes tables, some bytes at a time."""

    name = "python"

    def __init__(self, reading: Reading) -> None:
        self._reading = reading
        self.start(0)

    def start(self, offset: int) -> None:
        """Begin a stream at this byte of the capture."""
        self._decoder = Decoder(self._reading.spec)
        self._first = self._fed = self._offset = offset
        self._sequence = 0

    def feed(self, data: bytes | memoryview) -> Iterator[Tables]:
        """Take the next bytes of the stream."""
        self._fed += len(data)
        yield self._tables(self._decoder.feed(data))

    def flush(self) -> Iterator[Tables]:
        """Take the end of the stream."""
        yield self._tables(self._decoder.flush())

    def _tables(self, events: Sequence[Any]) -> Tables:
        by_kind: dict[str, list[tuple[int, Any]]] = {"message": [], "invalid": [], "unknown": []}
        for item in enumerate(events, self._sequence):
            by_kind[item[1].kind].append(item)
        offset, sequence = self._offset, self._sequence
        self._offset = self._fed - self._decoder.pending
        self._sequence += len(events)
        unknown = by_kind["unknown"]
        found = Tables(
            schema=self._reading.schema,
            engine=self.name,
            messages=self._messages(by_kind["message"]),
            invalid=_invalid(self._reading, by_kind["invalid"]),
            unknown=_unknown(self._reading, unknown),
            payloads=_octets(b"".join(event.payload for _, event in unknown)),
            offset=offset,
            size=self._offset - offset,
            sequence=sequence,
            events=len(events),
        )
        *tables, _ = found.every
        for table in tables:
            table["offset"] += numpy().uint64(self._first)
        return found

    def _messages(self, numbered: Sequence[tuple[int, Any]]) -> dict[str, Rows]:
        by_name: dict[str, list[tuple[int, Any]]] = {}
        for item in numbered:
            by_name.setdefault(item[1].message.NAME, []).append(item)
        tables = self._reading.schema.messages
        filled = {name: _filled(tables[name], items) for name, items in by_name.items()}
        return self._reading.empty | filled


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
            name = attribute(column.source)
            values = [getattr(event.parts, name) for _, event in numbered]
            found[column.name] = _array(column, column.dimensions, values, ChainMap())
    return found


def _invalid(reading: Reading, numbered: Sequence[tuple[int, Any]]) -> Rows:
    if not numbered:
        return reading.invalid
    found = _framed(reading.schema.invalid, numbered)
    found["reason"] = [InvalidReason[event.reason.upper()] for _, event in numbered]
    return found


def _unknown(reading: Reading, numbered: Sequence[tuple[int, Any]]) -> Rows:
    if not numbered:
        return reading.unknown
    table = reading.schema.unknown
    found = _framed(table, numbered)
    sizes = [len(event.payload) for _, event in numbered]
    places = {"payload_size": sizes, "payload_offset": list(accumulate(sizes[:-1], initial=0))}
    for column in table.columns:
        if column.role == "payload":
            found[column.name] = places[column.source]
    return found


def _filled(table: TableSchema, numbered: Sequence[tuple[int, Any]]) -> Rows:
    found = _framed(table, numbered)
    _fill(found, table.fields, [event.message for _, event in numbered], ChainMap())
    return found


# --- columns --------------------------------------------------------------------------------------


def _fill(found: Rows, columns: Sequence[Column], records: Values, scope: Scope) -> None:
    """Fill columns with the fields of these records."""
    for column in columns:
        name = attribute(column.source)
        values = [getattr(record, name) for record in records]
        if column.role == "presence":
            found[column.name] = [value is not None for value in values]
        elif column.role == "count":
            found[column.name] = [0 if value is None else len(value) for value in values]
        elif column.when is None:
            found[column.name] = _array(column, column.dimensions, values, scope)
        else:
            there = [place for place, value in enumerate(values) if value is not None]
            inner = [values[place] for place in there]
            seen = _at_places(scope, there)
            found[column.name][there] = _array(column, column.dimensions, inner, seen)
        scope[column.name] = values


def _at_places(scope: Scope, places: Sequence[int]) -> Scope:
    """Contents of the columns in some rows."""
    return Scope({name: [item[place] for place in places] for name, item in scope.items()})


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
    """Columns that each element sees of the row around it."""
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
    chosen = _said(choice.selector, scope, len(values))
    known: Mapping[int | None, Column] = dict(choice.cases)
    for value in dict.fromkeys(map(int, chosen)):
        places = [place for place, number in enumerate(chosen) if number == value]
        inner = [values[place] for place in places]
        seen = _at_places(scope, places)
        key = value if value in known or value in choice.empty else None
        if key in known:
            case = known[key]
            found[case.name][places] = _array(case, case.dimensions, inner, seen)
        elif key is None and choice.rest is not None:
            found[choice.rest.name][places] = _rest(choice.rest, inner)
    return found


def _said(what: str | int | Expression, scope: Scope, count: int) -> Values:
    """The numbers that a column, or an expression over columns, has in each row."""
    if isinstance(what, str):
        return scope[what]
    if isinstance(what, int):
        return [what] * count
    looked_up = {operand.name: _reached(scope, operand.path) for operand in operands(what)}
    return [
        int(value_of(what, lambda operand: looked_up[operand.name][row]))  # noqa: B023
        for row in range(count)
    ]


def _reached(scope: Scope, path: Sequence[str]) -> Values:
    values = scope[path[0]]
    for name in path[1:]:
        values = [getattr(value, name) for value in values]
    return values


def _rest(rest: Column, values: Values) -> Rows:
    assert isinstance(rest.shape, Record)
    found = rows(dtype_of(TableSchema(row=rest.shape)), len(values))
    held = rest.shape.column("bytes")
    found["size"] = [len(value) for value in values]
    found["bytes"] = _array(held, held.dimensions, values, Scope())
    return found
