"""Walks over the fields of a message, in wire order, to print statements for each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from protogen.model.types import (
    Array,
    Case,
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
)
from protogen.targets.c.helpers import Helpers
from protogen.targets.c.lines import Lines
from protogen.targets.c.spelling import constant, unsigned
from protogen.targets.c.storage import Number, Scope

_INDICES = "ijklmnopqrstuvw"


@dataclass(frozen=True, slots=True)
class Value:
    """What is walked over: a field, an element of its array, or what a case holds."""

    field: Field
    type: Type
    expression: str
    """The member, as `message->points[i]`."""
    count: str
    """The member that says how much of what fills the payload there is."""
    last: bool
    """Whether nothing follows it in the payload."""


class Walk:
    """What all walks have in common. A subclass says what is printed for each kind of value."""

    def __init__(self, helpers: Helpers, lines: Lines) -> None:
        self.helpers = helpers
        self.lines = lines
        self._loops = 0

    def message(self, fields: Sequence[Field]) -> None:
        """Walk over all fields of a message."""
        self.fields(fields, "message->", {}, last=True)

    def fields(self, fields: Sequence[Field], base: str, scope: Scope, *, last: bool) -> None:
        """Walk over fields whose members' expressions begin with `base`."""
        inner = dict(scope)
        for index, field in enumerate(fields):
            count = base + count_name(fields, field) if field.fills else ""
            at_end = last and index == len(fields) - 1
            value = Value(field, field.type, base + field.name, count, at_end)
            if field.const is not None:
                self.constant(value, inner)
            else:
                self.value(value, inner)
            self._remember(field, base, inner)

    def _remember(self, field: Field, base: str, scope: Scope) -> None:
        number = field.constant_number
        if number is not None:
            scope[field.name] = number
        elif isinstance(field.type, Integer):
            scope[field.name] = Number(self.remembered(field, base), field.type)

    def remembered(self, field: Field, base: str) -> str:
        """The expression of a number that may count or select what follows."""
        return base + field.name

    def value(self, value: Value, scope: Scope) -> None:
        """Walk over a value of any type."""
        match value.type:
            case Integer() | Float():
                self.scalar(value, value.type)
            case Text() | Octets():
                count = self.count(value, value.type.extent, scope)
                if count != 0:
                    self.bytes(value, value.type, count)
            case Struct(fields=fields):
                self.fields(fields, f"{value.expression}.", scope, last=value.last)
            case Array():
                count = self.count(value, value.type.extent, scope)
                if count != 0 and value.type.element.sizes.greatest:
                    self.array(value, value.type, count, scope)
            case Switch():
                self.switch(value, value.type, scope)

    def count(self, value: Value, extent: Extent, scope: Scope) -> int | str:
        """How many elements or bytes there are."""
        if isinstance(extent, Fixed):
            return extent.count
        if isinstance(extent, Fill):
            return value.count
        if extent.least == extent.greatest:
            return extent.least
        number = scope[extent.field]
        return number if isinstance(number, int) else number.count

    # --- what subclasses say ----------------------------------------------------------------------

    def constant(self, value: Value, scope: Scope) -> None:
        """A constant."""
        raise NotImplementedError

    def scalar(self, value: Value, type_: Integer | Float) -> None:
        """A number."""
        raise NotImplementedError

    def bytes(self, value: Value, type_: Text | Octets, count: int | str) -> None:
        """A text, or bytes."""
        raise NotImplementedError

    def array(self, value: Value, type_: Array, count: int | str, scope: Scope) -> None:
        """Elements; there are some, and they have bytes."""
        raise NotImplementedError

    def rest(self, value: Value, type_: Switch) -> None:
        """The bytes of a value without a case."""
        raise NotImplementedError

    def no_case(self) -> None:
        """A value without a case that is invalid."""

    def end_case(self, value: Value) -> None:
        """The end of a case."""

    # --- arrays and switches --------------------------------------------------------------------

    @contextmanager
    def loop(self, count: int | str) -> Iterator[str]:
        """A loop over so many elements; yields the index."""
        index = _INDICES[self._loops]
        limit = unsigned(count) if isinstance(count, int) else count
        self._loops += 1
        with self.lines.block(f"for (size_t {index} = 0; {index} < {limit}; {index}++)"):
            yield index
        self._loops -= 1

    def element(self, value: Value, type_: Array, index: str, *, last: bool = False) -> Value:
        """One element of an array."""
        return Value(value.field, type_.element, f"{value.expression}[{index}]", "", last)

    def switch(self, value: Value, type_: Switch, scope: Scope) -> None:
        """One of several cases."""
        selector = scope[type_.selector]
        if isinstance(selector, int):
            self._only_case(value, type_, type_.case(selector), scope)
            return
        with self.lines.switch(selector.selector):
            for case in type_.cases:
                label = f"case {constant(case.value, selector.type)}"
                with self.lines.case(label), self.branch():
                    self._case(value, case, scope)
                    self.end_case(value)
            self._default(value, type_)

    @contextmanager
    def branch(self) -> Iterator[None]:
        """What is printed for one of several cases."""
        yield

    def _only_case(self, value: Value, type_: Switch, case: Case | None, scope: Scope) -> None:
        if case is not None:
            self._case(value, case, scope)
        elif type_.rest is not None:
            self.rest(self._rest_of(value, type_), type_)
        else:
            self.no_case()

    def _case(self, value: Value, case: Case, scope: Scope) -> None:
        expression = f"{value.expression}.{case.name}"
        self.value(Value(value.field, case.type, expression, "", value.last), scope)

    def _default(self, value: Value, type_: Switch) -> None:
        with self.lines.case("default"), self.branch():
            if type_.rest is None:
                self.no_case()
            else:
                self.rest(self._rest_of(value, type_), type_)

    def _rest_of(self, value: Value, type_: Switch) -> Value:
        expression = f"{value.expression}.{type_.rest_name}"
        return Value(value.field, type_, expression, f"{expression}.size", value.last)
