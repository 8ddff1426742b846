"""The structs of generated C as ctypes has them, by the rules that the C target documents.

Written down a second time on purpose: the target's own views are not used here. Values are those of
JSON lines, as `to_dict` of a generated Python message shows them.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping, Sequence
from typing import Any

from expression_oracle import worked_out

from protogen.model.types import (
    Array,
    Between,
    Extent,
    Field,
    Fill,
    Fixed,
    Float,
    Integer,
    Marked,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
    Until,
)

Values = dict[str, Any]
Scope = dict[str, Any]

_UNSIGNED = {
    8: ctypes.c_uint8,
    16: ctypes.c_uint16,
    32: ctypes.c_uint32,
    64: ctypes.c_uint64,
}
_SIGNED = {8: ctypes.c_int8, 16: ctypes.c_int16, 32: ctypes.c_int32, 64: ctypes.c_int64}


# --- types --------------------------------------------------------------------------------------


def structure_of(fields: Sequence[Field]) -> type[ctypes.Structure]:
    """The struct of a message or struct with these fields."""
    members = [member for field in fields for member in _members(fields, field)]
    return _structure(members)


def _structure(members: list[tuple[str, Any]]) -> type[ctypes.Structure]:
    return type("Record", (ctypes.Structure,), {"_fields_": members})


def _members(fields: Sequence[Field], field: Field) -> list[tuple[str, Any]]:
    if field.const is not None:
        return []
    found = [(flag_name(fields, field), ctypes.c_bool)] if field.optional else []
    if isinstance(_extent(field.type), Between | Fill | Until | Marked):
        found.append((count_name(fields, field), _counting(_extent(field.type))))
    if has_room(field.type):
        found.append((field.name, _type(field.type)))
    return found


def _extent(type_: Type) -> Extent | None:
    return type_.extent if isinstance(type_, Array | Text | Octets) else None


def _counting(extent: Extent | None) -> Any:
    greatest = 0 if extent is None or isinstance(extent, Fixed) else extent.greatest
    return _unsigned(greatest)


def _unsigned(greatest: int) -> Any:
    return next(type_ for bits, type_ in _UNSIGNED.items() if greatest < 1 << bits)


def count_name(fields: Sequence[Field], field: Field) -> str:
    return _free(
        f"{field.name}_{'count' if isinstance(field.type, Array) else 'size'}",
        {other.name for other in fields} | _numbers_around(fields),
    )


def _numbers_around(fields: Sequence[Field]) -> set[str]:
    """The numbers of records around that fields ask for."""
    asked = {path.split(".")[0] for field in fields for path in field.needs}
    return asked - {field.name for field in fields}


def flag_name(fields: Sequence[Field], field: Field) -> str:
    """Whether a field that may be left out is there."""
    counts = {count_name(fields, other) for other in fields}
    return _free(f"has_{field.name}", {other.name for other in fields} | counts)


def rest_name(type_: Switch) -> str:
    return _free("other", {case.name for case in type_.cases})


def _free(name: str, taken: set[str]) -> str:
    found, number = name, 2
    while found in taken:
        found, number = f"{name}_{number}", number + 1
    return found


def has_room(type_: Type) -> bool:
    """True if C stores anything of the type."""
    match type_:
        case Struct(fields=fields):
            return any(_members(fields, field) for field in fields)
        case Array(element=element):
            return has_room(element)
        case Switch(cases=cases, rest=rest):
            return rest is not None or any(has_room(case.type) for case in cases)
        case _:
            return True


def _type(type_: Type) -> Any:
    match type_:
        case Integer(role="bool"):
            return ctypes.c_bool
        case Integer():
            kinds = _SIGNED if type_.signed else _UNSIGNED
            return next(kind for bits, kind in kinds.items() if type_.bits <= bits)
        case Float(bits=bits):
            return ctypes.c_float if bits == 32 else ctypes.c_double
        case Text(extent=extent) | Octets(extent=extent):
            return ctypes.c_uint8 * _room(extent)
        case Struct(fields=fields):
            return structure_of(fields)
        case Array(element=element, extent=extent):
            return _type(element) * _room(extent)
        case Switch():
            return _union(type_)


def _room(extent: Extent) -> int:
    return max(1, extent.count if isinstance(extent, Fixed) else extent.greatest)


def _union(type_: Switch) -> Any:
    members = [(case.name, _type(case.type)) for case in type_.cases if has_room(case.type)]
    if type_.rest is not None:
        size, data = ("size", _unsigned(type_.rest)), ("bytes", ctypes.c_uint8 * max(1, type_.rest))
        members.append((rest_name(type_), _structure([size, data])))
    return type("Cases", (ctypes.Union,), {"_fields_": members})


# --- values into structs ------------------------------------------------------------------------


class Unfit(Exception):  # noqa: N818 - a verdict, not a failure
    """C can't hold the value at all."""


