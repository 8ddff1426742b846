"""MCAP with messages in JSON, as Foxglove opens it: one topic for each message.

Topics are `/PROTOCOL/SENDER/MESSAGE`. A message has all columns of its table: `heading` and
`heading_deg`. The log's time is when the frame's last byte came. A capture without times gets the
time that its bytes take on the line at the schema's baud rate, from 1970-01-01 on; without one, a
microsecond a byte. What is no frame is in the topics `unknown_frames` and `invalid_spans`.

Foxglove takes a JSON Schema only if each `type` is one word, so a type can't be "integer or null".
A member without a value is therefore left out of its message. Elements of a list keep their places:
one without a value is null, and the list's `items` are `nullable`, in the words of OpenAPI 3.0.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from protogen.convert.columns.batches import Batch
from protogen.convert.columns.python_values import as_list
from protogen.convert.columns.rows import Rows
from protogen.convert.columns.tables import (
    Column,
    ColumnType,
    Listed,
    Names,
    Record,
    Scalar,
    Table,
    Tables,
)
from protogen.convert.errors import needed
from protogen.convert.writers.pending_files import Pending
from protogen.model.protocol import Link

_MICROSECOND = 1000


class McapWriter:
    """Writes one file."""

    def __init__(self, name: str, pending: Pending, tables: Tables) -> None:
        writers = needed("mcap.writer", "writing MCAP")
        self._tables = tables
        self._file = pending.path(f"{name}.mcap").open("wb")
        self._writer: Any = writers.Writer(self._file)
        library = f"protogen {tables.invalid.facts['protogen.version']}"
        self._writer.start(profile="", library=library)
        facts = {**tables.invalid.facts, "protogen.capture": name}
        self._writer.add_metadata("protogen", facts)
        self._channels: dict[str, int] = {}
        self._time_of = _line_time(tables.protocol.link)

    def write(self, batch: Batch) -> None:
        """Write the rows of a batch in the order of the capture."""
        rows = [row for item in batch.rows() for row in self._messages(item)]
        rows.sort(key=lambda row: row[0])
        for offset, when, channel, data in rows:
            self._writer.add_message(channel, when, data, when, offset & 0xFFFFFFFF)

    def close(self) -> None:
        """Write what is left, and the index."""
        with self._file:
            self._writer.finish()

    def _messages(self, rows: Rows) -> list[tuple[int, int, int, bytes]]:
        table = rows.table
        channel = self._channels.get(table.name) or self._open(table)
        names = [column.name for column in table.all_columns]
        columns = [as_list(values) for values in rows.columns]
        known = not any(_may_miss(column.type) for column in table.all_columns)
        messages = []
        for row in zip(*columns, strict=True):
            offset, size, when = row[:3]
            data = _message(names, row, known=known)
            # The log knows no time before 1970; `t_ns` says what a recording has.
            time = self._time_of(offset + size) if when is None else max(0, when)
            messages.append((offset, time, channel, data))
        return messages

    def _open(self, table: Table) -> int:
        facts = table.facts
        topic = f"/{facts['protogen.protocol']}/{facts['protogen.sender']}/{table.name}"
        schema = json.dumps(json_schema(table)).encode()
        name = f"{facts['protogen.protocol']}.{table.name}"
        schema_id = self._writer.register_schema(name, "jsonschema", schema)
        channel: int = self._writer.register_channel(topic, "json", schema_id, dict(facts))
        self._channels[table.name] = channel
        return channel


def _line_time(link: Link) -> Callable[[int], int]:
    """Nanoseconds that so many bytes take on the line."""
    if link.baud is None:
        return lambda size: size * _MICROSECOND
    bits, baud = link.bits_per_byte, link.baud
    return lambda size: size * bits * 10**9 // baud


# --- JSON -----------------------------------------------------------------------------------------


def _hex(value: Any) -> str:
    return bytes(value).hex()


def _message(names: list[str], row: tuple[Any, ...], *, known: bool) -> bytes:
    """A row without the columns that have no value. `known`: what lists hold is all there."""
    values = {name: value for name, value in zip(names, row, strict=True) if value is not None}
    if known:
        data = json.dumps(values, default=_hex).encode()
        if b"NaN" not in data and b"Infinity" not in data:
            return data
    return json.dumps(_present(values), default=_hex).encode()


def _present(value: Any) -> Any:
    """The value without members that are missing; JSON has no infinities and not-a-number."""
    match value:
        case float() if value - value != 0:
            return None
        case list():
            return [_present(item) for item in value]
        case dict():
            members = {name: _present(item) for name, item in value.items()}
            return {name: item for name, item in members.items() if item is not None}
        case _:
            return value


def _may_miss(type: ColumnType) -> bool:
    """True if members of what a list holds may be missing."""
    match type:
        case Record(members=members, gaps=gaps):
            return gaps or any(_may_miss(member) for _, member in members)
        case Listed(element=element):
            return _may_miss(element)
        case _:
            return False


def json_schema(table: Table) -> dict[str, Any]:
    """The JSON Schema of a table's rows."""
    always = [column.name for column in table.all_columns if _is_always_there(column)]
    return {
        "title": table.name,
        "description": table.facts.get("protogen.doc", ""),
        "type": "object",
        "properties": {column.name: _property(column) for column in table.all_columns},
        "required": always,
    }


def _is_always_there(column: Column) -> bool:
    return not column.nullable and not _is_float(column.type)


def _is_float(type: ColumnType) -> bool:
    # One that is no number has no value in JSON.
    return isinstance(type, Scalar) and type.kind in ("float32", "float64")


def _property(column: Column) -> dict[str, Any]:
    facts = dict(column.facts)
    text = facts.pop("doc", "")
    unit = f"[{facts['unit']}]" if "unit" in facts else ""
    described = " ".join(word for word in (text, unit) if word)
    extras = {f"x-{key}": value for key, value in facts.items()}
    return {**_shape(column.type), **({"description": described} if described else {}), **extras}


def _shape(type: ColumnType) -> dict[str, Any]:
    match type:
        case Names(texts=texts):
            return {"type": "string", "enum": [*texts]}
        case Listed(element=element, gaps=gaps):
            empty = {"nullable": True} if gaps or _is_float(element) else {}
            return {"type": "array", "items": {**_shape(element), **empty}}
        case Record(members=members):
            return {
                "type": "object",
                "properties": {name: _shape(member) for name, member in members},
            }
        case Scalar(kind="bool"):
            return {"type": "boolean"}
        case Scalar(kind="text" | "bytes"):
            return {"type": "string"}
        case Scalar(kind="float32" | "float64"):
            return {"type": "number"}
        case Scalar():
            return {"type": "integer"}
