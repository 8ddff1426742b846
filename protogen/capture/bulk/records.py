"""Payloads become rows: all payloads of a message that have the same shape at once.

What counts and selects is the same in payloads of one shape, so that every value of theirs lies at
the same place. Payloads that prove to differ are parted, and each part is read by itself. Whatever
is not plainly in order, and shapes that would be read value by value, are left to the decoder.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from protogen.capture.arrays import numpy
from protogen.capture.bulk.numbers import either, floats, integers, seen
from protogen.capture.schema import Choice, Column, Record
from protogen.model.messages import Message
from protogen.model.numbers import constant_bytes
from protogen.model.types import (
    Array,
    Counted,
    Extent,
    Field,
    Fill,
    Fixed,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)

if TYPE_CHECKING:
    from protogen.capture.tables import Rows

Scope = Mapping[str, "int | Rows"]
"""The numbers in front, which may count and select: one for all rows, or one for each."""
Dtype = Any
"""A NumPy dtype; a subarray's is that of its elements."""


class _Refused(Exception):  # noqa: N818 - nothing is known to be wrong: the decoder decides
    """These payloads are not read here."""


class _Parted(Exception):  # noqa: N818 - no error
    """The payloads have several shapes, told apart by these numbers."""

    def __init__(self, numbers: Rows) -> None:
        super().__init__()
        self.numbers = numbers


def read_payloads(
    message: Message, columns: Sequence[Column], octets: Rows, found: Rows, least: int
) -> Rows | None:
    """Fill rows of zeros by payloads of one size; the result: which are left to the decoder.

    `octets` has the payloads as its rows. Fewer payloads of one shape than `least` are not worth
    it. What is left has rows without sense.
    """
    if octets.shape[1] not in message.sizes:
        return _all(len(octets))

    def read(places: slice | Rows) -> Rows | None:
        reader = _Reader(octets[places], {}, least)
        if isinstance(places, slice):
            reader.record(message.fields, columns, found)
        else:
            rows = numpy().zeros(len(places), found.dtype)
            reader.record(message.fields, columns, rows)
            _put(found, rows, places)
        reader.end()
        return reader.wrong

    return _by_shape(len(octets), read, least)


def _by_shape(count: int, read: Callable[[slice | Rows], Rows | None], least: int) -> Rows | None:
    """Have so many payloads read, those of one shape together; which of them are left."""
    try:
        return read(slice(None))
    except _Refused:
        return _all(count)
    except _Parted as why:
        parts = list(_parted(numpy().arange(count), why.numbers))
    wrong = ~_all(count)
    while parts:
        places = parts.pop()
        try:
            if len(places) < least:
                raise _Refused
            left = read(places)
            wrong[places] = False if left is None else left
        except _Refused:
            wrong[places] = True
        except _Parted as why:
            parts += _parted(places, why.numbers)
    return seen(wrong)


def _all(count: int) -> Rows:
    found: Rows = numpy().ones(count, "?")
    return found


def _parted(places: Rows, numbers: Rows) -> list[Rows]:
    """The places of each number."""
    order = numpy().argsort(numbers, kind="stable")
    bounds = numpy().flatnonzero(numpy().diff(numbers[order])) + 1
    found: list[Rows] = numpy().split(places[order], bounds)
    return found


