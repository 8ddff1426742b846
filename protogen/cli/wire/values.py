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
from protogen.cli.wire.hints import chosen_case, members, value_in
from protogen.cli.wire.scalars import (
    float_value,
    from_json,
    integer_value,
    octets_value,
    text_value,
)
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    FloatStep,
    IntegerStep,
    OptionalStep,
    RecordStep,
    RepeatStep,
)
from protogen.model.payload_walks import held_step, without_constant
from protogen.model.types import Field, Text
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


def raw_values(steps: Sequence[AnyStep], written: Mapping[str, Any]) -> dict[str, Raw]:
    """Return the raw values of fields by name.

    Raises UsageError with the path of the field, what is allowed, and what was probably meant.
    Whether a value is in its range is for the encoder to say.
    """
    return _members(steps, written, "", ChainMap())


def _members(
    steps: Sequence[AnyStep], written: Mapping[str, Any], prefix: str, scope: Scope
) -> dict[str, Raw]:
    names = [step.name for step in steps]
    for name in written:
        if name not in names:
            hint = hint_for(name, names) or f"there are {', '.join(names) or 'none'}"
            raise UsageError(f"there is no field `{prefix}{name}`", hint)
    values: dict[str, Raw] = {}
    for step in steps:
        bare = without_constant(held_step(step))
        if step.name in written:
            value = _value(bare, written[step.name], prefix + step.name, scope)
            values[step.name] = scope[step.name] = value
        elif isinstance(bare, ChooseStep) and _is_empty(chosen_case(bare, scope)):
            values[step.name] = None
        elif not isinstance(step, OptionalStep):
            scope[step.name] = _what_is_sent(step.field)
    return values


def _is_empty(case: AnyStep | None) -> bool:
    """True for a case that has nothing to give."""
    return isinstance(case, RecordStep) and not case.steps


def _what_is_sent(field: Field) -> Raw:
    """Return what an encoder sends for a field without a value, as far as a switch may ask it."""
    value = field.default if field.const is None else field.const
    return value if isinstance(value, int) else None


def _value(step: AnyStep, written: Any, path: str, scope: Scope) -> Raw:
    match step:
        case RecordStep():
            given = _mapping(written, step, path)
            return _members(step.steps, given, f"{path}.", scope.new_child())
        case RepeatStep():
            return [
                _value(step.element, item, f"{path}[{index}]", scope)
                for index, item in enumerate(_list(written, path))
            ]
        case ChooseStep():
            return _case(step, written, path, scope)
        case IntegerStep():
            return integer_value(step, written, path)
        case FloatStep():
            return float_value(step.field, written, path)
        case BytesStep(type=Text()):
            return text_value(written, path)
        case _:
            return octets_value(written, path).hex()


def _case(step: ChooseStep, written: Any, path: str, scope: Scope) -> Raw:
    case = chosen_case(step, scope)
    if case is not None:
        return None if _is_empty(case) else _value(case, written, path, scope)
    if value_in(step.expression, scope) is None:
        raise UsageError(f"{path}: `{step.expression.text}` says what this is; give it, too")
    return octets_value(written, path).hex()


# --- what a list or a struct is written as ------------------------------------------------------


def _mapping(written: Any, record: RecordStep, path: str) -> Mapping[str, Any]:
    is_json = isinstance(written, str) and written.lstrip().startswith("{")
    value = from_json(written, path) if is_json else written
    if isinstance(value, Mapping):
        return value
    if len(record.steps) == 1:
        return {record.steps[0].name: value}
    raise UsageError(f"{path}: `{written}` is no struct", f"give {members(record, path)}")


def _list(written: Any, path: str) -> Sequence[Any]:
    if isinstance(written, str) and not written.lstrip().startswith(("[", "{")):
        return written.split(",") if written else []
    value = from_json(written, path) if isinstance(written, str) else written
    if isinstance(value, list):
        return value
    raise UsageError(f"{path}: a list is written `1,2,3` or as JSON, such as [1, 2, 3]")
