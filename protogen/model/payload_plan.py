"""Payload plan: the steps that read, check and write a payload, in wire order.

A step knows what a walk over it needs: where its number of elements comes from, what can be wrong
with its bytes, whether an encoder refuses some of its values, whether anything follows it. Names
of fields that count and select are resolved here: a constant one is a number, any other says which
of the records around it holds it. Targets print steps and decide nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto
from functools import cached_property
from math import ceil, floor

from protogen.model.numbers import constant_bytes
from protogen.model.sizes import SizeSet
from protogen.model.types import (
    Array,
    Case,
    Counted,
    Extent,
    Field,
    Fill,
    Fixed,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
    count_name,
    total,
)


class Check(Enum):
    """Something that can be wrong with bytes that are there in the right number."""

    SEVEN_BIT = auto()
    """A byte has its most significant bit set."""
    PADDING = auto()
    """A bit above those of the number is set."""
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


@dataclass(frozen=True, slots=True)
class Reference:
    """An earlier number that counts or selects."""

    name: str
    level: int
    """Depth of the record that holds it: 0 for the plan's own fields, -1 for one around them."""
    type: Integer | None
    """None for a number around the plan."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Count:
    """How many elements or bytes there are."""

    field: str = ""
    """Name of the earlier field that says it, if one does."""
    known: int | None = None
    """The number, where it is always the same."""
    by: Reference | None = None
    """The number that says it, unless that is a constant."""
    member: str = ""
    """Name for the number in a record, where all that is left of the payload is taken."""
    fills: bool = False
    """True if all that is left of the payload is taken."""
    least: int
    greatest: int
    stated: bool
    """True if the schema states the bounds."""

    @property
    def is_fixed(self) -> bool:
        """True if neither a field nor the payload's end says the number."""
        return not self.field and not self.fills


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """Step of a payload plan."""

    name: str
    """Name of the field or case; empty for an element of an array."""
    field: Field
    """The field that says what the values mean."""
    sizes: SizeSet
    """Wire bytes."""
    checks: frozenset[Check]
    """What can be wrong with the right number of bytes."""
    is_refusable: bool
    """True if an encoder refuses some values that a record can hold."""
    holds_values: bool = True
    """True if a record keeps anything of it."""
    is_last: bool = False
    """True if nothing follows it in the payload."""

    @property
    def fills(self) -> bool:
        """True if it takes all elements or bytes that are left of the payload."""
        return False

    @property
    def can_be_wrong(self) -> bool:
        """True if the right number of bytes may still be no value."""
        return bool(self.checks)

    @property
    def has_wrong_values(self) -> bool:
        """True if anything but a byte of more than 7 bits can be wrong."""
        return bool(self.checks - {Check.SEVEN_BIT})


@dataclass(frozen=True, slots=True, kw_only=True)
class NumberStep(Step):
    """An integer or a float."""

    type: Integer | Float


@dataclass(frozen=True, slots=True, kw_only=True)
class FloatStep(NumberStep):
    """A float."""

    type: Float


@dataclass(frozen=True, slots=True, kw_only=True)
class IntegerStep(NumberStep):
    """An integer."""

    type: Integer
    is_needed: bool = False
    """True if it counts or selects something that follows."""

    @property
    def bounds(self) -> tuple[int, int]:
        """The least and the greatest integer that an encoder allows, special values aside."""
        return _bounds(self.field, self.type)


@dataclass(frozen=True, slots=True, kw_only=True)
class BytesStep(Step):
    """A text, or bytes that nobody interprets."""

    type: Text | Octets
    count: Count

    @property
    def fills(self) -> bool:
        """True if it takes all bytes that are left of the payload."""
        return self.count.fills


