"""Steps that print rows as lines of JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from protogen.capture.schema import (
    OF_MESSAGES,
    CaptureSchema,
    Column,
    InvalidReason,
    Number,
    TableSchema,
)
from protogen.convert.writers.value_steps import Spot, ValueSteps, part_value
from protogen.model.types import Array, Octets, Type
from protogen.native.print_steps import (
    IN_LINES,
    TIME,
    Condition,
    Place,
    Source,
    Spelling,
    Step,
    Steps,
    hex_of,
    literal,
    named,
    number,
    when,
)


def line_steps(schema: CaptureSchema) -> list[Steps]:
    """Steps for the rows of each message, then those of invalid bytes and unknown frames."""
    sender = {"sender": schema.sender, **({"form": schema.form} if schema.form else {})}
    tables = [list(_message(name, table, sender)) for name, table in schema.messages.items()]
    return [
        *tables,
        list(_invalid(schema.invalid, schema.sender)),
        list(_unknown(schema.unknown, sender)),
    ]


def _message(name: str, table: TableSchema, sender: Mapping[str, str]) -> Iterator[Step]:
    assert table.message is not None
    places = places_of(table.columns)
    yield from _start(places, {"event": "message", "message": name, **sender})
    yield from _parts(table.columns)
    yield literal(', "fields": ')
    yield from _LineValues().members(table.message.fields, table.columns, Spot.row())
    yield when(Condition.DIFFERS, list(_raw(places)))
    yield from _end()


def _invalid(table: TableSchema, sender: str) -> Iterator[Step]:
    places = places_of(table.columns)
    yield from _start(places, {"event": "invalid", "sender": sender})
    yield literal(', "reason": "')
    yield named(places["reason"], {it.value: it.word for it in InvalidReason})
    yield literal('"')
    yield from _raw(places)
    yield from _end()


def _unknown(table: TableSchema, sender: Mapping[str, str]) -> Iterator[Step]:
    places = places_of(table.columns)
    yield from _start(places, {"event": "unknown", **sender})
    yield from _parts(table.columns)
    yield literal(', "payload": "')
    yield hex_of(Source.PAYLOADS, places["payload_offset"], places["payload_size"])
    yield literal('"')
    yield when(Condition.DIFFERS, list(_raw(places)))
    yield from _end()


def places_of(columns: Sequence[Column]) -> dict[str, Place]:
    """The numbers of an event, without the parts of the frame: by what they are."""
    return {
        item.source: Spot.row().moved(item).place(item)
        for item in columns
        if isinstance(item.shape, Number) and item.role not in (*OF_MESSAGES, "part")
    }


def _start(places: Mapping[str, Place], words: Mapping[str, str]) -> Iterator[Step]:
    yield literal('{"offset": ')
    yield number(places["offset"], IN_LINES)
    yield literal(', "size": ')
    yield number(places["size"], IN_LINES)
    for name, value in words.items():
        yield literal(f', "{name}": {json.dumps(value, ensure_ascii=False)}')


def _parts(columns: Sequence[Column]) -> Iterator[Step]:
    yield literal(', "parts": {')
    parts = [item for item in columns if item.role == "part"]
    for order, item in enumerate(parts):
        yield literal(f"{', ' if order else ''}{json.dumps(item.source)}: ")
        yield from part_value(item, IN_LINES, Spelling.JSON)
    yield literal("}")


def _raw(places: Mapping[str, Place]) -> Iterator[Step]:
    yield literal(', "raw": "')
    yield hex_of(Source.LINE, places["offset"], places["size"])
    yield literal('"')


def _end() -> Iterator[Step]:
    yield when(Condition.TIMED, [literal(', "t_ns": '), TIME])
    yield literal("}\n")


class _LineValues(ValueSteps):
    """Values as the lines of events have them: strict JSON, the chosen case without its name."""

    others = IN_LINES
    spelling = Spelling.JSON

    def name(self, name: str) -> str:
        return json.dumps(name, ensure_ascii=False)

    def constant(self, type: Type, value: Any) -> str:
        return json.dumps(_shown(type, value), ensure_ascii=False)

    def case(self, name: str, body: Iterator[Step]) -> Iterator[Step]:
        return body

    def nothing(self) -> str:
        return "null"


def _shown(type: Type, value: Any) -> Any:
    """A constant as JSON lines show it."""
    match type:
        case Octets():
            return value.hex()
        case Array(element=element):
            return [_shown(element, item) for item in value]
        case _:
            return str(value) if isinstance(value, float) and value - value != 0 else value