def fill(record: Any, fields: Sequence[Field], values: Mapping[str, Any], scope: Scope) -> None:
    """Put values into a struct."""
    inner = dict(scope)
    for field in fields:
        if field.when is not None and not worked_out(field.when, inner):
            continue
        value = field.const if field.const is not None else values[field.name]
        if field.optional:
            _set(record, flag_name(fields, field), value is not None)
            if value is None:
                continue
        if isinstance(field.type, Integer | Struct):
            inner[field.name] = value
        if field.const is not None:
            continue
        if isinstance(_extent(field.type), Between | Fill | Until | Marked):
            size = len(value) // (2 if isinstance(field.type, Octets) else 1)
            _set(record, count_name(fields, field), size)
        if has_room(field.type):
            _put(record, field.name, field.type, value, inner)


def _put(at: Any, key: Any, type_: Type, value: Any, scope: Scope) -> None:
    match type_:
        case Integer() | Float():
            _set(at, key, float(value) if isinstance(type_, Float) else value)
        case Text():
            _bytes(_get(at, key), value.encode("latin-1"))
        case Octets():
            _bytes(_get(at, key), bytes.fromhex(value))
        case Struct(fields=fields):
            fill(_get(at, key), fields, value, scope)
        case Array(element=element):
            for index, item in enumerate(value):
                _put(_get(at, key), index, element, item, scope)
        case Switch():
            _put_case(_get(at, key), type_, value, scope)


def _put_case(union: Any, type_: Switch, value: Any, scope: Scope) -> None:
    for case in type_.cases:
        if case.value in (worked_out(type_.selector, scope), None):  # That of all others is last.
            if has_room(case.type):
                _put(union, case.name, case.type, value, scope)
            return
    if type_.rest is None:
        return
    rest = getattr(union, rest_name(type_))
    data = bytes.fromhex(value)
    _set(rest, "size", len(data))
    _bytes(rest.bytes, data)


def _get(at: Any, key: Any) -> Any:
    try:
        return at[key] if isinstance(key, int) else getattr(at, key)
    except IndexError:
        raise Unfit from None


def _set(at: Any, key: Any, value: Any) -> None:
    try:
        if isinstance(key, int):
            at[key] = value
        else:
            setattr(at, key, value)
    except IndexError:
        raise Unfit from None
    if _get(at, key) != value and not isinstance(value, float):
        raise Unfit


def _bytes(array: Any, data: bytes) -> None:
    if len(data) > len(array):
        raise Unfit
    array[: len(data)] = list(data)


# --- values out of structs ----------------------------------------------------------------------


class FloatConstant(float):
    """A constant of which C does not keep the sign, where it is 0."""


def read(record: Any, fields: Sequence[Field], scope: Scope) -> Values:
    """The values of a struct."""
    inner = dict(scope)
    found: Values = {}
    for field in fields:
        if (field.when is not None and not worked_out(field.when, inner)) or (
            field.optional and not getattr(record, flag_name(fields, field))
        ):
            found[field.name] = None
        elif field.const is not None:
            found[field.name] = _shown(field.type, field.const)
        else:
            count = 0
            if isinstance(_extent(field.type), Between | Fill | Until | Marked):
                count = getattr(record, count_name(fields, field))
            found[field.name] = _take(record, field.name, field.type, count, inner)
        if isinstance(field.type, Integer | Struct):
            inner[field.name] = found[field.name]
    return found


def _shown(type_: Type, constant: Any) -> Any:
    if isinstance(type_, Integer) and type_.role == "bool":
        return bool(constant)
    if isinstance(type_, Float):
        return FloatConstant(constant)
    if isinstance(constant, bytes):
        return constant.hex()
    return list(constant) if isinstance(constant, tuple) else constant


def _take(at: Any, key: Any, type_: Type, count: int, scope: Scope) -> Any:
    match type_:
        case Integer():
            value = _get(at, key)
            return bool(value) if type_.role == "bool" else value
        case Float():
            value = _get(at, key)
            return value if math.isfinite(value) else str(value)
        case Text(extent=extent):
            data = bytes(_get(at, key))[: _count(extent, count, scope)]
            text = data.decode("latin-1")
            return text.rstrip("\0") if isinstance(extent, Fixed) else text
        case Octets(extent=extent):
            return bytes(_get(at, key))[: _count(extent, count, scope)].hex()
        case Struct(fields=fields):
            return read(_get(at, key) if has_room(type_) else None, fields, scope)
        case Array(element=element, extent=extent):
            elements = _get(at, key) if has_room(element) else None
            number = _count(extent, count, scope)
            return [_take(elements, index, element, 0, scope) for index in range(number)]
        case Switch():
            return _take_case(_get(at, key) if has_room(type_) else None, type_, scope)


def _count(extent: Extent, count: int, scope: Scope) -> int:
    match extent:
        case Fixed(count=number):
            return number
        case Between() | Fill() | Until() | Marked():
            return count
        case _:
            return worked_out(extent.by, scope)


def _take_case(union: Any, type_: Switch, scope: Scope) -> Any:
    for case in type_.cases:
        if case.value in (worked_out(type_.selector, scope), None):  # That of all others is last.
            if isinstance(case.type, Struct) and not case.type.fields:
                return None
            return _take(union, case.name, case.type, 0, scope)
    rest = getattr(union, rest_name(type_))
    return bytes(rest.bytes)[: rest.size].hex()
