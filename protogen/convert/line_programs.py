"""What prints the rows of a message as lines of JSON, whatever they hold.

The values are those of `nested.py`, which takes the same steps with values.
"""

from __future__ import annotations

import json
from collections import ChainMap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import prod
from typing import Any

from protogen.capture.schema import Choice, Column, Dimension, Number, Record, TableSchema
from protogen.capture.schema import Text as TextShape
from protogen.convert.plain import constant_of
from protogen.convert.plain_rows import json_value
from protogen.convert.programs import JSON, Place, Programs, operand
from protogen.model.types import (
    Array,
    Counted,
    Extent,
    Field,
    Fixed,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)
from protogen.native.printer import DEPTH, Kind, Operand

Scope = ChainMap[str, Place | int]
"""The numbers in front, which count and choose: where they are, or constant ones themselves."""


class UnprintableError(Exception):
    """There is no program for such rows."""


@dataclass(frozen=True, slots=True)
class _Spot:
    """A value in a record: how many lists are around, bytes from where the record begins."""

    depth: int
    offset: int
    scope: Scope

    def operand(self, code: str = "u1") -> Operand:
        """The number, or the first byte, that lies here."""
        return operand(code, self.offset)

    def moved(self, offset: int) -> _Spot:
        """So many bytes behind."""
        return _Spot(self.depth, self.offset + offset, self.scope)


def print_fields(programs: Programs, table: TableSchema) -> None:
    """Steps that print the fields of a row, in braces. Raises UnprintableError."""
    assert table.message is not None
    spot = _Spot(0, 0, ChainMap())
    _Fields(programs).members(table.message.fields, table.columns, spot)


