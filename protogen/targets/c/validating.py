"""Statements that tell whether a message can be sent."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor

from protogen.model.sizes import SizeSet
from protogen.model.types import (
    Array,
    Counted,
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
    total,
)
from protogen.targets.c.helpers import Helpers
from protogen.targets.c.lines import Lines
from protogen.targets.c.spelling import constant, counting_type, unsigned
from protogen.targets.c.storage import Scope
from protogen.targets.c.walk import Value, Walk


def can_be_refused(fields: Sequence[Field], sizes: SizeSet) -> bool:
    """Whether some values of a message's members can't be sent."""
    return not sizes.holds(total(tuple(fields))) or any(map(_field_can_be_refused, fields))


def _field_can_be_refused(field: Field) -> bool:
    if field.const is not None:
        extent = getattr(field.type, "extent", None)
        return isinstance(extent, Counted)
    return _can_be_refused(field, field.type)


def _can_be_refused(field: Field, type_: Type) -> bool:
    match type_:
        case Integer():
            return bool(_outside(field, type_, "x")) or _is_closed(type_)
        case Float():
            return field.ranged
        case Text(extent=extent):
            return True
        case Octets(extent=extent):
            return type_.byte_bits == 7 or not isinstance(extent, Fixed)
        case Struct(fields=fields):
            return any(map(_field_can_be_refused, fields))
        case Array(element=element, extent=extent):
            return not isinstance(extent, Fixed) or _can_be_refused(field, element)
        case Switch():
            return True


def _is_closed(type_: Integer) -> bool:
    return type_.enum is not None and type_.enum.closed


def _outside(field: Field, type_: Integer, expression: str) -> str:
    """A condition that holds where a number can't be sent; empty where all can."""
    if type_.role == "bool" and not field.ranged:
        return ""
    least, greatest = _bounds(field, type_)
    types_greatest = (1 << (type_.width - type_.signed)) - 1
    types_least = -types_greatest - 1 if type_.signed else 0
    tests = []
    if least > types_least:
        tests.append(f"{expression} < {constant(least, type_)}")
    if greatest < types_greatest:
        tests.append(f"{expression} > {constant(greatest, type_)}")
    if not tests:
        return ""
    special = [item.value for item in field.special if not least <= item.value <= greatest]
    both = " || ".join(tests)
    if not special:
        return both
    others = [f"{expression} != {constant(value, type_)}" for value in special]
    return " && ".join([f"({both})" if len(tests) > 1 else both, *others])


def _is_bounded_by_bits(field: Field, type_: Integer) -> bool:
    """Whether numbers can't be sent just where some of their upper bits are set."""
    least, greatest = _bounds(field, type_)
    is_plain = not type_.signed and type_.role != "bool" and not _is_closed(type_)
    fits = least == 0 and greatest & (greatest + 1) == 0 and bool(_outside(field, type_, "x"))
    return is_plain and fits and not any(item.value > greatest for item in field.special)


def _bounds(field: Field, type_: Integer) -> tuple[int, int]:
    if not field.ranged:
        return type_.least, type_.greatest
    least = type_.least if field.least is None else ceil(field.least)
    greatest = type_.greatest if field.greatest is None else floor(field.greatest)
    return max(least, type_.least), min(greatest, type_.greatest)


class Validate(Walk):
    """A check of what `message` points to."""

    def __init__(self, helpers: Helpers, lines: Lines, prefix: str) -> None:
        super().__init__(helpers, lines)
        self._error = f"return {prefix.upper()}_ERROR_RANGE;"

    def _refuse(self, condition: str) -> None:
        with self.lines.block(f"if ({condition})"):
            self.lines.add(self._error)

    def value(self, value: Value, scope: Scope) -> None:
        """A value of any type; nothing is said of one that can't be wrong."""
        if _can_be_refused(value.field, value.type):
            super().value(value, scope)

    def scalar(self, value: Value, type_: Integer | Float) -> None:
        """A number."""
        if isinstance(type_, Float):
            self._float(value, type_)
            return
        outside = _outside(value.field, type_, value.expression)
        if outside:
            self._refuse(outside)
        if type_.enum is not None and type_.enum.closed:
            values = tuple(item.value for item in type_.enum.values)
            known = self.helpers.known(type_.enum.name, type_, values)
            self._refuse(f"!{known}({value.expression})")

    def _float(self, value: Value, type_: Float) -> None:
        bounds = self.helpers.float_bounds(type_, value.field.least, value.field.greatest)
        tests = bounds(value.expression)
        if tests:
            self._refuse(f"!({' && '.join(tests)})")

    def constant(self, value: Value, scope: Scope) -> None:
        """What counts it has to say how long it is."""
        extent = getattr(value.type, "extent", None)
        if not isinstance(extent, Counted):
            return
        number = scope[extent.field]
        if not isinstance(number, int):
            size = len(value.field.const) if isinstance(value.field.const, Sequence) else 0
            self._refuse(f"{number.expression} != {unsigned(size)}")

    def bytes(self, value: Value, type_: Text | Octets, count: int | str) -> None:
        """A text, or bytes."""
        if isinstance(type_, Text) or type_.byte_bits == 7:
            amount = unsigned(count) if isinstance(count, int) else count
            seven_bit = self.helpers.seven_bit()
            self._refuse(f"!{seven_bit}({value.expression}, {amount})")

    def count(self, value: Value, extent: Extent, scope: Scope) -> int | str:
        """How many elements or bytes there are, which a struct has to have room for."""
        if isinstance(extent, Fill):
            self._fitting(value.count, extent.greatest)
        elif isinstance(extent, Counted):
            number = scope[extent.field]
            if not isinstance(number, int):
                self._counted(number.expression, number.type, extent)
        return super().count(value, extent, scope)

    def _fitting(self, count: str, greatest: int) -> None:
        capacity = (1 << int(counting_type(greatest)[4:-2])) - 1
        if greatest < capacity:
            self._refuse(f"{count} > {unsigned(greatest)}")

    def _counted(self, expression: str, type_: Integer, extent: Counted) -> None:
        tests = []
        if extent.least > 0:
            tests.append(f"{expression} < {unsigned(extent.least)}")
        if extent.greatest < (1 << type_.width) - 1:
            tests.append(f"{expression} > {unsigned(extent.greatest)}")
        if tests:
            self._refuse(" || ".join(tests))

    def array(self, value: Value, type_: Array, count: int | str, scope: Scope) -> None:
        """Elements."""
        element = type_.element
        if isinstance(element, Integer) and _is_bounded_by_bits(value.field, element):
            amount = unsigned(count) if isinstance(count, int) else count
            found = f"{self.helpers.all_bits(element)}({value.expression}, {amount})"
            self._refuse(_outside(value.field, element, found))
        elif _can_be_refused(value.field, element):
            with self.loop(count) as index:
                self.value(self.element(value, type_, index), scope)

    def rest(self, value: Value, type_: Switch) -> None:
        """The bytes of a value without a case."""
        self._fitting(value.count, type_.rest or 0)
        if type_.byte_bits == 7:
            seven_bit = self.helpers.seven_bit()
            self._refuse(f"!{seven_bit}({value.expression}.bytes, {value.count})")

    def no_case(self) -> None:
        """A value without a case."""
        self.lines.add(self._error)
