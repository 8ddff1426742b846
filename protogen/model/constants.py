"""Bytes of constants, and the values that a field allows."""

from __future__ import annotations

from math import ceil, floor

from protogen.model.types import (
    Array,
    Constant,
    Field,
    Integer,
    NumberType,
    Text,
    Type,
    codec,
)
from protogen.runtime.payload.bits import BitWriter


def constant_bytes(field: Field) -> bytes:
    """The wire bytes of a constant field that is not in a run of bits itself."""
    assert field.const is not None
    if isinstance(field.type, Array) and field.type.packed is not None:
        assert isinstance(field.const, tuple)
        assert isinstance(field.type.element, Integer)
        run = BitWriter(field.type.packed)
        for item in field.const:
            run.put(field.type.element.bits, item)
        return run.finish()
    if isinstance(field.const, tuple):
        return b"".join(raw_bytes(field.element, item) for item in field.const)
    return raw_bytes(field.type, field.const)


def raw_bytes(type_: Type, value: Constant) -> bytes:
    """The wire bytes of one value."""
    if isinstance(value, bytes):
        return value
    if isinstance(value, str):
        padded = type_.padded if isinstance(type_, Text) else None
        return value.encode("latin-1") if padded is None else padded.encode(value)
    assert isinstance(type_, NumberType)
    assert isinstance(value, int | float)
    return codec(type_).encode(type_.raw(value))


def allowed(field: Field, type_: Integer) -> tuple[int, int]:
    """The least and the greatest integer that an encoder allows, special values aside."""
    if not field.ranged:
        return type_.least, type_.greatest
    least = type_.least if field.least is None else ceil(field.least)
    greatest = type_.greatest if field.greatest is None else floor(field.greatest)
    return max(least, type_.least), min(greatest, type_.greatest)
