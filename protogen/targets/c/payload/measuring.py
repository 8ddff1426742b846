"""Statements that add up the payload's size of a valid message."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from protogen.c_language.numbers import unsigned
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConstantStep,
    IntegerStep,
    NumberStep,
    OptionalStep,
    RepeatStep,
    RestStep,
)
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.filled_packing import FilledRun
from protogen.targets.c.payload.free_numerals import FreeDigits
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.walk import Walk, times


class Measure(Walk):
    """Adds to a variable, which starts as `known`."""

    def __init__(self, helpers: Helpers, lines: Lines, variable: str = "size") -> None:
        super().__init__(helpers, lines)
        self._sum = variable
        self.known = 0
        """Bytes that were not added yet, because they are always the same."""

    def whole(self, step: AnyStep, place: str, around: Walk) -> None:
        """Add what a step takes where another walk has come to."""
        self.follow(around)
        self.step(step, place)
        self._settle()

    def _add(self, size: int | str) -> None:
        if isinstance(size, int):
            self.known += size
        else:
            self.lines.add(f"{self._sum} += {size};")

    def _settle(self) -> None:
        if self.known:
            self.lines.add(f"{self._sum} += {unsigned(self.known)};")
        self.known = 0

    def step(self, step: AnyStep, place: str) -> None:
        """Walk over a step of any kind; one of a fixed size is not looked into."""
        fixed = step.sizes.fixed
        if fixed is not None:
            self._add(fixed)
        else:
            super().step(step, place)

    def number(self, step: NumberStep, place: str) -> None:
        """A number of as many digits as it needs; others have a fixed size."""
        assert isinstance(step, IntegerStep)
        digits = FreeDigits.of(step.type)
        self._add(int(digits.form.leads))
        size = digits.size(self.helpers, place)
        if digits.absent:
            with self.lines.block(f"if ({place} != {digits.absent})"):
                self.lines.add(f"{self._sum} += {size};")
        else:
            self._add(size)

    def constant(self, step: ConstantStep) -> None:
        """A constant."""
        self._add(len(step.data))

    def bytes(self, step: BytesStep | RestStep, place: str, count: int | str) -> None:
        """A text, or bytes, with what ends them, or stands in front."""
        self._add(count)
        if step.count.between is not None:
            self._add(int(step.count.between.leads))
        if step.count.until is not None:
            self._add(1)

    def packed_fill(self, step: RepeatStep, place: str, count: str) -> None:
        """As many packed numbers as there are."""
        self._add(FilledRun.of(step).size(self.helpers, count))

    def repeat(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Elements."""
        size = step.element.sizes.fixed
        if size is not None:
            self._add(times(count, size))
            return
        with self.loop(count) as index:
            known, self.known = self.known, 0
            self.step(step.element, f"{place}[{index}]")
            self._settle()
            self.known = known

    def choose(self, step: ChooseStep, place: str) -> None:
        """One of several cases."""
        if isinstance(step.selector, int):
            super().choose(step, place)
            return
        with self._apart():
            super().choose(step, place)

    def optional(self, step: OptionalStep, place: str) -> None:
        """A step that is there only where a condition holds."""
        if isinstance(step.presence.holds, int):
            super().optional(step, place)
            return
        with self._apart():
            super().optional(step, place)

    @contextmanager
    def _apart(self) -> Iterator[None]:
        """Several ways, each of which adds what it has."""
        known, self.known = self.known, 0
        yield
        self.known = known

    def end_branch(self, step: ChooseStep | OptionalStep) -> None:
        """Add what there is on this way."""
        self._settle()
