"""Columns of the values at a path, for all rows at once.

Rows are taken apart level by level: the elements of all lists become one array, and of a switch
each case's rows. What is constant, or holds nothing, has no column; lists of such values still have
as many elements as a number says.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Iterable, Sequence
from itertools import takewhile
from typing import Any

import numpy as np

from protogen.capture.schema import Column, Dimension, Number, TableSchema
from protogen.convert.columns.arrays import Array, Lists, Numbers, Octets
from protogen.convert.columns.composite_arrays import Cases, ListsOf, Same, Scattered, Structs
from protogen.convert.columns.event_values import constant_of
from protogen.convert.columns.held_columns import (
    cases_of,
    dimensions_of,
    held_by,
    members_of,
    presence_of,
    rest_of,
)
from protogen.convert.columns.python_values import Values
from protogen.model.expressions import Expression, plain_name, value_of
from protogen.model.types import Array as ArrayType
from protogen.model.types import Counted, Extent, Field, Fixed, Struct, Switch, Text, Type
from protogen.model.types import Octets as OctetsType

Scope = ChainMap[str, Array]
"""The numbers in front, which count and choose, of each row."""


def nested(path: Sequence[str], table: TableSchema, rows: Any) -> Values:
    """The raw values at a path, of every row of a message."""
    assert table.message is not None
    return _reach(path, table.message.fields, table.columns, rows, ChainMap())


# --- the way to a value ---------------------------------------------------------------------------


def _reach(
    path: Sequence[str],
    fields: Sequence[Field],
    columns: Sequence[Column],
    rows: Any,
    around: Scope,
) -> Values:
    item = next(item for item in fields if item.name == path[0])
    column = held_by(item, columns)
    scope = around.new_child(_InFront(item, fields, columns, rows))
    held = _in_rows(column, rows)
    presence = presence_of(item, columns)
    if presence is None:
        return _inside(path[1:], item, item.type, column, held, scope)
    said = rows[presence.name] if isinstance(presence, Column) else _said(presence, scope)
    having, places = _having(np.broadcast_to(said != 0, len(held)))
    scope = _at_places(scope, lambda: having)
    return Scattered(_inside(path[1:], item, item.type, column, held[having], scope), places)


def _having(there: Array) -> tuple[Array, Array]:
    """The rows that have something, and for each row its place among those; -1: it has not."""
    having = np.flatnonzero(there)
    places = np.full(len(there), -1, "i8")
    places[having] = np.arange(len(having))
    return having, places


def _inside(
    path: Sequence[str], item: Field, type: Type, column: Column | None, held: Any, scope: Scope
) -> Values:
    if not path:
        return _values(item, type, column, dimensions_of(column), held, scope)
    if isinstance(type, Struct):
        return _reach(path, type.fields, members_of(column), held, scope)
    assert isinstance(type, Switch)
    return _case(path, item, type, column, held, scope)


def _case(
    path: Sequence[str], item: Field, type: Switch, column: Column | None, held: Any, scope: Scope
) -> Scattered:
    """Values behind a path, of the rows that have the case that it begins with."""
    case = next((case for case in type.cases if case.name == path[0]), None)
    chosen = np.ascontiguousarray(_said(type.selector, scope))
    if case is None or case.value is None:
        # NumPy would compare numbers of 64 bits with those of another type as floats.
        there = ~np.isin(chosen, np.array(type.values, chosen.dtype))
    else:
        there = chosen == case.value
    having, places = _having(there)
    if case is None:
        return Scattered(_rest(column, held[having]), places)
    within = cases_of(column).get(case.value)
    inside = _in_rows(within, held[having])
    scope = _at_places(scope, lambda: having)
    return Scattered(_inside(path[1:], item, case.type, within, inside, scope), places)


def _rest(column: Column | None, held: Any) -> Octets:
    rest = rest_of(column)
    assert rest is not None
    inside = held[rest.name]
    return Octets(np.ascontiguousarray(inside["bytes"]), inside["size"].astype("i4"))


def _in_rows(column: Column | None, rows: Any) -> Any:
    """The part of rows that a column has; without one, something that is as long."""
    return _nothing(len(rows)) if column is None else rows[column.name]


def _nothing(count: int) -> Array:
    return np.broadcast_to(np.uint8(0), count)


# --- numbers in front -----------------------------------------------------------------------------


class _InFront(dict[str, Array]):
    """Numbers of a record in front of a field, and the number of its elements, when asked for."""

    def __init__(
        self, item: Field | None, fields: Iterable[Field], columns: Sequence[Column], rows: Any
    ) -> None:
        super().__init__()
        self._item = item
        self._fields = fields
        self._columns = columns
        self._rows = rows

    def __missing__(self, name: str) -> Array:
        self[name] = found = self._found(name)
        return found

    def _found(self, name: str) -> Array:
        first, _, rest = name.partition(".")
        if rest:
            return self._member(first, rest)
        for column in self._columns:
            if column.role == "count" and column.name == name:
                return np.asarray(self._rows[name])
        for item in takewhile(lambda item: item is not self._item, self._fields):
            if item.name != name:
                continue
            if isinstance(item.const, int):
                return np.broadcast_to(item.const, len(self._rows))
            number = held_by(item, self._columns)
            if number is not None and not number.dimensions:
                return np.asarray(self._rows[number.name])
        raise KeyError(name)

    def _member(self, first: str, rest: str) -> Array:
        """The number of a member of a struct."""
        for item in takewhile(lambda item: item is not self._item, self._fields):
            if item.name == first and isinstance(item.type, Struct):
                column = held_by(item, self._columns)
                inside = _in_rows(column, self._rows)
                return _InFront(None, item.type.fields, members_of(column), inside)[rest]
        raise KeyError(first)


def _said(expression: Expression, scope: Scope) -> Array:
    """The numbers that an expression has in each row."""
    name = plain_name(expression)
    if name is not None:
        return scope[name]
    found = value_of(expression, lambda operand: np.asarray(scope[operand.name]).astype("i8"))
    return np.asarray(found).astype("i8")


def _at_places(scope: Scope, places: Callable[[], Array]) -> Scope:
    """Numbers that count and choose in these rows."""
    return ChainMap(_Picked(scope, places))


class _Picked(dict[str, Array]):
    """Picks rows of what is asked for, and of nothing else."""

    def __init__(self, scope: Scope, places: Callable[[], Array]) -> None:
        super().__init__()
        self._scope = scope
        self._places = places

    def __missing__(self, name: str) -> Array:
        self[name] = found = self._scope[name][self._places()]
        return found


# --- values ---------------------------------------------------------------------------------------


def _values(
    item: Field,
    type: Type,
    column: Column | None,
    left: Sequence[Dimension],
    held: Any,
    scope: Scope,
) -> Values:
    """The values of a column, or of the arrays in it, of which these dimensions are left."""
    if column is None and item.const is not None:
        return Same(constant_of(item), len(held))
    match type:
        case Struct(fields=fields):
            inner = members_of(column)
            members = {it.name: _reach([it.name], fields, inner, held, scope) for it in fields}
            return Structs(members, len(held))
        case Switch():
            return _cases(item, type, column, held, scope)
        case ArrayType(element=element) if column or not element.holds_values:
            return _lists(item, type, column, left, held, scope)
        case _ if column is None:
            return Same([], len(held))  # Nothing else holds nothing but an empty list.
        case Text():
            return _texts(type, left, held, scope)
        case OctetsType(extent=extent):
            size = _size(extent, left)
            return Octets(np.ascontiguousarray(held[:, :size]), _counts(extent, left, scope))
        case _:
            return Numbers(np.ascontiguousarray(held))


def _cases(item: Field, type: Switch, column: Column | None, held: Any, scope: Scope) -> Cases:
    names = [case.name for case in type.cases]
    if rest_of(column) is not None:
        names.append("")
    found = {name: _case([name], item, type, column, held, scope) for name in names}
    return Cases({name: it for name, it in found.items() if len(it.values)}, len(held))


def _texts(type: Text, left: Sequence[Dimension], held: Any, scope: Scope) -> list[str]:
    texts = [text.decode("latin-1") for text in held.tolist()]
    counts = _counts(type.extent, left, scope)
    if counts is None:
        return texts
    return [text.ljust(count, "\0") for text, count in zip(texts, counts.tolist(), strict=True)]


def _lists(
    item: Field,
    type: ArrayType,
    column: Column | None,
    left: Sequence[Dimension],
    held: Any,
    scope: Scope,
) -> Values:
    size, counts = _size(type.extent, left), _counts(type.extent, left, scope)
    is_number = column is not None and isinstance(column.shape, Number)
    if is_number and len(left) == 1 and not isinstance(type.element, OctetsType):
        return Lists(np.ascontiguousarray(held[:, :size]), counts)
    if counts is None:
        counts = np.full(len(held), size, "i4")
    elements = _nothing(int(counts.sum())) if column is None else _elements(held, counts)
    inner = _at_places(scope, lambda: np.repeat(np.arange(len(held)), counts))
    return ListsOf(_values(item, type.element, column, left[1:], elements, inner), counts)


def _elements(held: Any, counts: Array) -> Any:
    """Elements that are there, of all rows; copied whole, much faster than by members."""
    size = held.dtype.itemsize
    whole = held.view(f"u{size}" if size in (1, 2, 4, 8) else f"V{size}")
    if len(counts) and int(counts.min()) == held.shape[1]:
        return whole.reshape(-1, *held.shape[2:]).view(held.dtype)
    there = np.arange(held.shape[1]) < counts.reshape(-1, 1)
    return whole[there].view(held.dtype)


def _size(extent: Extent, left: Sequence[Dimension]) -> int:
    """Room for elements or bytes, of a fixed number that itself."""
    if isinstance(extent, Fixed):
        return extent.count
    return left[0].capacity if left else 0


def _counts(extent: Extent, left: Sequence[Dimension], scope: Scope) -> Array | None:
    """Number of elements or bytes in each row; None: always as many as there is room for."""
    if isinstance(extent, Counted):
        return _said(extent.by, scope).astype("i4")
    name = left[0].counted_by if left else None
    return scope[name].astype("i4") if isinstance(name, str) else None
