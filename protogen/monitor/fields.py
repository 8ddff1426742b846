"""Fields of messages as users name them in filters and plots: `battery_v`, `cells[2]`, `pose.x`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import reduce
from typing import Any

from protogen.errors import UserError
from protogen.problems import hint_for
from protogen.runtime.attributes import attribute
from protogen.runtime.payload.number_rules import FloatRule, IntegerRule
from protogen.runtime.payload.physical import Physical, PhysicalList, PhysicalListOrNone
from protogen.runtime.payload.records import ArrayRule, StructRule

FieldPath = tuple[str | int, ...]
"""Names of fields, and numbers of elements."""

_STEP = re.compile(r"(?P<name>[A-Za-z_]\w*)(?P<indices>(?:\[\d+\])*)")


class FilterError(UserError):
    """A filter, or a field, that can't be understood."""


def path_of(text: str, steps: Iterable[str]) -> FieldPath:
    """The path of a name in pieces, such as `cells[2]`. Raises FilterError."""
    path: list[str | int] = []
    for step in steps:
        found = _STEP.fullmatch(step)
        if found is None:
            raise FilterError(
                f"`{text}` names no field", "write MESSAGE.FIELD, or MESSAGE.FIELD[0]"
            )
        path.append(found["name"])
        path += map(int, re.findall(r"\d+", found["indices"]))
    return tuple(path)


def check_path(text: str, kind: type, path: FieldPath) -> None:
    """Raise FilterError where a message has no such field, or where it is not one value."""
    name = str(path[0])
    known = _names(kind)
    if name not in known:
        problem = f"`{text.partition('.')[0]}` has no field `{name}`"
        raise FilterError(problem, hint_for(name, known) or f"there are {', '.join(known)}")
    rule = _rule(kind, name)
    if len(path) == 1 and isinstance(rule, ArrayRule | PhysicalList | PhysicalListOrNone):
        raise FilterError(f"`{text}` has several values", f"choose one of them: {text}[0]")
    if len(path) == 1 and isinstance(rule, StructRule):
        raise FilterError(f"`{text}` has fields of its own", f"choose one of them: {text}.FIELD")


def check_text(value: str, kind: type, path: FieldPath) -> None:
    """Raise FilterError where no value of a field can be this text."""
    rule = _rule(kind, str(path[0]))
    if len(path) > 1 or not isinstance(rule, IntegerRule | FloatRule | Physical):
        return
    names = getattr(getattr(rule, "named", None), "__members__", None)
    if not names:
        raise FilterError(f"`{value}` is no number", "write it without its unit")
    known = [name.lower() for name in names]
    if "|" not in value and value not in known:
        hint = hint_for(value, known) or f"there are {', '.join(known)}"
        raise FilterError(f"`{path[0]}` is never `{value}`", hint)


def value_at(message: Any, path: FieldPath) -> Any:
    """A field, element or physical value of a message; None where it is not there."""
    return reduce(_step, path, message)


def _step(value: Any, step: str | int) -> Any:
    if isinstance(step, str):
        return getattr(value, step, None)
    return value[step] if isinstance(value, Sequence) and step < len(value) else None


def _names(kind: Any) -> list[str]:
    """The fields of a message and what shows them in another way, without its methods."""
    fields = [attribute(name) for name in kind.__fields__]
    views = [
        name
        for name in dir(kind)
        if name.islower() and name[0] != "_" and not callable(getattr(kind, name))
    ]
    return list(dict.fromkeys([*fields, *views]))


def _rule(kind: Any, name: str) -> Any:
    """What a field holds, or the property that shows it in another way."""
    rules = {attribute(field): rule for field, rule in kind.RULES}
    rule = rules.get(name, getattr(kind, name, None))
    return getattr(rule, "rule", rule)  # What may be absent has a rule for where it is there.
