"""What a single value may be: its boundaries, and how to draw any of the others."""

from __future__ import annotations

import math
import struct
from collections import ChainMap
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from random import Random
from typing import Any

from protogen.model.frame import CounterPart, ValuePart
from protogen.model.messages import Message
from protogen.model.types import (
    Array,
    Counted,
    Extent,
    Field,
    Fixed,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)

Scope = ChainMap[str, Any]
"""The values in front, which count and select what follows."""

_USUAL_COUNT = 24
"""Random arrays, texts and bytes are no longer than this where they need not be."""
_GREATEST_COUNT = 1 << 16
"""No sample is longer than this."""
SEVEN_BITS = 0x7F
"""The highest byte that every payload can carry."""
_LAST_OF_ASCII = 0x7F
"""Strict encoding, which the samples are for, takes no character above it."""
_ANY = 1 << 64
"""More than any integer of a schema."""


@dataclass(frozen=True, slots=True)
class Choices:
    """What a value may be: the boundaries, and a function that draws any of the others."""

    boundaries: Sequence[Any]
    draw: Callable[[Random], Any]


def part_choices(part: CounterPart | ValuePart) -> Choices:
    """What the caller may give for a part of the frame."""
    least, greatest = part.least, part.greatest
    return Choices((least, greatest), lambda random: random.randint(least, greatest))


def unspecified_choices(message: Message) -> Choices:
    """The payload of a message of which only the size is known."""
    data = message.fields[0].type
    assert isinstance(data, Octets)
    greatest = min(message.sizes.greatest, _GREATEST_COUNT)
    highest = SEVEN_BITS if data.byte_bits == 7 else 0xFF
    return bytes_choices(message.sizes.least, greatest, highest)


# --- numbers that count or select ----------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Need:
    """What a number has to be because it counts something, or selects one of several cases."""

    least: int
    greatest: int
    cases: tuple[int, ...] = ()
    others: bool = True
    """Whether it may be none of the cases."""

    def also(self, other: Need) -> Need:
        """What it has to be for both reasons."""
        return Need(
            max(self.least, other.least),
            min(self.greatest, other.greatest),
            self.cases + other.cases,
            self.others and other.others,
        )


def needs_of(fields: Sequence[Field]) -> dict[str, Need]:
    """What those behind them and inside of these need of the fields, by the fields' names."""
    return _needs_of_fields(fields)[0]


def _needs_of_fields(fields: Sequence[Field]) -> tuple[dict[str, Need], dict[str, Need]]:
    """What is needed of the fields themselves, and of numbers in front of all of them."""
    own: dict[str, Need] = {}
    needs: dict[str, Need] = {}
    for field in reversed(fields):
        if field.name in needs:
            own[field.name] = needs.pop(field.name)
        for name, need in _needs(field.type):
            needs[name] = needs[name].also(need) if name in needs else need
    return own, needs


def _needs(type: Type) -> Iterator[tuple[str, Need]]:
    match type:
        case Struct(fields=fields):
            yield from _needs_of_fields(fields)[1].items()
        case Array(element=element, extent=extent):
            yield from _needs_of_extent(extent)
            yield from _needs(element)
        case Text(extent=extent) | Octets(extent=extent):
            yield from _needs_of_extent(extent)
        case Switch(selector=selector, cases=cases, rest=rest):
            values = tuple(case.value for case in cases)
            yield selector, Need(-_ANY, _ANY, values, others=rest is not None)
            for case in cases:
                yield from _needs(case.type)


def _needs_of_extent(extent: Extent) -> Iterator[tuple[str, Need]]:
    if isinstance(extent, Counted):
        yield extent.field, Need(extent.least, min(extent.greatest, _GREATEST_COUNT))


# --- single values ------------------------------------------------------------------------------


def scalar_choices(
    field: Field, type: Integer | Float | Text | Octets, scope: Scope, need: Need | None
) -> Choices:
    """What a single value may be; `need` is what others need of it."""
    match type:
        case Integer():
            return _integer_choices(field, type, need)
        case Float():
            return _float_choices(field, type)
        case Text():
            return _text_choices(field, type, scope)
        case Octets():
            return _octets_choices(field, type, scope)


def _integer_choices(field: Field, type: Integer, need: Need | None) -> Choices:
    if isinstance(field.const, int):
        return _only(field.const)
    values = _known(field, type)
    least, greatest = _bounds(field, type)
    closed = type.enum is not None and type.enum.closed
    if not closed:
        near = [value for value in (0, 1, -1) if least <= value <= greatest]
        values = _distinct([*values, least, greatest, *near])
    if need is not None and need.cases:
        return _selecting(values, need)
    if need is not None:
        least, greatest = max(least, need.least), min(greatest, need.greatest)
        values = [value for value in values if least <= value <= greatest]
        values = values if values or closed else _distinct([least, greatest])
        greatest = min(greatest, least + _USUAL_COUNT)
    if closed:
        # Without a value that can be sent, one that the encoder refuses has to do.
        sendable = values or [least]
        return Choices(sendable, lambda random: random.choice(sendable))
    return Choices(values, lambda random: _any_integer(least, greatest, random))


def _selecting(values: Sequence[int], need: Need) -> Choices:
    others = [value for value in values if need.others and value not in need.cases]
    choices = [*need.cases, *others[-1:]]
    return Choices(choices, lambda random: random.choice([*choices, *others]))


