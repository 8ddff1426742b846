"""Functions of C that take a struct's values from a driver's input, or write them to its output.

The bytes are those of `c_values`. One function does both, so that they can't differ.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from protogen.model.types import (
    Array,
    Counted,
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
from protogen.targets.c.payload.numbers import Number, Scope
from protogen.targets.c.spelling import constant


def walk_function(name: str, struct: str, fields: Sequence[Field]) -> str:
    """The function for a message's struct."""
    walk = _Walk()
    walk.fields(fields, "message->", {})
    return "\n".join([f"static void {name}({struct} *message) {{", *walk.body(), "}"])


class _Walk:
    def __init__(self) -> None:
        self._lines: list[str] = []
        self._depth = 1
        self._loops = 0

    def body(self) -> list[str]:
        """The statements."""
        return ["    (void)message;", *self._lines]

    def _add(self, line: str) -> None:
        self._lines.append("    " * self._depth + line)

    @contextmanager
    def _block(self, head: str) -> Iterator[None]:
        self._add(f"{head} {{")
        self._depth += 1
        yield
        self._depth -= 1
        self._add("}")

    def fields(self, fields: Sequence[Field], at: str, scope: Scope) -> None:
        """The members of a struct; `at` is the struct and what selects a member of it."""
        inner = dict(scope)
        for field in fields:
            if isinstance(field.type, Integer):
                inner[field.name] = (
                    int(field.const)
                    if isinstance(field.const, int)
                    else Number(f"{at}{field.name}", field.type)
                )
            count = ""
            if field.fills:
                count = f"{at}{count_name(fields, field)}"
                self._scalar(count)
            if field.is_stored:
                self._value(field.type, f"{at}{field.name}", count, inner)

    def _scalar(self, place: str) -> None:
        self._add(f"scalar(&{place}, (uint8_t)sizeof {place});")

    def _value(self, type_: Type, place: str, count: str, scope: Scope) -> None:
        match type_:
            case Integer() | Float():
                self._scalar(place)
            case Text(extent=extent) | Octets(extent=extent):
                self._add(f"octets({place}, (size_t){self._count(extent, count, scope)});")
            case Struct(fields=fields):
                self.fields(fields, f"{place}.", scope)
            case Array():
                self._elements(type_, place, count, scope)
            case Switch():
                self._cases(type_, place, scope)

    def _count(self, extent: Fixed | Counted | Fill, count: str, scope: Scope) -> str:
        match extent:
            case Fixed(count=number):
                return str(number)
            case Fill():
                return count
            case Counted(field=field):
                found = scope[field]
                return str(found) if isinstance(found, int) else found.expression

    def _elements(self, type_: Array, place: str, count: str, scope: Scope) -> None:
        if not type_.element.holds_values:
            return
        index = f"i{self._loops}"
        self._loops += 1
        limit = self._count(type_.extent, count, scope)
        head = f"for (size_t {index} = 0; {index} != (size_t){limit}; {index}++)"
        with self._block(head):
            self._value(type_.element, f"{place}[{index}]", "", scope)

    def _cases(self, type_: Switch, place: str, scope: Scope) -> None:
        selector = scope[type_.selector]
        for case in type_.cases:
            if isinstance(selector, int):
                condition = "true" if selector == case.value else "false"
            else:
                literal = constant(case.value, selector.type)
                condition = f"{selector.expression} == {literal}"
            with self._block(f"if ({condition})"):
                if case.type.holds_values:
                    self._value(case.type, f"{place}.{case.name}", "", scope)
            self._add("else")
        with self._block(""):
            if type_.rest is not None:
                rest = f"{place}.{type_.rest_name}"
                self._scalar(f"{rest}.size")
                self._add(f"octets({rest}.bytes, (size_t){rest}.size);")
