"""Byte strings among the values of an example.

A byte string is written `{hex: ...}`, `{text: ...}`, as a number or as a list of numbers. The type
of a field tells which numbers, lists and mappings are byte strings: a struct may have a field that
is called `text`, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from protogen.model.expressions import Operand, value_of
from protogen.model.types import Array, Field, Octets, Struct, Switch, Type, is_integer
from protogen.passes.types.constants import named_raw_value
from protogen.schema.syntax.octets import to_octets

Change = Callable[[Any], Any]
"""Writes a byte string in another way."""


def with_byte_strings(fields: Iterable[Field], values: Mapping[str, Any]) -> dict[str, Any]:
    """The values of these fields, with every byte string that can be read as `{hex: ...}`.

    What does not fit its field stays as it is: the verification of the example says so.
    """
    return _changed(fields, values, _byte_string)


def with_hex_digits(fields: Iterable[Field], values: Mapping[str, Any]) -> dict[str, Any]:
    """The values of these fields, with `{hex: ...}` and `{text: ...}` as hex digits.

    Raises ValueError where one of them is no byte string.
    """
    return _changed(fields, values, _hex_digits)


def _changed(fields: Iterable[Field], values: Mapping[str, Any], change: Change) -> dict[str, Any]:
    types = {field.name: field.type for field in fields}
    return {
        name: _value(types[name], value, types, values, change) if name in types else value
        for name, value in values.items()
    }


def _value(
    type_: Type,
    value: Any,
    types: Mapping[str, Type],
    around: Mapping[str, Any],
    change: Change,
) -> Any:
    match type_:
        case Octets():
            return change(value)
        case Struct() if isinstance(value, dict):
            return _changed(type_.fields, value, change)
        case Array() if isinstance(value, list):
            return [_value(type_.element, item, types, around, change) for item in value]
        case Switch():
            case = _case(type_, types, around)
            if case is not None:
                return _value(case, value, types, around, change)
            # Bytes without a case; a number or a list may yet be of one.
            return change(value) if isinstance(value, dict) else value
    return value


def _byte_string(value: Any) -> Any:
    if not isinstance(value, int | list):
        return value
    try:
        return {"hex": to_octets(value).hex(" ").upper()}
    except ValueError:
        return value


def _hex_digits(value: Any) -> Any:
    is_written = isinstance(value, dict) and set(value) in ({"hex"}, {"text"})
    return to_octets(value).hex() if is_written else value


def _case(switch: Switch, types: Mapping[str, Type], around: Mapping[str, Any]) -> Type | None:
    """Type of a switch for the value that its selector has in the example."""
    try:
        chosen = value_of(switch.selector, lambda operand: _raw_value(operand, types, around))
    except LookupError:
        return None
    case = switch.case(int(chosen))
    return None if case is None else case.type


def _raw_value(operand: Operand, types: Mapping[str, Type], around: Mapping[str, Any]) -> int:
    """Raw value of a field in an example. Raises LookupError where it has none."""
    type_, value = types[operand.path[0]], around[operand.path[0]]
    for name in operand.path[1:]:
        if not isinstance(type_, Struct) or not isinstance(value, dict):
            raise LookupError(name)
        type_ = {field.name: field.type for field in type_.fields}[name]
        value = value[name]
    named = named_raw_value(type_, value) if is_integer(type_) else None
    if named is None:
        raise LookupError(operand.name)
    return named[0]
