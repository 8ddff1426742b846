"""Steps that print the values of fields as JSON, whatever they hold.

The columns are those that `capture/layout.py` lays out; the steps go through fields and columns
side by side.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import ChainMap
from collections.abc import Callable, Iterable, Iterator, Sequence
from math import prod
from typing import Any

import msgspec

from protogen.capture.schema import Choice, Column, Dimension, Number, Record
from protogen.capture.schema import Text as TextShape
from protogen.convert.columns.event_values import constant_of
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
    Characters,
    Choose,
    Count,
    Hex,
    Literal,
    Others,
    Place,
    Repeat,
    Spelling,
    Step,
    number,
)

Scope = ChainMap[str, Count]
"""The numbers in front, which count and choose: their places, or constant ones themselves."""


class Spot(msgspec.Struct, frozen=True):
    """A value in a record: how many lists are around, bytes from where the record begins."""

    depth: int
    offset: int
    scope: Scope

    @classmethod
    def row(cls) -> Spot:
        """The start of a row."""
        return cls(0, 0, ChainMap())

    def place(self, code: str = "u1") -> Place:
        """The number, or the first byte, that lies here."""
        return Place(self.depth, code, self.offset)

    def moved(self, offset: int) -> Spot:
        """A spot so many bytes behind."""
        return Spot(self.depth, self.offset + offset, self.scope)

    def inside(self, columns: Iterable[Column] = ()) -> Spot:
        """The same spot as that of a record with these columns, whose numbers are known there."""
        counts = {
            item.name: Place(self.depth, item.shape.code, self.offset + item.position)
            for item in columns
            if item.role == "count" and isinstance(item.shape, Number)
        }
        return Spot(self.depth, self.offset, self.scope.new_child(dict[str, Count](counts)))

    def note(self, item: Field, column: Column | None) -> None:
        """Let what stands behind a number find it."""
        if column is None:
            if isinstance(item.const, int):
                self.scope[item.name] = item.const
        elif isinstance(column.shape, Number) and not column.dimensions:
            place = self.moved(column.position).place(column.shape.code)
            self.scope[item.name] = self.scope[column.name] = place


def fields_of(columns: Iterable[Column]) -> dict[str, Column]:
    """The columns of fields by the fields' names."""
    return {item.source: item for item in columns if item.role == "field"}


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

    # --- records ----------------------------------------------------------------------------------

    def members(
        self, fields: Sequence[Field], columns: Sequence[Column], at: Spot
    ) -> Iterator[Step]:
        """The members of a record, in braces."""
        known, inner = fields_of(columns), at.inside(columns)
        yield Literal("{")
        for place, item in enumerate(fields):
            yield Literal(f"{', ' if place else ''}{self.name(item.name)}: ")
            column = known.get(item.name)
            if column is None:
                yield from self.constant_steps(item, item.type, inner)
                inner.note(item, None)
            else:
                inner.note(item, column)
                here = inner.moved(column.position)
                yield from self.value(item, item.type, column, column.dimensions, here)
        yield Literal("}")

    def constant_steps(self, item: Field, type: Type, at: Spot) -> Iterator[Step]:
        """A value that is in no row, because it is constant or holds nothing."""
        if item.const is not None:
            yield Literal(self.constant(type, constant_of(item, type)))
            return
        match type:
            case Struct(fields=fields):
                yield from self.members(fields, (), at)
            case Array(element=Struct() | Switch() | Array() as element, extent=extent):
                count = constant_count(extent, at)
                yield from self._list(
                    at, 0, count, lambda spot: self.constant_steps(item, element, spot)
                )
            case Switch(cases=cases, selector=selector):
                bodies = {it.value: self._case(item, it, None, at) for it in cases}
                yield from chosen(at.scope[selector], bodies, [])
            case _:
                yield Literal("[]")

    # --- values -----------------------------------------------------------------------------------

    def value(
        self, item: Field, type: Type, column: Column, left: Sequence[Dimension], at: Spot
    ) -> Iterator[Step]:
        """A value, or the arrays in it, of which these dimensions are left."""
        if isinstance(type, Text):
            yield Literal('"')
            yield characters(type, column, left[0], at, self.spelling)
            yield Literal('"')
        elif isinstance(type, Octets):
            yield Literal('"')
            yield Hex(at.place(), count_of(left[0], type.extent, at))
            yield Literal('"')
        elif left and isinstance(type, Array):
            element = type.element
            yield from self.array(
                type,
                column,
                left,
                at,
                lambda spot: self.value(item, element, column, left[1:], spot),
            )
        elif isinstance(column.shape, Record):
            assert isinstance(type, Struct)
            yield from self.members(type.fields, column.shape.columns, at)
        elif isinstance(column.shape, Choice):
            assert isinstance(type, Switch)
            yield from self._choice(item, type, column.shape, at)
        else:
            assert isinstance(column.shape, Number)
            yield number(at.place(column.shape.code), self.others)

    def array(
        self,
        type: Array,
        column: Column,
        left: Sequence[Dimension],
        at: Spot,
        body: Callable[[Spot], Iterator[Step]],
    ) -> Iterator[Step]:
        """A list of what `body` prints, in brackets."""
        sizes = [it.capacity for it in left[1:]]
        is_text = isinstance(column.shape, TextShape)
        stride = column.shape.size * prod(sizes[:-1] if is_text else sizes)
        yield from self._list(at, stride, count_of(left[0], type.extent, at), body)

    def _list(
        self, at: Spot, stride: int, count: Count, body: Callable[[Spot], Iterator[Step]]
    ) -> Iterator[Step]:
        yield Literal("[")
        yield Repeat(at.place(), stride, count, list(body(Spot(at.depth + 1, 0, at.scope))))
        yield Literal("]")

    def _choice(self, item: Field, type: Switch, choice: Choice, at: Spot) -> Iterator[Step]:
        known = dict(choice.cases)
        bodies = {it.value: self._case(item, it, known.get(it.value), at) for it in type.cases}
        rest = () if choice.rest is None else self.case("", self._rest(choice, at))
        yield from chosen(selector_of(choice, at), bodies, rest)

    def _case(self, item: Field, case: Case, column: Column | None, at: Spot) -> Iterator[Step]:
        if isinstance(case.type, Struct) and not case.type.fields:
            body: Iterator[Step] = iter([Literal(self.nothing())])
        elif column is None:
            body = self.constant_steps(item, case.type, at)
        else:
            body = self.value(item, case.type, column, column.dimensions, at)
        return self.case(case.name, body)

    def _rest(self, choice: Choice, at: Spot) -> Iterator[Step]:
        yield Literal('"')
        yield rest_of(choice, at)
        yield Literal('"')


