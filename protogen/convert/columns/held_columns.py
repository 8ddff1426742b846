"""Columns of rows beside the fields whose values they hold.

A field that is constant or holds nothing has no column: it is None here, as is all inside of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from protogen.capture.schema import Choice, Column, Dimension, Record
from protogen.model.expressions import Expression
from protogen.model.presence import Conditional, Trailing
from protogen.model.types import Field


def held(
    fields: Iterable[Field], columns: Iterable[Column]
) -> Iterator[tuple[Field, Column | None]]:
    """Each field with its column."""
    known = {item.source: item for item in columns if item.role == "field"}
    return ((item, known.get(item.name)) for item in fields)


def held_by(item: Field, columns: Iterable[Column]) -> Column | None:
    """The column of a field."""
    return next((it for it in columns if it.role == "field" and it.source == item.name), None)


def presence_of(item: Field, columns: Iterable[Column]) -> Column | Expression | None:
    """What says in a row whether a field is there: a column, or an expression over some.

    None: it always is.
    """
    match item.presence:
        case Conditional(condition=condition):
            return condition
        case Trailing():
            return next(it for it in columns if it.role == "presence" and it.source == item.name)
        case None:
            return None


def members_of(column: Column | None) -> Sequence[Column]:
    """The columns inside of a struct's."""
    shape = column and column.shape
    return shape.columns if isinstance(shape, Record) else ()


def cases_of(column: Column | None) -> dict[int | None, Column]:
    """The columns inside of a switch's, by the values that choose them; None: all others."""
    shape = column and column.shape
    return dict(shape.cases) if isinstance(shape, Choice) else {}


def rest_of(column: Column | None) -> Column | None:
    """The column of the bytes of a value that no case stands for."""
    shape = column and column.shape
    return shape.rest if isinstance(shape, Choice) else None


def dimensions_of(column: Column | None) -> Sequence[Dimension]:
    """The dimensions of the arrays in a column."""
    return () if column is None else column.dimensions
