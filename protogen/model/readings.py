"""Raw values as people read them: names of values and bits, physical values with their unit."""

from __future__ import annotations

import json
from collections import ChainMap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

from protogen.model.types import (
    Array,
    Extent,
    Field,
    Fill,
    Fixed,
    Flags,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)

Scope = ChainMap[str, Any]
"""The values of the fields in front, which choose the cases of switches."""

_MOST_ELEMENTS = 16
"""Elements of a list that are shown."""
_MOST_DIGITS = 12
"""A physical value with more decimals than this is rounded to six digits."""


def type_name(type: Type) -> str:
    """The type in the words of the schema language, such as `uint16 big` or `sint14[3]`."""
    match type:
        case Integer() | Float():
            order = "" if type.size == 1 else f" {type.byte_order}"
            return f"{_number_name(type)}{order}"
        case Text(extent=extent) | Octets(extent=extent):
            return f"{'ascii' if isinstance(type, Text) else 'bytes'}[{extent_name(extent)}]"
        case Array(element=element, extent=extent):
            return f"{type_name(element)}[{extent_name(extent)}]"
        case Struct(name=name):
            return name
        case Switch(selector=selector):
            return f"switch({selector})"


def extent_name(extent: Extent) -> str:
    """How many, in the words of the schema language: a number, a field's name or `fill`."""
    match extent:
        case Fixed(count=count):
            return str(count)
        case Fill():
            return "fill"
        case _:
            return extent.field


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
    if isinstance(raw, float) and not _finite(raw):
        return f"{raw}{unit}"
    if isinstance(raw, float) and not field.scaled:
        return f"{raw!r}{unit}"
    return f"{decimal(Fraction(raw) * field.scale + field.offset)}{unit}"


def readings(
    fields: Iterable[Field], values: Mapping[str, Any], around: Scope | None = None
) -> Iterator[tuple[str, str]]:
    """Yield the name of each field and its value in one short text without line breaks.

    The values are those of a JSON line: raw numbers, texts, bytes as hex digits, lists, mappings.
    The text of a single value is also what `protogen encode` takes for it.
    """
    scope = ChainMap({}, *(around.maps if around is not None else ()))
    for field in fields:
        scope[field.name] = values[field.name]
        yield field.name, _reading(field, field.type, values[field.name], scope)


def _reading(field: Field, type: Type, value: Any, scope: Scope) -> str:
    match type:
        case Struct(fields=fields):
            return _members(fields, value, scope)
        case Array():
            return _elements(field, type, value, scope)
        case Switch():
            return _case(type, value, scope)
        case Integer():
            return integer_reading(field, type, value)
        case _:
            return _other(field, type, value)


def _other(field: Field, type: Float | Text | Octets, value: Any) -> str:
    if isinstance(type, Float):
        return physical(field, float(value))
    return quoted(value) if isinstance(type, Text) else f"hex:{value}"


def _members(fields: Iterable[Field], values: Mapping[str, Any], scope: Scope) -> str:
    members = (f"{name}={text}" for name, text in readings(fields, values, scope))
    return "{" + ", ".join(members) + "}"


def _elements(field: Field, type: Array, values: Sequence[Any], scope: Scope) -> str:
    shown = [_reading(field, type.element, value, scope) for value in values[:_MOST_ELEMENTS]]
    if len(values) > _MOST_ELEMENTS:
        shown.append(f"... {len(values)} in all")
    return "[" + ", ".join(shown) + "]"


def _case(type: Switch, value: Any, scope: Scope) -> str:
    chosen = scope[type.selector]
    for case in type.cases:
        if case.value == chosen and isinstance(case.type, Struct):
            return _members(case.type.fields, value or {}, scope)
    return f"hex:{value}"


def quoted(text: str) -> str:
    """The text in double quotes, with the escapes of JSON for what can't be printed."""
    return json.dumps(text)


def flag_names(flags: Flags, value: int) -> str:
    """The names of the bits that are set, and the bits without a name as a number."""
    names = [flag.name for flag in flags.bits if value >> flag.bit & 1]
    unnamed = value & ~sum(1 << flag.bit for flag in flags.bits)
    return "|".join([*names, f"{unnamed:#x}"] if unnamed else names) or "0"


def bit_field_readings(type: Integer, value: int) -> str:
    """Each named run of bits with its value, and the bits without a name as a number."""
    runs = []
    unnamed = value & ((1 << type.bits) - 1)
    for run in type.bit_fields:
        number = (value & run.mask) >> run.low
        names = {} if run.enum is None else {item.value: item.name for item in run.enum.values}
        runs.append(f"{run.name}={names.get(number, number)}")
        unnamed &= ~run.mask
    return "{" + ", ".join([*runs, f"{unnamed:#x}"] if unnamed else runs) + "}"


def value_name(field: Field, type: Integer, value: int) -> str | None:
    """The name of a raw value: a special value's, or the enum's; None where it has none."""
    named = (*field.special, *(type.enum.values if type.enum is not None else ()))
    return next((item.name for item in named if item.value == value), None)


def integer_reading(field: Field, type: Integer, value: int, gap: str = "") -> str:
    """The name of an integer, what its bits mean, or its physical value."""
    name = value_name(field, type, value)
    if name is not None:
        return name
    if type.flags is not None:
        return flag_names(type.flags, value)
    if type.bit_fields:
        return bit_field_readings(type, value)
    if type.role == "bool":
        return "true" if value else "false"
    return character(value) if type.role == "char" else physical(field, value, gap)


def character(value: int) -> str:
    """The character of that code in quotes, or the number where it can't be printed."""
    return f"'{chr(value)}'" if 0x20 <= value < 0x7F else str(value)


def _number_name(type: Integer | Float) -> str:
    if isinstance(type, Float):
        return f"float{type.bits}"
    return f"{'s' if type.signed else 'u'}int{type.bits}" if type.role == "number" else type.role


def _shifted(value: Fraction, digits: int) -> str:
    whole = abs(value.numerator * 10**digits // value.denominator)
    sign = "-" if value < 0 else ""
    return f"{sign}{whole // 10**digits}.{whole % 10**digits:0{digits}}"


def _finite(value: float) -> bool:
    return value - value == 0
