"""Statements that take a message out of a payload that was checked."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.model.numbers import constant_bytes
from protogen.model.types import Array, Field, Fill, Float, Integer, Octets, Switch, Text
from protogen.targets.c.helpers import Helpers, is_plain, is_whole
from protogen.targets.c.lines import Lines
from protogen.targets.c.placed import PlacedWalk, times
from protogen.targets.c.spelling import counting_type, integer_type, unsigned
from protogen.targets.c.storage import Scope
from protogen.targets.c.storing import is_bytes
from protogen.targets.c.walk import Value


def loaded(helpers: Helpers, type_: Integer | Float, byte: str, address: str) -> str:
    """The number that lies there; `byte` is its first byte."""
    if isinstance(type_, Float):
        return f"{helpers.load(type_)}({address})"
    if type_.role == "bool":
        return f"{byte} != 0u"
    if is_plain(type_):
        return f"({integer_type(type_)}){byte}" if type_.signed else byte
    if type_.signed and is_whole(type_):
        raw = Integer(bits=type_.bits, byte_bits=type_.byte_bits, byte_order=type_.byte_order)
        return f"({integer_type(type_)}){helpers.load(raw)}({address})"
    return f"{helpers.load(type_)}({address})"


class Load(PlacedWalk):
    """Out of memory. Where the size varies, there is a variable `size`."""

    def __init__(self, helpers: Helpers, lines: Lines) -> None:
        super().__init__(helpers, lines, "const uint8_t *")
        self.uses_size = False

    def pointed(self, fields: Sequence[Field], base: str) -> None:
        """Take fields that lie where there is an `at` already; what counts is among them."""
        self._place.settled()
        self.fields(fields, base, {}, last=True)

    def constant(self, value: Value, scope: Scope) -> None:
        """It was checked, and nothing keeps it."""
        self._place.skip(len(constant_bytes(value.field)))

    def scalar(self, value: Value, type_: Integer | Float) -> None:
        """A number."""
        expression = loaded(self.helpers, type_, self._place.byte(), self._place.address())
        self.lines.add(f"{value.expression} = {expression};")
        self._place.skip(type_.size)

    def bytes(self, value: Value, type_: Text | Octets, count: int | str) -> None:
        """A text, or bytes."""
        if isinstance(type_.extent, Fill):
            self._rest(value, value.expression, type_.extent.greatest)
        else:
            self._copy(value.expression, count)

    def _rest(self, value: Value, expression: str, greatest: int) -> None:
        """Take all bytes that are left."""
        if greatest == 0:
            self.lines.add(f"{value.count} = 0u;")
            return
        self._fill(value, greatest)
        self._copy(expression, value.count)

    def _fill(self, value: Value, greatest: int) -> None:
        """Say how many bytes are left."""
        self.uses_size = True
        name, offset = self._place.passed
        left = "size" if name == "payload" else "(size_t)(payload + size - at)"
        left = f"{left} - {offset}u" if offset else left
        cast = counting_type(greatest)
        self.lines.add(f"{value.count} = ({cast})({left});")

    def _copy(self, expression: str, count: int | str) -> None:
        amount = unsigned(count) if isinstance(count, int) else count
        copy = self.helpers.copy()
        self.lines.add(f"{copy}({expression}, {self._place.address()}, {amount});")
        self._place.skip(count)

    def array(self, value: Value, type_: Array, count: int | str, scope: Scope) -> None:
        """Elements."""
        if isinstance(type_.extent, Fill):
            self._filling(value, type_, type_.extent, scope)
            return
        if is_bytes(type_.element):
            self._copy(value.expression, count)
            return
        size = type_.element.sizes.fixed
        if size is not None and not type_.element.holds_values:
            self._place.skip(times(count, size))
        elif self.helpers.loads_runs(type_.element) and isinstance(type_.element, Integer):
            run = self.helpers.load_run(type_.element)
            amount = unsigned(count) if isinstance(count, int) else count
            self.lines.add(f"{run}({value.expression}, {self._place.address()}, {amount});")
            self._place.skip(times(count, type_.element.size))
        else:
            self.elements(value, type_, count, scope)

    def _filling(self, value: Value, type_: Array, extent: Fill, scope: Scope) -> None:
        if is_bytes(type_.element) or extent.greatest == 0:
            self._rest(value, value.expression, extent.greatest)
            return
        self.uses_size = True
        self._place.settle()
        self.lines.add(f"{value.count} = 0u;")
        with self.lines.block("while (at < payload + size)"):
            if type_.element.holds_values:
                self.value(self.element(value, type_, value.count), scope)
            else:
                self.value(self.element(value, type_, "0"), scope)
            self._place.settle()
            self.lines.add(f"{value.count}++;")

    def rest(self, value: Value, type_: Switch) -> None:
        """The bytes of a value without a case."""
        self._rest(value, f"{value.expression}.bytes", type_.rest or 0)
