"""MCAP with messages in JSON, as Foxglove opens it: one topic for each message.

Topics are `/PROTOCOL/SENDER/MESSAGE`. A message has all columns of its table: `heading` and
`heading_deg`. The log's time is when the frame's last byte came. A capture without times gets the
time that its bytes take on the line at the schema's baud rate, from 1970-01-01 on; without one, a
microsecond a byte. What is no frame is in the topics `unknown_frames` and `invalid_spans`.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from protogen.convert.batches import Batch, Rows
from protogen.convert.errors import needed
from protogen.convert.outputs import Pending
from protogen.convert.tables import Column, ColumnType, Listed, Names, Record, Scalar, Table, Tables
from protogen.convert.values import as_list
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
        self._writer.finish()
        self._file.close()

    def _messages(self, rows: Rows) -> list[tuple[int, int, int, bytes]]:
        table = rows.table
        channel = self._channels.get(table.name) or self._open(table)
        names = [column.name for column in table.all_columns]
        columns = [as_list(values) for values in rows.columns]
        messages = []
        for row in zip(*columns, strict=True):
            offset, size, when = row[:3]
            data = json.dumps(dict(zip(names, row, strict=True)), default=_hex).encode()
            data = data if b"NaN" not in data and b"Infinity" not in data else _finite(names, row)
            time = self._time_of(offset + size) if when is None else when
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
    """How many nanoseconds so many bytes take on the line."""
    if link.baud is None:
        return lambda size: size * _MICROSECOND
    bits, baud = link.bits_per_byte, link.baud
    return lambda size: size * bits * 10**9 // baud


# --- JSON -----------------------------------------------------------------------------------------


def _hex(value: Any) -> str:
    return bytes(value).hex()


def _finite(names: list[str], row: tuple[Any, ...]) -> bytes:
    """The message without not-a-number and infinities, for which JSON has no numbers."""
    values = {name: _shown(value) for name, value in zip(names, row, strict=True)}
    return json.dumps(values, default=_hex).encode()


def _shown(value: Any) -> Any:
    match value:
        case float() if value - value != 0:
            return None
        case list():
            return [_shown(item) for item in value]
        case dict():
            return {name: _shown(item) for name, item in value.items()}
        case _:
            return value


def json_schema(table: Table) -> dict[str, Any]:
    """The JSON Schema of a table's rows."""
    properties = {column.name: _property(column) for column in table.all_columns}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": table.name,
        "description": table.facts.get("protogen.doc", ""),
        "type": "object",
        "properties": properties,
        "required": list(properties),
    }


def _property(column: Column) -> dict[str, Any]:
    shape = _shape(column.type, nullable=column.nullable)
    facts = dict(column.facts)
    text = facts.pop("doc", "")
    unit = f"[{facts['unit']}]" if "unit" in facts else ""
    described = " ".join(word for word in (text, unit) if word)
    extras = {f"x-{key}": value for key, value in facts.items()}
    return {**shape, **({"description": described} if described else {}), **extras}


def _shape(type: ColumnType, *, nullable: bool) -> dict[str, Any]:
    match type:
        case Names(texts=texts):
            return {"type": _or_null("string", nullable), "enum": [*texts, *[None][:nullable]]}
        case Listed(element=element):
            # An element may be missing as well: a special value, or a case that was not chosen.
            return {"type": _or_null("array", nullable), "items": _shape(element, nullable=True)}
        case Record(members=members):
            shapes = {name: _shape(member, nullable=True) for name, member in members}
            return {"type": _or_null("object", nullable), "properties": shapes}
        case Scalar(kind="bool"):
            return {"type": _or_null("boolean", nullable)}
        case Scalar(kind="text" | "bytes"):
            return {"type": _or_null("string", nullable)}
        case Scalar(kind="float32" | "float64"):
            # A float that is no number is null.
            return {"type": _or_null("number", nullable=True)}
        case Scalar():
            return {"type": _or_null("integer", nullable)}


def _or_null(type: str, nullable: bool) -> str | list[str]:
    return [type, "null"] if nullable else type
