"""Hints on what may be written for a field that an encoder refused."""

from __future__ import annotations

import re
from collections import ChainMap
from collections.abc import Mapping, Sequence
from typing import Any

from protogen.cli.wire.scalars import allowed
from protogen.model.types import Array, Field, Integer, Struct, Switch, Type

Scope = ChainMap[str, Any]
"""The values that were given, which choose the cases of switches."""

_STEP = re.compile(r"[^.\[\]]+")


def hint_at(fields: Sequence[Field], values: Mapping[str, Any], path: str) -> str | None:
    """Return what may be written for the field at ``path``; None if nothing is there.

    ``values`` are those of all fields, as far as they were given.
    """
    return _hint_inside(fields, values, _STEP.findall(path), ChainMap(), path)


def _hint_inside(
    fields: Sequence[Field], values: Any, steps: Sequence[str], around: Scope, path: str
) -> str | None:
    given = values if isinstance(values, Mapping) else {}
    scope = around.new_child(dict(given))
    for field in fields:
        if field.name in steps[:1]:
            return _hint(field, field.type, given.get(field.name), steps[1:], scope, path)
    return None


def _hint(
    field: Field, type: Type, value: Any, steps: Sequence[str], scope: Scope, path: str
) -> str | None:
    match type:
        case Switch() if case := _case(type, scope):
            return _hint(field, case, value, steps, scope, path)
        case Struct(fields=fields) if steps:
            return _hint_inside(fields, value, steps, scope, path)
        case Array(element=element) if steps:
            chosen = value[int(steps[0])] if isinstance(value, list) else None
            return _hint(field, element, chosen, steps[1:], scope, path)
        case Struct(fields=fields) if fields:
            return f"give {members(fields, path)}"
        case Integer():
            return f"`{path}` is {type.label}: {allowed(field, type)}"
        case _:
            return f"`{path}` is {type.label}"


def _case(type: Switch, scope: Scope) -> Type | None:
    chosen = scope.get(type.selector)
    return next((case.type for case in type.cases if case.value == chosen), None)


def members(fields: Sequence[Field], path: str) -> str:
    """Return how the members of a struct are given: each for itself, or as JSON.

    An element of a list has no name of its own, so that its members are JSON always.
    """
    if "[" in path:
        return "JSON: {" + ", ".join(f'"{field.name}": ...' for field in fields) + "}"
    return " ".join(f"{path}.{field.name}=..." for field in fields)