def _known(field: Field, type: Integer) -> list[int]:
    """The values that the schema names: of the enum, special ones, single bits and runs of bits."""
    named = [item.value for item in (type.enum.values if type.enum is not None else ())]
    named += [item.value for item in field.special]
    named += [1 << flag.bit for flag in (type.flags.bits if type.flags is not None else ())]
    if not type.signed:
        named += [run.mask for run in type.bit_fields]
    least, greatest = _bounds(field, type)
    special = {item.value for item in field.special}
    return _distinct(value for value in named if least <= value <= greatest or value in special)


def _bounds(field: Field, type: Integer) -> tuple[int, int]:
    if type.role == "bool":
        return 0, 1
    least = type.least if field.least is None else math.ceil(field.least)
    greatest = type.greatest if field.greatest is None else math.floor(field.greatest)
    return max(least, type.least), min(greatest, type.greatest)


def _any_integer(least: int, greatest: int, random: Random) -> int:
    """Any value, small ones as often as large ones."""
    value = random.randint(least, greatest) >> random.randrange((greatest - least).bit_length() + 1)
    return min(max(value, least), greatest)


def _float_choices(field: Field, type: Float) -> Choices:
    if isinstance(field.const, int | float):
        return _only(float(field.const))
    if field.ranged and field.least is not None and field.greatest is not None:
        low = _fitting(field.least, type.bits, math.inf)
        high = _fitting(field.greatest, type.bits, -math.inf)
        # Rounding to 32 bits never leaves two numbers of 32 bits.
        return Choices((low, high), lambda random: _rounded(random.uniform(low, high), type.bits))
    form = "<f" if type.bits == 32 else "<d"
    greatest = (2 - 2**-23) * 2.0**127 if type.bits == 32 else math.ldexp(2 - 2**-52, 1023)
    values = (0.0, -0.0, 1.0, -1.5, greatest, -greatest, math.inf, -math.inf, math.nan)
    return Choices(
        [_json_float(value) for value in values], lambda random: _any_float(form, random)
    )


def _fitting(value: Fraction, bits: int, towards: float) -> float:
    """A number of so many bits that is `value`, or close to it in this direction."""
    rounded = _rounded(float(value), bits)
    sign = 1 if towards > 0 else -1
    if (Fraction(rounded) - value) * sign >= 0:
        return rounded
    if bits == 64:
        return math.nextafter(rounded, towards)
    # One or two steps of 32-bit numbers.
    return _rounded(rounded + sign * max(abs(rounded) * 2**-23, 2**-149), bits)


def _rounded(value: float, bits: int) -> float:
    form = "<f" if bits == 32 else "<d"
    rounded: float = struct.unpack(form, struct.pack(form, value))[0]
    return rounded


def _any_float(form: str, random: Random) -> float | str:
    value: float = struct.unpack(form, random.randbytes(struct.calcsize(form)))[0]
    return _json_float(value)


def _json_float(value: float) -> float | str:
    return value if math.isfinite(value) else str(value)


def _text_choices(field: Field, type: Text, scope: Scope) -> Choices:
    if isinstance(field.const, str):
        return _only(field.const)
    least, greatest = _lengths(type.extent, scope)
    if isinstance(type.extent, Fixed):
        least = 0
    values = [character * greatest for character in ("A", "\n", chr(_LAST_OF_ASCII))]
    return Choices(
        _distinct(["A" * least, *values]),
        lambda random: _any_text(random, _any_length(least, greatest, random)),
    )


def _any_text(random: Random, length: int) -> str:
    # NUL pads a text of a fixed size, so no text has it.
    return "".join(chr(random.randint(1, _LAST_OF_ASCII)) for _ in range(length))


def _octets_choices(field: Field, type: Octets, scope: Scope) -> Choices:
    if isinstance(field.const, bytes):
        return _only(field.const.hex())
    return bytes_choices(*_lengths(type.extent, scope), 0x7F if type.byte_bits == 7 else 0xFF)


def bytes_choices(least: int, greatest: int, highest: int) -> Choices:
    """Bytes of any such length, none of them above `highest`."""
    counting = bytes(index & highest for index in range(greatest))
    values = (bytes(least), bytes(greatest), bytes((highest,)) * greatest, counting)
    return Choices(
        _distinct(value.hex() for value in values),
        lambda random: _any_bytes(random, _any_length(least, greatest, random), highest),
    )


def _any_bytes(random: Random, length: int, highest: int) -> str:
    return bytes(byte & highest for byte in random.randbytes(length)).hex()


def count_choices(extent: Extent, scope: Scope) -> Choices:
    """How many elements there may be."""
    least, greatest = _lengths(extent, scope)
    values = _distinct((least, max(least, min(1, greatest)), greatest))
    return Choices(values, lambda random: _any_length(least, greatest, random))


def _lengths(extent: Extent, scope: Scope) -> tuple[int, int]:
    """The least and the greatest number of elements or bytes."""
    if isinstance(extent, Fixed):
        return extent.count, extent.count
    if isinstance(extent, Counted):
        count = scope.get(extent.field, 0)
        return count, count
    return 0, min(extent.greatest, _GREATEST_COUNT)


def _any_length(least: int, greatest: int, random: Random) -> int:
    return random.randint(least, min(greatest, least + _USUAL_COUNT))


def _only(value: Any) -> Choices:
    return Choices((value,), lambda random: value)


def _distinct(values: Iterable[Any]) -> list[Any]:
    return list(dict.fromkeys(values))
