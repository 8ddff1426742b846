"""The plan of a CRC as C: the statements of its step, its table, and the loop of hosts."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from protogen.c_language.numbers import hexadecimal, unsigned_type
from protogen.model.checksums import ChecksumSpec
from protogen.targets.c.frame.crc_plan import BLOCK, CrcPlan, Register, Shifts, crc_plan

_PER_LINE = {8: 8, 16: 8, 32: 4, 64: 2}
"""Numbers on a line of a table, by their bits."""
_BLOCK_BYTES = ("first", "second", "third", "fourth")


class CrcText(msgspec.Struct, frozen=True):
    """How a CRC takes bytes, in each of the ways that a user can choose."""

    bits: int
    """Bits of the register."""
    entering: str
    """Statement that takes a byte in; `advance` follows for each of its bits."""
    advance: str
    step: tuple[str, ...]
    """Statements that take a byte at once."""
    by_words: tuple[str, ...]
    """Others for machines that shift words as fast as bytes; empty if there are none."""
    shifts: bool
    """True if the step needs no table, which only hosts have then."""
    table: tuple[str, ...]
    """Lines of the table for bytes behind which no more are taken."""
    block_table: tuple[str, ...]
    """Lines of those behind which one to three are, for hosts."""
    block: tuple[str, ...]
    """Statements that take four bytes."""


def crc_text(spec: ChecksumSpec, function: str) -> CrcText:
    """The C of a CRC whose functions' names begin so."""
    plan = crc_plan(spec)
    register = plan.register
    type_ = unsigned_type(register.bits)
    entering = _into_top("byte", register)
    shifts = plan.shifts
    return CrcText(
        bits=register.bits,
        entering=f"sum = ({type_})(sum ^ {entering});",
        advance=_advance(register),
        step=tuple(_by_shifts(register, shifts) if shifts else _by_table(plan, function)),
        by_words=tuple(_by_words(register, shifts)) if shifts and register.bits > 8 else (),
        shifts=shifts is not None,
        table=tuple(_table(plan, range(1))),
        block_table=tuple(_table(plan, range(1, BLOCK))),
        block=tuple(_block(register, function)),
    )


def constant(value: int, bits: int) -> str:
    """Constant of a register's type: `long` is wider than 32 bits on some machines."""
    digits = bits // 4
    return f"UINT{bits}_C(0x{value:0{digits}X})" if bits >= 32 else hexadecimal(value, digits)


def _into_top(byte: str, register: Register) -> str:
    """A byte where the register takes it."""
    if register.reflected or register.bits == 8:
        return byte
    type_ = unsigned_type(register.bits)
    return f"({type_})(({type_}){byte} << {register.bits - 8})"


def _advance(register: Register) -> str:
    bits, type_ = register.bits, unsigned_type(register.bits)
    if register.reflected:
        first, shifted = "1U", f"({type_})(sum >> 1)"
        divided = f"{shifted} ^ {constant(register.poly, bits)}"
    else:
        first, shifted = constant(1 << (bits - 1), bits), f"({type_})(sum << 1)"
        divided = f"({type_})({shifted} ^ {constant(register.poly, bits)})"
    return f"sum = ({type_})((sum & {first}) != 0U ? {divided} : {shifted});"


def _byte_of(register: Register, index: int) -> str:
    """The byte of the register that the next byte meets, or the one that meets a later one."""
    place = 8 * index if register.reflected else register.bits - 8 * (index + 1)
    return f"(sum >> {place})" if place else "sum"


def _rest(register: Register, bytes_: int) -> str:
    """What the register has left when so many bytes were shifted out; empty if that is nothing."""
    if 8 * bytes_ >= register.bits:
        return ""
    return f"(sum {'>>' if register.reflected else '<<'} {8 * bytes_})"


