"""NumPy, imported where it is used, and the dtypes of rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from protogen.capture.errors import MissingPackageError
from protogen.capture.schema import Choice, Column, Number, Record, Shape, TableSchema, Text

if TYPE_CHECKING:
    import numpy as np


def numpy() -> Any:
    """The module. Raises MissingPackageError that says how to get it."""
    try:
        import numpy
    except ImportError:
        raise MissingPackageError(
            "captures become NumPy columns, and NumPy is not installed: "
            "pip install 'protogen-serial[capture]'"
        ) from None
    return numpy


def dtype_of(table: TableSchema) -> np.dtype[Any]:
    """The dtype of a table's rows."""
    return _record(table.row)


def _column(column: Column) -> Any:
    base = _shape(column.shape)
    return (base, column.counts) if column.counts else base


def _shape(shape: Shape) -> Any:
    match shape:
        case Number(code=code):
            return code
        case Text(size=size):
            return f"S{size}"
        case Record():
            return _record(shape)
        case Choice():
            return _choice(shape)


def _record(record: Record) -> np.dtype[Any]:
    return _struct(
        {item.name: (_column(item), item.position) for item in record.columns}, record.size
    )


def _choice(choice: Choice) -> np.dtype[Any]:
    """All cases lie at its beginning."""
    members = [case for _, case in choice.cases]
    members += [] if choice.rest is None else [choice.rest]
    return _struct({item.name: (_column(item), 0) for item in members}, choice.size)


def _struct(members: dict[str, tuple[Any, int]], size: int) -> np.dtype[Any]:
    found: np.dtype[Any] = numpy().dtype(
        {
            "names": list(members),
            "formats": [format_ for format_, _ in members.values()],
            "offsets": [position for _, position in members.values()],
            "itemsize": size,
        }
    )
    return found
