"""Steps that print the values of fields as JSON, whatever they hold.

The columns are those that `capture/layout.py` lays out; the steps go through fields and columns
side by side.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import ChainMap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

from protogen.c_language.expressions import WIDEST, CPrinter
from protogen.c_language.numbers import number as number_in_c
from protogen.capture.schema import Column, Dimension, Number, Record
from protogen.capture.schema import Text as TextShape
from protogen.convert.columns.event_values import constant_of
from protogen.convert.columns.held_columns import (
    cases_of,
    dimensions_of,
    held,
    members_of,
    presence_of,
    rest_of,
)
from protogen.model.expression_bounds import Interval
from protogen.model.expressions import GREATEST_BITS, Expression, Operand, plain_name
from protogen.model.types import (
    Array,
    Case,
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
from protogen.native.print_steps import (
    Count,
    Others,
    Place,
    Spelling,
    Step,
    Worked,
    characters,
    choose,
    hex_digits,
    literal,
    number,
    repeat,
    where,
)

Scope = ChainMap[str, Count]
"""The numbers in front, which count and choose: their places, or constant ones themselves."""


@dataclass(frozen=True, slots=True)
class Spot:
    """A value in a record: how many lists are around, bytes from where the record begins."""

    depth: int
    offset: int
    scope: Scope

    @classmethod
    def row(cls) -> Spot:
        """The start of a row."""
        return cls(0, 0, ChainMap())

    def place(self, column: Column | None = None) -> Place:
        """The number of a column that lies here; without one, the first byte of something."""
        shape = column and column.shape
        return Place(self.depth, shape.code if isinstance(shape, Number) else "u1", self.offset)

    def moved(self, column: Column) -> Spot:
        """The spot of a column of the record that begins here."""
        return Spot(self.depth, self.offset + column.position, self.scope)

    def fields(
        self, fields: Sequence[Field], columns: Sequence[Column]
    ) -> Iterator[tuple[Field, Column | None, Spot]]:
        """The fields of the record that begins here, which know the numbers in front of them."""
        counts = {item.name: item for item in columns if item.role == "count"}
        front: dict[str, Count] = {
            name: self.moved(item).place(item) for name, item in counts.items()
        }
        scope = self.scope.new_child(front)
        inner = Spot(self.depth, self.offset, scope)
        for item, column in held(fields, columns):
            here = inner if column is None else inner.moved(column)
            scope[_flag(item.name)] = inner.presence(item, columns)
            yield item, column, here
            if column is None and isinstance(item.const, int):
                scope[item.name] = item.const
            elif column is not None:
                scope.update(_numbers(item.name, item.type, column, here))

    def presence(self, item: Field, columns: Sequence[Column]) -> Count:
        """What is not 0 where a field of the record that begins here is there."""
        found = presence_of(item, columns)
        if found is None:
            return 1
        return self.moved(found).place(found) if isinstance(found, Column) else said(found, self)


def _flag(name: str) -> str:
    """Name in a scope, unlike that of any field, for whether a field is there."""
    return f"{name}?"


def _numbers(name: str, type: Type, column: Column, at: Spot) -> Iterator[tuple[str, Count]]:
    """The numbers of a field that expressions behind it may name: itself, or its members."""
    if isinstance(column.shape, Number) and not column.dimensions:
        yield name, at.place(column)
    if not isinstance(type, Struct) or column.dimensions:
        return
    for item, inner in held(type.fields, members_of(column)):
        if inner is not None:
            yield from _numbers(f"{name}.{item.name}", item.type, inner, at.moved(inner))
        elif isinstance(item.const, int):
            yield f"{name}.{item.name}", item.const


class ValueSteps(ABC):
    """Prints values as JSON. Subclasses say how JSON lines and cells of CSV differ."""

    others: Others
    spelling: Spelling

    @abstractmethod
    def name(self, name: str) -> str:
        """A name as JSON."""

    @abstractmethod
    def constant(self, type: Type, value: Any) -> str:
        """A constant as JSON."""

    @abstractmethod
    def case(self, name: str, body: Iterator[Step]) -> Iterator[Step]:
        """The value of a switch: that of its case, or with an empty name its bytes."""

    @abstractmethod
    def nothing(self) -> str:
        """The value of a case without fields."""

    def members(
        self, fields: Sequence[Field], columns: Sequence[Column], at: Spot
    ) -> Iterator[Step]:
        """The members of a record, in braces."""
        yield literal("{")
        for place, (item, column, here) in enumerate(at.fields(fields, columns)):
            yield literal(f"{', ' if place else ''}{self.name(item.name)}: ")
            value = self.value(item, item.type, column, dimensions_of(column), here)
            yield from if_there(item, here, value, [literal("null")])
        yield literal("}")

    def value(
        self, item: Field, type: Type, column: Column | None, left: Sequence[Dimension], at: Spot
    ) -> Iterator[Step]:
        """A value, or the arrays in it, of which these dimensions are left."""
        if column is None and item.const is not None:
            yield literal(self.constant(type, constant_of(item)))
            return
        match type:
            case Struct(fields=fields):
                yield from self.members(fields, members_of(column), at)
            case Switch():
                yield from self._choice(item, type, column, at)
            case Array(element=element) if column or not element.holds_values:
                yield from self._array(item, type, column, left, at)
            case _ if column is None:
                yield literal("[]")  # Nothing else holds nothing.
            case Text():
                yield from in_quotes(text_of(type, column, left[0], at, self.spelling))
            case Octets(extent=extent):
                yield from in_quotes(hex_digits(at.place(), count_of(extent, left, at)))
            case _:
                yield number(at.place(column), self.others)

    def _array(
        self, item: Field, type: Array, column: Column | None, left: Sequence[Dimension], at: Spot
    ) -> Iterator[Step]:
        return self.array(
            type,
            column,
            left,
            at,
            lambda spot: self.value(item, type.element, column, left[1:], spot),
        )

    def array(
        self,
        type: Array,
        column: Column | None,
        left: Sequence[Dimension],
        at: Spot,
        body: Callable[[Spot], Iterator[Step]],
    ) -> Iterator[Step]:
        """A list of what `body` prints, in brackets."""
        stride = 0
        if column is not None:
            sizes = [it.capacity for it in left[1:]]
            is_text = isinstance(column.shape, TextShape)
            stride = column.shape.size * prod(sizes[:-1] if is_text else sizes)
        element = Spot(at.depth + 1, 0, at.scope)
        yield literal("[")
        yield repeat(at.place(), stride, count_of(type.extent, left, at), body(element))
        yield literal("]")

    def _choice(self, item: Field, type: Switch, column: Column | None, at: Spot) -> Iterator[Step]:
        known, rest = cases_of(column), rest_of(column)
        bodies = {it.value: self._case(item, it, known.get(it.value), at) for it in type.cases}
        other = () if rest is None else self.case("", in_quotes(rest_digits(rest, at)))
        yield from chosen(said(type.selector, at), bodies, other)

    def _case(self, item: Field, case: Case, column: Column | None, at: Spot) -> Iterator[Step]:
        if isinstance(case.type, Struct) and not case.type.fields:
            return self.case(case.name, iter([literal(self.nothing())]))
        return self.case(case.name, self.value(item, case.type, column, dimensions_of(column), at))


def in_quotes(step: Step) -> Iterator[Step]:
    """A step in double quotes."""
    yield literal('"')
    yield step
    yield literal('"')


# --- what counts and chooses ----------------------------------------------------------------------


def chosen(
    selector: Count, bodies: Mapping[int | None, Iterable[Step]], rest: Iterable[Step]
) -> Iterator[Step]:
    """The steps of the case that a number chooses; under None those of all others, else `rest`."""
    others = bodies.get(None, rest)
    own = {value: body for value, body in bodies.items() if value is not None}
    if isinstance(selector, int):
        yield from own.get(selector, others)
    else:
        yield choose(selector, own, others)


def if_there(
    item: Field, at: Spot, body: Iterable[Step], other: Iterable[Step] = ()
) -> Iterator[Step]:
    """The steps of a field where it is there, and others where it is not."""
    condition = told_presence(item, at)
    if isinstance(condition, int):
        yield from body if condition else other
    else:
        yield where(condition, body, other)


def told_presence(item: Field, at: Spot) -> Count:
    """What is not 0 where a field is there, at whose spot its record's fields are known."""
    return at.scope[_flag(item.name)]


