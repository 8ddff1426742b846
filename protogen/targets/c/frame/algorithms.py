"""Checksum algorithms as C: a register, what a byte does to it, and what is sent in the end."""

from __future__ import annotations

import msgspec

from protogen.c_language.numbers import unsigned_type
from protogen.model.checksums import ChecksumSpec
from protogen.model.types import storage_bits
from protogen.targets.c.frame.crc_plan import register_of
from protogen.targets.c.frame.crc_text import CrcText, constant, crc_text


class Algorithm(msgspec.Struct, frozen=True):
    """One algorithm."""

    function: str
    spec: ChecksumSpec
    type: str
    """The type of the register and of the result."""
    init: str
    steps: tuple[str, ...]
    """Statements that take `byte` into `sum`; those of a CRC are in `crc`."""
    final: str = "sum"
    """The result, made of `sum`."""
    reverses: bool = False
    """True if the result needs its bits reversed."""
    crc: CrcText | None = None
    block: tuple[str, ...] = ()
    """Statements with which hosts take most of `data` first, up to `index`."""


class Checksums(msgspec.Struct, frozen=True):
    """The algorithms of a source."""

    algorithms: tuple[Algorithm, ...]

    @property
    def folded(self) -> tuple[str, ...]:
        """The kinds of those that SSE2 takes sixteen bytes at a time of."""
        return tuple(sorted({c.spec.kind for c in self.algorithms if c.spec.is_folded_byte}))

    @property
    def have_blocks(self) -> bool:
        """True if hosts take several bytes of some of them at once."""
        return any(c.crc is not None or c.block for c in self.algorithms)

    @property
    def entry_bits(self) -> tuple[int, ...]:
        """Bits of the numbers in tables of CRCs; none where there is no CRC."""
        return tuple(sorted({c.crc.bits for c in self.algorithms if c.crc is not None}))


def algorithm_of(spec: ChecksumSpec, function: str) -> Algorithm:
    """The C of an algorithm, under that name."""
    match spec.kind:
        case "xor" | "sum":
            return _folded(spec, function)
        case "fletcher":
            return _fletcher(spec, function)
        case "crc":
            return _crc(spec, function)


_SUMMED_AT_ONCE = 4096
"""Bytes of which no sum of Fletcher's exceeds 32 bits."""


def _fletcher(spec: ChecksumSpec, function: str) -> Algorithm:
    """The low byte is the sum of the bytes, the high byte the sum of those sums."""
    if spec.modulus == 256:
        added: tuple[str, ...] = (
            "const uint8_t low = (uint8_t)(sum + byte);",
            "const uint8_t high = (uint8_t)((sum >> 8) + low);",
        )
    else:  # Modulo 255, what overflows a byte is added again: few machines divide.
        added = (
            "uint8_t low = (uint8_t)(sum + byte);",
            "uint8_t high;",
            "if (low < byte || low == 0xFFU) {",
            "    low++;",
            "}",
            "high = (uint8_t)((sum >> 8) + low);",
            "if (high < low || high == 0xFFU) {",
            "    high++;",
            "}",
        )
    steps = (*added, "sum = (uint16_t)(((uint16_t)high << 8) | low);")
    block = (
        "uint32_t low = sum & 0xFFU;",
        "uint32_t high = (uint32_t)sum >> 8;",
        f"while (size - index >= 4U) {{ /* No sum of {_SUMMED_AT_ONCE} bytes overflows. */",
        f"    const size_t left = size - index > {_SUMMED_AT_ONCE}U ? {_SUMMED_AT_ONCE}U"
        " : size - index;",
        "    const size_t end = index + (left & ~(size_t)3U);",
        "    for (; index < end; index += 4U) {",
        "        const uint8_t *const next = &data[index];",
        "        high += 4U * low + 4U * next[0] + 3U * next[1] + 2U * next[2] + next[3];",
        "        low += (uint32_t)next[0] + next[1] + next[2] + next[3];",
        "    }",
        f"    low %= {spec.modulus}U;",
        f"    high %= {spec.modulus}U;",
        "}",
        "sum = (uint16_t)((high << 8) | low);",
    )
    return Algorithm(function, spec, "uint16_t", "0", steps, block=block)


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
        ones = constant(spec.greatest, 2 * bits)
        steps = (
            f"const {type_} word = ({type_})(({type_})byte << ({shift}));",
            f"const {type_} next = (({type_}){place} + 1U) & {last}U;",
            f"sum = ({type_})(((sum {sign} word) & {ones}) | ({type_})(next << {bits}));",
        )
    init = constant(spec.init, 2 * bits if spec.words else bits)
    return Algorithm(function, spec, type_, init, steps, _result(spec, type_))


def _result(spec: ChecksumSpec, type_: str) -> str:
    """What is sent of a sum or an exclusive or."""
    bits = storage_bits(spec.width)
    is_whole = spec.words is None and spec.width == bits
    result = "sum"
    if spec.negated:
        result = f"({type_})(0U - {result})"
    if spec.xorout:
        result = f"({type_})({result} ^ {constant(spec.xorout, bits)})"
    if spec.mask is not None:
        result = f"({type_})({result} & {constant(spec.mask, bits)})"
    if spec.add:
        result = f"({type_})({result} + {constant(spec.add, bits)})"
    return result if is_whole else f"({type_})({result} & {constant(spec.greatest, bits)})"


def _crc(spec: ChecksumSpec, function: str) -> Algorithm:
    type_, register = unsigned_type(spec.width), register_of(spec)
    result = f"({type_})(sum >> {register.spare})" if register.spare else "sum"
    reverses = spec.refin != spec.refout
    if reverses:
        result = f"{function}_reversed({result})"
    if spec.xorout:
        result = f"({type_})({result} ^ {constant(spec.xorout, register.bits)})"
    init = constant(register.init, register.bits)
    crc = crc_text(spec, function)
    return Algorithm(function, spec, type_, init, (), result, reverses, crc=crc)
