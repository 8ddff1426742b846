"""Walks over payloads in memory, which go by a place that moves on."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from protogen.model.payload_plan import ChooseStep, NumberStep, RepeatStep
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.places import Place
from protogen.targets.c.payload.walk import Walk
from protogen.targets.c.spelling import unsigned


def times(count: int | str, size: int) -> int | str:
    """The bytes of so many elements."""
    if isinstance(count, int):
        return count * size
    return f"(size_t){unsigned(size)} * {count}" if size > 1 else count


class PlacedWalk(Walk):
    """A walk that goes by the place in memory of the next byte."""

    def __init__(self, helpers: Helpers, lines: Lines, pointer: str) -> None:
        """Begin at `payload`; `pointer` is the type of what points there, with the star."""
        super().__init__(helpers, lines)
        self._place = Place(lines, pointer)

    def elements(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Walk over elements one by one."""
        element, size = step.element, step.element.sizes.fixed
        if size is None:
            self._place.settle()
            with self.loop(count) as index:
                self.step(element, f"{place}[{index}]")
                self._place.settle()
            return
        several = not isinstance(element, NumberStep)
        self._place.catch_up()
        with self.loop(count) as index, self._place.element(size, index, several=several):
            self.step(element, f"{place}[{index}]")
        self._place.skip(times(count, size))

    def choose(self, step: ChooseStep, place: str) -> None:
        """One of several cases; behind it, `at` stands where the case has ended."""
        if step.is_last or isinstance(step.selector, int):
            self._place.catch_up()
            super().choose(step, place)
            return
        size = step.sizes.fixed
        if size is None:
            self._place.settle()
        self._place.catch_up()
        super().choose(step, place)
        if size is None:
            self._place.settled()
        else:
            self._place.skip(size)

    @contextmanager
    def branch(self) -> Iterator[None]:
        """Every case begins where the choice does."""
        with self._place.branch():
            yield

    def end_case(self, step: ChooseStep) -> None:
        """Settle where the case has ended, if something follows."""
        if not step.is_last and step.sizes.fixed is None:
            self._place.settle()