@dataclass(frozen=True, slots=True, kw_only=True)
class ConstantStep(Step):
    """Bytes that are always the same."""

    data: bytes
    value: IntegerStep | FloatStep | BytesStep | RepeatStep
    """The step that the field would be without the constant."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordStep(Step):
    """A struct: its own steps one after another."""

    type: Struct
    steps: tuple[AnyStep, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RepeatStep(Step):
    """Elements one after another."""

    element: AnyStep
    count: Count

    @property
    def fills(self) -> bool:
        """True if it takes all elements that are left of the payload."""
        return self.count.fills


@dataclass(frozen=True, slots=True, kw_only=True)
class RestStep(Step):
    """The bytes that are left of the payload, where no case has the value of the selector."""

    greatest: int
    seven_bit: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseStep:
    """The step for one value of a selector."""

    value: int
    name: str
    step: AnyStep

    @property
    def is_empty(self) -> bool:
        """True if the case has no fields, so that there is no value."""
        return isinstance(self.step, RecordStep) and not self.step.steps


@dataclass(frozen=True, slots=True, kw_only=True)
class ChooseStep(Step):
    """One of several steps, chosen by an earlier number."""

    selector_name: str
    """Name of the field that chooses."""
    selector: int | Reference
    """The number that chooses; of a constant its value."""
    cases: tuple[CaseStep, ...]
    rest: RestStep | None
    """The step for other values; None where they are invalid."""

    def case(self, value: int) -> AnyStep | RestStep | None:
        """The step for a value of the selector; None where it is invalid."""
        return next((case.step for case in self.cases if case.value == value), self.rest)


AnyStep = IntegerStep | FloatStep | BytesStep | ConstantStep | RecordStep | RepeatStep | ChooseStep


@dataclass(frozen=True, kw_only=True)
class PayloadPlan:
    """The steps of a payload."""

    steps: tuple[AnyStep, ...]
    sizes: SizeSet
    """Wire bytes of the steps; a frame may allow fewer of them."""

    @cached_property
    def checks(self) -> frozenset[Check]:
        """What can be wrong with the right number of bytes."""
        return _checks(self.steps)

    @property
    def has_wrong_values(self) -> bool:
        """True if anything but a byte of more than 7 bits can be wrong."""
        return bool(self.checks - {Check.SEVEN_BIT})

    @cached_property
    def is_refusable(self) -> bool:
        """True if an encoder refuses some values that a record can hold."""
        return any(step.is_refusable for step in self.steps)

    @cached_property
    def holds_values(self) -> bool:
        """True if a record keeps anything of it."""
        return any(step.holds_values or step.fills for step in self.steps)


def without_constant(step: AnyStep) -> AnyStep:
    """The step that reads or writes the same bytes as a value."""
    return step.value if isinstance(step, ConstantStep) else step


def plan_of(fields: Sequence[Field]) -> PayloadPlan:
    """The plan of a message's or struct's fields."""
    steps = _Builder(0, {}, {}).record(fields, is_last=True)
    return PayloadPlan(steps=steps, sizes=total(tuple(fields)))


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


# --- building -------------------------------------------------------------------------------------

_NOTHING: frozenset[Check] = frozenset()
_Scope = Mapping[str, "int | Reference"]
"""The numbers in front, some of which are constants."""
_Key = tuple[str, int, bool, "tuple[tuple[str, int | Reference], ...]"]


class _Builder:
    """Makes the steps of what lies at one depth of records, behind some numbers."""

    def __init__(self, level: int, scope: _Scope, made: dict[_Key, tuple[AnyStep, ...]]) -> None:
        self._level = level
        self._scope = dict(scope)
        self._made = made

    def record(self, fields: Sequence[Field], *, is_last: bool) -> tuple[AnyStep, ...]:
        """The steps of the fields of a record at this depth."""
        steps: list[AnyStep] = []
        needed = _needed_behind(fields)
        for index, field in enumerate(fields):
            member = count_name(fields, field) if field.fills else ""
            at_end = is_last and index == len(fields) - 1
            step = self._step(field, field.type, field.name, at_end, member)
            if isinstance(step, IntegerStep) and field.name in needed[index]:
                step = replace(step, is_needed=True)
            steps.append(_constant(field, step) if field.const is not None else step)
            self._remember(field)
        return tuple(steps)

    def _remember(self, field: Field) -> None:
        number = field.constant_number
        if number is not None:
            self._scope[field.name] = number
        elif isinstance(field.type, Integer):
            self._scope[field.name] = Reference(field.name, self._level, field.type)

    def _find(self, name: str) -> int | Reference:
        return self._scope.get(name, Reference(name, -1, None))

    def _step(
        self, field: Field, type_: Type, name: str, is_last: bool, member: str = ""
    ) -> AnyStep:
        match type_:
            case Integer():
                return IntegerStep(
                    name=name,
                    field=field,
                    sizes=type_.sizes,
                    checks=_number_checks(type_),
                    is_refusable=_is_number_refusable(field, type_),
                    is_last=is_last,
                    type=type_,
                )
            case Float():
                return FloatStep(
                    name=name,
                    field=field,
                    sizes=type_.sizes,
                    checks=_number_checks(type_),
                    is_refusable=field.ranged,
                    is_last=is_last,
                    type=type_,
                )
            case Text() | Octets():
                count = self._count(type_.extent, member)
                return BytesStep(
                    name=name,
                    field=field,
                    sizes=type_.sizes,
                    checks=_seven_bit(type_) | _count_checks(type_.extent),
                    is_refusable=isinstance(type_, Text)
                    or type_.byte_bits == 7
                    or not isinstance(type_.extent, Fixed),
                    is_last=is_last,
                    type=type_,
                    count=count,
                )
            case Struct():
                steps = self._inner(type_, is_last)
                return RecordStep(
                    name=name,
                    field=field,
                    sizes=type_.sizes,
                    checks=_checks(steps),
                    is_refusable=any(step.is_refusable for step in steps),
                    holds_values=any(step.holds_values or step.fills for step in steps),
                    is_last=is_last,
                    type=type_,
                    steps=steps,
                )
            case Array():
                return self._repeat(field, type_, name, is_last, member)
            case Switch():
                return self._choose(field, type_, name, is_last)

    def _inner(self, type_: Struct, is_last: bool) -> tuple[AnyStep, ...]:
        """The steps of a struct, made once for all places where they are the same."""
        outer = tuple((name, self._find(name)) for name in sorted(type_.needs))
        key = type_.name, self._level, is_last, outer
        if key not in self._made:
            inner = _Builder(self._level + 1, self._scope, self._made)
            self._made[key] = inner.record(type_.fields, is_last=is_last)
        return self._made[key]

    def _repeat(
        self, field: Field, type_: Array, name: str, is_last: bool, member: str
    ) -> RepeatStep:
        element = self._step(field, type_.element, "", is_last=False)
        return RepeatStep(
            name=name,
            field=field,
            sizes=type_.sizes,
            checks=element.checks | _count_checks(type_.extent),
            is_refusable=element.is_refusable or not isinstance(type_.extent, Fixed),
            holds_values=element.holds_values,
            is_last=is_last,
            element=element,
            count=self._count(type_.extent, member),
        )

    def _choose(self, field: Field, type_: Switch, name: str, is_last: bool) -> ChooseStep:
        cases = tuple(self._case(field, case, is_last) for case in type_.cases)
        inside = _checks(case.step for case in cases)
        return ChooseStep(
            name=name,
            field=field,
            sizes=type_.sizes,
            checks=inside | ({Check.CASE} if type_.rest is None else _NOTHING),
            is_refusable=True,
            holds_values=type_.holds_values,
            is_last=is_last,
            selector_name=type_.selector,
            selector=self._find(type_.selector),
            cases=cases,
            rest=None if type_.rest is None else _rest(field, type_, type_.rest, is_last),
        )

    def _case(self, field: Field, case: Case, is_last: bool) -> CaseStep:
        step = self._step(field, case.type, case.name, is_last)
        return CaseStep(value=case.value, name=case.name, step=step)

    def _count(self, extent: Extent, member: str) -> Count:
        least, greatest = extent.counts.least, extent.counts.greatest
        if isinstance(extent, Fixed):
            return Count(known=extent.count, least=least, greatest=greatest, stated=True)
        if isinstance(extent, Fill):
            return Count(
                member=member, fills=True, least=least, greatest=greatest, stated=extent.stated
            )
        number = self._find(extent.field)
        by = None if isinstance(number, int) else number
        known = number if isinstance(number, int) else None
        if least == greatest:
            known = least
        return Count(
            field=extent.field,
            known=known,
            by=by,
            least=least,
            greatest=greatest,
            stated=extent.stated,
        )


def _needed_behind(fields: Sequence[Field]) -> list[frozenset[str]]:
    """For each field the names that count or select in those behind it."""
    found: list[frozenset[str]] = []
    needed: frozenset[str] = frozenset()
    for field in reversed(fields):
        found.append(needed)
        needed = (needed - {field.name}) | field.type.needs
    return found[::-1]


def _constant(field: Field, step: AnyStep) -> ConstantStep:
    assert isinstance(step, NumberStep | BytesStep | RepeatStep)
    return ConstantStep(
        name=field.name,
        field=field,
        sizes=step.sizes,
        checks=step.checks | {Check.CONSTANT},
        is_refusable=isinstance(field.type.extent, Counted),
        holds_values=False,
        is_last=step.is_last,
        data=constant_bytes(field),
        value=step,
    )


def _rest(field: Field, type_: Switch, greatest: int, is_last: bool) -> RestStep:
    return RestStep(
        name=type_.rest_name,
        field=field,
        sizes=SizeSet.between(0, greatest),
        checks=frozenset({Check.SEVEN_BIT}) if type_.byte_bits == 7 else _NOTHING,
        is_refusable=True,
        is_last=is_last,
        greatest=greatest,
        seven_bit=type_.byte_bits == 7,
    )


# --- facts of numbers -----------------------------------------------------------------------------


def _checks(steps: Iterable[Step]) -> frozenset[Check]:
    return _NOTHING.union(*(step.checks for step in steps))


def _number_checks(type_: Integer | Float) -> frozenset[Check]:
    found = set(_seven_bit(type_))
    if type_.bits < type_.byte_bits * type_.size:
        found.add(Check.PADDING)
    if isinstance(type_, Integer) and type_.role == "bool":
        found.add(Check.BOOLEAN)
    if isinstance(type_, Integer) and type_.is_closed:
        found.add(Check.CLOSED)
    return frozenset(found)


def _seven_bit(type_: Integer | Float | Text | Octets) -> frozenset[Check]:
    return frozenset({Check.SEVEN_BIT}) if type_.byte_bits == 7 else _NOTHING


def _count_checks(extent: Extent) -> frozenset[Check]:
    return frozenset({Check.COUNT}) if isinstance(extent, Counted) else _NOTHING


def _is_number_refusable(field: Field, type_: Integer) -> bool:
    """True if the machine number that holds the value can have one that is not allowed."""
    if type_.is_closed:
        return True
    if type_.role == "bool" and not field.ranged:
        return False
    least, greatest = _bounds(field, type_)
    machine_greatest = (1 << (type_.width - type_.signed)) - 1
    machine_least = -machine_greatest - 1 if type_.signed else 0
    return least > machine_least or greatest < machine_greatest


def _bounds(field: Field, type_: Integer) -> tuple[int, int]:
    if not field.ranged:
        return type_.least, type_.greatest
    least = type_.least if field.least is None else ceil(field.least)
    greatest = type_.greatest if field.greatest is None else floor(field.greatest)
    return max(least, type_.least), min(greatest, type_.greatest)
