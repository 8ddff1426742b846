"""The values of a JSON line as tables hold them: bytes as bytes, cases by name."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Mapping, Sequence
from typing import Any

from protogen.model.expressions import Expression, value_of
from protogen.model.expressions import reached as reached_in
from protogen.model.presence import Conditional, Trailing
from protogen.model.types import Array, Field, Float, Octets, Struct, Switch, Type

Scope = ChainMap[str, Any]
"""The values of the fields in front, which choose the cases of switches."""


def plain_fields(
    fields: Sequence[Field], values: Mapping[str, Any], around: Scope | None = None
) -> dict[str, Any]:
    """The values of fields as a JSON line has them, made plain.

    A switch is a mapping of the chosen case's name to its value, or of the empty name to bytes.
    """
    scope: Scope = ChainMap({}, *(around.maps if around is not None else ()))
    plain = {}
    for item in fields:
        scope[item.name] = values[item.name]
        is_there = _is_there(item, scope)
        plain[item.name] = _plain(item.type, values[item.name], scope) if is_there else None
    return plain


def _is_there(item: Field, scope: Scope) -> bool:
    match item.presence:
        case Conditional(condition=condition):
            return bool(_said(condition, scope))
        case Trailing():
            return scope[item.name] is not None
        case None:
            return True


def _said(expression: Expression, scope: Scope) -> int:
    return int(value_of(expression, lambda operand: reached_in(scope, operand.name)))


def _plain(type: Type, value: Any, scope: Scope) -> Any:
    match type:
        case Float():
            return float(value)
        case Octets():
            return bytes.fromhex(value)
        case Array(element=element):
            return [_plain(element, item, scope) for item in value]
        case Struct(fields=fields):
            return plain_fields(fields, value, scope)
        case Switch():
            return _plain_case(type, value, scope)
        case _:
            return value


def _plain_case(type: Switch, value: Any, scope: Scope) -> dict[str, Any]:
    chosen = _said(type.selector, scope)
    case = type.case(chosen)
    if case is None:
        return {"": bytes.fromhex(value)}
    if isinstance(case.type, Struct):
        return {case.name: plain_fields(case.type.fields, value or {}, scope)}
    return {case.name: _plain(case.type, value, scope)}


def reached(values: Any, path: Sequence[str]) -> Any:
    """Value that a path leads to; None where a case on the way was not chosen."""
    for step in path:
        if values is None:
            return None
        values = values.get(step)
    return values


def constant_of(item: Field) -> Any:
    """The value of a constant field."""
    if isinstance(item.const, tuple):
        return list(item.const)
    return bool(item.const) if item.is_bool else item.const
