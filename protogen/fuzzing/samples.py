"""Values to try a codec with: boundaries first, then random ones, from a seed.

Values are those of JSON lines: raw numbers, texts, bytes as hex digits, lists, and mappings for
structs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from itertools import count, islice
from random import Random
from types import MappingProxyType
from typing import Any

from protogen.fuzzing.choices import (
    SEVEN_BITS,
    Choices,
    HeldPart,
    Need,
    any_of,
    bytes_choices,
    constant_value,
    count_choices,
    held_choices,
    lengths_of,
    needs_of,
    part_choices,
    run_choices,
    scalar_choices,
    unspecified_choices,
)
from protogen.fuzzing.last_elements import Mark
from protogen.model.expression_bounds import linear
from protogen.model.frame import Frame
from protogen.model.identities import Runs
from protogen.model.messages import Message
from protogen.model.packing import FilledPacking, Packing
from protogen.model.parts import ChoicePart, CounterPart, ValuePart
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConditionalPresence,
    ConstantStep,
    Count,
    Formula,
    IntegerStep,
    OptionalStep,
    PartStep,
    RecordStep,
    Reference,
    RegionStep,
    RepeatStep,
    RestStep,
    TrailingPresence,
)
from protogen.model.payload_walks import said, without_constant
from protogen.model.sizes import SizeSet
from protogen.model.types import Text, codec
from protogen.passes.framing.capacity import payload_range

_TRIES = 100
"""Draws until one has a size that the frame lets a payload have."""

Values = dict[str, Any]
"""Names of fields or parts with their values."""
Held = Mapping[str, int]
"""Fields that are parts of the frame, which the payload alone does not have."""
NOTHING_HELD: Held = MappingProxyType({})


class Boundaries:
    """Takes the boundaries of each value in turn, one in each round."""

    def __init__(self, round: int, rounds: set[int], cases: int = 1) -> None:
        self._round = round
        self._rounds = rounds
        """Takes up how many rounds each value needs."""
        self._cases = cases

    def choose(self, choices: Choices) -> Any:
        """The boundary that is due in this round."""
        count = len(choices.boundaries)
        self._rounds.add(count * self._cases)
        return choices.boundaries[self._round % count]

    def element(self, index: int) -> Boundaries:
        """For an element of an array: neighbours take different boundaries."""
        return Boundaries(self._round + index, self._rounds, self._cases)

    def inside(self, cases: int) -> Boundaries:
        """For what is inside one of `cases`, which is due only every so many rounds."""
        return Boundaries(self._round // cases, self._rounds, self._cases * cases)


class Chance:
    """Takes a boundary now and then, else any value."""

    def __init__(self, random: Random) -> None:
        self._random = random

    def choose(self, choices: Choices) -> Any:
        """Some value."""
        if self._random.random() < 0.3:
            return self._random.choice(choices.boundaries)
        return choices.draw(self._random)

    def element(self, index: int) -> Chance:
        """For an element of an array."""
        return self

    def inside(self, cases: int) -> Chance:
        """For what is inside one of several cases."""
        return self


Chooser = Boundaries | Chance


def samples(message: Message, frame: Frame, random: Random) -> Iterator[tuple[Values, Values]]:
    """Yield values of the fields and of the caller's parts, as long as some fit the frame.

    The first `boundary_rounds` of them hold every boundary of every value: the least and the
    greatest, names, special values, single bits, empty and full arrays.
    """
    yield from _boundary_samples(message, frame)
    yield from random_samples(message, frame, random)


def samples_at_least(
    least: int, message: Message, frame: Frame, random: Random
) -> Iterator[tuple[Values, Values]]:
    """Yield so many `samples`, or as many as it takes until each boundary was there."""
    yielded = 0
    for sample in _boundary_samples(message, frame):
        yielded += 1
        yield sample
    yield from islice(random_samples(message, frame, random), max(0, least - yielded))


def boundary_rounds(message: Message, frame: Frame) -> int:
    """Number of samples that have each boundary once."""
    return sum(1 for _ in _boundary_samples(message, frame))


def random_samples(
    message: Message, frame: Frame, random: Random
) -> Iterator[tuple[Values, Values]]:
    """Yield values of the fields and of the caller's parts without end, if any fit the frame."""
    chance, sizes, held = Chance(random), _carried(message, frame), _held_parts(message, frame)
    while True:
        tries = (_sample(message, sizes, held, chance) for _ in range(_TRIES))
        sample = next(filter(None, tries), None)
        if sample is None:
            return
        yield sample


def _boundary_samples(message: Message, frame: Frame) -> Iterator[tuple[Values, Values]]:
    rounds, sizes, held = {1}, _carried(message, frame), _held_parts(message, frame)
    for round in count():
        if round == max(rounds):
            return
        sample = _sample(message, sizes, held, Boundaries(round, rounds))
        if sample is not None:
            yield sample


