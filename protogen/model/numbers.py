"""Numbers as the bytes that lie on the wire: raw values, constants, checksums."""

from __future__ import annotations

from functools import cache

from protogen.model.checksums import ChecksumSpec
from protogen.model.types import Constant, Field, Fixed, NumberType, Text, Type
from protogen.runtime import checksum as sums
from protogen.runtime.payload.number import Number


def codec(type_: NumberType) -> Number:
    """Codec of a number's raw value; of a float it is that of its bits."""
    return Number(type_.bits, type_.signed, type_.byte_order, seven_bit=type_.byte_bits == 7)


@cache
def checksum_of(spec: ChecksumSpec) -> sums.Checksum:
    """Implementation of a checksum algorithm."""
    match spec.kind:
        case "xor":
            return sums.Xor8(spec.init)
        case "sum":
            return sums.Sum8(spec.init, spec.negated)
        case "fletcher":
            return sums.Fletcher16(spec.modulus)
        case "crc":
            return sums.Crc(spec.width, spec.poly, spec.init, spec.refin, spec.refout, spec.xorout)


def number_bytes(type_: NumberType, value: int) -> bytes:
    """The unstuffed bytes of a number, in wire order."""
    mask = (1 << type_.byte_bits) - 1
    value &= (1 << type_.bits) - 1
    little = bytes((value >> (type_.byte_bits * place)) & mask for place in range(type_.size))
    return little[::-1] if type_.byte_order == "big" else little


def constant_bytes(field: Field) -> bytes:
    """The wire bytes of a constant field."""
    assert field.const is not None
    if isinstance(field.const, tuple):
        return b"".join(_wire_bytes(field.element, item) for item in field.const)
    return _wire_bytes(field.type, field.const)


def _wire_bytes(type_: Type, value: Constant) -> bytes:
    if isinstance(value, bytes):
        return value
    if isinstance(value, str):
        is_padded = isinstance(type_, Text) and isinstance(type_.extent, Fixed)
        return value.encode("latin-1").ljust(type_.sizes.least if is_padded else 0, b"\0")
    assert isinstance(type_, NumberType)
    assert isinstance(value, int | float)
    return codec(type_).encode(type_.raw(value))