def _by_table(plan: CrcPlan, function: str) -> Iterator[str]:
    register = plan.register
    type_ = unsigned_type(register.bits)
    left = f"{function}_after((uint8_t)({_byte_of(register, 0)} ^ byte), 0U)"
    rest = _rest(register, 1)
    yield f"sum = ({type_})({rest} ^ {left});" if rest else f"sum = {left};"


def _by_shifts(register: Register, shifts: Shifts) -> Iterator[str]:
    """One statement for each byte of the register: small machines shift bytes best."""
    yield f"const uint8_t out = (uint8_t)({_byte_of(register, 0)} ^ byte);"
    yield f"const uint8_t factor = (uint8_t)({_xored('out', shifts.quotient)});"
    if register.bits == 8:
        yield f"sum = (uint8_t)({_xored('factor', shifts.product)});"
        return
    low, high = (_xored("factor", tuple(s - 8 * i for s in shifts.product)) for i in range(2))
    if register.reflected:
        low = f"(uint8_t)(sum >> 8) ^ {low}"
    else:
        high = f"(uint8_t)sum ^ {high}"
    yield f"const uint8_t high = (uint8_t)({high});"
    yield f"const uint8_t low = (uint8_t)({low});"
    yield "sum = (uint16_t)(((uint16_t)high << 8) | low);"


def _by_words(register: Register, shifts: Shifts) -> Iterator[str]:
    """Statements for the whole register. What is above a byte of `out` reaches no factor."""
    type_ = unsigned_type(register.bits)
    quotient = " ^ ".join(_moved("out", shift) for shift in shifts.quotient)
    wide = f"({type_})factor"
    terms = [
        _moved(wide if shift > 0 else "factor", shift) for shift in shifts.product if shift > -8
    ]
    yield f"const {type_} out = ({type_})({_byte_of(register, 0)} ^ byte);"
    yield f"const uint8_t factor = (uint8_t)({quotient});"
    yield f"const {type_} rest = ({type_}){_rest(register, 1)};"
    yield f"sum = ({type_})({' ^ '.join(['rest', *terms])});"


def _moved(number: str, shift: int) -> str:
    """The shift of a number that has room for it."""
    if not shift:
        return number
    return f"({number} {'<<' if shift > 0 else '>>'} {abs(shift)})"


def _xored(name: str, shifts: tuple[int, ...]) -> str:
    """The shifts of a byte that leave something of it in a byte; polynomials may have few."""
    return " ^ ".join(_shifted(name, shift) for shift in shifts if abs(shift) < 8) or "0U"


def _shifted(name: str, shift: int) -> str:
    if not shift:
        return name
    return f"(uint8_t)({name} << {shift})" if shift > 0 else f"({name} >> {-shift})"


def _table(plan: CrcPlan, rows: range) -> Iterator[str]:
    for row in rows:
        low, high = plan.table[row]
        yield from _numbers(low, plan.register.bits, "{{", "},")
        yield from _numbers(high, plan.register.bits, " {", "}},")


def _numbers(values: tuple[int, ...], bits: int, opening: str, closing: str) -> Iterator[str]:
    """Lines of an initialiser."""
    each = _PER_LINE[bits]
    for first in range(0, len(values), each):
        line = ", ".join(constant(value, bits) for value in values[first : first + each])
        is_last = first + each == len(values)
        yield f"{opening if not first else '  '}{line}{closing if is_last else ','}"


def _block(register: Register, function: str) -> Iterator[str]:
    type_ = unsigned_type(register.bits)
    for index, name in enumerate(_BLOCK_BYTES):
        taken = f"data[index + {index}U]" if index else "data[index]"
        if 8 * index < register.bits:
            taken = f"(uint8_t)({_byte_of(register, index)} ^ {taken})"
        yield f"const uint8_t {name} = {taken};"
    yield f"{type_} next = {_rest(register, BLOCK) or '0'};"
    for index, name in enumerate(_BLOCK_BYTES):
        left = f"{function}_after({name}, {BLOCK - 1 - index}U)"
        yield f"next = ({type_})(next ^ {left});"
    yield "sum = next;"
