"""Columns of a capture's tables: where they lie in a row, and what they mean.

A row is what generated C would hold of an event: `offset`, `sequence` and `size`, the frame's
parts, then the struct of the message. Its members lie as a C compiler lays them out.
"""

from __future__ import annotations

from enum import IntEnum
from math import prod
from typing import Literal

import msgspec

from protogen.copying import replace
from protogen.model.expressions import Expression
from protogen.model.meanings import Enum, Flags, NamedValue
from protogen.model.messages import Message
from protogen.model.parts import NumberPart
from protogen.model.types import Field, NumberType, Type
from protogen.runtime.errors import Reason

Role = Literal[
    "offset", "sequence", "size", "part", "field", "count", "presence", "reason", "payload"
]
"""Contents of a column: about the event, a part of the frame, a field, the number of elements or
bytes of the field behind it, whether the field behind it is there, the reason of invalid bytes, or
the place of an unknown payload."""
OF_MESSAGES: frozenset[Role] = frozenset({"field", "count", "presence"})
"""Contents of the columns of a message."""


class InvalidReason(IntEnum):
    """Reason why bytes are no frame, as the column `reason` says it."""

    SIZE = 1
    VALUE = 2
    ENCODING = 3
    NOISE = 4
    CHECKSUM = 5
    LENGTH = 6
    STUFFING = 7
    TRUNCATED = 8

    @property
    def word(self) -> Reason:
        """The reason as events say it."""
        found: Reason = self.name.lower()  # type: ignore[assignment]
        return found


# --- what a column holds --------------------------------------------------------------------------


class Number(msgspec.Struct, frozen=True):
    """A number: `u` or `i` and its bytes, `f4`, `f8`, or `?` for a bool."""

    code: str
    size: int

    @property
    def alignment(self) -> int:
        """Bytes."""
        return self.size


class Text(msgspec.Struct, frozen=True):
    """ASCII of at most `size` bytes, filled up with NUL bytes.

    A byte above 7F is the character of that number (Latin 1).
    """

    size: int
    alignment: int = 1


class Record(msgspec.Struct, frozen=True):
    """A struct: columns inside of a column."""

    columns: tuple[Column, ...]
    size: int
    alignment: int

    def column(self, name: str) -> Column:
        """The column of that name; raises KeyError."""
        for column in self.columns:
            if column.name == name:
                return column
        raise KeyError(name)


class Choice(msgspec.Struct, frozen=True):
    """A switch. Its cases share the same bytes; only the one that the selector chooses is there.

    `cases` gives the column of each value that has one, and `empty` the values whose case holds
    nothing; None is the value of the case of all others. Without that, any other value has `rest`,
    a record of `size` and `bytes`; where that is None, it can't be.
    """

    selector: str | int | Expression
    """The column, found as that of a `Dimension`; a number where it is always that; an expression
    over columns and members of them."""
    cases: tuple[tuple[int | None, Column], ...]
    empty: tuple[int | None, ...]
    rest: Column | None
    size: int
    alignment: int


Shape = Number | Text | Record | Choice


class Dimension(msgspec.Struct, frozen=True):
    """The elements of an array.

    `capacity`: how many a row has room for; those that are not there are zero. `counted_by`: the
    column that says how many there are, of the same record or, if that has none, of the one around
    it; an expression over such columns, and members of them; None: always as many as there is room
    for.
    """

    capacity: int
    counted_by: str | Expression | None = None


