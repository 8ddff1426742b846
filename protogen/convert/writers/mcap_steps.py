"""Steps that print rows as message records of MCAP, in JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from protogen.capture.schema import CaptureSchema, Column, TableSchema
from protogen.convert.columns import tables
from protogen.convert.columns.event_values import constant_of
from protogen.convert.columns.held_columns import dimensions_of
from protogen.convert.columns.python_values import present_json
from protogen.convert.columns.tables import Tables
from protogen.convert.writers.csv_steps import Cell, CellValues, event_cell
from protogen.convert.writers.jsonl_steps import places_of
from protogen.convert.writers.value_steps import (
    Spot,
    count_of,
    if_there,
    in_quotes,
    part_value,
    rest_digits,
    text_of,
)
from protogen.model.types import Array, Field, Float, Octets, Text, Type
from protogen.native.print_steps import (
    IN_JSON,
    TIME,
    Condition,
    Others,
    Place,
    Spelling,
    Step,
    Steps,
    enveloped,
    finite,
    hex_digits,
    literal,
    named,
    number,
    unless,
    when,
    without_comma,
)

_IN_LISTS = Others("null", "null", "null")
"""Elements of a list keep their places: one without a value is null."""


def message_steps(schema: CaptureSchema, shown: Tables) -> list[Steps]:
    """Steps for the rows of each message, then those of invalid bytes and unknown frames."""
    pairs = [(shown.messages[name], held) for name, held in schema.messages.items()]
    pairs += [(shown.invalid, schema.invalid), (shown.unknown, schema.unknown)]
    return [[_message(shown.channels[table.name], table, held)] for table, held in pairs]


def _message(channel: int, table: tables.Table, held: TableSchema) -> Step:
    return enveloped(channel, places_of(held.columns)["size"], _row(table, held))


def _row(table: tables.Table, held: TableSchema) -> Iterator[Step]:
    """The object of a row. What has no value is left out of it."""
    places = places_of(held.columns)
    yield literal("{")
    for column in table.frame_columns:
        yield from _frame_member(column, held, places)
    for column in table.columns:
        if table.message is None:
            yield from _member(column.name, in_quotes(event_cell(column, places)))
        else:
            fields = table.message.fields
            yield from _Member(column).reached(column.path, fields, held.columns, Spot.row())
    yield without_comma()
    yield literal("}")


def _member(name: str, body: Iterator[Step]) -> Iterator[Step]:
    yield literal(f"{json.dumps(name)}: ")
    yield from body
    yield literal(", ")


def _frame_member(
    column: tables.Column, held: TableSchema, places: Mapping[str, Place]
) -> Iterator[Step]:
    match column.path:
        case ("@", name):
            value = part_value(held.part(name), IN_JSON, Spelling.JSON_ASCII)
            yield from _member(column.name, value)
        case ("t_ns",):
            yield when(Condition.TIMED, _member(column.name, iter([TIME])))
        case _:
            yield from _member(column.name, iter([number(places[column.path[0]], IN_JSON)]))


class _InsideValues(CellValues):
    """Values inside of lists: records leave out floats that are no numbers."""

    others = _IN_LISTS

    def members(
        self, fields: Sequence[Field], columns: Sequence[Column], at: Spot
    ) -> Iterator[Step]:
        """The members of a record, in braces."""
        yield literal("{")
        for item, column, here in at.fields(fields, columns):
            value = self.value(item, item.type, column, dimensions_of(column), here)
            member = _there(item.type, column, here, _member(item.name, value))
            yield from if_there(item, here, member)
        yield without_comma()
        yield literal("}")

    def constant(self, type: Type, value: Any) -> str:
        return present_json(value)


def _there(type: Type, column: Column | None, at: Spot, body: Iterator[Step]) -> Iterator[Step]:
    """Steps of a value, unless it is a float that is no number."""
    if isinstance(type, Float) and column is not None:
        yield finite(at.place(column), None, body)
    else:
        yield from body


class _Member(Cell):
    """Prints the member of a column: it may lie inside of structs, and of cases that are chosen."""

    values = _InsideValues()

    def rest(self, rest: Column, at: Spot) -> Iterator[Step]:
        """The bytes of a value that no case stands for."""
        return _member(self.column.name, in_quotes(rest_digits(rest, at)))

    def value(self, item: Field, type: Type, column: Column | None, at: Spot) -> Iterator[Step]:
        """The member of a value that was reached."""
        name, derived = self.column.name, self.column.derived
        if column is None and item.const is not None:
            value = constant_of(item)
            text = present_json(value if derived is None else derived.of(value))
            yield from () if text == "null" else _member(name, iter([literal(text)]))
        elif column is None or isinstance(type, Array):
            yield from _member(name, self.list_of(item, type, column, at))
        elif isinstance(type, Text):
            dimension, spelling = column.dimensions[0], Spelling.JSON_ASCII
            yield from _member(name, in_quotes(text_of(type, column, dimension, at, spelling)))
        elif isinstance(type, Octets):
            count = count_of(type.extent, column.dimensions, at)
            yield from _member(name, in_quotes(hex_digits(at.place(), count)))
        elif isinstance(derived, tables.Naming):
            texts = {
                it: f"{json.dumps(name)}: {json.dumps(to)}, " for it, to in derived.names.items()
            }
            yield named(at.place(column), texts)
        else:
            yield from self._number_there(at.place(column))

    def element(self, place: Place) -> Step:
        """An element of a list of derived values."""
        return self.number(place, "null", _IN_LISTS)

    def _number_there(self, place: Place) -> Iterator[Step]:
        derived = self.column.derived
        steps = _member(self.column.name, iter([self.number(place, "", IN_JSON)]))
        meaning = derived if isinstance(derived, tables.Physical) else None
        if place.is_float:
            scaled = None if meaning is None else (meaning.scale, meaning.offset)
            steps = iter([finite(place, scaled, steps)])
        if meaning is not None and meaning.special:
            steps = iter([unless(place, meaning.special, steps)])
        yield from steps