class _Fields:
    def __init__(self, programs: Programs) -> None:
        self._programs = programs

    def members(self, fields: Sequence[Field], columns: Sequence[Column], at: _Spot) -> None:
        """The members of a record."""
        known = {item.source: item for item in columns if item.role == "field"}
        scope = at.scope.new_child(_counts(columns, at))
        inner = _Spot(at.depth, at.offset, scope)
        for place, item in enumerate(fields):
            self._name(place, item)
            column = known.get(item.name)
            if column is None:
                self._unstored(item, item.type, inner)
                _note_constant(scope, item)
            else:
                _note(scope, item, column, inner)
                here = inner.moved(column.position)
                self._value(item, item.type, column, column.dimensions, here)
        self._programs.text("}" if fields else "{}")

    def _name(self, place: int, item: Field) -> None:
        comma = ", " if place else "{"
        self._programs.text(f"{comma}{json.dumps(item.name, ensure_ascii=False)}: ")

    def _unstored(self, item: Field, type: Type, at: _Spot) -> None:
        """What is constant or holds nothing."""
        if item.const is not None:
            value = json_value(type, constant_of(item, type))
            self._programs.text(json.dumps(value, ensure_ascii=False))
            return
        match type:
            case Struct(fields=fields):
                inner = _Spot(at.depth, at.offset, at.scope.new_child())
                for place, member in enumerate(fields):
                    self._name(place, member)
                    self._unstored(member, member.type, inner)
                    _note_constant(inner.scope, member)
                self._programs.text("}" if fields else "{}")
            case Array(element=Struct() | Switch() | Array() as element, extent=extent):
                body = partial(self._unstored, item, element)
                self._list(at, 0, _unstored_count(extent, at), body)
            case Switch():
                self._unstored_choice(item, type, at)
            case _:
                self._programs.text("[]")

    def _unstored_choice(self, item: Field, type: Switch, at: _Spot) -> None:
        bodies = {case.value: partial(self._case, item, case.type, None, at) for case in type.cases}
        selector = at.scope[type.selector]
        if isinstance(selector, int):
            bodies[selector]()
        else:
            self._programs.choose(selector.seen(at.depth), list(bodies.items()), lambda: None)

    def _value(
        self, item: Field, type: Type, column: Column, left: Sequence[Dimension], at: _Spot
    ) -> None:
        """A value, or the arrays in it, of which these dimensions are left."""
        programs = self._programs
        if isinstance(type, Text):
            self._text(type, left[0], column, at)
        elif isinstance(type, Octets):
            programs.text('"')
            count = _count(left[0], type.extent, at)
            if isinstance(count, int):
                programs.step(Kind.HEX, a=1, b=count, x=at.operand())
            else:
                programs.step(Kind.HEX, x=at.operand(), y=count)
            programs.text('"')
        elif left and isinstance(type, Array):
            self._array(item, type, column, left, at)
        elif isinstance(column.shape, Record):
            assert isinstance(type, Struct)
            self.members(type.fields, column.shape.columns, at)
        elif isinstance(column.shape, Choice):
            assert isinstance(type, Switch)
            self._choice(item, type, column.shape, at)
        else:
            assert isinstance(column.shape, Number)
            programs.number(at.operand(column.shape.code), column.shape.code)

    def _text(self, type: Text, dimension: Dimension, column: Column, at: _Spot) -> None:
        assert isinstance(column.shape, TextShape)
        self._programs.text('"')
        size, first = column.shape.size, at.operand()
        if isinstance(type.extent, Fixed):
            self._programs.step(Kind.STRING, b=size, c=JSON, x=first)
        elif dimension.counted_by is None:
            raise UnprintableError
        else:
            count = _count(dimension, type.extent, at)
            assert isinstance(count, Operand)
            self._programs.step(Kind.STRING, a=1, b=size, c=JSON, x=first, y=count)
        self._programs.text('"')

    def _array(
        self, item: Field, type: Array, column: Column, left: Sequence[Dimension], at: _Spot
    ) -> None:
        inner = left[1:]
        sizes = [it.capacity for it in inner]
        stride = column.shape.size * prod(sizes[:-1] if _is_text(column) else sizes)
        body = partial(self._value, item, type.element, column, inner)
        self._list(at, stride, _count(left[0], type.extent, at), body)

    def _list(
        self, at: _Spot, stride: int, count: Operand | int, body: Callable[[_Spot], None]
    ) -> None:
        if at.depth + 2 > DEPTH:
            raise UnprintableError
        element = _Spot(at.depth + 1, 0, at.scope)
        self._programs.text("[")
        self._programs.listed(at.operand(), stride, count, partial(body, element))
        self._programs.text("]")

    def _choice(self, item: Field, type: Switch, choice: Choice, at: _Spot) -> None:
        known = dict(choice.cases)
        bodies = {
            case.value: partial(self._case, item, case.type, known.get(case.value), at)
            for case in type.cases
        }
        rest = partial(self._rest, choice, at)
        if isinstance(choice.selector, int):
            bodies.get(choice.selector, rest)()
        else:
            self._programs.choose(_seen(choice.selector, at), list(bodies.items()), rest)

    def _case(self, item: Field, type: Type, column: Column | None, at: _Spot) -> None:
        if isinstance(type, Struct) and not type.fields:
            self._programs.text("null")
        elif column is None:
            self._unstored(item, type, at)
        else:
            self._value(item, type, column, column.dimensions, at)

    def _rest(self, choice: Choice, at: _Spot) -> None:
        if choice.rest is None:
            return  # There is a case for every value.
        assert isinstance(choice.rest.shape, Record)
        size = choice.rest.shape.column("size")
        data = choice.rest.shape.column("bytes")
        assert isinstance(size.shape, Number)
        self._programs.text('"')
        self._programs.step(
            Kind.HEX,
            x=at.moved(data.position).operand(),
            y=at.moved(size.position).operand(size.shape.code),
        )
        self._programs.text('"')


def _is_text(column: Column) -> bool:
    return isinstance(column.shape, TextShape)


def _counts(columns: Sequence[Column], at: _Spot) -> dict[str, Place | int]:
    """Where the counts of a record are, by the names of their columns."""
    return {
        item.name: Place(at.depth, item.shape.code, at.offset + item.position)
        for item in columns
        if item.role == "count" and isinstance(item.shape, Number)
    }


def _note(scope: Scope, item: Field, column: Column, at: _Spot) -> None:
    """Let what stands behind a number find it."""
    if isinstance(column.shape, Number) and not column.dimensions:
        place = Place(at.depth, column.shape.code, at.offset + column.position)
        scope[item.name] = scope[column.name] = place


def _note_constant(scope: Scope, item: Field) -> None:
    if isinstance(item.const, int):
        scope[item.name] = item.const


def _seen(name: str, at: _Spot) -> Operand:
    """The number of that name, which is in a column."""
    place = at.scope[name]
    assert isinstance(place, Place)
    return place.seen(at.depth)


def _unstored_count(extent: Extent, at: _Spot) -> Operand | int:
    if isinstance(extent, Counted):
        place = at.scope[extent.field]
        return place if isinstance(place, int) else place.seen(at.depth)
    return extent.count if isinstance(extent, Fixed) else 0


