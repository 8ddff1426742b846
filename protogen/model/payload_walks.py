"""Walks over the steps of a payload plan."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import msgspec

from protogen.model.expressions import reached
from protogen.model.payload_plan import (
    AnyStep,
    ConstantStep,
    Formula,
    IntegerStep,
    OptionalStep,
    RegionStep,
    RepeatStep,
)


def said(number: int | Formula, records: Sequence[Mapping[str, Any]]) -> int:
    """A number that counts or selects, where the values of the records around it are known."""
    if isinstance(number, int):
        return number
    return number.value(lambda reference: reached(records[reference.level], reference.name))


def held_step(step: AnyStep) -> AnyStep:
    """The step of the value itself, whether that is always there or not, in a region or not."""
    while isinstance(step, OptionalStep | RegionStep):
        step = step.step
    return step


def without_constant(step: AnyStep) -> AnyStep:
    """The step that reads or writes the same bytes as a value."""
    return step.value if isinstance(step, ConstantStep) else step


class PackedNumber(msgspec.Struct, frozen=True):
    """A number of a run of bits."""

    step: IntegerStep
    name: str
    """The field; empty in an array that is packed itself."""
    index: int | None
    """Place among the elements of an array."""
    first: int
    """Place of its first bit in the run."""
    constant: int | None


def packed_numbers(steps: Iterable[AnyStep], filled: int = 0) -> Iterator[PackedNumber]:
    """Yield the numbers of packed steps, in wire order; `filled` of what takes all that is left."""
    first = 0
    for step in steps:
        value = without_constant(step)
        elements = [value] if isinstance(value, IntegerStep) else _packed_elements(value, filled)
        const = step.field.const
        for index, element in enumerate(elements):
            constant = const[index] if isinstance(const, tuple) else const
            assert constant is None or isinstance(constant, int)
            place = None if element is value else index
            yield PackedNumber(element, step.name, place, first, constant)
            first += element.type.bits


def _packed_elements(step: AnyStep, filled: int) -> list[IntegerStep]:
    assert isinstance(step, RepeatStep)
    assert isinstance(step.element, IntegerStep)
    return [step.element] * (filled if step.fills else step.count.known or 0)
