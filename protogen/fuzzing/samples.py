"""Values to try a codec with: boundaries first, then random ones, from a seed.

Values are those of JSON lines: raw numbers, texts, bytes as hex digits, lists, and mappings for
structs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count
from random import Random
from typing import Any

from protogen.fuzzing.choices import (
    SEVEN_BITS,
    Choices,
    Need,
    bytes_choices,
    constant_value,
    count_choices,
    lengths_of,
    needs_of,
    part_choices,
    scalar_choices,
    unspecified_choices,
)
from protogen.model.frame import Frame
from protogen.model.messages import Message
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConstantStep,
    Count,
    RecordStep,
    Reference,
    RepeatStep,
    RestStep,
)

Values = dict[str, Any]
"""Names of fields or parts with their values."""


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
    """Yield values of the fields and of the caller's parts, without end.

    The first `boundary_rounds` of them hold every boundary of every value: the least and the
    greatest, names, special values, single bits, empty and full arrays.
    """
    yield from _boundary_samples(message, frame)
    chance = Chance(random)
    while True:
        yield _sample(message, frame, chance)


def boundary_rounds(message: Message, frame: Frame) -> int:
    """Number of samples that have each boundary once."""
    return sum(1 for _ in _boundary_samples(message, frame))


def _boundary_samples(message: Message, frame: Frame) -> Iterator[tuple[Values, Values]]:
    rounds = {1}
    for round in count():
        if round == max(rounds):
            return
        yield _sample(message, frame, Boundaries(round, rounds))


def _sample(message: Message, frame: Frame, chooser: Chooser) -> tuple[Values, Values]:
    if message.unspecified:
        fields = {message.fields[0].name: chooser.choose(unspecified_choices(message))}
    else:
        fields = _Sampler().record(message.plan.steps, chooser)
    parts = {part.name: chooser.choose(part_choices(part)) for part in frame.caller_parts}
    return fields, parts


# --- composites ---------------------------------------------------------------------------------


class _Sampler:
    """Chooses values step by step; those in front count and select what follows."""

    def __init__(self) -> None:
        self._records: list[Values] = []

    def record(self, steps: Sequence[AnyStep], chooser: Chooser) -> Values:
        """The values of a record."""
        level = len(self._records)
        needs = needs_of(steps, level)
        values: Values = {}
        self._records.append(values)
        for step in steps:
            values[step.name] = self._value(step, chooser, needs.get((level, step.name)))
        self._records.pop()
        return values

    def _value(self, step: AnyStep, chooser: Chooser, need: Need | None = None) -> Any:
        match step:
            case RecordStep():
                return self.record(step.steps, chooser)
            case RepeatStep():
                length = chooser.choose(count_choices(self._lengths(step.count)))
                places = range(length)
                return [self._value(step.element, chooser.element(index)) for index in places]
            case ChooseStep():
                return self._case(step, chooser)
            case ConstantStep():
                return constant_value(step)
            case _:
                lengths = self._lengths(step.count) if isinstance(step, BytesStep) else (0, 0)
                return chooser.choose(scalar_choices(step, lengths, need))

    def _number(self, number: int | Reference) -> int:
        if isinstance(number, int):
            return number
        return int(self._records[number.level][number.name])

    def _lengths(self, count: Count) -> tuple[int, int]:
        return lengths_of(count, 0 if count.by is None else self._number(count.by))

    def _case(self, step: ChooseStep, chooser: Chooser) -> Any:
        inside = chooser.inside(len(step.cases) + (step.rest is not None))
        chosen = step.case(self._number(step.selector))
        if isinstance(chosen, RecordStep) and not chosen.steps:
            return None
        if chosen is None or isinstance(chosen, RestStep):
            greatest = 0 if chosen is None else chosen.count.greatest
            return inside.choose(bytes_choices(0, greatest, SEVEN_BITS))
        return self._value(chosen, inside)
