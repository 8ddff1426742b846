"""The fields of a payload, found in its bytes one after another."""

from __future__ import annotations

import struct
from collections import ChainMap
from collections.abc import Sequence
from dataclasses import dataclass, replace

from protogen.model.frame import Part
from protogen.model.numbers import codec
from protogen.model.readings import (
    integer_reading,
    physical,
    quoted,
    type_name,
    value_name,
)
from protogen.model.types import (
    Array,
    Counted,
    Extent,
    Field,
    Fixed,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)
from protogen.model.wire import Unit
from protogen.runtime.errors import ByteError

Scope = ChainMap[str, int]
"""The integers read so far, which count and select what follows."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """Some bytes of a frame and what they stand for."""

    offset: int
    """Of the first byte on the wire, counted from the start of the frame."""
    wire: bytes
    """As on the wire."""
    bytes: bytes
    """Without transparency."""
    path: str
    """The part's name, or the field's with what leads to it, such as `points[2].x`."""
    type: str
    """In the words of the schema language; `literal` for a literal."""
    value: int | float | str | None = None
    """The raw value of a number or a text."""
    meaning: str = ""
    """A name of the value, its physical value, or what the part is good for."""
    fault: str = ""
    """Why these bytes can't stand here; empty where they can."""
    cut: bool = False
    """Whether more bytes belong here, but the frame has no more."""
    subject: Part | Field | None = None
    """The part or the field that the bytes belong to; None where they belong to none."""
    value_type: Integer | Float | Text | Octets | None = None
    """The type of a part's or a field's value; None for a literal, or bytes that none fits."""

    def reads(self, value: int | float | str, meaning: str, fault: str = "") -> Row:
        """The row with what its bytes turned out to be."""
        return replace(self, value=value, meaning=meaning, fault=self.fault or fault)


@dataclass(frozen=True, slots=True)
class Piece:
    """Bytes that were taken for something; `missing` says how many more should be there."""

    offset: int
    units: tuple[Unit, ...]
    missing: int

    @property
    def bytes(self) -> bytes:
        """Without transparency."""
        return bytes(unit.byte for unit in self.units)

    def row(
        self,
        path: str,
        type: str,
        *,
        meaning: str = "",
        fault: str = "",
        subject: Part | Field | None = None,
        value_type: Integer | Float | Text | Octets | None = None,
    ) -> Row:
        """These bytes as a row without a value."""
        wire = b"".join(unit.wire for unit in self.units)
        if self.missing:
            fault = f"missing bytes: {self.missing}"
        return Row(
            offset=self.offset,
            wire=wire,
            bytes=self.bytes,
            path=path,
            type=type,
            meaning=meaning,
            fault=fault,
            cut=bool(self.missing),
            subject=subject,
            value_type=value_type,
        )


class Cursor:
    """Takes units one after another. `offset` is the place of the first one in the frame."""

    def __init__(self, units: Sequence[Unit], offset: int) -> None:
        self._units = units
        self._offset = offset
        self.position = 0

    @property
    def left(self) -> int:
        """How many units are left."""
        return len(self._units) - self.position

    def take(self, count: int) -> Piece:
        """The next `count` units, or as many as there are."""
        taken = tuple(self._units[self.position : self.position + count])
        piece = Piece(self._offset, taken, count - len(taken))
        self.position += len(taken)
        self._offset += sum(len(unit.wire) for unit in taken)
        return piece

    def ends_with(self, data: bytes) -> bool:
        """Whether the units that are left end with these bytes."""
        left = self._units[self.position :]
        return bytes(unit.byte for unit in left[-len(data) :]) == data

    def skip(self, size: int) -> int:
        """Pass bytes on the wire that belong to no unit; return the place of the first."""
        self._offset += size
        return self._offset - size

    def part(self, count: int) -> Cursor:
        """A cursor over the next `count` units, which this one passes."""
        offset = self._offset
        return Cursor(self.take(count).units, offset)


def dissect(fields: Sequence[Field], cursor: Cursor) -> list[Row]:
    """Return a row for each field, member and element, up to the first that has no bytes."""
    reader = _Reader(cursor)
    reader.fields(fields, "", ChainMap())
    return reader.rows


