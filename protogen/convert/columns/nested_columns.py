"""Columns of what lies inside of lists, structs and switches, for all rows at once.

Rows are taken apart level by level: the elements of all lists become one array, and of a switch
each case's rows. What is constant, or holds nothing, has no column: `constant_columns.py`.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterable, Sequence
from itertools import takewhile
from typing import Any

import numpy as np

from protogen.capture.schema import Choice, Column, Dimension, Record, TableSchema
from protogen.capture.schema import Text as TextShape
from protogen.convert.columns.arrays import Array, Lists, Numbers, Octets
from protogen.convert.columns.composite_arrays import Cases, ListsOf, Scattered, Structs
from protogen.convert.columns.constant_columns import (
    CaseRows,
    Scope,
    at_places,
    constant_values,
    constants_in,
    followed,
)
from protogen.convert.columns.python_values import Values
from protogen.model.types import Array as ArrayType
from protogen.model.types import Field, Fixed, Struct, Switch, Text, Type
from protogen.model.types import Octets as OctetsType


def nested(path: Sequence[str], table: TableSchema, rows: Any) -> Values:
    """The raw values at a path, of every row of a message."""
    assert table.message is not None
    return _reach(path, table.message.fields, table.columns, rows, ChainMap())


def _reach(
    path: Sequence[str],
    fields: Sequence[Field],
    columns: Sequence[Column],
    rows: Any,
    around: Scope,
) -> Values:
    item = next(item for item in fields if item.name == path[0])
    column = _held(item, columns)
    in_front = list(takewhile(lambda other: other is not item, fields))
    scope = around.new_child(_numbers(item, in_front, columns, rows))
    if column is None:
        return followed(constant_values(item, item.type, len(rows), scope), path[1:])
    held = rows[column.name]
    return _inside(path[1:], item, item.type, column, held, scope)


def _inside(
    path: Sequence[str], item: Field, type: Type, column: Column, held: Any, scope: Scope
) -> Values:
    if not path:
        return _values(item, type, column, column.dimensions, held, scope)
    if isinstance(column.shape, Record):
        assert isinstance(type, Struct)
        return _reach(path, type.fields, column.shape.columns, held, scope)
    assert isinstance(column.shape, Choice)
    assert isinstance(type, Switch)
    chosen = _chosen(column.shape, len(held), scope)
    return _case(path, item, type, column.shape, chosen, held, scope)


def _held(item: Field, columns: Sequence[Column]) -> Column | None:
    return next((c for c in columns if c.role == "field" and c.source == item.name), None)


def _numbers(
    item: Field, in_front: Sequence[Field], columns: Iterable[Column], rows: Any
) -> dict[str, Array]:
    """Numbers in front of a field, which count or choose, by the names of fields and columns."""
    found = constants_in(in_front, len(rows))
    names = {other.name for other in in_front}
    for column in columns:
        if column.role == "count" and column.source in {*names, item.name}:
            found[column.name] = rows[column.name]
        if column.role == "field" and column.source in names and not column.dimensions:
            found[column.name] = found[column.source] = rows[column.name]
    return found


def _chosen(choice: Choice, count: int, scope: Scope) -> Array:
    """Value of the selector in each row."""
    if isinstance(choice.selector, int):
        return np.full(count, choice.selector)
    return np.ascontiguousarray(scope[choice.selector])


def _case(
    path: Sequence[str],
    item: Field,
    type: Switch,
    choice: Choice,
    chosen: Array,
    held: Any,
    scope: Scope,
) -> Scattered:
    """Values behind a path, of the rows that have the case that it begins with."""
    case = next((case for case in type.cases if case.name == path[0]), None)
    if case is None:
        # NumPy would compare numbers of 64 bits with those of another type as floats.
        there = ~np.isin(chosen, np.array([case.value for case in type.cases], chosen.dtype))
    else:
        there = chosen == case.value
    having = CaseRows.where(there, scope)
    if case is None:
        return Scattered(_rest(choice, held[having.rows]), having.places)
    column = dict(choice.cases).get(case.value)
    if column is None:
        constant = constant_values(item, case.type, len(having), having.scope)
        return Scattered(followed(constant, path[1:]), having.places)
    inside = held[having.rows][column.name]
    found = _inside(path[1:], item, case.type, column, inside, having.scope)
    return Scattered(found, having.places)


def _rest(choice: Choice, held: Any) -> Octets:
    assert choice.rest is not None
    rest = held[choice.rest.name]
    return Octets(np.ascontiguousarray(rest["bytes"]), rest["size"].astype("i4"))


def _values(
    item: Field,
    type: Type,
    column: Column,
    dimensions: Sequence[Dimension],
    held: Any,
    scope: Scope,
) -> Values:
    """The values of a column, or of the arrays in it, of which `dimensions` are left."""
    if isinstance(type, Text):
        return _texts(type, dimensions[0], held, scope)
    if isinstance(type, OctetsType):
        size = _size(dimensions[0], type.extent)
        return Octets(np.ascontiguousarray(held[:, :size]), _counts(dimensions[0], scope))
    if dimensions and isinstance(type, ArrayType):
        return _arrays(item, type, column, dimensions, held, scope)
    match column.shape:
        case Record() as record:
            assert isinstance(type, Struct)
            members = {
                it.name: _reach([it.name], type.fields, record.columns, held, scope)
                for it in type.fields
            }
            return Structs(members, len(held))
        case Choice() as choice:
            assert isinstance(type, Switch)
            return _cases(item, type, choice, held, scope)
        case _:
            return Numbers(np.ascontiguousarray(held))


def _counts(dimension: Dimension, scope: Scope) -> Array | None:
    """Number of elements or bytes in each row; None: as many as there is room for."""
    counted_by = dimension.counted_by
    if counted_by is None:
        return None
    found: Array = scope[counted_by].astype("i4")
    return found


def _size(dimension: Dimension, extent: Any) -> int:
    return extent.count if isinstance(extent, Fixed) else dimension.capacity


def _texts(type: Text, dimension: Dimension, held: Any, scope: Scope) -> list[str]:
    texts = [text.decode("latin-1") for text in held.tolist()]
    if isinstance(type.extent, Fixed):
        return texts
    counts = _counts(dimension, scope)
    assert counts is not None
    return [text.ljust(count, "\0") for text, count in zip(texts, counts.tolist(), strict=True)]


def _arrays(
    item: Field,
    type: ArrayType,
    column: Column,
    dimensions: Sequence[Dimension],
    held: Any,
    scope: Scope,
) -> Values:
    size = _size(dimensions[0], type.extent)
    counts = _counts(dimensions[0], scope)
    is_number = not isinstance(column.shape, Record | Choice | TextShape)
    if is_number and len(dimensions) == 1 and not isinstance(type.element, OctetsType):
        return Lists(np.ascontiguousarray(held[:, :size]), counts)
    if counts is None:
        counts = np.full(len(held), size, "i4")
    inner = at_places(scope, lambda: np.repeat(np.arange(len(held)), counts))
    elements = _elements(held, counts)
    return ListsOf(_values(item, type.element, column, dimensions[1:], elements, inner), counts)


def _elements(held: Any, counts: Array) -> Any:
    """Elements that are there, of all rows; copied whole, much faster than by members."""
    size = held.dtype.itemsize
    whole = held.view(f"u{size}" if size in (1, 2, 4, 8) else f"V{size}")
    if len(counts) and int(counts.min()) == held.shape[1]:
        return whole.reshape(-1, *held.shape[2:]).view(held.dtype)
    there = np.arange(held.shape[1]) < counts.reshape(-1, 1)
    return whole[there].view(held.dtype)


def _cases(item: Field, type: Switch, choice: Choice, held: Any, scope: Scope) -> Cases:
    chosen = _chosen(choice, len(held), scope)
    names = [case.name for case in type.cases]
    if choice.rest is not None:
        names.append("")
    found = {name: _case([name], item, type, choice, chosen, held, scope) for name in names}
    return Cases({name: it for name, it in found.items() if len(it.values)}, len(held))
