"""Statements that put a valid message's payload into memory, or into a writer byte by byte."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from protogen.model.types import Array, Float, Integer, Octets, Switch, Text, Type
from protogen.targets.c.constants import constant_bytes
from protogen.targets.c.helpers import Helpers, bits_of, is_plain, parted
from protogen.targets.c.lines import Lines
from protogen.targets.c.places import Place
from protogen.targets.c.spelling import hexadecimal, unsigned, unsigned_type
from protogen.targets.c.storage import Scope
from protogen.targets.c.walk import Value, Walk


def byte_of(type_: Integer, expression: str) -> str:
    """The only byte of a number."""
    if type_.role == "bool":
        return f"(uint8_t){expression}"
    if is_plain(type_):
        return f"(uint8_t){expression}" if type_.signed else expression
    return parted(type_, raw_of(type_, expression))[0]


def raw_of(type_: Integer, expression: str) -> str:
    """The unsigned value of a number."""
    return f"({unsigned_type(type_.bits)}){expression}" if type_.signed else expression


def is_bytes(type_: Type) -> bool:
    """Whether elements of the type lie in memory as they lie on the wire."""
    return isinstance(type_, Integer) and is_plain(type_) and type_.role != "bool"


def times(count: int | str, size: int) -> int | str:
    """The bytes of so many elements."""
    if isinstance(count, int):
        return count * size
    return f"(size_t){unsigned(size)} * {count}" if size > 1 else count


class Store(Walk):
    """Into memory."""

    def __init__(self, helpers: Helpers, lines: Lines) -> None:
        super().__init__(helpers, lines)
        self._place = Place(lines, "uint8_t *")

    def constant(self, value: Value, scope: Scope) -> None:
        """Its bytes."""
        data = constant_bytes(value.field)
        for index, byte in enumerate(data):
            self.lines.add(f"{self._place.byte(index)} = {hexadecimal(byte)};")
        self._place.skip(len(data))

    def scalar(self, value: Value, type_: Integer | Float) -> None:
        """A number."""
        expression = value.expression
        if isinstance(type_, Float):
            expression = f"{self.helpers.bits_of_float(type_)}({expression})"
            type_ = bits_of(type_)
        if type_.size == 1:
            self.lines.add(f"{self._place.byte()} = {byte_of(type_, expression)};")
        else:
            store = self.helpers.store(type_)
            self.lines.add(f"{store}({self._place.address()}, {raw_of(type_, expression)});")
        self._place.skip(type_.size)

    def bytes(self, value: Value, type_: Text | Octets, count: int | str) -> None:
        """A text, or bytes."""
        self._copy(value.expression, count)

    def _copy(self, expression: str, count: int | str) -> None:
        amount = unsigned(count) if isinstance(count, int) else count
        copy = self.helpers.copy()
        self.lines.add(f"{copy}({self._place.address()}, {expression}, {amount});")
        self._place.skip(count)

    def array(self, value: Value, type_: Array, count: int | str, scope: Scope) -> None:
        """Elements."""
        if is_bytes(type_.element):
            self._copy(value.expression, count)
            return
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

    def rest(self, value: Value, type_: Switch) -> None:
        """The bytes of a value without a case."""
        self._copy(f"{value.expression}.bytes", value.count)


class Put(Walk):
    """Into a writer."""

    def __init__(self, helpers: Helpers, lines: Lines, prefix: str, writing: str) -> None:
        super().__init__(helpers, lines)
        self._write = f"{prefix}_write"
        self._writing = writing

    def constant(self, value: Value, scope: Scope) -> None:
        """Its bytes."""
        for byte in constant_bytes(value.field):
            self.lines.add(f"{self._write}({self._writing}, {hexadecimal(byte)});")

    def scalar(self, value: Value, type_: Integer | Float) -> None:
        """A number."""
        expression = value.expression
        if isinstance(type_, Float):
            expression = f"{self.helpers.bits_of_float(type_)}({expression})"
            type_ = bits_of(type_)
        if type_.size == 1:
            self.lines.add(f"{self._write}({self._writing}, {byte_of(type_, expression)});")
        else:
            write = self.helpers.write(type_)
            self.lines.add(f"{write}({self._writing}, {raw_of(type_, expression)});")

    def bytes(self, value: Value, type_: Text | Octets, count: int | str) -> None:
        """A text, or bytes."""
        self._bytes(value.expression, count)

    def _bytes(self, expression: str, count: int | str) -> None:
        amount = unsigned(count) if isinstance(count, int) else count
        self.lines.add(f"{self.helpers.write_bytes()}({self._writing}, {expression}, {amount});")

    def array(self, value: Value, type_: Array, count: int | str, scope: Scope) -> None:
        """Elements."""
        if is_bytes(type_.element):
            self._bytes(value.expression, count)
            return
        with self.loop(count) as index:
            self.value(self.element(value, type_, index), scope)

    def rest(self, value: Value, type_: Switch) -> None:
        """The bytes of a value without a case."""
        self._bytes(f"{value.expression}.bytes", value.count)
