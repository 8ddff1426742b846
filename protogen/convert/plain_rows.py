"""Rows of NumPy tables as plain values, whatever they hold: arrays of structs, cases of switches.

For what has no shorter way: an object is made for each value.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from protogen.capture.schema import TableSchema
from protogen.convert.composed import Structs
from protogen.convert.nested import nested
from protogen.model.types import Array, Field, Octets, Struct, Switch, Type


def plain_rows(table: TableSchema, rows: Any) -> list[dict[str, Any]]:
    """The fields of each row, as `plain_fields` has them."""
    assert table.message is not None
    names = [item.name for item in table.message.fields]
    return Structs({name: nested([name], table, rows) for name in names}, len(rows)).tolist()


# --- for JSON lines -------------------------------------------------------------------------------


def json_fields(fields: Sequence[Field], values: Mapping[str, Any]) -> dict[str, Any]:
    """Plain values as JSON lines show them."""
    return {item.name: json_value(item.type, values[item.name]) for item in fields}


def json_value(type: Type, value: Any) -> Any:
    """A plain value as JSON lines show it."""
    match type:
        case Octets():
            return value.hex()
        case Array(element=element):
            return [json_value(element, item) for item in value]
        case Struct(fields=fields):
            return json_fields(fields, value)
        case Switch(cases=cases):
            ((name, chosen),) = value.items()
            case = next((case for case in cases if case.name == name), None)
            if case is None:
                return chosen.hex()
            return json_value(case.type, chosen) if chosen != {} else None
        case _:
            return str(value) if isinstance(value, float) and value - value != 0 else value
