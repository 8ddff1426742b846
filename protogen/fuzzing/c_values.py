"""Values as the bytes that drivers of generated C exchange.

The members of a struct one after another, numbers in big-endian order and as wide as their members
are, so that the bytes are the same for every machine. Of arrays, texts and bytes only what is in
use; of a union only the case that the selector chooses. `c_walk` writes the same as C.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping, Sequence
from typing import Any, BinaryIO

from protogen.fuzzing.samples import Values
from protogen.model.types import (
    Array,
    Extent,
    Field,
    Fill,
    Fixed,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
    counting_bits,
    storage_bits,
)

Scope = dict[str, int]
"""The numbers in front, which count and select."""


class Unfit(Exception):  # noqa: N818 - a verdict, not a failure
    """No struct can hold the value."""


class Answers:
    """What a driver answered, read from the front."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream

    def take(self, size: int) -> bytes:
        """The next bytes."""
        data = self._stream.read(size)
        if len(data) < size:
            raise EOFError(f"the driver stopped: {size - len(data)} bytes are missing")
        return data

    def number(self, size: int, *, signed: bool = False) -> int:
        """The number of the next bytes."""
        return int.from_bytes(self.take(size), "big", signed=signed)

    def data(self) -> bytes:
        """The next bytes, in front of which their number stands."""
        return self.take(self.number(4))


def number(value: int, size: int, *, signed: bool = False) -> bytes:
    """A number; raises Unfit."""
    try:
        return int(value).to_bytes(size, "big", signed=signed)
    except OverflowError:
        raise Unfit from None


def member_size(type_: Integer | Float) -> int:
    """Bytes of the member that holds such numbers."""
    return storage_bits(type_.bits) // 8


def counting_size(extent: Extent | int) -> int:
    """Bytes of the member that counts elements or bytes."""
    greatest = extent if isinstance(extent, int) else extent.room
    return counting_bits(greatest) // 8


# --- values into bytes ----------------------------------------------------------------------------


def pack(fields: Sequence[Field], values: Mapping[str, Any], scope: Scope | None = None) -> bytes:
    """The bytes of a struct with these values; raises Unfit where no struct can have them."""
    inner = dict(scope or {})
    parts = []
    for field in fields:
        value: Any = values[field.name] if field.const is None else field.const
        if isinstance(field.type, Integer):
            inner[field.name] = int(value)
        if field.const is not None:
            continue
        if field.fills:
            extent = field.type.extent
            assert extent is not None
            size = len(value) // (2 if isinstance(field.type, Octets) else 1)
            parts.append(number(size, counting_size(extent)))
        parts.append(_pack(field.type, value, inner))
    return b"".join(parts)


def _pack(type_: Type, value: Any, scope: Scope) -> bytes:
    match type_:
        case Integer():
            return number(value, member_size(type_), signed=type_.signed)
        case Float():
            return _float_bytes(type_, float(value))
        case Text(extent=extent):
            data = value.encode("latin-1")
            return _padded(data, extent, scope)
        case Octets(extent=extent):
            return _padded(bytes.fromhex(value), extent, scope)
        case Struct(fields=fields):
            return pack(fields, value, scope)
        case Array(element=element, extent=extent):
            if len(value) != _count(extent, len(value), scope) or len(value) > extent.room:
                raise Unfit
            return b"".join(_pack(element, item, scope) for item in value)
        case Switch():
            return _pack_case(type_, value, scope)


def _pack_case(type_: Switch, value: Any, scope: Scope) -> bytes:
    case = type_.case(scope[type_.selector])
    if case is not None:
        return b"" if value is None else _pack(case.type, value, scope)
    if type_.rest is None:
        return b""
    data = bytes.fromhex(value)
    if len(data) > type_.rest:
        raise Unfit
    return number(len(data), counting_size(type_.rest)) + data


def _padded(data: bytes, extent: Extent, scope: Scope) -> bytes:
    size = _count(extent, len(data), scope)
    if len(data) > size or size > extent.room:
        raise Unfit
    return data.ljust(size, b"\0")


def _float_bytes(type_: Float, value: float) -> bytes:
    try:
        return struct.pack(">f" if type_.bits == 32 else ">d", value)
    except OverflowError:
        raise Unfit from None


def _count(extent: Extent, count: int, scope: Scope) -> int:
    match extent:
        case Fixed(count=fixed):
            return fixed
        case Fill():
            return count
        case _:
            return scope[extent.field]


# --- bytes into values ----------------------------------------------------------------------------


def unpack(fields: Sequence[Field], answers: Answers, scope: Scope | None = None) -> Values:
    """The values of a struct."""
    inner = dict(scope or {})
    found: Values = {}
    for field in fields:
        if field.const is not None:
            found[field.name] = _shown(field.type, field.const)
        else:
            count = 0
            if field.fills:
                extent = field.type.extent
                assert extent is not None
                count = answers.number(counting_size(extent))
            found[field.name] = _unpack(field.type, answers, count, inner)
        if isinstance(field.type, Integer):
            inner[field.name] = int(found[field.name])
    return found


def _shown(type_: Type, constant: Any) -> Any:
    """A constant as JSON lines have it."""
    if isinstance(type_, Integer) and type_.role == "bool":
        return bool(constant)
    if isinstance(type_, Float):
        return float(constant)
    if isinstance(constant, bytes):
        return constant.hex()
    return list(constant) if isinstance(constant, tuple) else constant


def _unpack(type_: Type, answers: Answers, count: int, scope: Scope) -> Any:
    match type_:
        case Integer():
            value = answers.number(member_size(type_), signed=type_.signed)
            return bool(value) if type_.role == "bool" else value
        case Float():
            return _float(type_, answers)
        case Text(extent=extent):
            text = answers.take(_count(extent, count, scope)).decode("latin-1")
            return text.rstrip("\0") if isinstance(extent, Fixed) else text
        case Octets(extent=extent):
            return answers.take(_count(extent, count, scope)).hex()
        case Struct(fields=fields):
            return unpack(fields, answers, scope)
        case Array(element=element, extent=extent):
            elements = range(_count(extent, count, scope))
            return [_unpack(element, answers, 0, scope) for _ in elements]
        case Switch():
            return _unpack_case(type_, answers, scope)


def _unpack_case(type_: Switch, answers: Answers, scope: Scope) -> Any:
    case = type_.case(scope[type_.selector])
    if case is None:
        assert type_.rest is not None
        return answers.take(answers.number(counting_size(type_.rest))).hex()
    if isinstance(case.type, Struct) and not case.type.fields:
        return None
    return _unpack(case.type, answers, 0, scope)


def _float(type_: Float, answers: Answers) -> float | str:
    form = ">f" if type_.bits == 32 else ">d"
    value: float = struct.unpack(form, answers.take(type_.bits // 8))[0]
    return value if math.isfinite(value) else str(value)
