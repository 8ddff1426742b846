"""Raw values as people read them: names of values and bits, physical values with their unit."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from math import isfinite
from typing import Any

from protogen.model.meanings import BitField, Flags
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConstantStep,
    FloatStep,
    IntegerStep,
    OptionalStep,
    PayloadPlan,
    RecordStep,
    RegionStep,
    RepeatStep,
)
from protogen.model.payload_walks import said
from protogen.model.types import Field, NumberType, Text

_MOST_ELEMENTS = 16
"""Elements of a list that are shown."""
_MOST_DIGITS = 12
"""A physical value with more decimals than this is rounded to six digits."""


def decimal(value: Fraction) -> str:
    """The number with as many decimals as it has; six digits where they would be too many."""
    if value.denominator == 1:
        return str(value.numerator)
    for digits in range(1, _MOST_DIGITS + 1):
        if (value * 10**digits).denominator == 1:
            return _shifted(value, digits)
    return f"{float(value):.6g}"


def physical(field: Field, raw: int | float, gap: str = "") -> str:
    """The physical value and, behind `gap`, its unit: `50.75deg`."""
    unit = f"{gap}{field.unit}" if field.unit else ""
    if isinstance(raw, float) and not isfinite(raw):
        return f"{raw}{unit}"
    if isinstance(raw, float) and not field.scaled:
        return f"{raw!r}{unit}"
    return f"{decimal(Fraction(raw) * field.scale + field.offset)}{unit}"


def readings(plan: PayloadPlan, values: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the name of each field and its value in one short text without line breaks.

    The values are those of a JSON line: raw numbers, texts, bytes as hex digits, lists, mappings.
    The text of a single value is also what `protogen encode` takes for it.
    """
    return _members(plan.steps, values, ())


_Records = tuple[Mapping[str, Any], ...]
"""The values of the records around, whose numbers choose cases."""


def _members(
    steps: Sequence[AnyStep], values: Mapping[str, Any], around: _Records
) -> Iterator[tuple[str, str]]:
    for step in steps:
        yield step.name, _reading(step, values[step.name], (*around, values))


def _record(steps: Sequence[AnyStep], values: Mapping[str, Any], around: _Records) -> str:
    members = (f"{name}={text}" for name, text in _members(steps, values, around))
    return "{" + ", ".join(members) + "}"


def _reading(step: AnyStep, value: Any, records: _Records) -> str:
    match step:
        case RecordStep():
            return _record(step.steps, value, records)
        case RepeatStep():
            return _elements(step, value, records)
        case ChooseStep():
            return _case(step, value, records)
        case IntegerStep():
            return integer_reading(step, value)
        case FloatStep():
            return physical(step.field, float(value))
        case BytesStep():
            return quoted(value) if isinstance(step.type, Text) else f"hex:{value}"
        case ConstantStep(value=inner) | RegionStep(step=inner):
            return _reading(inner, value, records)
        case OptionalStep():
            return "absent" if value is None else _reading(step.step, value, records)


def _elements(step: RepeatStep, values: Sequence[Any], records: _Records) -> str:
    shown = [_reading(step.element, value, records) for value in values[:_MOST_ELEMENTS]]
    if len(values) > _MOST_ELEMENTS:
        shown.append(f"... {len(values)} in all")
    return "[" + ", ".join(shown) + "]"


def _case(step: ChooseStep, value: Any, records: _Records) -> str:
    by = step.selector
    chosen = step.case(by if isinstance(by, int) else said(by, records))
    if isinstance(chosen, RecordStep):
        return _record(chosen.steps, value or {}, records)
    return f"hex:{value}"


def quoted(text: str) -> str:
    """The text in double quotes, with the escapes of JSON for what can't be printed."""
    return json.dumps(text)


def _flag_names(flags: Flags, value: int) -> str:
    """The names of the bits that are set, and the bits without a name as a number."""
    names = [flag.name for flag in flags.bits if value >> flag.bit & 1]
    unnamed = value & ~sum(1 << flag.bit for flag in flags.bits)
    return "|".join([*names, f"{unnamed:#x}"] if unnamed else names) or "0"


def _run_values(named: Sequence[BitField], unnamed: int, value: int) -> str:
    """Each named run of bits with its value, and the bits without a name as a number."""
    runs = []
    for run in named:
        number = (value & run.mask) >> run.low
        names = {} if run.enum is None else {item.value: item.name for item in run.enum.values}
        runs.append(f"{run.name}={names.get(number, number)}")
        unnamed &= ~run.mask
    return "{" + ", ".join([*runs, f"{unnamed:#x}"] if unnamed else runs) + "}"


def value_name(field: Field, type: NumberType, value: int) -> str | None:
    """The name of a raw value: a special value's, or the enum's; None where it has none."""
    named = (*field.special, *(type.enum.values if type.enum is not None else ()))
    return next((item.name for item in named if item.value == value), None)


def integer_reading(step: IntegerStep, value: int, gap: str = "") -> str:
    """The name of an integer, what its bits mean, or its physical value."""
    type = step.type
    name = value_name(step.field, type, value)
    if name is not None:
        return name
    if type.flags is not None:
        return _flag_names(type.flags, value)
    if type.bit_fields:
        return _run_values(type.bit_fields, value & type.unsigned.greatest, value)
    if type.role == "bool":
        return "true" if value else "false"
    return character(value) if type.role == "char" else physical(step.field, value, gap)


def character(value: int) -> str:
    """The character of that code in quotes, or the number where it can't be printed."""
    return f"'{chr(value)}'" if 0x20 <= value < 0x7F else str(value)


def _shifted(value: Fraction, digits: int) -> str:
    whole = abs(value.numerator * 10**digits // value.denominator)
    sign = "-" if value < 0 else ""
    return f"{sign}{whole // 10**digits}.{whole % 10**digits:0{digits}}"
