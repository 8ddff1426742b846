"""Raw values as the bytes that lie on the wire."""

from __future__ import annotations

import struct

from protogen.model.types import Array, Constant, Field, Fixed, Float, Integer, Octets, Text, Type
from protogen.runtime.number import Number


def codec(type_: Integer | Float) -> Number:
    """Codec of a number's raw value; of a float it is that of its bits."""
    signed = isinstance(type_, Integer) and type_.signed
    return Number(type_.bits, signed, type_.byte_order, seven_bit=type_.byte_bits == 7)


def number_bytes(type_: Integer, value: int) -> bytes:
    """The unstuffed bytes of a number, in wire order."""
    mask = (1 << type_.byte_bits) - 1
    value &= (1 << type_.bits) - 1
    little = bytes((value >> (type_.byte_bits * place)) & mask for place in range(type_.size))
    return little[::-1] if type_.byte_order == "big" else little


def constant_bytes(field: Field) -> bytes:
    """The wire bytes of a constant field."""
    assert field.const is not None
    return _wire_bytes(field.type, field.const)


def _wire_bytes(type_: Type, value: Constant) -> bytes:
    match type_, value:
        case Integer(), int():
            return codec(type_).encode(int(value))
        case Float(), int() | float():
            return codec(type_).encode(float_bits(type_, value))
        case Text(), str():
            return _padded(type_, value.encode("latin-1"))
        case Octets(), bytes():
            return value
        case Array(element=element), tuple():
            return b"".join(_wire_bytes(element, item) for item in value)
    raise TypeError(f"{value!r} is no constant of {type_!r}")


def float_bits(type_: Float, value: float) -> int:
    """The bits of a float that is that value."""
    form, size = ("<f", 4) if type_.bits == 32 else ("<d", 8)
    return int.from_bytes(struct.pack(form, value)[:size], "little")


def _padded(type_: Text, data: bytes) -> bytes:
    return data.ljust(type_.extent.count, b"\0") if isinstance(type_.extent, Fixed) else data
