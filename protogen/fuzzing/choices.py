"""Choices for single values: the boundaries, and draws of any other value."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from functools import lru_cache
from random import Random
from typing import Any

import msgspec

from protogen.model.expression_bounds import linear
from protogen.model.expressions import Number, Operand, every, operands
from protogen.model.identities import Runs
from protogen.model.messages import Message
from protogen.model.parts import ChoicePart, CounterPart, IdentityPart, ValuePart
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    Check,
    ChooseStep,
    ConditionalPresence,
    ConstantStep,
    Count,
    FloatStep,
    Formula,
    IntegerStep,
    OptionalStep,
    PartStep,
    RecordStep,
    Reference,
    RegionStep,
    RepeatStep,
)
from protogen.model.sizes import SizeSet
from protogen.model.types import Fixed, Text

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


class Choices(msgspec.Struct, frozen=True):
    """Boundaries of a value, and a function that draws any other."""

    boundaries: Sequence[Any]
    draw: Callable[[Random], Any]


def any_of(values: Sequence[Any]) -> Choices:
    """Choices for what is one of some values, all of which are boundaries."""
    return Choices(values, lambda random: random.choice(values))


def part_choices(part: CounterPart | ValuePart) -> Choices:
    """Choices for a part of the frame that the caller gives."""
    if isinstance(part, ChoicePart):
        values = tuple(map(part.shown, part.values))
        return Choices(values, lambda random: random.choice(values))
    if part.type.is_text:
        return _text_part_choices(part.type.size, part.between)
    least, greatest = part.least, part.greatest
    return Choices((least, greatest), lambda random: random.randint(least, greatest))


def _text_part_choices(size: int, between: tuple[int, int] | None) -> Choices:
    if between is not None:
        ends = [chr(character) * size for character in between]
        return Choices(
            ends, lambda random: "".join(chr(random.randint(*between)) for _ in range(size))
        )
    texts = [character * size for character in ("A", "\n", chr(_LAST_OF_ASCII))]
    return Choices(["", *texts], lambda random: _any_text(random, random.randint(0, size)))


def run_choices(part: IdentityPart, runs: Runs) -> Choices:
    """Choices for an identity part of which a message has several values."""
    ends = tuple(dict.fromkeys(part.shown(end) for run in runs for end in run))
    return Choices(ends, lambda random: part.shown(random.randint(*random.choice(runs))))


def unspecified_choices(message: Message, sizes: SizeSet) -> Choices:
    """The payload of a message of which only the sizes are known."""
    seven = Check.SEVEN_BIT in message.plan.checks
    greatest = min(sizes.greatest, max(sizes.least, _GREATEST_COUNT))
    return bytes_choices(sizes.least, greatest, SEVEN_BITS if seven else 0xFF)


# --- numbers that count or select ----------------------------------------------------------------


class Run(msgspec.Struct, frozen=True):
    """A run of bits of a number, which has to select one of several cases."""

    low: int
    high: int
    cases: tuple[int, ...]

    def selecting(self, value: int) -> int:
        """The value with one of the cases in the run."""
        mask = (1 << self.high + 1) - (1 << self.low)
        chosen = (value & mask) >> self.low
        case = chosen if chosen in self.cases else self.cases[value % len(self.cases)]
        return value & ~mask | case << self.low


class Need(msgspec.Struct, frozen=True):
    """Bounds of a number because it counts something, or selects one of several cases."""

    least: int = -_ANY
    greatest: int = _ANY
    cases: tuple[int, ...] = ()
    others: bool = True
    """True if it may be none of the cases."""
    near: tuple[int, ...] = ()
    """Further values that make a difference."""
    runs: tuple[Run, ...] = ()
    """Runs of its bits that select."""

    @property
    def is_bounded(self) -> bool:
        """True if not every number will do."""
        return (self.least, self.greatest) != (-_ANY, _ANY)

    def also(self, other: Need) -> Need:
        """Both needs together."""
        return Need(
            max(self.least, other.least),
            min(self.greatest, other.greatest),
            self.cases + other.cases,
            self.others and other.others,
            self.near + other.near,
            self.runs + other.runs,
        )

    def selecting(self, value: int) -> int:
        """The value with cases in the runs of bits that select."""
        for run in self.runs:
            value = run.selecting(value)
        return value


Needs = dict[tuple[int, str], Need]
"""The needs of numbers, by the level of the record that holds each, and its name."""


@lru_cache(maxsize=256)
def needs_of(steps: tuple[AnyStep, ...], level: int) -> Needs:
    """Needs of the steps of a record at some level, of its numbers and of those around it."""
    needs: Needs = {}
    for step in steps:
        for number, need in _needs(step, level):
            place = number.level, number.name
            needs[place] = needs[place].also(need) if place in needs else need
    return needs


def _needs(step: AnyStep, level: int) -> Iterator[tuple[Reference, Need]]:
    match step:
        case ConstantStep():
            yield from _needs(step.value, level)
        case RecordStep():
            for (outer, name), need in needs_of(step.steps, level + 1).items():
                if outer <= level:
                    yield Reference(name, outer, None), need
        case BytesStep() | RepeatStep():
            yield from _needs_of_count(step.count)
            if isinstance(step, RepeatStep):
                yield from _needs(step.element, level)
        case ChooseStep():
            yield from _needs_of_choice(step)
            for case in step.cases:
                yield from _needs(case.step, level)
        case OptionalStep() | RegionStep():
            yield from _needs_around(step)
            yield from _needs(step.step, level)


def _needs_around(step: OptionalStep | RegionStep) -> Iterator[tuple[Reference, Need]]:
    if isinstance(step, RegionStep):
        yield from _needs_of_count(step.region)
    elif isinstance(step.presence, ConditionalPresence):
        yield from _needs_of_formula(step.presence.holds, (0, 1))


def _needs_of_count(count: Count) -> Iterator[tuple[Reference, Need]]:
    if count.by is None:
        return
    least, greatest = count.least, min(count.greatest, _GREATEST_COUNT)
    line = linear(count.by.expression)
    if line is None:
        yield from _needs_of_formula(count.by, (least, greatest))
        return
    yield count.by.references[line.name], Need(*line.within(least, greatest))


def _needs_of_choice(step: ChooseStep) -> Iterator[tuple[Reference, Need]]:
    if isinstance(step.selector, int):
        return
    values = step.type.values
    if step.selector.plain is not None:
        yield step.selector.plain, Need(cases=values, others=step.type.takes_all)
        return
    yield from _needs_of_formula(step.selector, values)
    selector = step.selector.expression
    if isinstance(selector, Operand) and selector.run is not None and not step.type.takes_all:
        number = step.selector.references[selector.name]
        yield number, Need(runs=(Run(*selector.run, values),))


def _needs_of_formula(
    formula: int | Formula, values: Iterable[int] = ()
) -> Iterator[tuple[Reference, Need]]:
    """Numbers that make a difference to a formula, or give it one of these values."""
    if isinstance(formula, int):
        return
    line = linear(formula.expression)
    written = [it.value for it in every(formula.expression) if isinstance(it, Number)]
    for operand in operands(formula.expression):
        found = [*written, *values] if line is None else map(line.inverse, values)
        low, high = operand.run or (0, 0)
        near = [number for it in found for number in (it - 1, it, it + 1)]
        bits = [number << low for number in near if number >= 0]
        chosen = near if operand.run is None else [0, (1 << high + 1) - (1 << low), *bits]
        yield formula.references[operand.name], Need(near=tuple(chosen))


# --- single values ------------------------------------------------------------------------------

Lengths = tuple[int, int]
"""The least and the greatest number of elements or bytes."""


def scalar_choices(
    step: IntegerStep | FloatStep | BytesStep, lengths: Lengths, need: Need | None
) -> Choices:
    """Choices for a single value; `need` comes from the steps that it counts or selects."""
    match step:
        case IntegerStep():
            choices = _integer_choices(step, need)
            return choices if need is None or not need.runs else _selecting_runs(choices, need)
        case FloatStep():
            return _float_choices(step)
        case BytesStep():
            return _text_choices(step, lengths)


class HeldPart(msgspec.Struct, frozen=True):
    """A part of the frame that a message may have as a field."""

    choices: Choices
    holds: Callable[[int], bool]
    """True for the numbers that the part may be."""


def held_choices(step: PartStep, part: HeldPart, need: Need | None) -> Choices:
    """Choices for a field that is a part of the frame: what both may be, where there is any."""
    own = scalar_choices(step, (0, 0), need)
    values = list(filter(part.holds, own.boundaries)) or part.choices.boundaries

    def draw(random: Random) -> Any:
        value = own.draw(random)
        return value if part.holds(value) else random.choice(values)

    return Choices(values, draw)


def constant_value(step: ConstantStep) -> Any:
    """A constant as JSON lines have it."""
    constant, value = step.field.const, step.value
    if isinstance(constant, bytes):
        return constant.hex()
    if isinstance(constant, tuple):
        return list(constant)
    if isinstance(value, FloatStep) and isinstance(constant, int):
        return float(constant)
    is_bool = isinstance(value, IntegerStep) and value.type.role == "bool"
    return bool(constant) if is_bool else constant


def _integer_choices(step: IntegerStep, need: Need | None) -> Choices:
    values = _known(step)
    least, greatest = _bounds(step)
    closed = step.type.is_closed
    if not closed:
        near = [value for value in (0, 1, -1) if least <= value <= greatest]
        values = _distinct([*values, least, greatest, *near])
    if need is not None and need.cases:
        more = () if closed else range(least, min(greatest, least + len(need.cases)) + 1)
        return _selecting(values, need, more)
    if need is not None and not closed:
        values = _distinct([*values, *(it for it in need.near if least <= it <= greatest)])
    if need is not None and need.is_bounded:
        least, greatest = max(least, need.least), min(greatest, need.greatest)
        values = [value for value in values if least <= value <= greatest]
        values = values if values or closed else _distinct([least, greatest])
        greatest = min(greatest, least + _USUAL_COUNT)
    if closed:
        # Without a value that can be sent, one that the encoder refuses has to do.
        sendable = values or [least]
        return Choices(sendable, lambda random: random.choice(sendable))
    return Choices(values, lambda random: _any_integer(least, greatest, random))


def _selecting(values: Sequence[int], need: Need, more: Iterable[int]) -> Choices:
    """The cases, and other values where those will do: if none is among `values`, one of `more`."""
    others = [value for value in values if need.others and value not in need.cases]
    if need.others and not others:
        others = [value for value in more if value not in need.cases][:1]
    choices = [*need.cases, *others[-1:]]
    return Choices(choices, lambda random: random.choice([*choices, *others]))


def _selecting_runs(choices: Choices, need: Need) -> Choices:
    """The choices with a case in each run of bits that selects."""
    boundaries = _distinct(map(need.selecting, choices.boundaries))
    return Choices(boundaries, lambda random: need.selecting(choices.draw(random)))


def _known(step: IntegerStep) -> list[int]:
    """The values that the schema names: of the enum, special ones, single bits and runs of bits."""
    type, special = step.type, [item.value for item in step.field.special]
    named = [item.value for item in (type.enum.values if type.enum is not None else ())]
    named += special
    named += [1 << flag.bit for flag in (type.flags.bits if type.flags is not None else ())]
    if not type.signed:
        named += [run.mask for run in type.bit_fields]
    least, greatest = _bounds(step)
    return _distinct(value for value in named if least <= value <= greatest or value in special)


def _bounds(step: IntegerStep) -> tuple[int, int]:
    return (0, 1) if step.type.role == "bool" else step.bounds


def _any_integer(least: int, greatest: int, random: Random) -> int:
    """Any value, small ones as often as large ones."""
    value = random.randint(least, greatest) >> random.randrange((greatest - least).bit_length() + 1)
    return min(max(value, least), greatest)


def _float_choices(step: FloatStep) -> Choices:
    field, bits = step.field, step.type.bits
    if field.ranged and field.least is not None and field.greatest is not None:
        low = _fitting(field.least, bits, math.inf)
        high = _fitting(field.greatest, bits, -math.inf)
        # Rounding to 32 bits never leaves two numbers of 32 bits.
        return Choices((low, high), lambda random: _rounded(random.uniform(low, high), bits))
    form = "<f" if bits == 32 else "<d"
    greatest = float(step.type.greatest)
    values = (0.0, -0.0, 1.0, -1.5, greatest, -greatest, "inf", "-inf", "nan")
    return Choices(values, lambda random: _any_float(form, random))


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
    return value if math.isfinite(value) else str(value)


def _text_choices(step: BytesStep, lengths: Lengths) -> Choices:
    least, greatest = lengths
    if not isinstance(step.type, Text):
        highest = SEVEN_BITS if step.type.byte_bits == 7 else 0xFF
        return bytes_choices(least, greatest, highest, step.count.until)
    if step.count.between is not None:
        return _characters_choices(step.count.between.characters.decode(), lengths)
    if isinstance(step.type.extent, Fixed):
        least = 0
    if not step.type.form.is_plain:
        return _padded_choices(step.type.form.padding, greatest)
    end = step.count.until
    ends = (_without(end, character.encode()) for character in ("A", "\n", chr(_LAST_OF_ASCII)))
    values = [character.decode() * greatest for character in ends]
    return Choices(
        _distinct([values[0][:least], *values]),
        lambda random: _any_text(random, _any_length(least, greatest, random), end),
    )


def _characters_choices(characters: str, lengths: Lengths) -> Choices:
    """Texts of these characters."""
    least, greatest = lengths
    values = [it * length for it in (characters[0], characters[-1]) for length in lengths]
    return Choices(
        _distinct(values),
        lambda random: "".join(
            random.choice(characters) for _ in range(_any_length(least, greatest, random))
        ),
    )


def _padded_choices(padding: int, greatest: int) -> Choices:
    """Texts with another padding: none of them ends with it."""
    last = chr(padding)
    texts = ["", *(letter * greatest for letter in ("A", "\x01", chr(_LAST_OF_ASCII)))]
    if greatest > 1:
        texts.append(last * (greatest - 1) + "A")
    return Choices(
        _distinct([text.rstrip(last) for text in texts]),
        lambda random: _any_text(random, random.randint(0, greatest)).rstrip(last),
    )


def _any_text(random: Random, length: int, end: int | None = None) -> str:
    # NUL pads a text of a fixed size, so no text has it.
    data = bytes(random.randint(1, _LAST_OF_ASCII) for _ in range(length))
    return _without(end, data).decode()


def _without(end: int | None, data: bytes) -> bytes:
    """The bytes with others for those that would end them."""
    return data if end is None else bytes(byte ^ (byte == end) for byte in data)


def bytes_choices(least: int, greatest: int, highest: int, end: int | None = None) -> Choices:
    """Bytes of any such length, none of them above `highest`, and none of them `end`."""
    counting = bytes(index & highest for index in range(greatest))
    values = (bytes(least), bytes(greatest), bytes((highest,)) * greatest, counting)
    return Choices(
        _distinct(_without(end, value).hex() for value in values),
        lambda random: _any_bytes(random, _any_length(least, greatest, random), highest, end),
    )


def _any_bytes(random: Random, length: int, highest: int, end: int | None) -> str:
    return _without(end, bytes(byte & highest for byte in random.randbytes(length))).hex()


def count_choices(lengths: Lengths) -> Choices:
    """Choices for a number of elements."""
    least, greatest = lengths
    values = _distinct((least, max(least, min(1, greatest)), greatest))
    return Choices(values, lambda random: _any_length(least, greatest, random))


def lengths_of(count: Count, said: int) -> Lengths:
    """The least and the greatest number of elements or bytes; `said` is what a number says."""
    if count.is_delimited:
        return count.least, max(count.least, min(count.greatest, _GREATEST_COUNT))
    found = said if count.known is None else count.known
    return found, found


def _any_length(least: int, greatest: int, random: Random) -> int:
    return random.randint(least, min(greatest, least + _USUAL_COUNT))


def _distinct(values: Iterable[Any]) -> list[Any]:
    return list(dict.fromkeys(values))
