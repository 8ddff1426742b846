"""Rows of NumPy tables as plain values, whatever they hold: arrays of structs, cases of switches.

For what has no shorter way: an object is made for each value.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Mapping, Sequence
from typing import Any

from protogen.capture.schema import Choice, Column, Dimension, Record, TableSchema
from protogen.capture.schema import Text as TextShape
from protogen.model.fields import Field
from protogen.model.types import Array, Fixed, Integer, Octets, Struct, Switch, Text, Type

Scope = ChainMap[str, list[Any]]
"""The values of the columns in front, which count and choose."""


def plain_rows(table: TableSchema, rows: Any) -> list[dict[str, Any]]:
    """The fields of each row, as `plain_fields` has them."""
    assert table.message is not None
    columns = {item.source: item for item in table.columns if item.role == "field"}
    counts = {item.name: item for item in table.columns if item.role == "count"}
    return _members(table.message.fields, columns, counts, rows, ChainMap())


def _members(
    fields: Sequence[Field],
    columns: Mapping[str, Column],
    counts: Mapping[str, Column],
    rows: Any,
    around: Scope,
) -> list[dict[str, Any]]:
    scope = around.new_child({name: rows[name].tolist() for name in counts})
    values = {}
    for item in fields:
        column = columns.get(item.name)
        found = _field(item, column, rows, scope)
        values[item.name] = scope[item.name] = found
        if column is not None:
            scope[column.name] = found
    return _zipped(values, len(rows))


def _zipped(values: Mapping[str, Sequence[Any]], count: int) -> list[dict[str, Any]]:
    if not values:
        return [{} for _ in range(count)]
    return [dict(zip(values, row, strict=True)) for row in zip(*values.values(), strict=True)]


def _field(item: Field, column: Column | None, rows: Any, scope: Scope) -> list[Any]:
    if column is None:
        return [constant(item, item.type) for _ in range(len(rows))]
    return _values(item, item.type, column, column.dimensions, rows[column.name], scope)


def constant(item: Field, type: Type) -> Any:
    """The only value of a field that is not stored, because it is constant or holds nothing."""
    if item.const is not None:
        return list(item.const) if isinstance(item.const, tuple) else _as_bool(type, item.const)
    match type:
        case Struct(fields=fields):
            return {member.name: constant(member, member.type) for member in fields}
        case Array(element=element, extent=Fixed(count=count)):
            return [constant(item, element) for _ in range(count)]
        case Switch(cases=cases):
            return {cases[0].name: constant(item, cases[0].type)}
        case _:
            return []


def _as_bool(type: Type, value: Any) -> Any:
    return bool(value) if isinstance(type, Integer) and type.role == "bool" else value


def _values(
    item: Field,
    type: Type,
    column: Column,
    dimensions: Sequence[Dimension],
    held: Any,
    scope: Scope,
) -> list[Any]:
    """The values of a column, or of the arrays in it, of which `dimensions` are left."""
    if dimensions and isinstance(type, Array):
        return _arrays(item, type, column, dimensions, held, scope)
    if isinstance(type, Text):
        assert isinstance(column.shape, TextShape)
        return _texts(type, dimensions[0], held, scope)
    if isinstance(type, Octets):
        counts = _counts(dimensions[0], type.extent, len(held), scope)
        return [row[:count].tobytes() for row, count in zip(held, counts, strict=True)]
    match column.shape:
        case Record() as record:
            assert isinstance(type, Struct)
            return _records(type, record, held, scope)
        case Choice() as choice:
            assert isinstance(type, Switch)
            return _choices(item, type, choice, held, scope)
        case _:
            numbers: list[Any] = held.tolist()
            return numbers


def _counts(dimension: Dimension, extent: Any, rows: int, scope: Scope) -> list[int]:
    if dimension.counted_by is not None:
        return [int(count) for count in scope[dimension.counted_by]]
    return [extent.count if isinstance(extent, Fixed) else dimension.capacity] * rows


def _texts(type: Text, dimension: Dimension, held: Any, scope: Scope) -> list[str]:
    texts = [text.decode("latin-1") for text in held.tolist()]
    if isinstance(type.extent, Fixed):
        return texts
    counts = _counts(dimension, type.extent, len(held), scope)
    return [text.ljust(count, "\0") for text, count in zip(texts, counts, strict=True)]


def _arrays(
    item: Field,
    type: Array,
    column: Column,
    dimensions: Sequence[Dimension],
    held: Any,
    scope: Scope,
) -> list[Any]:
    import numpy as np

    counts = _counts(dimensions[0], type.extent, len(held), scope)
    there = np.arange(dimensions[0].capacity) < np.array(counts, "i8").reshape(-1, 1)
    inner: Scope = ChainMap(
        {
            name: [value for value, count in zip(values, counts, strict=True) for _ in range(count)]
            for name, values in scope.items()
        }
    )
    flat = iter(_values(item, type.element, column, dimensions[1:], held[there], inner))
    return [[next(flat) for _ in range(count)] for count in counts]


def _records(type: Struct, record: Record, held: Any, scope: Scope) -> list[Any]:
    columns = {item.source: item for item in record.columns if item.role == "field"}
    counts = {item.name: item for item in record.columns if item.role == "count"}
    return _members(type.fields, columns, counts, held, scope)


def _choices(item: Field, type: Switch, choice: Choice, held: Any, scope: Scope) -> list[Any]:
    chosen = (
        [choice.selector] * len(held)
        if isinstance(choice.selector, int)
        else [int(value) for value in scope[choice.selector]]
    )
    known = dict(choice.cases)
    cases = {case.value: case for case in type.cases}
    found: list[Any] = [None] * len(held)
    for value in dict.fromkeys(chosen):
        places = [place for place, number in enumerate(chosen) if number == value]
        inner: Scope = ChainMap(
            {name: [values[place] for place in places] for name, values in scope.items()}
        )
        for place, it in zip(
            places, _case(item, cases.get(value), known.get(value), choice, held[places], inner),
            strict=True,
        ):  # fmt: skip
            found[place] = it
    return found


def _case(
    item: Field, case: Any, column: Column | None, choice: Choice, held: Any, scope: Scope
) -> list[Any]:
    if case is None:
        assert choice.rest is not None
        rest = held[choice.rest.name]
        sizes = rest["size"].tolist()
        rows = zip(rest["bytes"], sizes, strict=True)
        return [{"": row[:size].tobytes()} for row, size in rows]
    if column is None:
        return [{case.name: constant(item, case.type)} for _ in range(len(held))]
    values = _values(item, case.type, column, column.dimensions, held[column.name], scope)
    return [{case.name: value} for value in values]


# --- for JSON lines -------------------------------------------------------------------------------


def json_fields(fields: Sequence[Field], values: Mapping[str, Any]) -> dict[str, Any]:
    """Plain values as JSON lines show them."""
    return {item.name: json_value(item.type, values[item.name]) for item in fields}


def json_value(type: Type, value: Any) -> Any:
    """A plain value as JSON lines show it."""
    match type:
        case Octets():
            return value.hex()
        case Array(element=element):
            return [json_value(element, item) for item in value]
        case Struct(fields=fields):
            return json_fields(fields, value)
        case Switch(cases=cases):
            ((name, chosen),) = value.items()
            case = next((case for case in cases if case.name == name), None)
            if case is None:
                return chosen.hex()
            return json_value(case.type, chosen) if chosen != {} else None
        case _:
            return str(value) if isinstance(value, float) and value - value != 0 else value
