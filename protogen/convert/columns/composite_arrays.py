"""Columns put together of others: structs, cases, lists of them, and values of some rows only."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import islice
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from protogen.convert.columns.arrays import Array
from protogen.convert.columns.python_values import Values, as_list
from protogen.convert.columns.tables import ColumnType, Listed, Record

if TYPE_CHECKING:
    import pyarrow as pa


class Same(msgspec.Struct, frozen=True):
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


class Scattered(msgspec.Struct, frozen=True):
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
        return _placed(type, _arrow(type, self.values), self.places)


class Structs(msgspec.Struct, frozen=True):
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

        from protogen.convert.columns.arrow_tables import type_of

        assert isinstance(type, Record)
        if not type.members:
            return pa.array(self.tolist(), type_of(type))
        arrays = [_arrow(inner, self.members[name]) for name, inner in type.members]
        return pa.StructArray.from_arrays(arrays, fields=list(type_of(type)))


class Cases(msgspec.Struct, frozen=True):
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

        from protogen.convert.columns.arrow_tables import type_of

        assert isinstance(type, Record)
        named = dict(self.members)
        if "" in named:
            named[type.members[-1][0]] = named.pop("")
        nowhere = np.full(self.count, -1)
        arrays = [
            named[name].to_arrow(inner)
            if name in named
            else _placed(inner, pa.nulls(0, type_of(inner)), nowhere)
            for name, inner in type.members
        ]
        return pa.StructArray.from_arrays(arrays, fields=list(type_of(type)))


class ListsOf(msgspec.Struct, frozen=True):
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

        from protogen.convert.columns.arrow_tables import type_of

        assert isinstance(type, Listed)
        flat = _arrow(type.element, self.elements)
        if type.count is not None:
            return pa.FixedSizeListArray.from_arrays(flat, type=type_of(type))
        ends = np.zeros(len(self.counts) + 1, "i4")
        np.cumsum(self.counts, out=ends[1:])
        return pa.ListArray.from_arrays(pa.array(ends), flat, type=type_of(type))


def _arrow(type: ColumnType, values: Values) -> pa.Array:
    from protogen.convert.columns.arrow_tables import array_of

    return array_of(type, values)


def _placed(type: ColumnType, values: pa.Array, places: Array) -> pa.Array:
    """Value at each place; none for -1."""
    import pyarrow as pa

    from protogen.convert.columns.arrow_tables import type_of

    if not isinstance(type, Record) or not type.members:
        return values.take(_indices(places))
    # Parquet refuses members of what is missing that are missing, too, and never are elsewhere.
    fields = list(type_of(type))
    if not len(values):
        missing = pa.array([None], type_of(type))  # Its members are there, and empty.
        members = [missing.field(place) for place in range(len(fields))]
        values = pa.StructArray.from_arrays(members, fields=fields)
    there = values.take(pa.array(np.maximum(places, 0)))
    return pa.StructArray.from_arrays(there.flatten(), fields=fields, mask=pa.array(places < 0))


def _indices(places: Array) -> pa.Array:
    import pyarrow as pa

    missing = places < 0
    return pa.array(places, mask=missing if missing.any() else None)