# --- what counts and chooses ----------------------------------------------------------------------


def selector_of(choice: Choice, at: Spot) -> Count:
    """The number that chooses a case."""
    selector = choice.selector
    return selector if isinstance(selector, int) else at.scope[selector]


def chosen(
    selector: Count, bodies: dict[int, Iterator[Step]], rest: Iterable[Step]
) -> Iterator[Step]:
    """The steps of the case that a number chooses."""
    if isinstance(selector, int):
        yield from bodies.get(selector, rest)
    else:
        yield Choose(selector, [(it, list(body)) for it, body in bodies.items()], list(rest))


def count_of(dimension: Dimension, extent: Extent, at: Spot) -> Count:
    """The elements or bytes that there are."""
    if dimension.counted_by is not None:
        return at.scope[dimension.counted_by]
    return extent.count if isinstance(extent, Fixed) else dimension.capacity


def constant_count(extent: Extent, at: Spot) -> Count:
    """The elements of a list that is in no row."""
    if isinstance(extent, Counted):
        return at.scope[extent.field]
    return extent.count if isinstance(extent, Fixed) else 0


def characters(
    type: Text, column: Column, dimension: Dimension, at: Spot, spelling: Spelling
) -> Step:
    """The characters of a text."""
    is_padded = isinstance(type.extent, Fixed)
    count = None if is_padded else count_of(dimension, type.extent, at)
    return Characters(at.place(), column.shape.size, count, spelling)


def rest_of(choice: Choice, at: Spot) -> Step:
    """The bytes of a value that no case stands for."""
    assert choice.rest is not None
    assert isinstance(choice.rest.shape, Record)
    size, data = choice.rest.shape.column("size"), choice.rest.shape.column("bytes")
    assert isinstance(size.shape, Number)
    count = at.moved(size.position).place(size.shape.code)
    return Hex(at.moved(data.position).place(), count)
