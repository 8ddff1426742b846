"""Hints on what may be written for a field that an encoder refused."""

from __future__ import annotations

import re
from collections import ChainMap
from collections.abc import Mapping, Sequence
from typing import Any

from protogen.cli.wire.scalars import allowed
from protogen.model.expressions import Expression, reached, value_of
from protogen.model.payload_plan import (
    AnyStep,
    ChooseStep,
    IntegerStep,
    RecordStep,
    RepeatStep,
    RestStep,
)
from protogen.model.payload_walks import held_step, without_constant

Scope = ChainMap[str, Any]
"""The values that were given, which choose the cases of switches."""

_NAME_OR_INDEX = re.compile(r"[^.\[\]]+")


def hint_at(steps: Sequence[AnyStep], values: Mapping[str, Any], path: str) -> str | None:
    """Return what may be written for the field at ``path``; None if nothing is there.

    ``values`` are those of all fields, as far as they were given.
    """
    return _hint_inside(steps, values, _NAME_OR_INDEX.findall(path), ChainMap(), path)


def _hint_inside(
    steps: Sequence[AnyStep], values: Any, way: Sequence[str], around: Scope, path: str
) -> str | None:
    given = values if isinstance(values, Mapping) else {}
    scope = around.new_child(dict(given))
    for step in steps:
        if step.name in way[:1]:
            bare = without_constant(held_step(step))
            return _hint(bare, given.get(step.name), way[1:], scope, path)
    return None


def _hint(step: AnyStep, value: Any, way: Sequence[str], scope: Scope, path: str) -> str | None:
    match step:
        case ChooseStep() if case := chosen_case(step, scope):
            return _hint(case, value, way, scope, path)
        case RecordStep() if way:
            return _hint_inside(step.steps, value, way, scope, path)
        case RepeatStep() if way:
            chosen = value[int(way[0])] if isinstance(value, list) else None
            return _hint(step.element, chosen, way[1:], scope, path)
        case RecordStep() if step.steps:
            return f"give {members(step, path)}"
        case IntegerStep():
            return f"`{path}` is {step.type.label}: {allowed(step)}"
        case _:
            return f"`{path}` is {step.type.label}"


def chosen_case(step: ChooseStep, scope: Mapping[str, Any]) -> AnyStep | None:
    """Return the step of the case that the value of the selector chooses, if it has one."""
    chosen = value_in(step.expression, scope)
    found = None if chosen is None else step.case(chosen)
    return None if isinstance(found, RestStep) else found


def value_in(expression: Expression, scope: Mapping[str, Any]) -> int | None:
    """Return the value of an expression; None where the values in front do not say it."""
    try:
        return int(value_of(expression, lambda operand: reached(scope, operand.name)))
    except (KeyError, TypeError):
        return None


def members(record: RecordStep, path: str) -> str:
    """Return how the members of a struct are given: each for itself, or as JSON.

    An element of a list has no name of its own, so that its members are JSON always.
    """
    if "[" in path:
        return "JSON: {" + ", ".join(f'"{step.name}": ...' for step in record.steps) + "}"
    return " ".join(f"{path}.{step.name}=..." for step in record.steps)
