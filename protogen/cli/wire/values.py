"""Field values as people write them on a command line, made into the raw values of JSON lines.

A number stands for the raw value (`5`, `0x1F`), a number with the field's unit for the physical
value (`90deg`). Enums and special values have names, flags are joined by `|`, a character may
stand in single quotes and a text in double ones, bytes are `hex:1B02` or `text:abc`, lists and
structs are JSON. A dotted name is a member of a struct, a flag or a run of bits.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from protogen.cli.exits import UsageError
from protogen.cli.wire.hints import members
from protogen.cli.wire.scalars import (
    float_value,
    from_json,
    integer_value,
    octets_value,
    text_value,
)
from protogen.model.types import (
    Array,
    Case,
    Field,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)
from protogen.problems import hint_for

Raw = int | float | str | list[Any] | dict[str, Any] | None
"""A raw value as a JSON line has it: bytes are hex digits, a case without bytes is None."""

Scope = ChainMap[str, Raw]
"""The values of the fields so far, which choose the cases of switches."""


def split_assignment(text: str) -> tuple[str, str]:
    """Return what stands in front of the first `=` and behind it. Raises UsageError."""
    name, equals, value = text.partition("=")
    if not equals or not name:
        raise UsageError(f"`{text}` is no assignment", "write FIELD=VALUE, or @PART=VALUE")
    return name, value


def tree_of(assignments: Iterable[tuple[str, str]]) -> dict[str, Any]:
    """Return the assignments as a tree: `a.b` is the member `b` of `a`. Raises UsageError."""
    tree: dict[str, Any] = {}
    for path, value in assignments:
        *outer, name = path.split(".")
        place = tree
        for step in outer:
            place = place.setdefault(step, {})
            if not isinstance(place, dict):
                raise UsageError(f"`{path}` is given twice")
        if name in place:
            raise UsageError(f"`{path}` is given twice")
        place[name] = value
    return tree


def raw_values(fields: Sequence[Field], written: Mapping[str, Any]) -> dict[str, Raw]:
    """Return the raw values of fields by name.

    Raises UsageError with the path of the field, what is allowed, and what was probably meant.
    Whether a value is in its range is for the encoder to say.
    """
    return _members(fields, written, "", ChainMap())


def _members(
    fields: Sequence[Field], written: Mapping[str, Any], prefix: str, scope: Scope
) -> dict[str, Raw]:
    names = [field.name for field in fields]
    for name in written:
        if name not in names:
            hint = hint_for(name, names) or f"there are {', '.join(names) or 'none'}"
            raise UsageError(f"there is no field `{prefix}{name}`", hint)
    values: dict[str, Raw] = {}
    for field in fields:
        if field.name in written:
            value = _value(field, field.type, written[field.name], prefix + field.name, scope)
            values[field.name] = scope[field.name] = value
        elif _has_no_bytes(field, scope):
            values[field.name] = None
        else:
            scope[field.name] = _what_is_sent(field)
    return values


def _has_no_bytes(field: Field, scope: Scope) -> bool:
    """True if the field is a switch whose case has nothing to give."""
    if not isinstance(field.type, Switch):
        return False
    chosen = scope.get(field.type.selector)
    return any(case.value == chosen and _is_empty(case) for case in field.type.cases)


def _is_empty(case: Case) -> bool:
    return isinstance(case.type, Struct) and not case.type.fields


def _what_is_sent(field: Field) -> Raw:
    """Return what an encoder sends for a field without a value, as far as a switch may ask it."""
    value = field.default if field.const is None else field.const
    return value if isinstance(value, int) else None


def _value(field: Field, type: Type, written: Any, path: str, scope: Scope) -> Raw:
    match type:
        case Struct(fields=fields):
            given = _mapping(written, fields, path)
            return _members(fields, given, f"{path}.", scope.new_child())
        case Array():
            return _elements(field, type, written, path, scope)
        case Switch():
            return _case(field, type, written, path, scope)
        case _:
            return _scalar(field, type, written, path)


def _elements(field: Field, type: Array, written: Any, path: str, scope: Scope) -> list[Raw]:
    return [
        _value(field, type.element, item, f"{path}[{index}]", scope)
        for index, item in enumerate(_list(written, path))
    ]


def _scalar(
    field: Field, type: Integer | Float | Text | Octets, written: Any, path: str
) -> int | float | str:
    match type:
        case Integer():
            return integer_value(field, type, written, path)
        case Float():
            return float_value(field, written, path)
        case Text():
            return text_value(written, path)
        case Octets():
            return octets_value(written, path).hex()


def _case(field: Field, type: Switch, written: Any, path: str, scope: Scope) -> Raw:
    chosen = scope.get(type.selector)
    for case in type.cases:
        if case.value == chosen:
            return None if _is_empty(case) else _value(field, case.type, written, path, scope)
    if chosen is None:
        raise UsageError(f"{path}: `{type.selector}` says what this is; give it, too")
    return octets_value(written, path).hex()


# --- what a list or a struct is written as ------------------------------------------------------


def _mapping(written: Any, fields: Sequence[Field], path: str) -> Mapping[str, Any]:
    is_json = isinstance(written, str) and written.lstrip().startswith("{")
    value = from_json(written, path) if is_json else written
    if isinstance(value, Mapping):
        return value
    if len(fields) == 1:
        return {fields[0].name: value}
    raise UsageError(f"{path}: `{written}` is no struct", f"give {members(fields, path)}")


def _list(written: Any, path: str) -> Sequence[Any]:
    if isinstance(written, str) and not written.lstrip().startswith(("[", "{")):
        return written.split(",") if written else []
    value = from_json(written, path) if isinstance(written, str) else written
    if isinstance(value, list):
        return value
    raise UsageError(f"{path}: a list is written `1,2,3` or as JSON, such as [1, 2, 3]")
