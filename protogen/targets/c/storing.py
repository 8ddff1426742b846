"""Statements that put a valid message's payload into memory, or into a writer byte by byte."""

from __future__ import annotations

from protogen.model.numbers import constant_bytes
from protogen.model.types import Array, Float, Integer, Octets, Switch, Text, Type
from protogen.targets.c.helpers import Helpers, is_plain, parted
from protogen.targets.c.lines import Lines
from protogen.targets.c.placed import PlacedWalk
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


class Store(PlacedWalk):
    """Into memory."""

    def __init__(self, helpers: Helpers, lines: Lines) -> None:
        super().__init__(helpers, lines, "uint8_t *")

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
            type_ = type_.pattern
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
        else:
            self.elements(value, type_, count, scope)

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
            type_ = type_.pattern
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
