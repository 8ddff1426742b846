"""Statements that tell whether a message can be sent."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from itertools import groupby
from typing import NamedTuple

from protogen.c_language.numbers import constant, hexadecimal, unsigned, unsigned_type
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    Check,
    ConstantStep,
    Count,
    FloatStep,
    Formula,
    IntegerStep,
    NumberStep,
    OptionalStep,
    PartStep,
    PayloadPlan,
    RegionStep,
    RepeatStep,
    RestStep,
    TrailingPresence,
)
from protogen.model.sizes import SizeSet
from protogen.model.types import Text, counting_bits, storage_bits
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.between import is_text
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.measuring import Measure
from protogen.targets.c.payload.texts import PaddedText
from protogen.targets.c.payload.walk import Walk, amount, is_unfit, out_of_bounds


def can_be_refused(plan: PayloadPlan, sizes: SizeSet) -> bool:
    """True if some values of a message's members can't be sent."""
    return not sizes.holds(plan.sizes) or plan.is_refusable


def _outside(step: IntegerStep, expression: str) -> str:
    """A condition that holds where a number can't be sent; empty where all can."""
    type_ = step.type
    if type_.role == "bool" and not step.field.ranged:
        return ""
    least, greatest = step.bounds
    machine_least, machine_greatest = type_.machine_bounds
    below = f"{expression} < {constant(least, type_)}" if least > machine_least else ""
    above = f"{expression} > {constant(greatest, type_)}" if greatest < machine_greatest else ""
    outside = " || ".join(filter(None, (below, above)))
    special = [item.value for item in step.field.special if not least <= item.value <= greatest]
    if not outside or not special:
        return outside
    others = [f"{expression} != {constant(value, type_)}" for value in special]
    return " && ".join([f"({outside})" if below and above else outside, *others])


def _is_bounded_by_bits(step: IntegerStep) -> bool:
    """True if numbers can't be sent just where some of their upper bits are set."""
    type_ = step.type
    least, greatest = step.bounds
    is_plain = not type_.signed and type_.role != "bool" and not type_.is_closed
    fits = least == 0 and greatest & (greatest + 1) == 0 and bool(_outside(step, "x"))
    return is_plain and fits and not any(item.value > greatest for item in step.field.special)


class _Span(NamedTuple):
    """Numbers that can be sent just where they have so many bits."""

    storage: int
    """Bits of the member."""
    bits: int
    signed: bool


