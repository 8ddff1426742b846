"""Byte strings in the values of examples.

A byte string is written `{hex: ...}`, `{text: ...}`, as a number or as a list of numbers. The type
of a field tells which numbers and lists are byte strings.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from protogen.model.types import Array, Field, Octets, Struct, Switch, Type, is_integer
from protogen.passes.types.constants import named_raw_value
from protogen.schema.syntax.octets import to_octets


def with_byte_strings(fields: Iterable[Field], values: Mapping[str, Any]) -> dict[str, Any]:
    """The values of these fields, with every byte string that can be read as `{hex: ...}`.

    What does not fit its field stays as it is: the verification of the example says so.
    """
    types = {field.name: field.type for field in fields}
    return {
        name: _value(types[name], value, types, values) if name in types else value
        for name, value in values.items()
    }


def _value(type_: Type, value: Any, types: Mapping[str, Type], around: Mapping[str, Any]) -> Any:
    match type_:
        case Octets():
            return _byte_string(value)
        case Struct() if isinstance(value, dict):
            return with_byte_strings(type_.fields, value)
        case Array() if isinstance(value, list):
            return [_value(type_.element, item, types, around) for item in value]
        case Switch():
            case = _case(type_, types, around)
            return value if case is None else _value(case, value, types, around)
    return value


def _byte_string(value: Any) -> Any:
    if not isinstance(value, int | list):
        return value
    try:
        return {"hex": to_octets(value).hex(" ").upper()}
    except ValueError:
        return value


def _case(switch: Switch, types: Mapping[str, Type], around: Mapping[str, Any]) -> Type | None:
    """Type of a switch for the value that its selector has in the example."""
    selector = types.get(switch.selector)
    if selector is None or not is_integer(selector) or switch.selector not in around:
        return None
    named = named_raw_value(selector, around[switch.selector])
    found = (case.type for case in switch.cases if named is not None and case.value == named[0])
    return next(found, None)
