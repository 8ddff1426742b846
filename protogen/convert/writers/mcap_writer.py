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
import struct
from collections.abc import Iterator
from typing import Any

from protogen.convert.columns.batches import Batch, Messages
from protogen.convert.columns.python_values import as_list, present_json
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
from protogen.convert.writers.mcap_file import McapFile
from protogen.convert.writers.pending_files import Pending

_MESSAGE = 5
"""Number of the records that hold messages."""
_HEAD = struct.Struct("<BQHIQQ")
"""What stands in front of a message."""
_PLACE = struct.Struct("<QQ")
"""A message in an index: its time, and where it begins in its chunk."""


class McapWriter:
    """Writes one file."""

    def __init__(self, name: str, pending: Pending, tables: Tables) -> None:
        needed("mcap", "writing MCAP")
        self._tables = tables
        self._file = pending.path(f"{name}.mcap").open("wb")
        facts = tables.invalid.facts
        self._mcap = McapFile(self._file, f"protogen {facts['protogen.version']}")
        self._mcap.add_metadata("protogen", {**facts, "protogen.capture": name})

    def write(self, batch: Batch) -> None:
        """Write the rows of a batch in the order of the capture."""
        for messages in batch.messages() or self._made(batch):
            for number in sorted(messages.places.keys() - self._mcap.channels):
                self._open(number, self._tables.all_tables[number - 1])
            self._mcap.add(messages)

    def close(self) -> None:
        """Write what is left, and the index."""
        with self._file:
            self._mcap.close()

    def _made(self, batch: Batch) -> Iterator[Messages]:
        """The rows made by Python, where no C prints them."""
        records = sorted(record for rows in batch.rows() for record in self._records(rows))
        places: dict[int, list[bytes]] = {}
        place = 0
        for _, time, channel, data in records:
            places.setdefault(channel, []).append(_PLACE.pack(time, place))
            place += len(data)
        if records:
            times = [time for _, time, _, _ in records]
            yield Messages(
                b"".join(data for *_, data in records),
                {channel: b"".join(found) for channel, found in places.items()},
                min(times),
                max(times),
            )

    def _records(self, rows: Rows) -> Iterator[tuple[int, int, int, bytes]]:
        channel, byte_time = self._tables.channels[rows.table.name], self._tables.byte_time
        names = [column.name for column in rows.table.all_columns]
        columns = [as_list(values) for values in rows.columns]
        for row in zip(*columns, strict=True):
            offset, size, when = row[:3]
            data = present_json(dict(zip(names, row, strict=True))).encode()
            # The log knows no time before 1970; `t_ns` says what a recording has.
            time = int((offset + size) * byte_time) if when is None else max(0, when)
            head = (_MESSAGE, 22 + len(data), channel, offset & 0xFFFFFFFF, time, time)
            yield offset, time, channel, _HEAD.pack(*head) + data

    def _open(self, number: int, table: Table) -> None:
        facts = table.facts
        topic = f"/{facts['protogen.protocol']}/{facts['protogen.sender']}/{table.name}"
        schema = json.dumps(json_schema(table)).encode()
        name = f"{facts['protogen.protocol']}.{table.name}"
        self._mcap.add_channel(number, topic, name, schema, facts)


# --- JSON -----------------------------------------------------------------------------------------


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