def _count(dimension: Dimension, extent: Any, at: _Spot) -> Operand | int:
    if dimension.counted_by is not None:
        return _seen(dimension.counted_by, at)
    return extent.count if isinstance(extent, Fixed) else dimension.capacity


# --- lines ----------------------------------------------------------------------------------------

ROWS, DIFFERS, TIMES, TIMED, LINE, PAYLOADS = range(6)
"""The columns: rows, whether an encoder would give other bytes, when they came, whether that is
known, the bytes of the line, and those of unknown payloads."""


def print_start(
    programs: Programs, places: Mapping[str, Place], event: str, more: Mapping[str, str]
) -> None:
    """The beginning of every line; `places` are those of `offset` and `size`."""
    programs.text('{"offset": ')
    programs.step(Kind.PLACE, x=places["offset"].seen(0))
    programs.text(', "size": ')
    programs.step(Kind.INTEGER, x=places["size"].seen(0))
    for name, value in {"event": event, **more}.items():
        programs.text(f', "{name}": {json.dumps(value, ensure_ascii=False)}')


def print_raw(programs: Programs, places: Mapping[str, Place]) -> None:
    """The bytes of the line."""
    programs.text(', "raw": "')
    programs.step(Kind.SPAN, LINE, 1, x=places["offset"].seen(0), y=places["size"].seen(0))
    programs.text('"')


def print_end(programs: Programs) -> None:
    """When it came, where that is known, and the end of the line."""

    def stamp() -> None:
        programs.text(', "t_ns": ')
        programs.step(Kind.INTEGER, x=operand("i8", source=TIMES))

    programs.when(Kind.IF, operand("u1", source=TIMED), stamp)
    programs.text("}\n")
    programs.end()


def places_of(columns: Sequence[Column]) -> dict[str, Place]:
    """Where the numbers of an event are: by what they are, parts of the frame with `@` in front."""
    return {
        f"@{item.source}" if item.role == "part" else item.source: Place(
            0, item.shape.code, item.position
        )
        for item in columns
        if isinstance(item.shape, Number) and item.role not in ("field", "count")
    }


def _print_parts(programs: Programs, places: Mapping[str, Place]) -> None:
    programs.text(', "parts": {')
    for number, (name, place) in enumerate(it for it in places.items() if it[0].startswith("@")):
        programs.text(f"{', ' if number else ''}{json.dumps(name[1:])}: ")
        programs.number(place.seen(0), place.code)
    programs.text("}")


def message_program(programs: Programs, table: TableSchema, sender: str) -> int:
    """Prints the rows of a message; its first step. Raises UnprintableError."""
    assert table.message is not None
    start, places = programs.here, places_of(table.columns)
    print_start(programs, places, "message", {"message": table.message.name, "sender": sender})
    _print_parts(programs, places)
    programs.text(', "fields": ')
    print_fields(programs, table)
    programs.when(Kind.ODD, operand("u1", source=DIFFERS), partial(print_raw, programs, places))
    print_end(programs)
    return start


def invalid_program(
    programs: Programs, table: TableSchema, sender: str, reasons: Sequence[str]
) -> int:
    """Prints the rows of invalid spans, whose reasons are numbers of these; its first step."""
    start, places = programs.here, places_of(table.columns)
    print_start(programs, places, "invalid", {"sender": sender})
    programs.text(', "reason": "')
    programs.name(places["reason"].seen(0), reasons)
    programs.text('"')
    print_raw(programs, places)
    print_end(programs)
    return start


def unknown_program(programs: Programs, table: TableSchema, sender: str) -> int:
    """Prints the rows of unknown frames; its first step."""
    start, places = programs.here, places_of(table.columns)
    print_start(programs, places, "unknown", {"sender": sender})
    _print_parts(programs, places)
    first, size = places["payload_offset"].seen(0), places["payload_size"].seen(0)
    programs.text(', "payload": "')
    programs.step(Kind.SPAN, PAYLOADS, x=first, y=size)
    programs.text('"')
    programs.when(Kind.IF, operand("u1", source=DIFFERS), partial(print_raw, programs, places))
    print_end(programs)
    return start


def copy_program(programs: Programs) -> int:
    """Copies lines that are texts already: columns of offsets, starts, sizes and the texts."""
    sizes, starts = operand("i8", source=2), operand("i8", source=1)
    start = programs.step(Kind.COPY, 3, x=starts, y=sizes)
    programs.end()
    return start
