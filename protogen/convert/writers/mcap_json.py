"""Messages of MCAP in JSON, as Foxglove opens them.

Foxglove takes a JSON Schema only if each `type` is one word, so a type can't be "integer or null".
A member without a value is therefore left out of its message. Elements of a list keep their places:
one without a value is null, and the list's `items` are `nullable`, in the words of OpenAPI 3.0.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

from protogen.convert.columns.python_values import present_json
from protogen.convert.columns.tables import (
    Column,
    ColumnType,
    Listed,
    Names,
    Record,
    Scalar,
    Table,
)


class JsonMessages:
    """The encoding of messages as JSON."""

    profile = ""
    compression = "zstd"
    has_checksums = True
    schema_encoding = "jsonschema"
    message_encoding = "json"

    def schema(self, table: Table) -> tuple[str, bytes]:
        """The name of a table's schema, and the JSON Schema."""
        name = f"{table.facts['protogen.protocol']}.{table.name}"
        return name, json.dumps(json_schema(table)).encode()

    def encoder(self, table: Table) -> Callable[[Mapping[str, Any]], bytes]:
        """What makes messages of rows: values by the names of their columns."""
        return lambda row: present_json(dict(row)).encode()


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
