"""Packed numbers: expressions that take them out of bytes, and bytes that are made of them.

All shifts are constant, and each byte is moved by itself, so that small controllers have no wide
numbers to shift.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from math import gcd

import msgspec

from protogen.c_language.numbers import constant, hexadecimal, integer_type, unsigned_type
from protogen.model.packing import BytePart, Packing
from protogen.model.payload_plan import AnyStep, Check, RepeatStep
from protogen.model.payload_walks import PackedNumber, packed_numbers
from protogen.model.types import NumberType
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.number_bytes import is_whole

Placed = tuple[PackedNumber, str]
"""A number, and the member that holds it."""


class Group(msgspec.Struct, frozen=True):
    """Elements of an array that take whole bytes together, as often as they do."""

    times: int
    packing: Packing
    numbers: tuple[PackedNumber, ...]


def groups_of(step: RepeatStep) -> Iterator[Group]:
    """Yield what repeats of an array, and what is left behind that."""
    assert isinstance(step.packing, Packing)
    every = tuple(packed_numbers([step]))
    bits = step.packing.bits // len(every)
    size = 8 // gcd(bits, 8)
    times, rest = divmod(len(every), size)
    if times > 1:
        yield Group(times, Packing(step.packing.order, size * bits), every[:size])
    else:
        rest = len(every)
    if rest:
        yield Group(1, Packing(step.packing.order, rest * bits), every[:rest])


def members_of(helpers: Helpers, steps: Iterable[AnyStep], base: str) -> list[Placed]:
    """The numbers of a record whose members begin with `base`, with these members."""
    return [
        (item, base + helpers.member(item.name) + _index(item)) for item in packed_numbers(steps)
    ]


def _index(item: PackedNumber) -> str:
    return "" if item.index is None else f"[{item.index}]"


# --- reading --------------------------------------------------------------------------------------


def number_in(
    helpers: Helpers, packing: Packing, item: PackedNumber, byte: Callable[[int], str]
) -> str:
    """The number that lies in a run; `byte` gives the expression of one of its bytes."""
    type_ = item.step.type
    parts = packing.parts(item.first, type_.bits)
    raw = _joined([_moved_up(part, byte(part.byte), type_) for part in parts])
    if type_.role == "bool":
        return f"({raw}) != 0U"
    number = f"({unsigned_type(type_.bits)})({raw})"
    if not type_.signed:
        return number
    return (
        f"({integer_type(type_)}){number}" if is_whole(type_) else helpers.extended(type_, number)
    )


def _joined(terms: list[str]) -> str:
    """Terms whose bits do not overlap, as one expression."""
    return terms[0] if len(terms) == 1 else " | ".join(map(_in_brackets, terms))


def _moved_up(part: BytePart, byte: str, type_: NumberType) -> str:
    """Bits of a byte at their place in the number."""
    moved = f"{byte} >> {part.at}" if part.at else byte
    if not part.ends_byte:
        moved = f"{_in_brackets(moved)} & {hexadecimal((1 << part.bits) - 1)}"
    if not part.low:
        return moved
    cast = "uint16_t" if type_.bits <= 8 else unsigned_type(type_.bits)
    return f"({cast}){_in_brackets(moved)} << {part.low}"


def _in_brackets(expression: str) -> str:
    """The expression as an operand."""
    return f"({expression})" if " " in expression else expression


def faults_in(
    helpers: Helpers, packing: Packing, items: Iterable[PackedNumber], byte: Callable[[int], str]
) -> Iterator[str]:
    """Conditions under which the bytes of a run hold something that can't be."""
    for item in items:
        if item.constant is None and Check.CLOSED not in item.step.checks:
            continue
        number = number_in(helpers, packing, item, byte)
        if item.constant is not None and item.step.type.role == "bool":
            yield number.replace("!=", "==") if item.constant else number
        elif item.constant is not None:
            yield f"{number} != {constant(item.constant, item.step.type)}"
        else:
            yield f"!{helpers.known(item.step.type)}({number})"
    if packing.padding:
        yield f"({byte(packing.size - 1)} & {hexadecimal(packing.padding)}) != 0U"


# --- writing --------------------------------------------------------------------------------------


def bytes_of(packing: Packing, placed: Sequence[Placed]) -> list[str]:
    """The expression of each byte of a run."""
    known = [0] * packing.size
    terms: list[list[str]] = [[] for _ in known]
    for item, place in placed:
        type_ = item.step.type
        for part in packing.parts(item.first, type_.bits):
            if item.constant is None:
                terms[part.byte].append(_moved_down(part, place, type_))
            else:
                own = item.constant >> part.low & (1 << part.bits) - 1
                known[part.byte] |= own << part.at
    return [_byte(some, own) for some, own in zip(terms, known, strict=True)]


def _byte(terms: list[str], known: int) -> str:
    """A byte of terms, and of bits that are always the same."""
    if not terms:
        return hexadecimal(known)
    # Bytes are signed ints where they meet, so this is one, too.
    constants = [f"0x{known:02X}"] if known else []
    if len(terms) + len(constants) > 1:
        terms = [f"(uint8_t){_in_brackets(term)}" for term in terms]
    return f"(uint8_t)({' | '.join(terms + constants)})"


def _moved_down(part: BytePart, place: str, type_: NumberType) -> str:
    """Bits of a number at their place in a byte; the cast to a byte cuts off those above it."""
    is_raw = not type_.signed and type_.role != "bool"
    moved = place if is_raw else f"({unsigned_type(type_.bits)}){place}"
    if part.low:
        moved = f"{moved} >> {part.low}"
    ends_number = is_raw and part.low + part.bits == type_.bits
    if not part.ends_byte and not ends_number:
        moved = f"{_in_brackets(moved)} & {hexadecimal((1 << part.bits) - 1)}"
    if part.at:
        moved = f"{_in_brackets(moved)} << {part.at}"
    return moved
