"""Steps that print rows as lines of CSV."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from protogen.capture.schema import (
    CaptureSchema,
    Choice,
    Column,
    InvalidReason,
    Number,
    Record,
    TableSchema,
)
from protogen.convert.columns import tables
from protogen.convert.columns.csv_text import cell_text
from protogen.convert.columns.event_values import constant_of
from protogen.convert.columns.tables import Path, Tables
from protogen.convert.writers.jsonl_steps import places_of
from protogen.convert.writers.value_steps import (
    Spot,
    ValueSteps,
    characters,
    chosen,
    count_of,
    fields_of,
    rest_of,
    selector_of,
)
from protogen.model.types import Array, Case, Field, Octets, Struct, Switch, Text, Type
from protogen.native.print_steps import (
    IN_CELLS,
    IN_JSON,
    Condition,
    Hex,
    HexOf,
    Int,
    Literal,
    Name,
    Others,
    Physical,
    Place,
    Quoted,
    Source,
    Spelling,
    Step,
    Steps,
    Time,
    When,
    number,
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
        found += [_frame_cell(column, places), Literal(",")]
    for column in table.columns:
        if table.message is None:
            found.append(_event_cell(column, places))
        else:
            fields = table.message.fields
            found += _Cell(column).reached(column.path, fields, held.columns, Spot.row())
        found.append(Literal(","))
    found[-1] = Literal("\n")
    return found


def _frame_cell(column: tables.Column, places: Mapping[str, Place]) -> Step:
    match column.path:
        case ("@", name):
            return number(places[f"@{name}"], IN_CELLS)
        case ("t_ns",):
            return When(Condition.TIMED, [Time()])
        case _:
            (role,) = column.path
            return Int(places[role], from_start=role == "offset")


def _event_cell(column: tables.Column, places: Mapping[str, Place]) -> Step:
    match column.path:
        case ("reason",):
            return Name(places["reason"], {it.value: it.word for it in InvalidReason})
        case ("payload",):
            return HexOf(Source.PAYLOADS, places["payload_offset"], places["payload_size"])
        case _:
            return HexOf(Source.LINE, places["offset"], places["size"])


class _CellValues(ValueSteps):
    """Values inside of lists, as `json.dumps` has what `plain_fields` gives."""

    others = IN_JSON
    spelling = Spelling.JSON_ASCII

    def name(self, name: str) -> str:
        return json.dumps(name)

    def constant(self, type: Type, value: Any) -> str:
        return json.dumps(value, default=bytes.hex)

    def case(self, name: str, body: Iterator[Step]) -> Iterator[Step]:
        yield Literal(f"{{{json.dumps(name)}: ")
        yield from body
        yield Literal("}")

    def nothing(self) -> str:
        return "{}"


class _Cell:
    """Prints the cell of a column: it may lie inside of structs, and of cases that are chosen."""

    def __init__(self, column: tables.Column) -> None:
        self._column = column
        self._values = _CellValues()

    # --- the way to it ----------------------------------------------------------------------------

    def reached(
        self, path: Path, fields: Sequence[Field], columns: Sequence[Column], at: Spot
    ) -> Iterator[Step]:
        """The cell of what a path leads to in a record."""
        known, inner = fields_of(columns), at.inside(columns)
        for item in fields:
            column = known.get(item.name)
            if item.name == path[0]:
                yield from self._inside(path[1:], item, item.type, column, inner)
                return
            inner.note(item, column)

    def _inside(
        self, path: Path, item: Field, type: Type, column: Column | None, at: Spot
    ) -> Iterator[Step]:
        """The cell of what the rest of a path leads to; `column` is None for what is in no row."""
        if column is not None:
            at = at.moved(column.position)
        if not path:
            stored = None if column is None else self._stored(item, type, column, at)
            yield from self._constant(item, type, at) if stored is None else stored
        elif isinstance(type, Struct):
            columns = column.shape.columns if column and isinstance(column.shape, Record) else ()
            yield from self.reached(path, type.fields, columns, at)
        else:
            assert isinstance(type, Switch)
            yield from self._chosen(path, item, type, column, at)

    def _chosen(
        self, path: Path, item: Field, type: Switch, column: Column | None, at: Spot
    ) -> Iterator[Step]:
        bodies: dict[int, Iterator[Step]] = {case.value: iter(()) for case in type.cases}
        choice = column.shape if column and isinstance(column.shape, Choice) else None
        selector = at.scope[type.selector] if choice is None else selector_of(choice, at)
        if not path[0]:
            assert choice is not None
            yield from chosen(selector, bodies, [rest_of(choice, at)])
            return
        known = {} if choice is None else dict(choice.cases)
        case = next(case for case in type.cases if case.name == path[0])
        bodies[case.value] = self._case(path[1:], item, case, known.get(case.value), at)
        yield from chosen(selector, bodies, ())

    def _case(
        self, path: Path, item: Field, case: Case, column: Column | None, at: Spot
    ) -> Iterator[Step]:
        return self._inside(path, item, case.type, column, at)

    # --- the value --------------------------------------------------------------------------------

    def _constant(self, item: Field, type: Type, at: Spot) -> Iterator[Step]:
        if item.const is None:
            yield Quoted(list(self._values.constant_steps(item, type, at)))
            return
        value = constant_of(item, type)
        derived = self._column.derived
        shown = value if derived is None else derived.of(value)
        yield Literal(cell_text(self._column.type, shown))

    def _stored(self, item: Field, type: Type, column: Column, at: Spot) -> Iterator[Step]:
        dimensions = column.dimensions
        if isinstance(type, Text):
            yield Quoted([characters(type, column, dimensions[0], at, Spelling.PLAIN)])
        elif isinstance(type, Octets):
            yield Hex(at.place(), count_of(dimensions[0], type.extent, at))
        elif isinstance(type, Array):
            yield Quoted(list(self._list(item, type, column, at)))
        else:
            assert isinstance(column.shape, Number)
            yield self._number(at.place(column.shape.code), "", IN_CELLS)

    def _list(self, item: Field, type: Array, column: Column, at: Spot) -> Iterator[Step]:
        if self._column.derived is None:
            return self._values.value(item, type, column, column.dimensions, at)

        def body(spot: Spot) -> Iterator[Step]:
            assert isinstance(column.shape, Number)
            yield self._number(spot.place(column.shape.code), "null", IN_JSON)

        return self._values.array(type, column, column.dimensions, at, body)

    def _number(self, place: Place, missing: str, others: Others) -> Step:
        match self._column.derived:
            case tables.Physical(scale=scale, offset=offset, special=special):
                return Physical(place, scale, offset, sorted(special), missing, others)
            case tables.Naming(names=names):
                texts = {it: cell_text(tables.TEXT, name) for it, name in names.items()}
                return Name(place, texts)
        return number(place, others)