def _sample(
    message: Message, sizes: SizeSet, held: Mapping[str, HeldPart], chooser: Chooser
) -> tuple[Values, Values] | None:
    """A sample; None where its payload has a size that the frame does not let it have."""
    if message.unspecified:
        fields = {message.fields[0].name: chooser.choose(unspecified_choices(message, sizes))}
    else:
        sampler = _Sampler(sizes, held)
        try:
            fields = sampler.record(message.plan.steps, chooser)
        except _UnfitError:
            return None
        if sampler.size not in sizes:
            return None
    parts = {name: chooser.choose(part.choices) for name, part in held.items()}
    return fields, parts | {field.part: int(fields[field.name]) for field in message.held}


def _held_parts(message: Message, frame: Frame) -> dict[str, HeldPart]:
    """The parts that senders choose in frames of a message."""
    found = {part.name: _value_part(part) for part in frame.caller_parts}
    for index, part in enumerate(frame.identity):
        if message.chooses(index):
            runs = message.told_by.runs[index]
            found[part.name] = HeldPart(run_choices(part, runs), partial(_is_in, runs))
    return found


def _value_part(part: CounterPart | ValuePart) -> HeldPart:
    is_one = part.values.__contains__ if isinstance(part, ChoicePart) else part.holds
    return HeldPart(part_choices(part), is_one)


def _is_in(runs: Runs, value: int) -> bool:
    return any(first <= value <= last for first, last in runs)


def _is_trailing(step: AnyStep) -> bool:
    return isinstance(step, OptionalStep) and isinstance(step.presence, TrailingPresence)


def _carried(message: Message, frame: Frame) -> SizeSet:
    """The sizes of the message that the frame's length can say: other forms may carry others."""
    stated = payload_range(frame)
    if stated is None:
        return message.sizes
    return message.sizes.within(stated.least, stated.greatest) or message.sizes


# --- composites ---------------------------------------------------------------------------------


class _UnfitError(Exception):
    """Numbers in front say what nothing can have."""