class _Reader:
    """Reads payloads of one shape, value by value from the front."""

    def __init__(self, octets: Rows, scope: Scope, least: int) -> None:
        self.wrong: Rows | None = None
        """Which payloads are not in order; None: all are."""
        self._octets = octets
        self._count: int
        self._size: int
        self._count, self._size = octets.shape
        self._scope = dict(scope)
        self._least = least
        self._at = 0
        self._filled = 0  # Elements or bytes of what filled the payload.

    def end(self) -> None:
        """Nothing is behind what was read."""
        if self._at != self._size:
            raise _Refused

    def record(self, fields: Sequence[Field], columns: Sequence[Column], found: Rows) -> None:
        """Fill the columns of these fields."""
        outside = dict(self._scope)
        held = {item.source: item for item in columns if item.role == "field"}
        counts = {item.source: item.name for item in columns if item.role == "count"}
        for field in fields:
            if field.const is not None:
                self._constant(field)
                continue
            column = held.get(field.name)
            if column is None:
                self._without_values(field.type)
                continue
            values = self.value(field.type, column, found.dtype[column.name].base)
            if isinstance(field.type, Integer):
                self._scope[field.name] = values
            if field.name in counts:
                found[counts[field.name]] = self._filled
            _put(found[column.name], values)
        self._scope = outside

    def value(self, type_: Type, column: Column, dtype: Dtype) -> Rows:
        """The next value of each payload, as the column holds it.

        Arrays have as many elements as there are, which may be fewer than the column has room for.
        """
        match type_:
            case Integer():
                return self._judged(integers(self._take(type_.size), type_))
            case Float():
                return self._judged(floats(self._take(type_.size), type_))
            case Text() | Octets():
                return self._string(type_, dtype)
            case Struct():
                found = numpy().zeros(self._count, dtype)
                assert isinstance(column.shape, Record)
                self.record(type_.fields, column.shape.columns, found)
                return found  # type: ignore[no-any-return]
            case Array():
                return self._array(type_, column, dtype)
            case Switch():
                assert isinstance(column.shape, Choice)
                return self._switch(type_, column.shape, dtype)

    # --- bytes ------------------------------------------------------------------------------------

    def _take(self, size: int) -> Rows:
        """The next bytes of each payload."""
        if self._at + size > self._size:
            raise _Refused
        found: Rows = self._octets[:, self._at : self._at + size]
        self._at += size
        return found

    def _judged(self, values: tuple[Rows, Rows | None]) -> Rows:
        found, wrong = values
        self._leave(wrong)
        return found

    def _leave(self, wrong: Rows | None) -> None:
        """Leave payloads to the decoder in which any of these is set."""
        if wrong is not None:
            rows: Rows = wrong.reshape(self._count, -1).max(axis=1)
            self.wrong = either(self.wrong, rows)

    def _constant(self, field: Field) -> None:
        due = numpy().frombuffer(constant_bytes(field), "u1")
        self._leave(seen(self._take(len(due)) != due))
        number = field.constant_number
        self._scope.pop(field.name, None)
        if number is not None:
            self._scope[field.name] = number

    def _without_values(self, type_: Type) -> None:
        """What holds nothing but constants."""
        if not isinstance(type_, Struct):
            raise _Refused
        self.record(type_.fields, (), self._octets)

    def _string(self, type_: Text | Octets, dtype: Dtype) -> Rows:
        octets = self._take(self._number(type_.extent, 1))
        if type_.byte_bits == 7:
            self._leave(seen(octets > 0x7F))
        if isinstance(type_, Octets):
            return octets
        found = numpy().zeros((self._count, dtype.itemsize), "u1")
        found[:, : octets.shape[1]] = octets
        return found.view(dtype)[:, 0]  # type: ignore[no-any-return]

    # --- arrays -----------------------------------------------------------------------------------

    def _number(self, extent: Extent, size: int) -> int:
        """How many elements of so many bytes, or bytes, there are."""
        match extent:
            case Fixed():
                return extent.count
            case Fill(greatest=greatest):
                left = self._size - self._at
                if left % size or left > size * greatest:
                    raise _Refused
                self._filled = left // size
                return self._filled
            case Counted():
                count = self._uniform(extent.field)
                least = extent.least if extent.stated else 0
                if not least <= count <= extent.greatest:
                    raise _Refused
                return count

    def _uniform(self, name: str) -> int:
        """The number of that name, the same in all payloads."""
        numbers = self._scope.get(name)
        if numbers is None or isinstance(numbers, int):
            assert numbers is not None
            return numbers
        first = numbers[0]
        if (numbers != first).any():
            raise _Parted(numbers)
        return int(first)

    def _array(self, array: Array, column: Column, dtype: Dtype) -> Rows:
        element = array.element
        size = element.sizes.fixed
        if not size:
            raise _Refused
        count = self._number(array.extent, size)
        octets = self._take(size * count).reshape(self._count, count, size)
        if isinstance(element, Integer):
            return self._judged(integers(octets, element))
        if isinstance(element, Float):
            return self._judged(floats(octets, element))
        found = self._elements(element, column, dtype, octets.reshape(-1, size))
        return found.reshape(self._count, count, *found.shape[1:])

    def _elements(self, type_: Type, column: Column, dtype: Dtype, octets: Rows) -> Rows:
        """Elements of one size, which are read as if they were payloads."""
        count = len(octets) // self._count
        scope = {
            name: item if isinstance(item, int) else numpy().repeat(item, count)
            for name, item in self._scope.items()
        }
        inner = replace(column, dimensions=column.dimensions[1:])
        return self._judged(_elements(type_, inner, dtype, octets, scope, self._least))

    # --- switches ---------------------------------------------------------------------------------

    def _switch(self, switch: Switch, choice: Choice, dtype: Dtype) -> Rows:
        found = numpy().zeros(self._count, dtype)
        number = self._uniform(switch.selector)
        case = next((item for item in switch.cases if item.value == number), None)
        column = dict(choice.cases).get(number)
        if case is not None and column is not None:
            values = self.value(case.type, column, dtype[column.name].base)
            _put(found[column.name], values)
        elif case is not None:
            self._without_values(case.type)
        else:
            self._rest(switch, choice, found)
        return found  # type: ignore[no-any-return]

    def _rest(self, switch: Switch, choice: Choice, found: Rows) -> None:
        """The bytes of a value without a case."""
        if switch.rest is None or choice.rest is None or self._size - self._at > switch.rest:
            raise _Refused
        octets = self._take(self._size - self._at)
        if switch.byte_bits == 7:
            self._leave(seen(octets > 0x7F))
        held = found[choice.rest.name]
        held["size"] = octets.shape[1]
        _put(held["bytes"], octets)


def _elements(
    type_: Type, column: Column, dtype: Dtype, octets: Rows, scope: Scope, least: int
) -> tuple[Rows, Rows | None]:
    """Values that have all of the bytes in a row each; which of them are left to the decoder."""
    found = numpy().zeros((len(octets), *column.counts), dtype)
    if not len(octets):
        return found, None

    def read(places: slice | Rows) -> Rows | None:
        inside = {
            name: item if isinstance(item, int) else item[places] for name, item in scope.items()
        }
        reader = _Reader(octets[places], inside, least)
        values = reader.value(type_, column, dtype)
        reader.end()
        rows = numpy().zeros((len(values), *column.counts), dtype)
        _put(rows, values)
        _put(found, rows, places)
        return reader.wrong

    return found, _by_shape(len(octets), read, least)


def _put(target: Rows, values: Rows, places: slice | Rows = slice(None)) -> None:
    """Copy values to the front of each dimension; rows as they lie, with what is between."""
    if target.dtype.fields is not None:
        target, values = (
            target.view(f"V{target.dtype.itemsize}"),
            values.view(f"V{values.dtype.itemsize}"),
        )
    target[(places, *(slice(size) for size in values.shape[1:]))] = values