def count_of(extent: Extent, left: Sequence[Dimension], at: Spot) -> Count:
    """The elements or bytes that there are."""
    match extent:
        case Fixed(count=count):
            return count
        case Counted(by=expression):
            return said(expression, at)
    counted_by = left[0].counted_by if left else None
    return at.scope[counted_by] if isinstance(counted_by, str) else 0


def said(expression: Expression, at: Spot) -> Count:
    """The number that an expression has."""
    name = plain_name(expression)
    return at.scope[name] if name is not None else Worked(_RowPrinter(at.scope).text(expression))


class _RowPrinter(CPrinter):
    """Prints expressions over numbers of a row, all of them as the widest integer."""

    def __init__(self, scope: Scope) -> None:
        super().__init__(WIDEST)
        self._scope = scope

    def whole(self, operand: Operand) -> str:
        found = self._scope[operand.name]
        return number_in_c(found) if isinstance(found, int) else found.value

    def bounds(self, operand: Operand) -> Interval:
        return -(1 << GREATEST_BITS), 1 << GREATEST_BITS  # Any number may be below 0.


def text_of(type: Text, column: Column, dimension: Dimension, at: Spot, spelling: Spelling) -> Step:
    """The characters of a text."""
    is_padded = isinstance(type.extent, Fixed)
    count = None if is_padded else count_of(type.extent, [dimension], at)
    return characters(at.place(), column.shape.size, count, spelling)


def part_text(column: Column, spelling: Spelling) -> Step | None:
    """The characters of a part of the frame; None where it is a number."""
    if not isinstance(column.shape, TextShape):
        return None
    return characters(Spot.row().moved(column).place(), column.shape.size, None, spelling)


def part_value(column: Column, others: Others, spelling: Spelling) -> Iterator[Step]:
    """A part of the frame as JSON."""
    text = part_text(column, spelling)
    if text is None:
        yield number(Spot.row().moved(column).place(column), others)
    else:
        yield from in_quotes(text)


def rest_digits(rest: Column, at: Spot) -> Step:
    """The bytes of a value that no case stands for."""
    assert isinstance(rest.shape, Record)
    size, data = rest.shape.column("size"), rest.shape.column("bytes")
    return hex_digits(at.moved(data).place(), at.moved(size).place(size))