class Column(msgspec.Struct, frozen=True, kw_only=True):
    """A column of a table, or of a record in one."""

    name: str
    """In the table. Where the schema's name is taken there, `_` stands behind it."""
    role: Role
    source: str
    """The name of the field or part; of what is counted."""
    shape: Shape
    dimensions: tuple[Dimension, ...] = ()
    """The innermost one of bytes and text is their size."""
    when: str | int | Expression | None = None
    """The condition on which there is a value, over columns as those of a `Dimension`; 0: there
    never is one; None: there always is."""
    position: int = 0
    """Bytes from the beginning of the row or record."""
    field: Field | None = None
    """The field: unit, scale, offset, special values, what is said about it."""
    part: NumberPart | None = None
    """The part of the frame."""

    @property
    def counts(self) -> tuple[int, ...]:
        """Room for elements in each dimension of the array. Text has one less: it is one value."""
        sizes = tuple(dimension.capacity for dimension in self.dimensions)
        return sizes[:-1] if isinstance(self.shape, Text) else sizes

    @property
    def size(self) -> int:
        """Bytes in a row."""
        return self.shape.size * prod(self.counts)

    @property
    def type(self) -> Type | None:
        """The type on the wire; None for what is not on it as a number or field."""
        if self._meaning is not None:
            return self._meaning.type
        return None if self.part is None else self.part.type

    @property
    def element(self) -> NumberType | None:
        """The type of the number, or of each one of the array; None if it holds no numbers."""
        type_ = self.type if self._meaning is None else self._meaning.element
        return type_ if isinstance(type_, NumberType) else None

    @property
    def enum(self) -> Enum | None:
        """The names of raw values, where they have some."""
        return self.element.enum if self.element else None

    @property
    def flags(self) -> Flags | None:
        """The names of bits, where they have some."""
        return self.element.flags if self.element else None

    @property
    def unit(self) -> str | None:
        """The unit of the physical value, which is raw x `field.scale` + `field.offset`."""
        return self._meaning.unit if self._meaning else None

    @property
    def scaled(self) -> bool:
        """True if the physical value differs from the raw one."""
        return self._meaning is not None and self._meaning.scaled

    @property
    def special(self) -> tuple[NamedValue, ...]:
        """Raw values that stand for something else than a number."""
        return self._meaning.special if self._meaning else ()

    @property
    def doc(self) -> str:
        """Documentation in the schema."""
        about = self._meaning or self.part
        return about.about.doc if about else ""

    @property
    def _meaning(self) -> Field | None:
        return self.field if self.role == "field" else None

    def at(self, position: int) -> Column:
        """The same column at another place."""
        return replace(self, position=position)


# --- tables ---------------------------------------------------------------------------------------


class TableSchema(msgspec.Struct, frozen=True, kw_only=True):
    """A table: its row."""

    row: Record
    message: Message | None = None
    """The message whose table it is."""

    @property
    def columns(self) -> tuple[Column, ...]:
        """In the order of the row."""
        return self.row.columns

    def part(self, name: str) -> Column:
        """The column of that part of the frame; raises KeyError."""
        for column in self.columns:
            if (column.role, column.source) == ("part", name):
                return column
        raise KeyError(name)

    @property
    def fields(self) -> tuple[Column, ...]:
        """The message's columns alone."""
        return tuple(item for item in self.columns if item.role in OF_MESSAGES)

    @property
    def holes(self) -> tuple[range, ...] | None:
        """Bytes of a row that no member has; None where it depends on the row what there is."""
        return _holes(self.row)


def _holes(record: Record) -> tuple[range, ...] | None:
    found: list[range] = []
    end = 0
    for column in record.columns:
        inner = _holes_in(column)
        if inner is None:
            return None
        found.append(range(end, column.position))
        found += [
            range(column.position + hole.start, column.position + hole.stop) for hole in inner
        ]
        end = column.position + column.size
    found.append(range(end, record.size))
    return tuple(filter(None, found))


def _holes_in(column: Column) -> tuple[range, ...] | None:
    if any(dimension.counted_by is not None for dimension in column.dimensions):
        return None
    if isinstance(column.shape, Choice):
        return None
    inner = _holes(column.shape) if isinstance(column.shape, Record) else ()
    return None if inner and column.counts else inner


class CaptureSchema(msgspec.Struct, frozen=True, kw_only=True):
    """All tables of what one endpoint sends."""

    protocol: str
    sender: str
    """The endpoint that sends."""
    form: str
    """The form of its frames; empty where there is only one."""
    spec_hash: str
    messages: dict[str, TableSchema]
    """By the message's name, in the schema's order; what a decoder never yields is left out."""
    invalid: TableSchema
    unknown: TableSchema
