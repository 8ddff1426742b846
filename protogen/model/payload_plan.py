"""Payload plan: the steps that read, check and write a payload, in wire order.

A step knows what a walk over it needs: where its number of elements comes from, what can be wrong
with its bytes, whether an encoder refuses some of its values, whether anything follows it. What
counts and selects is resolved here: where it never changes it is a number, anything else a formula,
which knows which of the records around it holds each of its fields. Targets print steps and decide
nothing.

Nobody compares steps, and every command makes their classes, so these have no comparisons.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from enum import Enum, auto
from functools import cached_property
from typing import cast

import msgspec

from protogen.model.constants import allowed, constant_bytes
from protogen.model.expression_bounds import Interval, bounds_of, hull_of
from protogen.model.expressions import Expression, Operand, value_of
from protogen.model.packing import FilledPacking, Packing
from protogen.model.sizes import SizeSet
from protogen.model.types import (
    Between,
    Field,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Tail,
    Text,
    Type,
)


class Check(Enum):
    """Something that can be wrong with bytes that are there in the right number."""

    CHARACTERS = auto()
    """A character of a text is none of those that it can have, or a byte stands for none."""
    SEVEN_BIT = auto()
    """A byte has its most significant bit set."""
    PADDING = auto()
    """A bit above those of the number is set."""
    DIGITS = auto()
    """A character is no digit, or the digits stand for a number that is too great."""
    BOOLEAN = auto()
    """The number is neither 0 nor 1."""
    CLOSED = auto()
    """The closed enum has no such value."""
    CONSTANT = auto()
    """The bytes are not those of the constant."""
    COUNT = auto()
    """The number that an earlier field gives is out of bounds."""
    CASE = auto()
    """No case has the value of the selector."""


_NO_CHECKS: frozenset[Check] = frozenset()


def packing_checks(packing: Packing | FilledPacking | None) -> frozenset[Check]:
    """Faults of a run of bits, beside those of its numbers."""
    match packing:
        case Packing(padding=padding):
            is_padded = padding != 0
        case FilledPacking(width=width):
            is_padded = width % 8 != 0
        case None:
            is_padded = False
    return frozenset({Check.PADDING}) if is_padded else _NO_CHECKS


class Reference(msgspec.Struct, frozen=True):
    """An earlier number that counts or selects."""

    name: str
    """Of a member of a struct, `header.count`."""
    level: int
    """Depth of the record that holds it: 0 for the plan's own fields, -1 for one around them."""
    type: Integer | None
    """None for a number around the plan."""

    @property
    def bounds(self) -> Interval:
        """What the bits can hold, whatever an encoder allows."""
        return (0, 0) if self.type is None else (self.type.least, self.type.greatest)


class Formula(msgspec.Struct, frozen=True, eq=False, dict=True):
    """A number or condition that is worked out of earlier numbers."""

    expression: Expression
    references: Mapping[str, Reference]
    """The numbers, by the names that the expression has for them."""

    @cached_property
    def plain(self) -> Reference | None:
        """The number that it is, where nothing has to be worked out."""
        is_plain = isinstance(self.expression, Operand) and self.expression.run is None
        return next(iter(self.references.values())) if is_plain else None

    @property
    def label(self) -> str:
        """The formula in the words of the schema language."""
        return self.expression.text

    @cached_property
    def bounds(self) -> Interval:
        """The least and the greatest value, of whatever the fields can hold."""
        return bounds_of(self.expression, self.bounds_of)

    @cached_property
    def hull(self) -> Interval:
        """The bounds of all numbers on the way to the value, itself included."""
        return hull_of(self.expression, self.bounds_of)

    def bounds_of(self, operand: Operand) -> Interval:
        """The bounds of a field, or of the bits that count of it."""
        if operand.run is not None:
            low, high = operand.run
            return 0, (1 << (high - low + 1)) - 1
        return self.references[operand.name].bounds

    def value(self, look: Callable[[Reference], int]) -> int:
        """The value, where `look` gives the numbers; of a condition, 0 or 1."""
        found = value_of(self.expression, lambda operand: look(self.references[operand.name]))
        return int(found)

    def holds(self, look: Callable[[Reference], int]) -> bool:
        """True if the condition holds; a number does unless it is 0."""
        return self.value(look) != 0


