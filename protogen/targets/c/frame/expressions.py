"""Fragments of C about the bytes of a frame, as values that one place writes.

Where the size of the payload is kept depends on who asks: a decoder has it as a member, an encoder
as a parameter, and one that knows a single size as a constant. So nothing here holds it; whoever
writes a fragment gives its C.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

import msgspec

from protogen.c_language.numbers import hexadecimal, unsigned_type
from protogen.model.frame_places import Place, Side
from protogen.model.parts import BitsPart, ChecksumPart, MirrorBits, PartType, place_of
from protogen.model.types import NumberType


class Index(msgspec.Struct, frozen=True):
    """An index into the content of a frame."""

    place: Place
    head_size: int

    def at(self, payload: int) -> int:
        """The index in a frame with such a payload."""
        return self.place.at(self.head_size, payload)

    def of(self, payload: str) -> str:
        """The index, where `payload` is the C of the payload's size."""
        place, size = self.place, constant_of(payload)
        if size is not None:
            return f"{self.at(size)}U"
        if place.side is Side.HEAD:
            return f"{place.offset}U"
        if not place.absent:
            return f"{self.head_size + place.offset}U + {payload}"
        left = place.offset - place.absent
        return f"{self.head_size}U + {payload} + ({payload} == 0U ? {left}U : {place.offset}U)"


def constant_of(size: str) -> int | None:
    """The size that a constant in C says; None of any other expression."""
    digits = size.removesuffix("U")
    return int(digits) if digits.isdecimal() else None


def less_absent(place: Place, payload: str) -> str:
    """Bytes taken off an offset of the tail where the payload is empty, with its sign."""
    if place.side is Side.HEAD or not place.absent:
        return ""
    size = constant_of(payload)
    if size is not None:
        return "" if size else f" - {place.absent}U"
    return f" - ({payload} == 0U ? {place.absent}U : 0U)"


def plus(size: int) -> str:
    """A size that is added to what stands in front of it, or taken away where it is below 0."""
    return f" {'-' if size < 0 else '+'} {abs(size)}U" if size else ""


# --- bytes ----------------------------------------------------------------------------------------


def byte(value: int) -> str:
    """A byte in hexadecimal digits."""
    return hexadecimal(value)


def octets(data: bytes) -> str:
    """The bytes of an initialiser."""
    return ", ".join(byte(value) for value in data)


def byte_at(data: bytes, index: str) -> str:
    """The byte of a literal at a place that varies."""
    last = byte(data[-1])
    if len(data) == 1:
        return last
    # Where all are the same, the place is asked for nevertheless: else nothing would use it.
    ends = [i for i, pair in enumerate(pairwise(data)) if pair[0] != pair[1]] or [0]
    chosen = (f"{index} {f'<= {i}U' if i else '== 0U'} ? {byte(data[i])} : " for i in ends)
    return f"({''.join(chosen)}{last})"


def among(values: Sequence[int], at: str) -> str:
    """The condition that a byte is one of these, which are in order."""
    runs: list[tuple[int, int]] = []
    for value in values:
        if runs and runs[-1][1] == value - 1:
            runs[-1] = (runs[-1][0], value)
        else:
            runs.append((value, value))
    found = [_in_run(first, last, at) for first, last in runs]
    return found[0] if len(found) == 1 else f"({' || '.join(f'({item})' for item in found)})"


def _in_run(first: int, last: int, at: str) -> str:
    if first == last:
        return f"{at} == {byte(first)}"
    found = [f"{at} >= {byte(first)}"] if first > 0 else []
    found += [f"{at} <= {byte(last)}"] if last < 255 else []
    return " && ".join(found)


def differs(data: Iterable[int | str], array: str, at: int | str = 0) -> str:
    """The condition that something else than these bytes stands there."""
    return " || ".join(f"{item} != {value}" for item, value in _pairs(data, array, at))


def equals(data: Iterable[int | str], array: str, at: int | str = 0) -> str:
    """The condition that these bytes stand there."""
    return " && ".join(f"{item} == {value}" for item, value in _pairs(data, array, at))


def _pairs(data: Iterable[int | str], array: str, at: int | str) -> Iterable[tuple[str, str]]:
    for offset, value in enumerate(data):
        behind = f"{at} + {offset}U" if offset else at
        index = at + offset if isinstance(at, int) else behind
        yield f"{array}[{index}]", byte(value) if isinstance(value, int) else value


# --- numbers --------------------------------------------------------------------------------------


