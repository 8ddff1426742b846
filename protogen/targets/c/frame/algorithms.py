"""Checksum algorithms as C: a register, what a byte does to it, and what is sent in the end."""

from __future__ import annotations

import msgspec

from protogen.c_language.numbers import hexadecimal, unsigned_type
from protogen.model.checksums import ChecksumSpec
from protogen.model.types import storage_bits


class Algorithm(msgspec.Struct, frozen=True):
    """One algorithm.

    CRCs whose bytes enter most significant bit first are kept in the upper bits of the register, so
    that no width needs a mask.
    """

    function: str
    spec: ChecksumSpec
    type: str
    """The type of the register and of the result."""
    init: str
    steps: tuple[str, ...]
    """Statements that take `byte` into `sum`; of a CRC, the second is done for each bit."""
    final: str = "sum"
    """The result, made of `sum`."""
    reverses: bool = False
    """True if the result needs its bits reversed."""


def algorithm_of(spec: ChecksumSpec, function: str) -> Algorithm:
    """The C of an algorithm, under that name."""
    match spec.kind:
        case "xor" | "sum":
            return _folded(spec, function)
        case "fletcher":
            # The low byte is the sum of the bytes, the high byte the sum of those sums.
            steps = (
                f"const uint8_t low = (uint8_t)(((sum & 0xFFU) + byte) % {spec.modulus}U);",
                f"const uint8_t high = (uint8_t)(((sum >> 8) + low) % {spec.modulus}U);",
                "sum = (uint16_t)((uint16_t)(high << 8) | low);",
            )
            return Algorithm(function, spec, "uint16_t", "0", steps)
        case "crc":
            return _crc(spec, function)


def _folded(spec: ChecksumSpec, function: str) -> Algorithm:
    """A sum or an exclusive or. Of words, the upper half of the register counts the bytes."""
    bits = storage_bits(spec.width)
    sign = "^" if spec.kind == "xor" else "+"
    if spec.words is None:
        type_ = unsigned_type(bits)
        steps: tuple[str, ...] = (f"sum = ({type_})(sum {sign} byte);",)
    else:
        type_ = unsigned_type(2 * bits)
        place, last = f"(sum >> {bits})", spec.width // 8 - 1
        shift = f"8U * {place}" if spec.words == "little" else f"8U * ({last}U - {place})"
        ones = _constant(spec.greatest, 2 * bits)
        steps = (
            f"const {type_} word = ({type_})(({type_})byte << ({shift}));",
            f"const {type_} next = (({type_}){place} + 1U) & {last}U;",
            f"sum = ({type_})(((sum {sign} word) & {ones}) | ({type_})(next << {bits}));",
        )
    init = _constant(spec.init, 2 * bits if spec.words else bits)
    return Algorithm(function, spec, type_, init, steps, _result(spec, type_))


def _result(spec: ChecksumSpec, type_: str) -> str:
    """What is sent of a sum or an exclusive or."""
    bits = storage_bits(spec.width)
    is_whole = spec.words is None and spec.width == bits
    result = "sum"
    if spec.negated:
        result = f"({type_})(0U - {result})"
    if spec.xorout:
        result = f"({type_})({result} ^ {_constant(spec.xorout, bits)})"
    if spec.mask is not None:
        result = f"({type_})({result} & {_constant(spec.mask, bits)})"
    if spec.add:
        result = f"({type_})({result} + {_constant(spec.add, bits)})"
    return result if is_whole else f"({type_})({result} & {_constant(spec.greatest, bits)})"


def _crc(spec: ChecksumSpec, function: str) -> Algorithm:
    bits = storage_bits(spec.width)
    type_ = unsigned_type(spec.width)
    spare = bits - spec.width
    register = "sum"
    if spec.refin:
        poly, init = _reversed(spec.poly, spec.width), _reversed(spec.init, spec.width)
        entering, first, shifted = "byte", "1U", f"({type_})(sum >> 1)"
        divided = f"{shifted} ^ {_constant(poly, bits)}"
    else:
        poly, init = spec.poly << spare, spec.init << spare
        entering = "byte" if bits == 8 else f"({type_})(({type_})byte << {bits - 8})"
        first, shifted = _constant(1 << (bits - 1), bits), f"({type_})(sum << 1)"
        divided = f"({type_})({shifted} ^ {_constant(poly, bits)})"
        register = f"({type_})(sum >> {spare})" if spare else "sum"
    advance = f"sum = ({type_})((sum & {first}) != 0U ? {divided} : {shifted});"
    reverses = spec.refin != spec.refout
    result = f"{function}_reversed({register})" if reverses else register
    if spec.xorout:
        result = f"({type_})({result} ^ {_constant(spec.xorout, bits)})"
    steps = (f"sum = ({type_})(sum ^ {entering});", advance)
    return Algorithm(function, spec, type_, _constant(init, bits), steps, result, reverses)


def _constant(value: int, bits: int) -> str:
    """Constant of a register's type: `long` is wider than 32 bits on some machines."""
    digits = bits // 4
    return f"UINT{bits}_C(0x{value:0{digits}X})" if bits >= 32 else hexadecimal(value, digits)


def _reversed(value: int, width: int) -> int:
    return int(f"{value:0{width}b}"[::-1], 2)
