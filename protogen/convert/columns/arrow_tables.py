"""Rows as Arrow has them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from protogen.convert.columns.rows import Rows
from protogen.convert.columns.tables import Column, ColumnType, Listed, Names, Record, Scalar, Table

if TYPE_CHECKING:
    import pyarrow as pa


def schema_of(table: Table, more: Mapping[str, str]) -> pa.Schema:
    """The schema of a table, with what its columns mean, and `more`, as metadata."""
    import pyarrow as pa

    fields = [_field(column) for column in table.all_columns]
    return pa.schema(fields, metadata={**table.facts, **more})


def _field(column: Column) -> pa.Field:
    import pyarrow as pa

    metadata = {f"protogen.{key}": text for key, text in column.facts.items()}
    return pa.field(column.name, type_of(column.type), column.nullable, metadata)


def type_of(type: ColumnType) -> pa.DataType:
    """The Arrow type of a column."""
    import pyarrow as pa

    match type:
        case Scalar(kind="text"):
            return pa.string()
        case Scalar(kind="bytes"):
            return pa.binary()
        case Scalar(kind="bool"):
            return pa.bool_()
        case Scalar(kind=kind):
            return getattr(pa, kind)()
        case Names():
            return pa.dictionary(pa.int16(), pa.string())
        case Listed(element=element, count=count, gaps=gaps):
            # Levels of what is never missing need not be written.
            item = pa.field("element", type_of(element), nullable=gaps)
            return pa.list_(item) if count is None else pa.list_(item, count)
        case Record(members=members, gaps=gaps):
            fields = [(name, type_of(member)) for name, member in members]
            return pa.struct([pa.field(*field, nullable=gaps) for field in fields])


def batch_of(rows: Rows, schema: pa.Schema) -> pa.RecordBatch:
    """The rows as a record batch."""
    import pyarrow as pa

    columns = zip(rows.table.all_columns, rows.columns, strict=True)
    return pa.RecordBatch.from_arrays(
        [array_of(column.type, values) for column, values in columns], schema=schema
    )


def array_of(type: ColumnType, values: Any) -> pa.Array:
    """The values of a column as an Arrow array."""
    import pyarrow as pa

    if hasattr(values, "to_arrow"):
        return values.to_arrow(type)
    if isinstance(type, Names):
        places = {text: place for place, text in enumerate(type.texts)}
        indices = pa.array([places.get(value) for value in values], pa.int16())
        return pa.DictionaryArray.from_arrays(indices, pa.array(type.texts, pa.string()))
    if isinstance(type, Scalar) and type.kind == "text":
        values = [value and value.encode("utf-8", "replace").decode() for value in values]
    if isinstance(type, Listed) and isinstance(type.element, Record):
        values = [_named(type, value) for value in values]
    return pa.array(values, type_of(type))


def _named(type: ColumnType, value: Any) -> Any:
    """Give the bytes of a switch without a case, which have no name, that of their column."""
    match type:
        case Listed(element=element):
            return None if value is None else [_named(element, item) for item in value]
        case Record(members=members) if value is not None:
            given = {**value, members[-1][0]: value[""]} if "" in value else value
            return {name: _named(member, given.get(name)) for name, member in members}
        case _:
            return value
