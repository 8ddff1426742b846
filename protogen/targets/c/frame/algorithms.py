"""Checksum algorithms as C: a register, what a byte does to it, and what is sent in the end."""

from __future__ import annotations

import msgspec

from protogen.model.checksums import ChecksumSpec
from protogen.model.types import storage_bits
from protogen.targets.c.spelling import hexadecimal, unsigned_type


class Algorithm(msgspec.Struct, frozen=True):
    """One algorithm.

    CRCs whose bytes enter most significant bit first are kept in the upper bits of the register, so
    that no width needs a mask.
    """

    function: str
    about: str
    kind: str
    register: str
    """The register's type."""
    result: str
    """The type of the result."""
    width: int
    init: str
    steps: tuple[str, ...]
    """Statements that take `byte` into `sum`."""
    final: str
    """The result, made of `sum`."""
    loops: bool
    """True if the steps need a counter `bit`."""
    reverses: bool
    """True if the result needs its bits reversed."""


def algorithm_of(spec: ChecksumSpec, function: str) -> Algorithm:
    """The C of an algorithm, under that name."""
    makers = {"xor": _xor, "sum": _sum, "fletcher": _fletcher, "crc": _crc}
    return makers[spec.kind](spec, function)


def _xor(spec: ChecksumSpec, function: str) -> Algorithm:
    return _simple(spec, function, "sum = (uint8_t)(sum ^ byte);", "sum")


def _sum(spec: ChecksumSpec, function: str) -> Algorithm:
    final = "(uint8_t)(0U - sum)" if spec.negated else "sum"
    return _simple(spec, function, "sum = (uint8_t)(sum + byte);", final)


def _simple(spec: ChecksumSpec, function: str, step: str, final: str) -> Algorithm:
    init = hexadecimal(spec.init)
    return Algorithm(
        function, spec.name, spec.kind, "uint8_t", "uint8_t", 8, init, (step,), final, False, False
    )


def _fletcher(spec: ChecksumSpec, function: str) -> Algorithm:
    """The low byte is the sum of the bytes, the high byte the sum of those sums."""
    steps = (
        f"const uint8_t low = (uint8_t)(((sum & 0xFFU) + byte) % {spec.modulus}U);",
        f"const uint8_t high = (uint8_t)(((sum >> 8) + low) % {spec.modulus}U);",
        "sum = (uint16_t)((uint16_t)(high << 8) | low);",
    )
    return Algorithm(
        function, spec.name, spec.kind, "uint16_t", "uint16_t", 16, "0", steps, "sum", False, False
    )


def _crc(spec: ChecksumSpec, function: str) -> Algorithm:
    bits = storage_bits(spec.width)
    type_ = unsigned_type(spec.width)
    spare = bits - spec.width
    digits = bits // 4
    if spec.refin:
        poly, init = _reversed(spec.poly, spec.width), _reversed(spec.init, spec.width)
        enter = f"sum = ({type_})(sum ^ byte);"
        advance = (
            f"sum = ({type_})((sum & 1U) != 0U ? "
            f"({type_})(sum >> 1) ^ {_constant(poly, bits, digits)} : ({type_})(sum >> 1));"
        )
        register = "sum"
    else:
        poly, init = spec.poly << spare, spec.init << spare
        entering = "byte" if bits == 8 else f"({type_})(({type_})byte << {bits - 8})"
        enter = f"sum = ({type_})(sum ^ {entering});"
        top, added = (_constant(value, bits, digits) for value in (1 << (bits - 1), poly))
        advance = (
            f"sum = ({type_})((sum & {top}) != 0U ? "
            f"({type_})(({type_})(sum << 1) ^ {added}) : ({type_})(sum << 1));"
        )
        register = f"({type_})(sum >> {spare})" if spare else "sum"
    reverses = spec.refin != spec.refout
    result = f"{function}_reversed({register})" if reverses else register
    if spec.xorout:
        result = f"({type_})({result} ^ {_constant(spec.xorout, bits, digits)})"
    return Algorithm(
        function,
        spec.name,
        spec.kind,
        type_,
        type_,
        spec.width,
        _constant(init, bits, digits),
        (enter, advance),
        result,
        True,
        reverses,
    )


def _constant(value: int, bits: int, digits: int) -> str:
    """Constant of a register's type: `long` is wider than 32 bits on some machines."""
    return f"UINT{bits}_C(0x{value:0{digits}X})" if bits >= 32 else hexadecimal(value, digits)


def _reversed(value: int, width: int) -> int:
    return int(f"{value:0{width}b}"[::-1], 2)