def _span(step: AnyStep) -> _Span | None:
    """The numbers that can be sent, where those are all of so many bits.

    None for other bounds, and for a number that counts or selects something that follows.
    """
    if not isinstance(step, IntegerStep) or step.is_needed or Check.CLOSED in step.checks:
        return None
    least, greatest = step.bounds
    bits = (greatest - least).bit_length()
    type_ = step.type
    is_whole = greatest - least == (1 << bits) - 1 > 0 and least in (0, -(1 << bits) // 2)
    is_plain = type_.role != "bool" and type_.signed == (least < 0)
    has_offset = not type_.signed or storage_bits(bits) == storage_bits(type_.bits)
    if not (is_whole and is_plain and has_offset and _outside(step, "x")) or step.field.special:
        return None
    return _Span(storage_bits(type_.bits), bits, type_.signed)


def path_of(place: str) -> str:
    """A member of a message as text: `points[].x` for `message->points[i].x`."""
    return re.sub(r"\[\w+\]", "[]", place.removeprefix("message->"))


class Validate(Walk):
    """Prints a check of what `message` points to; `error` is returned for a member.

    With `by_member` each is looked at by itself, else neighbours with the same bounds together.
    """

    def __init__(
        self, helpers: Helpers, lines: Lines, error: Callable[[str], str], *, by_member: bool = True
    ) -> None:
        super().__init__(helpers, lines)
        self._error = error
        self._is_by_member = by_member
        self._member = ""
        self._outermost = lines.margin
        self._refused: set[str] = set()
        """Conditions of which a value is refused whatever the others are."""

    def _refuse(self, condition: str) -> None:
        if condition and condition not in self._refused:
            if self.lines.margin == self._outermost:
                self._refused.add(condition)
            with self.lines.block(f"if ({condition})"):
                self._fail()

    def _fail(self) -> None:
        self.lines.add(f"return {self._error(self._member)};")

    def step(self, step: AnyStep, place: str) -> None:
        """A step of any kind; nothing is said of values that can't be wrong."""
        if step.is_refusable:
            around, self._member = self._member, place
            super().step(step, place)
            self._member = around

    def record(self, steps: Sequence[AnyStep], base: str) -> None:
        """The members of a record; neighbours with the same bounds are looked at together."""
        if self._is_by_member:
            super().record(steps, base)
            return
        self._records.append(base)
        for span, found in groupby((step for step in steps if step.is_refusable), _span):
            group = list(found)
            places = [base + self.helpers.member(step.name) for step in group]
            if span is not None and len(group) > 1:
                self._together(span, places)
            else:
                for step, place in zip(group, places, strict=True):
                    self.step(step, place)
        self._records.pop()

    def _together(self, span: _Span, places: Sequence[str]) -> None:
        """Refuse numbers of which one has more bits.

        It calls nothing: SDCC loses a byte of a message where an expression has two such calls.
        """
        numbers, bits = list(places), span.bits
        if span.signed:
            kind = unsigned_type(bits)
            numbers = [f"({kind}){place}" for place in places]
            if 8 < bits < 16:  # What the lower byte is changes nothing.
                kind, bits = "uint8_t", bits - 8
                numbers = [f"({number} >> 8)" for number in numbers]
            above = hexadecimal(1 << (bits - 1))
            numbers = [f"({kind})({number} + {above})" for number in numbers]
        self._refuse(f"({' | '.join(numbers)}) > {hexadecimal((1 << bits) - 1)}")

    def number(self, step: NumberStep, place: str) -> None:
        """A number."""
        if isinstance(step, FloatStep):
            self._float(step, place)
        elif isinstance(step, IntegerStep):
            self._refuse(_outside(step, place))
            if Check.CLOSED in step.checks:
                self._refuse(f"!{self.helpers.known(step.type)}({place})")

    def part(self, step: PartStep, place: str) -> None:
        """A number of the frame."""
        self.number(step, place)

    def _float(self, step: FloatStep, place: str) -> None:
        tests = self.helpers.float_tests(step, place)
        if tests:
            self._refuse(f"!({' && '.join(tests)})")

    def constant(self, step: ConstantStep) -> None:
        """Refuse a count that is not the constant's size."""
        value = step.value
        if isinstance(value, NumberStep) or value.count.by is None:
            return
        const = step.field.const
        size = len(const) if isinstance(const, str | bytes | tuple) else 0
        self._refuse(self.differs(value.count.by, size))

    def bytes(self, step: BytesStep | RestStep, place: str, count: int | str) -> None:
        """A text, or bytes."""
        if step.count.between is not None:
            self._refuse(f"!{is_text(self.helpers, step.count.between, place, amount(count))}")
        elif isinstance(step.type, Text) or Check.SEVEN_BIT in step.checks:
            self._refuse(f"!{self.helpers.seven_bit()}({place}, {amount(count)})")
        text = PaddedText.of(step.type)
        is_fit = "" if text is None else text.is_fit(self.helpers)
        if is_fit:
            self._refuse(f"!{is_fit}({place}, {amount(count)})")
        if step.count.until is not None:
            end = hexadecimal(step.count.until)
            size = f"{self.helpers.text_size()}({place}, {amount(count)}, {end})"
            self._refuse(f"{size} != {amount(count)}")

    def count(self, count: Count) -> int | str:
        """Number of elements or bytes, which a struct has to have room for."""
        if count.is_delimited:
            self._bounded(self.filled(count), count, counting_bits(count.greatest))
        elif count.by is not None and count.by.plain is not None:
            assert count.by.plain.type is not None
            self._bounded(self.referred(count.by.plain), count, count.by.plain.type.width)
        elif count.by is not None and count.known is not None and is_unfit("", count, count.by):
            self._refuse(is_unfit(self.declared(count.by), count, count.by))
        return super().count(count)

    def worked_out(self, count: Count, by: Formula) -> str:
        """A variable with a number that a struct has to have room for."""
        name = self.declared(by)
        self._refuse(is_unfit(name, count, by))
        return f"(size_t){name}"

    def _bounded(self, number: str, count: Count, bits: int) -> None:
        self._refuse(out_of_bounds(number, count.least, count.greatest, (1 << bits) - 1))

    def repeat(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Elements."""
        element = step.element
        if isinstance(element, IntegerStep) and _is_bounded_by_bits(element):
            found = f"{self.helpers.all_bits(element.type)}({place}, {amount(count)})"
            self._refuse(_outside(element, found))
        elif element.is_refusable:
            self.elements(step, place, count)
        if step.count.mark is not None:
            self._marked(step.count.mark, place, count)

    def _marked(self, mark: Formula, place: str, count: int | str) -> None:
        """Refuse elements of which another one than the last says that it is the last."""
        with self.loop(count) as index:
            says = self.is_last(mark, f"{place}[{index}]")
            self._refuse(f"({says}) != ({index} + 1U == {amount(count)})")

    def optional(self, step: OptionalStep, place: str) -> None:
        """A step that may be there, but not behind one that is left out."""
        presence = step.presence
        if isinstance(presence, TrailingPresence) and presence.behind:
            base = self._records[-1]
            self._refuse(f"{base}{presence.member} && !{base}{presence.behind}")
        if step.step.is_refusable:
            super().optional(step, place)

    def region(self, step: RegionStep, place: str) -> None:
        """What takes just so many bytes."""
        size = amount(self.count(step.region))
        self.step(step.step, place)
        fixed = step.step.sizes.fixed
        if fixed is not None:
            self._refuse(f"{size} != {unsigned(fixed)}" if size != unsigned(fixed) else "")
            return
        content = self.variable("content")
        self.lines.add(f"size_t {content} = 0U;")
        Measure(self.helpers, self.lines, content).whole(step.step, place, self)
        self._refuse(f"{content} != {size}")

    def rest(self, step: RestStep, place: str) -> None:
        """The bytes of a value without a case."""
        self._member, size = place, f"{place}.{step.count.member}"
        self._bounded(size, step.count, counting_bits(step.count.greatest))
        super().rest(step, place)

    def no_case(self) -> None:
        """A value without a case."""
        self._fail()