class _Reader:
    def __init__(self, cursor: Cursor) -> None:
        self._cursor = cursor
        self._short = False
        self.rows: list[Row] = []

    def fields(self, fields: Sequence[Field], prefix: str, scope: Scope) -> None:
        for field in fields:
            self._value(field, field.type, prefix + field.name, scope)

    def _value(self, field: Field, type: Type, path: str, scope: Scope) -> None:
        if self._short:
            return
        match type:
            case Struct(fields=members):
                self.fields(members, f"{path}.", scope.new_child())
            case Array(element=element, extent=extent):
                self._elements(field, element, extent, path, scope)
            case Switch():
                self._case(field, type, path, scope)
            case _:
                self._scalar(field, type, path, scope)

    def _elements(
        self, field: Field, element: Type, extent: Extent, path: str, scope: Scope
    ) -> None:
        count = _count(extent, scope)
        index = 0
        while not self._short and (self._cursor.left if count is None else index < count):
            self._value(_element(field, index), element, f"{path}[{index}]", scope)
            index += 1

    def _case(self, field: Field, type: Switch, path: str, scope: Scope) -> None:
        chosen = scope.get(type.selector)
        for case in type.cases:
            if case.value == chosen:
                self._value(field, case.type, path, scope)
                return
        fault = f"`{type.selector}` has no case {chosen}" if type.rest is None else ""
        if self._cursor.left:
            piece = self._cursor.take(self._cursor.left)
            self.rows.append(piece.row(path, "bytes", fault=fault, subject=field))

    def _scalar(
        self, field: Field, type: Integer | Float | Text | Octets, path: str, scope: Scope
    ) -> None:
        size = _size(type, scope)
        piece = self._cursor.take(self._cursor.left if size is None else size)
        row = piece.row(path, type_name(type), subject=field, value_type=type)
        self._short = bool(piece.missing)
        if not piece.missing:
            row = _read(field, type, row)
        if isinstance(row.value, int):
            scope[field.name] = row.value
        self.rows.append(row)


def _element(field: Field, index: int) -> Field:
    """The field as it is for one element; only a constant has a value for each."""
    if not isinstance(field.const, tuple):
        return field
    return replace(field, const=field.const[index] if index < len(field.const) else None)


def _count(extent: Extent, scope: Scope) -> int | None:
    """How many; None: as many as there are."""
    if isinstance(extent, Fixed):
        return extent.count
    return scope.get(extent.field, 0) if isinstance(extent, Counted) else None


def _size(type: Integer | Float | Text | Octets, scope: Scope) -> int | None:
    return type.size if isinstance(type, Integer | Float) else _count(type.extent, scope)


# --- values -------------------------------------------------------------------------------------


def _read(field: Field, type: Integer | Float | Text | Octets, row: Row) -> Row:
    if type.byte_bits == 7 and not row.bytes.isascii():
        return replace(row, fault="has a byte of more than 7 bits")
    match type:
        case Integer() | Float():
            return _number(field, type, row)
        case Text():
            return _text(field, type, row)
        case Octets():
            return _octets(field, row)


def _number(field: Field, type: Integer | Float, row: Row) -> Row:
    try:
        value = codec(type).decode(row.bytes)
    except ByteError as error:
        return replace(row, fault=str(error))
    if isinstance(type, Float):
        real = _float(type, value)
        return row.reads(real, physical(field, real, gap=" "))
    return row.reads(value, _meaning(field, type, value), _fault(field, type, value))


def _float(type: Float, pattern: int) -> float:
    form = ">f" if type.bits == 32 else ">d"
    value: float = struct.unpack(form, pattern.to_bytes(type.bits // 8, "big"))[0]
    return value


def _octets(field: Field, row: Row) -> Row:
    if isinstance(field.const, bytes) and field.const != row.bytes:
        return replace(row, fault=f"must be {field.const.hex(' ').upper()}")
    return row


def _text(field: Field, type: Text, row: Row) -> Row:
    text = row.bytes.decode("latin-1")
    if isinstance(type.extent, Fixed):
        text = text.rstrip("\0")
    wrong = isinstance(field.const, str) and text != field.const
    return row.reads(text, "", f"must be {quoted(str(field.const))}" if wrong else "")


def _meaning(field: Field, type: Integer, value: int) -> str:
    text = integer_reading(field, type, value, gap=" ")
    if text != str(value):
        return text
    return "a value without a name" if type.enum is not None else ""


def _fault(field: Field, type: Integer, value: int) -> str:
    if field.const is not None and isinstance(field.const, int) and value != field.const:
        return f"must be {field.const}"
    if type.enum is not None and type.enum.closed and value_name(field, type, value) is None:
        return "is none of the values that there are"
    return ""
