"""What walks over payloads in memory have in common: both go by a place that moves on."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from protogen.model.types import Array, Float, Integer, Switch
from protogen.targets.c.helpers import Helpers
from protogen.targets.c.lines import Lines
from protogen.targets.c.places import Place
from protogen.targets.c.spelling import unsigned
from protogen.targets.c.storage import Scope
from protogen.targets.c.walk import Value, Walk


def times(count: int | str, size: int) -> int | str:
    """The bytes of so many elements."""
    if isinstance(count, int):
        return count * size
    return f"(size_t){unsigned(size)} * {count}" if size > 1 else count


class PlacedWalk(Walk):
    """A walk that goes by the place in memory of the next byte."""

    def __init__(self, helpers: Helpers, lines: Lines, pointer: str) -> None:
        """`pointer` is the type of what points there, with the star."""
        super().__init__(helpers, lines)
        self._place = Place(lines, pointer)

    def elements(self, value: Value, type_: Array, count: int | str, scope: Scope) -> None:
        """Walk over elements one by one."""
        size = type_.element.sizes.fixed
        if size is None:
            self._place.settle()
            with self.loop(count) as index:
                self.value(self.element(value, type_, index), scope)
                self._place.settle()
            return
        several = not isinstance(type_.element, Integer | Float)
        self._place.catch_up()
        with self.loop(count) as index, self._place.element(size, index, several=several):
            self.value(self.element(value, type_, index), scope)
        self._place.skip(times(count, size))

    def switch(self, value: Value, type_: Switch, scope: Scope) -> None:
        """One of several cases; behind it, `at` stands where the case has ended."""
        if value.last or isinstance(scope[type_.selector], int):
            self._place.catch_up()
            super().switch(value, type_, scope)
            return
        size = type_.sizes.fixed
        if size is None:
            self._place.settle()
        self._place.catch_up()
        super().switch(value, type_, scope)
        if size is None:
            self._place.settled()
        else:
            self._place.skip(size)

    @contextmanager
    def branch(self) -> Iterator[None]:
        """Every case begins where the switch does."""
        with self._place.branch():
            yield

    def end_case(self, value: Value) -> None:
        """Where something follows, it has to be clear where the case has ended."""
        if not value.last and value.type.sizes.fixed is None:
            self._place.settle()
