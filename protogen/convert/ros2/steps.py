"""Steps that print rows as message records of MCAP, in the CDR of ROS 2.

What they print is what `cdr.py` makes of the same rows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import prod
from typing import Any

from protogen.capture.schema import CaptureSchema, Column, Dimension, InvalidReason, TableSchema
from protogen.capture.schema import Text as TextShape
from protogen.convert.columns import tables
from protogen.convert.columns.event_values import constant_of
from protogen.convert.columns.held_columns import cases_of, dimensions_of, members_of, rest_of
from protogen.convert.columns.tables import Path, Physical, Tables
from protogen.convert.ros2.cdr import HEADER, missing
from protogen.convert.ros2.cdr_printer import CdrPrinter, Make, constant_bytes
from protogen.convert.ros2.layout import (
    Layout,
    ListOf,
    Member,
    Message,
    Number,
    RosType,
    String,
)
from protogen.convert.writers.jsonl_steps import places_of
from protogen.convert.writers.value_steps import Spot, count_of, said
from protogen.model.types import Array, Case, Field, Fixed, Octets, Struct, Switch, Text, Type
from protogen.native import cdr_steps as cdr
from protogen.native.cdr_steps import Alignment
from protogen.native.print_steps import (
    Count,
    Place,
    Source,
    Step,
    Steps,
    enveloped,
    is_one_of,
)


def message_steps(schema: CaptureSchema, shown: Tables) -> list[Steps]:
    """Steps for the rows of each message, then those of invalid bytes and unknown frames."""
    layout = Layout(shown)
    pairs = [(shown.messages[name], held) for name, held in schema.messages.items()]
    pairs += [(shown.invalid, schema.invalid), (shown.unknown, schema.unknown)]
    found: list[Steps] = []
    for table, held in pairs:
        row = _Row(table, held, layout.messages[table.name])
        size = row.places["size"]
        found.append([enveloped(shown.channels[table.name], size, row.steps())])
    return found


class _Values(CdrPrinter):
    """Prints values of fields, whatever they hold."""

    def value(
        self,
        kind: RosType,
        item: Field,
        type: Type,
        column: Column | None,
        left: Sequence[Dimension],
        at: Spot,
    ) -> list[Step]:
        """A value, or the arrays in it, of which these dimensions are left."""
        if column is None and item.const is not None:
            return self.constant(kind, constant_of(item))
        match type:
            case Struct(fields=fields):
                assert isinstance(kind, Message)
                return self._members(kind, fields, members_of(column), at)
            case Switch():
                assert isinstance(kind, Message)
                return self._choice(kind, item, type, column, at)
            case Array() if column or not type.element.holds_values:
                return self._array(kind, item, type, column, left, at)
            case _ if column is None:
                return self.constant(kind, None)  # Nothing else holds nothing.
            case Text(extent=extent):
                padded = isinstance(extent, Fixed)
                return self.text(column, None if padded else count_of(extent, left, at), at)
            case Octets(extent=extent):
                return self.counted_octets(at.place(), count_of(extent, left, at))
            case _:
                return self.number(kind, at.place(column))

    def number(self, kind: RosType, place: Place) -> list[Step]:
        """A number as it is."""
        assert isinstance(kind, Number)
        return self.aligned(kind.size, cdr.number(place, kind.size))

    def text(self, column: Column, count: Count | None, at: Spot) -> list[Step]:
        """The characters of a text."""
        return [*self.align(4), *self.octets(cdr.string(at.place(), column.shape.size, count))]

    def counted_octets(self, place: Place, count: Count) -> list[Step]:
        return [*self.count(count), *self.octets(cdr.octets(place, count))]

    def _members(
        self, kind: Message, fields: Sequence[Field], columns: Sequence[Column], at: Spot
    ) -> list[Step]:
        """The members of a record."""
        if not fields:
            return self.constant(kind, None)
        found = []
        for member, (item, column, here) in zip(
            kind.members, at.fields(fields, columns), strict=True
        ):
            found += self._member(member, item, column, here)
        return found

    def _member(self, member: Member, item: Field, column: Column | None, at: Spot) -> list[Step]:
        def there() -> list[Step]:
            found = self.flag(True) if member.flag else []
            left = dimensions_of(column)
            return found + self.value(member.type, item, item.type, column, left, at)

        return self.if_there(item, at, there, lambda: self.absent(member))

    def absent(self, member: Member) -> list[Step]:
        """What stands for a member that is not there."""
        found = self.flag(False) if member.flag else []
        return found + self.constant(member.type, None)

    def _choice(
        self, kind: Message, item: Field, type: Switch, column: Column | None, at: Spot
    ) -> list[Step]:
        known, rest = cases_of(column), rest_of(column)
        cases = {case.name: case for case in type.cases}
        found = []
        for member in kind.members:
            if member.flag is None:  # No case has anything.
                found += self.constant(member.type, None)
                continue
            absent = self._absence(member)
            if member.source:
                case = cases[member.source]
                make = self._case(member, item, case.type, known.get(case.value), at)
                bodies, other = _of_case(type, case, make, absent)
            else:
                bodies = dict.fromkeys(type.values, absent)
                other = self.rest_of(member, rest, at)
            found += self.chosen(said(type.selector, at), bodies, other)
        return found

    def _case(
        self, member: Member, item: Field, type: Type, column: Column | None, at: Spot
    ) -> Make:
        left = dimensions_of(column)
        return lambda: [
            *self.flag(True),
            *self.value(member.type, item, type, column, left, at),
        ]

    def _absence(self, member: Member) -> Make:
        return lambda: self.absent(member)

    def rest_of(self, member: Member, rest: Column | None, at: Spot) -> Make:
        """The bytes of a value that no case stands for."""
        if rest is None:
            return self._absence(member)
        shape: Any = rest.shape
        size, data = shape.column("size"), shape.column("bytes")
        return lambda: [
            *self.flag(True),
            *self.counted_octets(at.moved(data).place(), at.moved(size).place(size)),
        ]

    # --- lists ------------------------------------------------------------------------------------

    def _array(
        self,
        kind: RosType,
        item: Field,
        type: Array,
        column: Column | None,
        left: Sequence[Dimension],
        at: Spot,
    ) -> list[Step]:
        if isinstance(kind, Message):
            kind = kind.members[0].type
        assert isinstance(kind, ListOf)
        element, count = kind.element, count_of(type.extent, left, at)
        if isinstance(element, Number) and not element.is_float and column is not None:
            return self._integers(kind, element, at.place(column), count)
        return self.list_of(
            kind,
            column,
            left,
            count,
            at,
            lambda spot: self.value(element, item, type.element, column, left[1:], spot),
        )

    def _integers(self, kind: ListOf, element: Number, place: Place, count: Count) -> list[Step]:
        """Integers, which lie in the row as they do in the message."""
        found = self.count(count) if kind.count is None else []
        step = cdr.numbers(place, element.size, count)
        return found + self._run(element.size, count, lambda: [step])

    def _run(self, size: int, count: Count, body: Make) -> list[Step]:
        """Numbers of a size, at multiples of it, that `body` prints; without any, no zeros."""
        start = self._at
        front = self.align(size) if count != 0 else []
        first, self._at = self._at, Alignment(size)
        found = body()
        if isinstance(count, int):
            self._at = first.after(count * size)
            return front + found
        self._at = start.joined(Alignment(size))
        return [cdr.where(count, front, []), *found] if front else found

    def list_of(
        self,
        kind: ListOf,
        column: Column | None,
        left: Sequence[Dimension],
        count: Count,
        at: Spot,
        body: Callable[[Spot], list[Step]],
    ) -> list[Step]:
        """A list of what `body` prints."""
        stride = 0
        if column is not None:
            sizes = [it.capacity for it in left[1:]]
            is_text = isinstance(column.shape, TextShape)
            stride = column.shape.size * prod(sizes[:-1] if is_text else sizes)
        element = Spot(at.depth + 1, 0, at.scope)
        found = self.count(count) if kind.count is None else []

        def elements() -> list[Step]:
            return [cdr.repeat(at.place(), stride, count, self.loop(lambda: body(element)))]

        if isinstance(kind.element, Number):
            return found + self._run(kind.element.size, count, elements)
        return found + elements()


class _Row(_Values):
    """Prints the message of a row."""

    def __init__(self, table: tables.Table, held: TableSchema, message: Message) -> None:
        super().__init__()
        self._table = table
        self._held = held
        self._message = message
        self.places = places_of(held.columns)

    def steps(self) -> list[Step]:
        """Every column."""
        found = cdr.header(HEADER)
        for member in self._message.members:
            column = member.column
            assert column is not None
            if column in self._table.frame_columns:
                found += self._frame_member(member, column)
            elif self._table.message is None:
                found += self._event_member(column)
            else:
                fields = self._table.message.fields
                found += self._reached(member, column.path, fields, self._held.columns, Spot.row())
        return found

    def _frame_member(self, member: Member, column: tables.Column) -> list[Step]:
        match column.path:
            case ("@", name):
                part = self._held.part(name)
                here = Spot.row().moved(part)
                if isinstance(part.shape, TextShape):
                    return self.text(part, None, here)
                return self.number(member.type, here.place(part))
            case ("t_ns",):
                return [cdr.timed(*self.fork([self._time, lambda: self.absent(member)]))]
            case _:
                return self.number(member.type, self.places[column.path[0]])

    def _time(self) -> list[Step]:
        return [*self.flag(True), *self.aligned(8, cdr.time())]

    def _event_member(self, column: tables.Column) -> list[Step]:
        """The reason or the bytes of what is no message."""
        match column.path:
            case ("reason",):
                front = self.align(4)
                self._at = Alignment(1)
                words = {
                    it.value: [cdr.fixed(constant_bytes(String(), it.word))] for it in InvalidReason
                }
                return [*front, cdr.choose(self.places["reason"], words, ())]
            case ("payload",):
                source, start = Source.PAYLOADS, self.places["payload_offset"]
                size = self.places["payload_size"]
            case _:
                source, start, size = Source.LINE, self.places["offset"], self.places["size"]
        return [*self.count(size), *self.octets(cdr.octets_of(source, start, size))]

    # --- the way to a value -----------------------------------------------------------------------

    def _reached(
        self,
        member: Member,
        path: Path,
        fields: Sequence[Field],
        columns: Sequence[Column],
        at: Spot,
    ) -> list[Step]:
        """The value that a path leads to in a record."""
        every = at.fields(fields, columns)
        item, column, here = next(found for found in every if found[0].name == path[0])
        return self.if_there(
            item,
            here,
            lambda: self._inside(member, path[1:], item, item.type, column, here),
            lambda: self._nowhere(member),
        )

    def _inside(
        self,
        member: Member,
        path: Path,
        item: Field,
        type: Type,
        column: Column | None,
        at: Spot,
    ) -> list[Step]:
        """The value that the rest of a path leads to."""
        if not path:
            return self._found(member, item, type, column, at)
        if isinstance(type, Struct):
            return self._reached(member, path, type.fields, members_of(column), at)
        assert isinstance(type, Switch)
        nowhere: Make = lambda: self._nowhere(member)  # noqa: E731
        if not path[0]:
            bodies = dict.fromkeys(type.values, nowhere)
            rest = self.rest_of(member, rest_of(column), at)
            return self.chosen(said(type.selector, at), bodies, rest)
        case = next(case for case in type.cases if case.name == path[0])
        within = cases_of(column).get(case.value)
        make: Make = lambda: self._inside(member, path[1:], item, case.type, within, at)  # noqa: E731
        return self.chosen(said(type.selector, at), *_of_case(type, case, make, nowhere))

    def _nowhere(self, member: Member) -> list[Step]:
        """What stands for a column's value where there is none."""
        if member.flag is None:
            return self.constant(member.type, missing(member.type))
        return self.absent(member)

    def _found(
        self, member: Member, item: Field, type: Type, column: Column | None, at: Spot
    ) -> list[Step]:
        """A value that was reached."""
        shown = member.column
        assert shown is not None
        meaning = shown.derived if isinstance(shown.derived, Physical) else None
        if column is None and item.const is not None:
            value = constant_of(item)
            return self._constant_found(member, value if meaning is None else meaning.of(value))
        if meaning is not None and column is not None:
            return self._physical(member, meaning, type, column, at)
        found = self.flag(True) if member.flag else []
        return found + self.value(member.type, item, type, column, dimensions_of(column), at)

    def _constant_found(self, member: Member, value: Any) -> list[Step]:
        if value is None:
            return self._nowhere(member)
        found = self.flag(True) if member.flag else []
        return found + self.constant(member.type, value)

    def _physical(
        self, member: Member, meaning: Physical, type: Type, column: Column, at: Spot
    ) -> list[Step]:
        """A physical value, or a list of them."""
        if isinstance(type, Array):
            assert isinstance(member.type, ListOf)
            front = self.flag(True) if member.flag else []
            left = dimensions_of(column)
            element = member.type.element
            return front + self.list_of(
                member.type,
                column,
                left,
                count_of(type.extent, left, at),
                at,
                lambda spot: self._physical_number(element, meaning, spot.place(column)),
            )
        place = at.place(column)
        if member.flag is None:
            return self._physical_number(member.type, meaning, place)
        special = is_one_of(place, meaning.special)

        def there() -> list[Step]:
            return [*self.flag(True), *self._physical_number(member.type, meaning, place)]

        if not special:
            return there()
        return self.either(special, lambda: self._nowhere(member), there)

    def _physical_number(self, kind: RosType, meaning: Physical, place: Place) -> list[Step]:
        assert isinstance(kind, Number)
        if not meaning.is_plain:
            step = cdr.physical(place, meaning.scale, meaning.offset, meaning.special)
            return self.aligned(8, step)
        if kind.is_float and meaning.special:
            return self.aligned(kind.size, cdr.plain_physical(place, kind.size, meaning.special))
        return self.number(kind, place)


def _of_case(type: Switch, case: Case, make: Make, absent: Make) -> tuple[dict[int, Make], Make]:
    """What is made for single values of a switch's selector, and for all others."""
    if case.value is None:
        return dict.fromkeys(type.values, absent), make
    return {case.value: make}, absent
