"""Statements that add up the payload's size of a valid message."""

from __future__ import annotations

from protogen.model.numbers import constant_bytes
from protogen.model.types import Array, Float, Integer, Octets, Switch, Text
from protogen.targets.c.helpers import Helpers
from protogen.targets.c.lines import Lines
from protogen.targets.c.placed import times
from protogen.targets.c.storage import Scope
from protogen.targets.c.walk import Value, Walk


class Measure(Walk):
    """Adds to a variable `size`, which starts as `start`."""

    def __init__(self, helpers: Helpers, lines: Lines) -> None:
        super().__init__(helpers, lines)
        self._known = 0

    def _add(self, size: int | str) -> None:
        if isinstance(size, int):
            self._known += size
        else:
            self.lines.add(f"size += {size};")

    @property
    def known(self) -> int:
        """What was not added yet, because it is always the same."""
        return self._known

    def settle(self) -> None:
        """Add what is known."""
        if self._known:
            self.lines.add(f"size += {self._known};")
        self._known = 0

    def value(self, value: Value, scope: Scope) -> None:
        """A value of any type; what is always of one size is not looked into."""
        fixed = value.type.sizes.fixed
        if fixed is not None:
            self._add(fixed)
        else:
            super().value(value, scope)

    def constant(self, value: Value, scope: Scope) -> None:
        """A constant."""
        self._add(len(constant_bytes(value.field)))

    def scalar(self, value: Value, type_: Integer | Float) -> None:
        """A number."""
        self._add(type_.size)

    def bytes(self, value: Value, type_: Text | Octets, count: int | str) -> None:
        """A text, or bytes."""
        self._add(count)

    def array(self, value: Value, type_: Array, count: int | str, scope: Scope) -> None:
        """Elements."""
        size = type_.element.sizes.fixed
        if size is not None:
            self._add(times(count, size))
            return
        with self.loop(count) as index:
            known, self._known = self._known, 0
            self.value(self.element(value, type_, index), scope)
            self.settle()
            self._known = known

    def switch(self, value: Value, type_: Switch, scope: Scope) -> None:
        """One of several cases."""
        if isinstance(scope[type_.selector], int):
            super().switch(value, type_, scope)
            return
        known, self._known = self._known, 0
        super().switch(value, type_, scope)
        self._known = known

    def end_case(self, value: Value) -> None:
        """Add what the case has."""
        self.settle()

    def rest(self, value: Value, type_: Switch) -> None:
        """The bytes of a value without a case."""
        self._add(value.count)