class Count(msgspec.Struct, frozen=True, kw_only=True, eq=False, dict=True):
    """Number of elements or bytes."""

    expression: Expression | None = None
    """What says it as the schema has it, if earlier fields do."""
    known: int | None = None
    """The number, where it is always the same."""
    by: Formula | None = None
    """The numbers that say it, unless those are constants."""
    member: str = ""
    """Name for the number in a record, where no earlier field says it."""
    fills: bool = False
    """True if all that is left of the payload is taken."""
    until: int | None = None
    """The byte that ends what is taken, and stands behind it."""
    tail: Tail | None = None
    """What stands behind elements that take what is left; they end where that begins."""
    between: Between | None = None
    """What stands around a text among separators."""
    mark: Formula | None = None
    """What is not 0 in the last of the elements, as a formula over the members of one."""
    least: int
    greatest: int
    stated: bool
    """True if the schema states the bounds."""

    @property
    def is_fixed(self) -> bool:
        """True if nothing in the payload says the number."""
        return self.expression is None and not self.is_delimited

    @property
    def is_delimited(self) -> bool:
        """True if what ends it says the number: a byte, the last element, the payload's end."""
        ends = (self.until, self.mark, self.tail, self.between)
        return self.fills or any(end is not None for end in ends)


class Step(msgspec.Struct, frozen=True, kw_only=True, eq=False, dict=True):
    """Step of a payload plan."""

    name: str
    """Name of the field or case; empty for an element of an array."""
    field: Field
    """The field that says what the values mean."""
    type: Type
    sizes: SizeSet
    """Wire bytes."""
    checks: frozenset[Check]
    """Faults that the right number of bytes can have."""
    is_refusable: bool
    """True if an encoder refuses some values that a record can hold."""
    holds_values: bool = True
    """True if a record keeps anything of it."""
    is_last: bool = False
    """True if nothing follows it in the payload."""
    count: Count | None = None
    """Number of elements or bytes, of what has one."""

    @cached_property
    def known_size(self) -> int | None:
        """Bytes of every such value, where that tells the places behind it; None where it does not.

        Numbers of as many digits as they need are read up to where they end, whatever their size,
        and so is what has a number of bytes of its own.
        """
        steps = every_step([cast("AnyStep", self)])
        return None if any(map(_tells_its_end, steps)) else self.sizes.fixed

    @property
    def fills(self) -> bool:
        """True if it takes all elements or bytes that are left of the payload."""
        return self.count is not None and self.count.fills

    @property
    def can_be_wrong(self) -> bool:
        """True if the right number of bytes may still be no value."""
        return bool(self.checks)

    @property
    def has_wrong_values(self) -> bool:
        """True if anything but a byte of more than 7 bits can be wrong."""
        return bool(self.checks - {Check.SEVEN_BIT})


class NumberStep(Step, frozen=True, kw_only=True, eq=False, dict=True):
    """An integer or a float."""

    type: Integer | Float


class FloatStep(NumberStep, frozen=True, kw_only=True, eq=False, dict=True):
    """A float."""

    type: Float


class IntegerStep(NumberStep, frozen=True, kw_only=True, eq=False, dict=True):
    """An integer."""

    type: Integer
    is_needed: bool = False
    """True if it counts or selects something that follows."""

    @property
    def bounds(self) -> tuple[int, int]:
        """The least and the greatest integer that an encoder allows, special values aside."""
        return allowed(self.field, self.type)


class PartStep(IntegerStep, frozen=True, kw_only=True, eq=False, dict=True):
    """An integer that is a part of the frame: the payload has no bytes of it."""

    @property
    def part(self) -> str:
        """The part."""
        return self.field.part


class BytesStep(Step, frozen=True, kw_only=True, eq=False, dict=True):
    """A text, or bytes that nobody interprets."""

    type: Text | Octets
    count: Count


class ConstantStep(Step, frozen=True, kw_only=True, eq=False, dict=True):
    """Bytes that are always the same."""

    value: IntegerStep | FloatStep | BytesStep | RepeatStep
    """The step that the field would be without the constant."""

    @property
    def data(self) -> bytes:
        """The bytes."""
        return constant_bytes(self.field)


class RecordStep(Step, frozen=True, kw_only=True, eq=False, dict=True):
    """A struct: its own steps one after another."""

    type: Struct
    steps: tuple[AnyStep, ...]
    packing: Packing | None = None
    """The run of bits that its numbers are, where they are packed."""


class RepeatStep(Step, frozen=True, kw_only=True, eq=False, dict=True):
    """Elements one after another."""

    element: AnyStep
    count: Count
    packing: Packing | FilledPacking | None = None
    """The run of bits that its numbers are, where they are packed."""


class RestStep(Step, frozen=True, kw_only=True, eq=False, dict=True):
    """The bytes that are left of the payload, where no case has the value of the selector."""

    type: Switch
    count: Count


class CaseStep(msgspec.Struct, frozen=True, kw_only=True, eq=False, dict=True):
    """The step for one value of a selector."""

    value: int | None
    """None: every value that no other case has."""
    name: str
    step: AnyStep

    @property
    def is_empty(self) -> bool:
        """True if the case has no fields, so that there is no value."""
        return isinstance(self.step, RecordStep) and not self.step.steps


