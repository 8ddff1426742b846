"""Columns of what lies inside of lists, structs and switches, for all rows at once.

Rows are taken apart level by level: the elements of all lists become one array, and of a switch
each case's rows. `plain_rows.py` says the same row by row.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, takewhile
from typing import TYPE_CHECKING, Any

import numpy as np

from protogen.capture.schema import Choice, Column, Dimension, Record, TableSchema
from protogen.capture.schema import Text as TextShape
from protogen.convert.arrays import Array, Lists, Numbers, Octets
from protogen.convert.plain import reached
from protogen.convert.plain_rows import constant
from protogen.convert.tables import ColumnType, Listed
from protogen.convert.tables import Record as RecordType
from protogen.convert.values import as_list
from protogen.model.fields import Field
from protogen.model.types import Array as ArrayType
from protogen.model.types import Fixed, Struct, Switch, Text, Type
from protogen.model.types import Octets as OctetsType

if TYPE_CHECKING:
    import pyarrow as pa

Values = Any
Scope = ChainMap[str, Array]
"""The numbers in front, which count and choose, of each row."""

# --- what such columns are ------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Same:
    """The same value in each row."""

    value: Any
    count: int

    def __len__(self) -> int:
        return self.count

    def tolist(self) -> list[Any]:
        """The value, for each row."""
        return [self.value] * self.count

    def to_arrow(self, type: ColumnType) -> pa.Array:
        """The Arrow array."""
        return _arrow(type, [self.value]).take(_indices(np.zeros(self.count, "i8")))


@dataclass(frozen=True, slots=True)
class Scattered:
    """Values of some of the rows: `places` has the number of each row's value; -1: none."""

    values: Values
    places: Array

    def __len__(self) -> int:
        return len(self.places)

    def tolist(self) -> list[Any]:
        """The value of each row, or None."""
        # The last one stands for -1.
        found = [*as_list(self.values), None]
        return [found[place] for place in self.places.tolist()]

    def to_arrow(self, type: ColumnType) -> pa.Array:
        """The Arrow array."""
        return _arrow(type, self.values).take(_indices(self.places))


@dataclass(frozen=True, slots=True)
class Structs:
    """Named values in each row."""

    members: Mapping[str, Values]
    count: int

    def __len__(self) -> int:
        return self.count

    def tolist(self) -> list[Any]:
        """The values of each row by their names."""
        if not self.members:
            return [{} for _ in range(self.count)]
        columns = zip(*map(as_list, self.members.values()), strict=True)
        return [dict(zip(self.members, row, strict=True)) for row in columns]

    def to_arrow(self, type: ColumnType) -> pa.Array:
        """The Arrow array."""
        import pyarrow as pa

        from protogen.convert.arrow_tables import type_of

        assert isinstance(type, RecordType)
        if not type.members:
            return pa.array(self.tolist(), type_of(type))
        arrays = [_arrow(inner, self.members[name]) for name, inner in type.members]
        return pa.StructArray.from_arrays(arrays, fields=list(type_of(type)))


@dataclass(frozen=True, slots=True)
class Cases:
    """One of several named values in each row: for each name those of the rows that have it."""

    members: Mapping[str, Scattered]
    """The name of what no case stands for is empty."""
    count: int

    def __len__(self) -> int:
        return self.count

    def tolist(self) -> list[Any]:
        """The value of each row, by its name."""
        found: list[Any] = [None] * self.count
        for name, values in self.members.items():
            held = as_list(values.values)
            for row in np.flatnonzero(values.places >= 0).tolist():
                found[row] = {name: held[int(values.places[row])]}
        return found

    def to_arrow(self, type: ColumnType) -> pa.Array:
        """The Arrow array."""
        import pyarrow as pa

        from protogen.convert.arrow_tables import type_of

        assert isinstance(type, RecordType)
        named = dict(self.members)
        if "" in named:
            named[type.members[-1][0]] = named.pop("")
        arrays = [
            named[name].to_arrow(inner) if name in named else pa.nulls(self.count, type_of(inner))
            for name, inner in type.members
        ]
        return pa.StructArray.from_arrays(arrays, fields=list(type_of(type)))