def wire_bytes(type_: NumberType, value: str) -> tuple[str, ...]:
    """The bytes of an unsigned `value`, in wire order."""
    places = range(0, type_.byte_bits * type_.size, type_.byte_bits)
    mask = " & 0x7FU" if type_.byte_bits == 7 else ""
    items = [_byte_of(value, shift, mask) for shift in places]
    return tuple(items if type_.byte_order == "little" else reversed(items))


def _byte_of(value: str, shift: int, mask: str) -> str:
    shifted = f"({value} >> {shift})" if shift and mask else f"{value} >> {shift}"
    if not shift:
        shifted = value
    return f"(uint8_t)({shifted}{mask})" if shift or mask else f"(uint8_t){value}"


def bits_of(type_: PartType, number: str, carrier_bits: int) -> str:
    """The bits that an integer has in another one, as a number in the type that holds them."""
    low = place_of(type_)
    moved = f"({number} >> {low})" if low else number
    is_top = low + type_.bits == carrier_bits
    masked = moved if is_top else f"({moved} & {hexadecimal(type_.greatest)})"
    return f"({unsigned_type(type_.bits)}){masked}"


def mirrored(item: MirrorBits, number: str) -> str:
    """The bits that follow from a number."""
    if not item.inverted:
        return number
    return f"({unsigned_type(item.type.bits)})({number} ^ {hexadecimal(item.flips)})"


def bytes_of_bits(part: BitsPart, names: Mapping[str, str]) -> tuple[str, ...]:
    """The bytes of a number whose bits are parts, in wire order; those of checksums are 0.

    Each of these parts has its C, and so has each number from which bits follow.
    """
    width = part.type.byte_bits
    items = [_byte_of_bits(part, names, low) for low in range(0, width * part.type.size, width)]
    return tuple(items if part.type.byte_order == "little" else reversed(items))


def _byte_of_bits(part: BitsPart, names: Mapping[str, str], low: int) -> str:
    """The byte of the bits from `low` on."""
    width = part.type.byte_bits
    own = (1 << width) - 1
    fixed, terms = part.fixed >> low & own, []
    if fixed:
        terms.append(byte(fixed))
    for item in (*part.members, *part.mirrors):
        name = (
            mirrored(item, names[item.of.name])
            if isinstance(item, MirrorBits)
            else names[item.name]
        )
        terms += _bits_in_byte(item.type, name, low, width)
    joined = f"(uint8_t)({' | '.join(terms) or '0U'})"
    return f"(uint8_t)({joined} & {byte(own)})" if width == 7 else joined


def _bits_in_byte(type_: PartType, number: str, low: int, width: int) -> list[str]:
    """What bits of a part make of its byte with the bits from `low` on; nothing of some."""
    shift = place_of(type_) - low
    if not -type_.bits < shift < width:
        return []
    operator = "<<" if shift > 0 else ">>"
    return [f"(uint8_t)({number} {operator} {abs(shift)})" if shift else number]


def bits_put(type_: PartType, number: str) -> tuple[tuple[int, str], ...]:
    """The bytes, by their places in the part, that hold its bits of a number; the others are 0."""
    width = type_.byte_bits
    places = range(type_.size) if type_.byte_order == "little" else range(type_.size - 1, -1, -1)
    found = (
        (place, item)
        for index, place in enumerate(places)
        for item in _bits_in_byte(type_, number, index * width, width)
    )
    own = byte((1 << width) - 1)
    return tuple((place, f"({item} & {own})" if width == 7 else item) for place, item in found)


def taken_bits(part: ChecksumPart, result: str) -> str:
    """The bits of a checksum's result that stand in bits of a part."""
    moved = f"({result} >> {part.lowest})" if part.lowest else result
    is_top = part.lowest + part.type.bits == part.algorithm.width
    masked = moved if is_top else f"({moved} & {hexadecimal(part.type.greatest)})"
    return f"({unsigned_type(part.type.bits)}){masked}"


def number_of(type_: NumberType, at: str, offset: int, less: str = "") -> str:
    """The unsigned value of the bytes from `at[offset]` on, padding bits included.

    `less` is C that is put behind each index.
    """
    if type_.size == 1:
        return f"{at}[{offset}{less}]"
    target = unsigned_type(type_.byte_bits * type_.size)
    order = range(type_.size) if type_.byte_order == "little" else range(type_.size - 1, -1, -1)
    terms = []
    for place, index in enumerate(order):
        shift = place * type_.byte_bits
        term = f"({target}){at}[{offset + index}{less}]"
        terms.append(f"({target})({term} << {shift})" if shift else term)
    return f"({target})({' | '.join(terms)})"