class ChooseStep(Step, frozen=True, kw_only=True, eq=False, dict=True):
    """One of several steps, chosen by an earlier number."""

    type: Switch
    expression: Expression
    """What chooses, as the schema has it."""
    selector: int | Formula
    """The number that chooses; of a constant its value."""
    cases: tuple[CaseStep, ...]
    """The steps for some values each; last the one for all others, if there is one."""
    rest: RestStep | None
    """The step for the bytes of other values; None where they have a case or are invalid."""

    @cached_property
    def otherwise(self) -> CaseStep | None:
        """The case of all values that no other one has, if there is one."""
        return self.cases[-1] if self.cases and self.cases[-1].value is None else None

    def case(self, value: int) -> AnyStep | RestStep | None:
        """The step for a value of the selector; None where it is invalid."""
        found = next((case for case in self.cases if case.value == value), self.otherwise)
        return self.rest if found is None else found.step


class ConditionalPresence(msgspec.Struct, frozen=True, kw_only=True, eq=False):
    """Presence that earlier numbers say."""

    expression: Expression
    """The condition, as the schema has it."""
    holds: int | Formula
    """The condition over a record; of constants 0 where it does not hold."""

    @property
    def member(self) -> str:
        """Name for it in a record: none, as other members say it."""
        return ""


class TrailingPresence(msgspec.Struct, frozen=True, kw_only=True, eq=False):
    """Presence that the end of the payload says: the step is there if bytes are left."""

    member: str
    """Name for it in a record, in which nothing else says it."""
    holds: Formula
    """The condition over a record: that member."""
    behind: str = ""
    """The member of the trailing step in front, which has to be there, too; empty: none."""


class OptionalStep(Step, frozen=True, kw_only=True, eq=False, dict=True):
    """A step that is there or not."""

    presence: ConditionalPresence | TrailingPresence
    """What says it."""
    step: AnyStep

    @property
    def fills(self) -> bool:
        """True if it takes all elements or bytes that are left of the payload."""
        return self.step.fills


class RegionStep(Step, frozen=True, kw_only=True, eq=False, dict=True):
    """A step that takes just so many bytes; inside of it, its end is that of the payload."""

    step: AnyStep
    region: Count
    """The bytes."""


AnyStep = (
    IntegerStep
    | FloatStep
    | BytesStep
    | ConstantStep
    | RecordStep
    | RepeatStep
    | ChooseStep
    | OptionalStep
    | RegionStep
)


def _tells_its_end(step: AnyStep) -> bool:
    is_free = isinstance(step, IntegerStep) and step.type.is_free
    is_between = isinstance(step, BytesStep) and step.count.between is not None
    return is_free or is_between or isinstance(step, RegionStep)


class PayloadPlan(msgspec.Struct, frozen=True, kw_only=True, dict=True):
    """The steps of a payload."""

    steps: tuple[AnyStep, ...]
    sizes: SizeSet
    """Wire bytes of the steps; a frame may allow fewer of them."""
    packing: Packing | None = None
    """The run of bits that the numbers of a packed struct are."""

    @cached_property
    def checks(self) -> frozenset[Check]:
        """Faults that the right number of bytes can have."""
        return packing_checks(self.packing).union(*(step.checks for step in self.steps))

    @property
    def has_wrong_values(self) -> bool:
        """True if anything but a byte of more than 7 bits can be wrong."""
        return bool(self.checks - {Check.SEVEN_BIT})

    @cached_property
    def is_refusable(self) -> bool:
        """True if an encoder refuses some values that a record can hold."""
        return any(step.is_refusable for step in self.steps)

    @cached_property
    def has_one_spelling(self) -> bool:
        """True if the same values always have the same bytes."""
        return not any(
            isinstance(step, IntegerStep) and step.type.is_free for step in every_step(self.steps)
        )

    @cached_property
    def holds_values(self) -> bool:
        """True if a record keeps anything of it."""
        return any(map(has_member, self.steps))


def has_member(step: AnyStep) -> bool:
    """True if a record has a value of it, how many there are, or whether it is there."""
    is_told = isinstance(step, OptionalStep) and bool(step.presence.member)
    return step.holds_values or step.fills or is_told


def every_step(steps: Iterable[AnyStep]) -> Iterator[AnyStep]:
    """All steps and those inside of them, in wire order."""
    for step in steps:
        yield step
        match step:
            case RecordStep():
                yield from every_step(step.steps)
            case RepeatStep():
                yield from every_step((step.element,))
            case ConstantStep():
                yield from every_step((step.value,))
            case ChooseStep():
                yield from every_step(case.step for case in step.cases)
            case OptionalStep() | RegionStep():
                yield from every_step((step.step,))