@dataclass(frozen=True, slots=True)
class ListsOf:
    """Several values in each row: `elements` has those of all rows, `counts` how many are whose."""

    elements: Values
    counts: Array

    def __len__(self) -> int:
        return len(self.counts)

    def tolist(self) -> list[Any]:
        """The list of each row."""
        flat = iter(as_list(self.elements))
        return [list(islice(flat, count)) for count in self.counts.tolist()]

    def to_arrow(self, type: ColumnType) -> pa.Array:
        """The Arrow array."""
        import pyarrow as pa

        from protogen.convert.arrow_tables import type_of

        assert isinstance(type, Listed)
        flat = _arrow(type.element, self.elements)
        if type.count is not None:
            return pa.FixedSizeListArray.from_arrays(flat, type=type_of(type))
        ends = np.zeros(len(self.counts) + 1, "i4")
        np.cumsum(self.counts, out=ends[1:])
        return pa.ListArray.from_arrays(pa.array(ends), flat, type=type_of(type))


def _arrow(type: ColumnType, values: Values) -> pa.Array:
    from protogen.convert.arrow_tables import array_of

    return array_of(type, values)


def _indices(places: Array) -> pa.Array:
    import pyarrow as pa

    missing = places < 0
    return pa.array(places, mask=missing if missing.any() else None)


# --- how they are read ----------------------------------------------------------------------------


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
    if column is None:
        return Same(reached(constant(item, item.type), path[1:]), len(rows))
    in_front = takewhile(lambda other: other is not column, columns)
    scope = around.new_child(_numbers(in_front, rows))
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


def _numbers(columns: Iterable[Column], rows: Any) -> dict[str, Array]:
    """What counts or chooses, by the names of fields and columns."""
    found = {}
    for column in columns:
        if column.role in ("field", "count") and not column.dimensions:
            found[column.name] = rows[column.name]
            if column.role == "field":
                found[column.source] = rows[column.name]
    return found


def _at(scope: Scope, places: Callable[[], Array]) -> Scope:
    """What counts and chooses in these rows."""
    return ChainMap(_Picked(scope, places))


class _Picked(dict[str, Array]):
    """Picks rows of what is asked for, and of nothing else."""

    def __init__(self, scope: Scope, places: Callable[[], Array]) -> None:
        super().__init__()
        self._scope = scope
        self._places = places

    def __missing__(self, name: str) -> Array:
        found: Array = self._scope[name][self._places()]
        self[name] = found
        return found


def _chosen(choice: Choice, count: int, scope: Scope) -> Array:
    """What the selector is, of each row."""
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
    """Of the rows that have the case that the path begins with, what the rest of it leads to."""
    case = next((case for case in type.cases if case.name == path[0]), None)
    if case is None:
        # NumPy would compare numbers of 64 bits with those of another type as floats.
        there = ~np.isin(chosen, np.array([case.value for case in type.cases], chosen.dtype))
    else:
        there = chosen == case.value
    rows = np.flatnonzero(there)
    places = np.full(len(held), -1, "i8")
    places[rows] = np.arange(len(rows))
    if case is None:
        return Scattered(_rest(choice, held[rows]), places)
    column = dict(choice.cases).get(case.value)
    if column is None:
        value = reached(constant(item, case.type), path[1:])
        return Scattered(Same(value, len(rows)), places)
    inner = _at(scope, lambda: rows)
    found = _inside(path[1:], item, case.type, column, held[rows][column.name], inner)
    return Scattered(found, places)


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
    """How many elements or bytes each row has; None: as many as there is room for."""
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
    inner = _at(scope, lambda: np.repeat(np.arange(len(held)), counts))
    elements = _elements(held, counts)
    return ListsOf(_values(item, type.element, column, dimensions[1:], elements, inner), counts)


def _elements(held: Any, counts: Array) -> Any:
    """Those that are there, of all rows; copied whole, which is much faster than by members."""
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