class _Sampler:
    """Chooses values step by step; those in front count and select what follows."""

    def __init__(self, sizes: SizeSet, held: Mapping[str, HeldPart]) -> None:
        self._held = held
        """Parts of the frame, which may be fields."""
        self.size = 0
        """Bytes of the values so far."""
        self._sizes = sizes
        self._records: list[Values] = []
        self._said_of: set[tuple[int, str]] = set()
        """Numbers that told something already, by their records."""
        self._going_on = 0
        """Fields that are still to come, of those that may be left out at the end."""
        self._tails = 1
        """How many ends a message can have."""
        self._mark: Mark | None = None
        """What the next record says of being the last, where it has to."""

    def record(self, steps: tuple[AnyStep, ...], chooser: Chooser) -> Values:
        """The values of a record."""
        level, mark, self._mark = len(self._records), self._mark, None
        needs = needs_of(steps, level)
        values: Values = {}
        self._records.append(values)
        optional = sum(map(_is_trailing, steps))
        if optional:
            self._tails = optional + 1
            self._going_on = chooser.choose(any_of(range(optional, -1, -1)))
        for step in steps:
            values[step.name] = self._value(step, chooser, needs.get((level, step.name)))
            if mark is not None and step.name == mark.operand.path[0]:
                mark.set_in(values, steps)
                self._said_of.add((id(values), ".".join(mark.operand.path)))
        self._records.pop()
        return values

    def _value(self, step: AnyStep, chooser: Chooser, need: Need | None = None) -> Any:
        if isinstance(step, RecordStep | RepeatStep) and isinstance(step.packing, Packing):
            self.size += step.packing.size  # Of the numbers themselves, none has bytes.
        match step:
            case RecordStep():
                return self.record(step.steps, chooser)
            case RepeatStep():
                return self._array(step, chooser)
            case ChooseStep():
                return self._case(step, chooser)
            case OptionalStep():
                is_there, rounds = self._presence(step.presence)
                return self._value(step.step, chooser.inside(rounds)) if is_there else None
            case RegionStep():
                return self._region(step, chooser)
            case PartStep():
                return chooser.choose(held_choices(step, self._held[step.part], need))
            case ConstantStep():
                return self._taken(step, constant_value(step))
            case _:
                lengths = self._lengths(step.count, 1) if isinstance(step, BytesStep) else (0, 0)
                return self._taken(step, chooser.choose(scalar_choices(step, lengths, need)))

    def _presence(self, presence: ConditionalPresence | TrailingPresence) -> tuple[bool, int]:
        """Whether a step is there, and how many more rounds it takes as it is not always."""
        match presence:
            case ConditionalPresence(holds=condition):
                return bool(self._told(condition)), 2
            case TrailingPresence():
                self._going_on -= 1
                return self._going_on >= 0, self._tails

    def _taken(self, step: AnyStep, value: Any) -> Any:
        """A value whose bytes are counted; where their number varies, it is text or hex digits."""
        bare = without_constant(step)
        if isinstance(bare, IntegerStep) and bare.type.is_free:
            self.size += len(codec(bare.type).encode(value))
            return value
        is_text = isinstance(bare, BytesStep) and isinstance(bare.type, Text)
        self.size += isinstance(bare, BytesStep) and bare.count.until is not None
        if isinstance(bare, BytesStep) and bare.count.between is not None:
            self.size += bare.count.between.leads + len(value)
            return value
        fixed = step.sizes.fixed
        if fixed is None and isinstance(step, ConstantStep):
            fixed = len(step.data)
        self.size += fixed if fixed is not None else len(value) // (1 if is_text else 2)
        return value

    def _packed_fill(self, step: RepeatStep, packing: FilledPacking, chooser: Chooser) -> list[Any]:
        """Packed elements that take what is left, as many as there is room for at most."""
        least, greatest = lengths_of(step.count, 0)
        room, due = self._sizes.greatest - self.size, self._sizes.least - self.size
        greatest = min(greatest, max(0, 8 * room) // packing.width)
        needed = -(-(8 * due - 7) // packing.width)
        length = chooser.choose(count_choices((min(greatest, max(least, needed)), greatest)))
        self.size += packing.size_of(length)
        return [self._value(step.element, chooser.element(index)) for index in range(length)]

    def _array(self, step: RepeatStep, chooser: Chooser) -> list[Any]:
        if isinstance(step.packing, FilledPacking):
            return self._packed_fill(step, step.packing, chooser)
        count = step.count
        length = chooser.choose(count_choices(self._lengths(count, step.element.sizes.least)))
        values: list[Any] = []
        while len(values) < length or (count.fills and self.size < self._sizes.least):
            before = self.size
            self._mark = Mark.of(count, is_last=len(values) == length - 1)
            value = self._value(step.element, chooser.element(len(values)))
            if count.fills and (self.size > self._sizes.greatest or self.size == before):
                self.size = before  # There is no room for it, or it takes none.
                break
            values.append(value)
        return values

    def _region(self, step: RegionStep, chooser: Chooser) -> Any:
        """What fills a region; the number that tells its size follows it, where it is free to."""
        begun, outside = self.size, self._sizes
        region, most = step.region, max(0, outside.greatest - begun)
        known = region.known
        if region.by is not None and any(map(self._has_told, region.by.references.values())):
            known = self._said(region, region.by)
        least, greatest = (known, known) if known is not None else (region.least, region.greatest)
        self._sizes = SizeSet.between(begun + least, begun + min(greatest, most))
        value = self._value(step.step, chooser)
        size, self._sizes = self.size - begun, outside
        if not least <= size <= greatest:
            raise _UnfitError
        if known is None and region.by is not None:
            self._tell(region.by, size)
        return value

    def _tell(self, by: Formula, size: int) -> None:
        """Have the number that tells a size tell this one."""
        line = linear(by.expression)
        if line is not None:
            number = by.references[line.name]
            *path, name = number.name.split(".")
            record: Any = self._records[number.level]
            for member in path:
                record = record[member]
            record[name] = line.inverse(size)
        if self._told(by) != size:
            raise _UnfitError

    def _has_told(self, number: Reference) -> bool:
        return (id(self._records[number.level]), number.name) in self._said_of

    def _told(self, number: int | Formula) -> int:
        """What earlier numbers say, which stay as they are from now on."""
        if isinstance(number, Formula):
            for it in number.references.values():
                self._said_of.add((id(self._records[it.level]), it.name))
        return said(number, self._records)

    def _said(self, count: Count, by: Formula) -> int:
        """The number of elements or bytes that earlier numbers say."""
        found = self._told(by)
        if not count.least <= found <= count.greatest:
            raise _UnfitError
        return found

    def _lengths(self, count: Count, size: int) -> tuple[int, int]:
        """The least and the greatest number of elements that have at least `size` bytes."""
        least, greatest = lengths_of(count, 0 if count.by is None else self._said(count, count.by))
        if (count.mark is not None or count.tail is not None) and size:
            greatest = min(greatest, max(least, (self._sizes.greatest - self.size) // size))
        if count.fills and size:
            greatest = min(greatest, max(0, self._sizes.greatest - self.size) // size)
            needed = -(min(0, self.size - self._sizes.least) // size)
            least = min(greatest, max(least, needed))
        if count.until is not None:
            greatest = min(greatest, max(least, self._sizes.greatest - self.size - 1))
        if count.between is not None:
            room = self._sizes.greatest - self.size - count.between.leads
            greatest = min(greatest, max(least, room))
        return least, greatest

    def _case(self, step: ChooseStep, chooser: Chooser) -> Any:
        inside = chooser.inside(len(step.cases) + (step.rest is not None))
        chosen = step.case(self._told(step.selector))
        if chosen is None:
            raise _UnfitError
        if isinstance(chosen, RecordStep) and not chosen.steps:
            return None
        if isinstance(chosen, RestStep):
            lengths = self._lengths(chosen.count, 1)
            value = inside.choose(bytes_choices(*lengths, SEVEN_BITS))
            self.size += len(value) // 2
            return value
        return self._value(chosen, inside)
