"""Values to try a codec with: boundaries first, then random ones, from a seed.

Values are those of JSON lines: raw numbers, texts, bytes as hex digits, lists, and mappings for
structs.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterable, Iterator, Sequence
from random import Random
from typing import Any

from protogen.fuzzing.choices import (
    SEVEN_BITS,
    Choices,
    Need,
    Scope,
    bytes_choices,
    count_choices,
    needs_of,
    part_choices,
    scalar_choices,
    unspecified_choices,
)
from protogen.model.frame import Frame
from protogen.model.messages import Message
from protogen.model.types import Array, Field, Struct, Switch, Type

Values = dict[str, Any]
"""Names of fields or parts with their values."""


class Boundaries:
    """Takes the boundaries of each value in turn, one in each round."""

    def __init__(self, round: int) -> None:
        self._round = round

    def choose(self, choices: Choices) -> Any:
        """The boundary that is due in this round."""
        return choices.boundaries[self._round % len(choices.boundaries)]

    def element(self, index: int) -> Boundaries:
        """For an element of an array: neighbours take different boundaries."""
        return Boundaries(self._round + index)

    def inside(self, cases: int) -> Boundaries:
        """For what is inside one of `cases`, which is due only every so many rounds."""
        return Boundaries(self._round // cases)


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
    for round in range(boundary_rounds(message, frame)):
        yield _sample(message, frame, Boundaries(round))
    chance = Chance(random)
    while True:
        yield _sample(message, frame, chance)


def boundary_rounds(message: Message, frame: Frame) -> int:
    """How many samples it takes to have each boundary once."""
    parts = [len(part_choices(part).boundaries) for part in frame.caller_parts]
    if message.unspecified:
        return max([len(unspecified_choices(message).boundaries), *parts])
    return max([1, _rounds_of_fields(message.fields), *parts])


def _sample(message: Message, frame: Frame, chooser: Chooser) -> tuple[Values, Values]:
    if message.unspecified:
        fields = {message.fields[0].name: chooser.choose(unspecified_choices(message))}
    else:
        fields = _fields(message.fields, ChainMap(), chooser)
    parts = {part.name: chooser.choose(part_choices(part)) for part in frame.caller_parts}
    return fields, parts


# --- how many rounds ----------------------------------------------------------------------------


def _rounds_of_fields(fields: Iterable[Field]) -> int:
    fields = tuple(fields)
    needs = needs_of(fields)
    return max((_rounds(field, field.type, needs.get(field.name)) for field in fields), default=1)


def _rounds(field: Field, type: Type, need: Need | None = None) -> int:
    match type:
        case Struct(fields=fields):
            return _rounds_of_fields(fields)
        case Array(element=element, extent=extent):
            return max(len(count_choices(extent, ChainMap()).boundaries), _rounds(field, element))
        case Switch(cases=cases):
            return _branches(type) * max(_rounds(field, case.type) for case in cases)
        case _:
            return len(scalar_choices(field, type, ChainMap(), need).boundaries)


def _branches(type: Switch) -> int:
    return len(type.cases) + (type.rest is not None)


# --- composites ---------------------------------------------------------------------------------


def _fields(fields: Sequence[Field], scope: Scope, chooser: Chooser) -> Values:
    inner = scope.new_child()
    needs = needs_of(fields)
    for field in fields:
        inner[field.name] = _value(field, field.type, inner, chooser, needs.get(field.name))
    return dict(inner.maps[0])


def _value(
    field: Field, type: Type, scope: Scope, chooser: Chooser, need: Need | None = None
) -> Any:
    match type:
        case Struct(fields=fields):
            return _fields(fields, scope, chooser)
        case Array():
            return _elements(field, type, scope, chooser)
        case Switch():
            return _case(field, type, scope, chooser)
        case _:
            return chooser.choose(scalar_choices(field, type, scope, need))


def _elements(field: Field, type: Array, scope: Scope, chooser: Chooser) -> list[Any]:
    if isinstance(field.const, tuple):
        return list(field.const)
    length = chooser.choose(count_choices(type.extent, scope))
    return [_value(field, type.element, scope, chooser.element(index)) for index in range(length)]


def _case(field: Field, type: Switch, scope: Scope, chooser: Chooser) -> Any:
    inside = chooser.inside(_branches(type))
    for case in type.cases:
        if case.value == scope[type.selector]:
            empty = isinstance(case.type, Struct) and not case.type.fields
            return None if empty else _value(field, case.type, scope, inside)
    return inside.choose(bytes_choices(0, type.rest or 0, SEVEN_BITS))
