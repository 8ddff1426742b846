"""Steps that print rows as lines of CSV."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from protogen.capture.schema import CaptureSchema, Column, InvalidReason, TableSchema
from protogen.convert.columns import tables
from protogen.convert.columns.csv_text import cell_text
from protogen.convert.columns.event_values import constant_of
from protogen.convert.columns.held_columns import cases_of, dimensions_of, members_of, rest_of
from protogen.convert.columns.tables import Path, Tables
from protogen.convert.writers.jsonl_steps import places_of
from protogen.convert.writers.value_steps import (
    Spot,
    ValueSteps,
    chosen,
    count_of,
    if_there,
    part_text,
    rest_digits,
    said,
    text_of,
)
from protogen.model.types import Array, Field, Octets, Struct, Switch, Text, Type
from protogen.native.print_steps import (
    IN_CELLS,
    IN_JSON,
    TIME,
    Condition,
    Others,
    Place,
    Source,
    Spelling,
    Step,
    Steps,
    hex_digits,
    hex_of,
    literal,
    named,
    number,
    physical,
    quoted,
    when,
)


def cell_steps(schema: CaptureSchema, shown: Tables) -> list[Steps]:
    """Steps for the rows of each message, then those of invalid bytes and unknown frames."""
    messages = [_row(shown.messages[name], held) for name, held in schema.messages.items()]
    return [*messages, _row(shown.invalid, schema.invalid), _row(shown.unknown, schema.unknown)]


def _row(table: tables.Table, held: TableSchema) -> Steps:
    """The line of a row."""
    places = places_of(held.columns)
    found: list[Step] = []
    for column in table.frame_columns:
        found += [_frame_cell(column, held, places), literal(",")]
    for column in table.columns:
        if table.message is None:
            found.append(event_cell(column, places))
        else:
            fields = table.message.fields
            found += Cell(column).reached(column.path, fields, held.columns, Spot.row())
        found.append(literal(","))
    found[-1] = literal("\n")
    return found


def _frame_cell(column: tables.Column, held: TableSchema, places: Mapping[str, Place]) -> Step:
    match column.path:
        case ("@", name):
            part = held.part(name)
            text = part_text(part, Spelling.PLAIN)
            if text is not None:
                return quoted([text])
            return number(Spot.row().moved(part).place(part), IN_CELLS)
        case ("t_ns",):
            return when(Condition.TIMED, [TIME])
        case _:
            return number(places[column.path[0]], IN_CELLS)


def event_cell(column: tables.Column, places: Mapping[str, Place]) -> Step:
    """The reason or the bytes of what is no message, without quotes."""
    match column.path:
        case ("reason",):
            return named(places["reason"], {it.value: it.word for it in InvalidReason})
        case ("payload",):
            return hex_of(Source.PAYLOADS, places["payload_offset"], places["payload_size"])
        case _:
            return hex_of(Source.LINE, places["offset"], places["size"])


class CellValues(ValueSteps):
    """Values inside of lists, as `json.dumps` has what `plain_fields` gives."""

    others = IN_JSON
    spelling = Spelling.JSON_ASCII

    def name(self, name: str) -> str:
        """A name as JSON."""
        return json.dumps(name)

    def constant(self, type: Type, value: Any) -> str:
        """A constant as JSON."""
        return json.dumps(value, default=bytes.hex)

    def case(self, name: str, body: Iterator[Step]) -> Iterator[Step]:
        """The value of a switch: that of its case, or with an empty name its bytes."""
        yield literal(f"{{{json.dumps(name)}: ")
        yield from body
        yield literal("}")

    def nothing(self) -> str:
        """The value of a case without fields."""
        return "{}"


class Cell:
    """Prints the cell of a column: it may lie inside of structs, and of cases that are chosen.

    Subclasses print what is found there in other words.
    """

    values = CellValues()

    def __init__(self, column: tables.Column) -> None:
        self.column = column

    def reached(
        self, path: Path, fields: Sequence[Field], columns: Sequence[Column], at: Spot
    ) -> Iterator[Step]:
        """The cell of what a path leads to in a record."""
        every = at.fields(fields, columns)
        item, column, here = next(found for found in every if found[0].name == path[0])
        return if_there(item, here, self._inside(path[1:], item, item.type, column, here))

    def _inside(
        self, path: Path, item: Field, type: Type, column: Column | None, at: Spot
    ) -> Iterator[Step]:
        """The cell of what the rest of a path leads to."""
        if not path:
            return self.value(item, type, column, at)
        if isinstance(type, Struct):
            return self.reached(path, type.fields, members_of(column), at)
        assert isinstance(type, Switch)
        known, rest = cases_of(column), rest_of(column)
        bodies = {
            case.value: self._inside(path[1:], item, case.type, known.get(case.value), at)
            if case.name == path[0]
            else ()
            for case in type.cases
        }
        other = () if rest is None or path[0] else self.rest(rest, at)
        return chosen(said(type.selector, at), bodies, other)

    def rest(self, rest: Column, at: Spot) -> Iterator[Step]:
        """The bytes of a value that no case stands for."""
        yield rest_digits(rest, at)

    def value(self, item: Field, type: Type, column: Column | None, at: Spot) -> Iterator[Step]:
        """The cell of a value that was reached."""
        if column is None and item.const is not None:
            value, derived = constant_of(item), self.column.derived
            shown = value if derived is None else derived.of(value)
            yield literal(cell_text(self.column.type, shown))
        elif column is None or isinstance(type, Array):
            yield quoted(self.list_of(item, type, column, at))
        elif isinstance(type, Text):
            yield quoted([text_of(type, column, column.dimensions[0], at, Spelling.PLAIN)])
        elif isinstance(type, Octets):
            yield hex_digits(at.place(), count_of(type.extent, column.dimensions, at))
        else:
            yield self.number(at.place(column), "", IN_CELLS)

    def list_of(self, item: Field, type: Type, column: Column | None, at: Spot) -> Iterator[Step]:
        """A list as JSON, of raw or of derived values."""
        left = dimensions_of(column)
        if column is None or self.column.derived is None:
            return self.values.value(item, type, column, left, at)
        assert isinstance(type, Array)
        return self.values.array(
            type,
            column,
            left,
            at,
            lambda spot: iter([self.element(spot.place(column))]),
        )

    def element(self, place: Place) -> Step:
        """An element of a list of derived values."""
        return self.number(place, "null", IN_JSON)

    def number(self, place: Place, missing: str, others: Others) -> Step:
        """A number, or what is derived of it; `missing` where that has no value."""
        match self.column.derived:
            case tables.Physical(scale=scale, offset=offset, special=special):
                return physical(place, scale, offset, special, missing, others)
            case tables.Naming(names=names):
                return named(
                    place, {it: cell_text(tables.TEXT, name) for it, name in names.items()}
                )
        return number(place, others)
