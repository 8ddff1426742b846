"""Statements that tell whether bytes are a message's payload.

Values are looked at in wire order. Bytes have to be there before anything is said of them; where
nothing can be wrong with several values in a row, one comparison asks for the bytes of all.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from protogen.model.names import free_name
from protogen.model.numbers import constant_bytes
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
    needed_by,
)
from protogen.targets.c.helpers import Helpers
from protogen.targets.c.lines import Lines
from protogen.targets.c.loading import loaded
from protogen.targets.c.placed import times
from protogen.targets.c.spelling import hexadecimal, integer_type, unsigned
from protogen.targets.c.storage import Number, Scope
from protogen.targets.c.walk import Value, Walk

_RESERVED = frozenset(
    {"payload", "size", "need", "at", "end", "bool", "size_t", "i", "j", "k", "l", "m", "n"}
    | {f"{sign}int{bits}_t" for sign in ("", "u") for bits in (8, 16, 32, 64)}
)
"""Names that a local variable may not have."""


def can_be_wrong(type_: Type) -> bool:
    """Whether the right number of bytes may still be no value of the type."""
    match type_:
        case Integer():
            closed = type_.enum is not None and type_.enum.closed
            unused = type_.bits < type_.byte_bits * type_.size
            return type_.byte_bits == 7 or unused or type_.role == "bool" or closed
        case Float():
            return type_.byte_bits == 7
        case Text(extent=extent) | Octets(extent=extent):
            return type_.byte_bits == 7 or isinstance(extent, Counted)
        case Struct(fields=fields):
            return any(field_can_be_wrong(field) for field in fields)
        case Array(element=element, extent=extent):
            return can_be_wrong(element) or isinstance(extent, Counted)
        case Switch(cases=cases, rest=rest):
            return rest is None or any(can_be_wrong(case.type) for case in cases)


def field_can_be_wrong(field: Field) -> bool:
    """Whether the right number of bytes may still be no value of the field."""
    return field.const is not None or can_be_wrong(field.type)


def has_wrong_values(fields: Sequence[Field]) -> bool:
    """Whether anything but a byte of more than 7 bits can be wrong."""
    return any(field.const is not None or _wrong_value(field.type) for field in fields)


def _wrong_value(type_: Type) -> bool:
    match type_:
        case Integer():
            closed = type_.enum is not None and type_.enum.closed
            return type_.bits < type_.byte_bits * type_.size or type_.role == "bool" or closed
        case Float():
            return type_.bits < type_.byte_bits * type_.size
        case Text(extent=extent) | Octets(extent=extent):
            return isinstance(extent, Counted)
        case Struct(fields=fields):
            return has_wrong_values(fields)
        case Array(element=element, extent=extent):
            return _wrong_value(element) or isinstance(extent, Counted)
        case Switch(cases=cases, rest=rest):
            return rest is None or any(_wrong_value(case.type) for case in cases)


def _carried(type_: Integer | Float) -> int:
    """Bits that a byte may have set before anything else is asked of it; a boolean is 0 or 1."""
    return 8 if isinstance(type_, Integer) and type_.role == "bool" else type_.byte_bits


class Check(Walk):
    """A check of `payload`, which has `size` bytes.

    With `needs`, it is told through a pointer `need`, unless that is NULL, how many bytes there
    have to be at least. A message of a fixed size has
    all of its bytes; the function's head has seen to that.
    """

    def __init__(
        self, helpers: Helpers, lines: Lines, prefix: str, *, fixed: bool, needs: bool
    ) -> None:
        super().__init__(helpers, lines)
        self._error = f"return {prefix.upper()}_ERROR_"
        self._fixed = fixed
        self._needs = needs
        self._at = ""
        self._offset = 0
        self._secured = 0  # Bytes behind `at` that are known to be there.
        self._pending: int | str = 0
        self._unchecked: int | None = None  # Where bytes begin whose top bits are to be checked.
        self._locals = set(_RESERVED)
        self._used: list[frozenset[str]] = []  # Fields of each record that count or select.
        self._branches = 0
        self._ended = False  # Whether something has taken all bytes that there were.

    # --- positions ------------------------------------------------------------------------------

    def _sum(self, offset: int) -> str:
        if not self._at:
            return str(offset)
        return f"{self._at} + {offset}" if offset else self._at

    def _byte(self, index: int = 0) -> str:
        return f"payload[{self._sum(self._offset + index)}]"

    def _address(self, offset: int | None = None) -> str:
        total = self._sum(self._offset if offset is None else offset)
        return "payload" if total == "0" else f"payload + {total}"

    def _require(self, size: int, extra: str = "") -> None:
        """Go on only if so many bytes more are there."""
        due = self._offset + size
        if self._fixed or (not extra and due <= self._secured):
            return
        here = f"size - {self._at}" if self._at else "size"
        amount = " + ".join(filter(None, [unsigned(due) if due or not extra else "", extra]))
        with self.lines.block(f"if ({here} < {amount})"):
            start = f"{self._at} + " if self._at else ""
            self._missing(f"{start}{amount}")
        if not extra:
            self._secured = due

    def _missing(self, due: str) -> None:
        if self._needs:
            self.lines.add(f"return {self.helpers.missing()}(need, {due});")
        else:
            self.lines.add(f"{self._error}SIZE;")

    def _settle(self) -> None:
        """Have `at` stand at the place itself; all bytes in front of it are there."""
        self._flush()
        self._require(0)
        self._move(self._offset)

    def _move(self, distance: int | str) -> None:
        if not self._at:
            start = str(distance) if isinstance(distance, int) else distance
            self.lines.add(f"size_t at = {start};")
            self._at = "at"
        elif distance:
            self.lines.add(f"at += {distance};")
        passed = distance if isinstance(distance, int) else 0
        self._secured = max(0, self._secured - passed) if isinstance(distance, int) else 0
        self._offset = 0

    def finish(self, least: int, greatest: int) -> None:
        """Say what is left to say at the end of the payload; 0 where a bound says nothing."""
        self._flush()
        if self._fixed:
            return
        self._require(0)
        if not self._ended:
            self._refuse(f"size != {self._sum(self._offset)}", "SIZE")
        tests = [f"size < {unsigned(least)}"] if least else []
        tests += [f"size > {unsigned(greatest)}"] if greatest else []
        if tests:
            self._refuse(" || ".join(tests), "SIZE")

    # --- most significant bits ------------------------------------------------------------------

    def _seven_bit(self, size: int) -> None:
        """Have the top bits of so many bytes checked, at the latest before anything else is."""
        if self._unchecked is None:
            self._unchecked = self._offset
        if not self._fixed:
            self._flush(size)

    def _begin(self, byte_bits: int) -> None:
        """Begin a value of such bytes."""
        if byte_bits == 8:
            self._flush()

    def _flush(self, size: int = 0) -> None:
        start = self._unchecked
        self._unchecked = None
        end = self._offset + size
        if start is None or start == end:
            return
        if end - start == 1:
            self._refuse(f"payload[{self._sum(start)}] > 0x7Fu", "ENCODING")
            return
        check = self.helpers.seven_bit()
        self._refuse(f"!{check}({self._address(start)}, {end - start})", "ENCODING")

    def _refuse(self, condition: str, reason: str) -> None:
        with self.lines.block(f"if ({condition})"):
            self.lines.add(f"{self._error}{reason};")

    # --- values ---------------------------------------------------------------------------------

    def fields(self, fields: Sequence[Field], base: str, scope: Scope, *, last: bool) -> None:
        """Keep in mind which numbers count or select something."""
        used = (
            field.name
            for index, field in enumerate(fields)
            if field.name in needed_by(fields[index + 1 :])
        )
        self._used.append(frozenset(used))
        super().fields(fields, base, scope, last=last)
        self._used.pop()

    def remembered(self, field: Field, base: str) -> str:
        """A local variable that has the value."""
        assert isinstance(field.type, Integer)
        if field.name not in self._used[-1]:
            return ""
        name = free_name(field.name, self._locals)
        self._locals.add(name)
        self._offset -= field.type.size
        value = loaded(self.helpers, field.type, self._byte(), self._address())
        self._offset += field.type.size
        self.lines.add(f"const {integer_type(field.type)} {name} = {value};")
        return name

    def scalar(self, value: Value, type_: Integer | Float) -> None:
        """A number."""
        fallible = can_be_wrong(type_)
        self._begin(_carried(type_))
        used = isinstance(type_, Integer) and value.field.name in self._used[-1]
        if fallible or used:
            self._require(type_.size)
        if fallible:
            self._number(type_)
        elif used:
            self._flush()
        self._offset += type_.size

    def _number(self, type_: Integer | Float) -> None:
        if _carried(type_) == 7:
            self._seven_bit(type_.size)
        if _wrong_value(type_):
            self._flush(type_.size)
        unused = type_.byte_bits * type_.size - type_.bits
        if isinstance(type_, Integer) and type_.role == "bool":
            self._refuse(f"{self._byte()} > 1u", "VALUE")
            return
        if unused:
            top = type_.size - 1 if type_.byte_order == "little" else 0
            greatest = (1 << (type_.byte_bits - unused)) - 1
            self._refuse(f"{self._byte(top)} > {hexadecimal(greatest)}", "VALUE")
        if isinstance(type_, Integer) and type_.enum is not None and type_.enum.closed:
            values = tuple(item.value for item in type_.enum.values)
            known = self.helpers.known(type_.enum.name, type_, values)
            number = loaded(self.helpers, type_, self._byte(), self._address())
            self._refuse(f"!{known}({number})", "VALUE")

    def constant(self, value: Value, scope: Scope) -> None:
        """Its bytes, after its elements have been looked at."""
        data = constant_bytes(value.field)
        type_ = value.type
        if isinstance(type_, Array):
            self._constant_array(type_, data, scope)
        elif isinstance(type_, Text | Octets):
            self._constant_bytes(type_, data, scope)
        else:
            assert isinstance(type_, Integer | Float)
            self._begin(_carried(type_))
            self._require(len(data))
            if _carried(type_) == 7:
                self._seven_bit(len(data))
            self._offset += len(data)
            if value.field.const == 0 and isinstance(type_, Float):
                self._zero(type_)
            else:
                self._same(data)

    def _constant_array(self, type_: Array, data: bytes, scope: Scope) -> None:
        size = type_.element.sizes.least
        count = len(data) // size if size else 0
        if not isinstance(type_.extent, Fixed):
            self._right_count(type_.extent, count, size, scope)
        if not can_be_wrong(type_.element):
            self._flush()
        for _ in range(count):
            if can_be_wrong(type_.element):
                self._require(size)
                assert isinstance(type_.element, Integer)
                self._number(type_.element)
            self._offset += size
        self._require(0)
        self._same(data)

    def _constant_bytes(self, type_: Text | Octets, data: bytes, scope: Scope) -> None:
        if not isinstance(type_.extent, Fixed):
            self._right_count(type_.extent, len(data), 1, scope)
        self._begin(type_.byte_bits)
        self._require(len(data))
        if type_.byte_bits == 7 and data:
            self._seven_bit(len(data))
        self._offset += len(data)
        self._same(data)

    def _right_count(self, extent: Extent, count: int, size: int, scope: Scope) -> None:
        """A constant of another size is another constant."""
        self._flush()
        self._require(0)
        if isinstance(extent, Counted):
            number = scope[extent.field]
            if not isinstance(number, int):
                self._refuse(f"{number.expression} != {unsigned(count)}", "VALUE")
            return
        here = f"size - {self._sum(self._offset)}" if self._at or self._offset else "size"
        self._refuse(f"{here} != {unsigned(count * size)}", "VALUE")

    def _same(self, data: bytes) -> None:
        """Refuse other bytes than these in front of the place."""
        self._flush()
        for index, byte in enumerate(data):
            self._refuse(f"{self._byte(index - len(data))} != {hexadecimal(byte)}", "VALUE")

    def _zero(self, type_: Float) -> None:
        """Refuse other numbers than 0 in front of the place; its sign does not matter."""
        self._flush()
        sign = (type_.bits - 1) // type_.byte_bits
        place = sign if type_.byte_order == "little" else type_.size - 1 - sign
        mask = ((1 << type_.byte_bits) - 1) & ~(1 << (type_.bits - 1) % type_.byte_bits)
        for index in range(type_.size):
            byte = self._byte(index - type_.size)
            other = f"({byte} & {hexadecimal(mask)}) != 0u"
            self._refuse(other if index == place else f"{byte} != 0u", "VALUE")

    def bytes(self, value: Value, type_: Text | Octets, count: int | str) -> None:
        """A text, or bytes."""
        seven = type_.byte_bits == 7
        if isinstance(type_.extent, Fill):
            self._filled(type_.extent.greatest, seven=seven)
            return
        self._begin(type_.byte_bits)
        if isinstance(count, int):
            if seven:
                self._require(count)
                self._seven_bit(count)
            self._offset += count
            return
        self._settle()
        self._require(0, count)
        if seven:
            self._refuse(f"!{self.helpers.seven_bit()}(payload + at, {count})", "ENCODING")
        self._move(count)

    def count(self, value: Value, extent: Extent, scope: Scope) -> int | str:
        """How many elements or bytes there are; nothing that was read says it of what fills."""
        if isinstance(extent, Counted):
            number = scope[extent.field]
            if not isinstance(number, int):
                self._bounded(extent, number)
        return super().count(value, extent, scope)

    def _bounded(self, extent: Counted, number: Number) -> None:
        """Refuse numbers of elements that a struct has no room for."""
        self._flush()
        tests = []
        if extent.least > 0:
            tests.append(f"{number.expression} < {unsigned(extent.least)}")
        if extent.greatest < number.type.greatest:
            tests.append(f"{number.expression} > {unsigned(extent.greatest)}")
        if tests:
            self._refuse(" || ".join(tests), "SIZE")

    def _filled(self, greatest: int, *, seven: bool) -> None:
        """All bytes that are left; where the size is always the same there are none."""
        self._flush()
        if self._fixed:
            return
        self._require(0)
        offset = self._sum(self._offset)
        left = f"size - {offset}" if offset != "0" else "size"
        left = f"size - ({offset})" if "+" in offset else left
        self._refuse(f"{left} > {unsigned(greatest)}", "SIZE")
        if seven:
            check = f"!{self.helpers.seven_bit()}({self._address()}, {left})"
            self._refuse(check, "ENCODING")
        if greatest:
            self._end()

    def _end(self) -> None:
        """Nothing is left."""
        if self._branches:
            self._settle()
            self.lines.add("at = size;")
            self._secured = 0
        else:
            self._ended = True

    def array(self, value: Value, type_: Array, count: int | str, scope: Scope) -> None:
        """Elements."""
        if isinstance(type_.extent, Fill):
            self._filling(value, type_, type_.extent, scope)
            return
        size = type_.element.sizes.fixed
        if size is not None and not can_be_wrong(type_.element):
            self._run(count, size)
        elif isinstance(count, int) and self._is_seven_bit_run(type_.element):
            self._seven_bit(count * (size or 0))
            self._offset += count * (size or 0)
        else:
            self._each(value, type_, count, scope)

    def _is_seven_bit_run(self, type_: Type) -> bool:
        return (
            self._fixed
            and isinstance(type_, Integer | Float)
            and type_.byte_bits == 7
            and not _wrong_value(type_)
        )

    def _run(self, count: int | str, size: int) -> None:
        """Elements that can't be wrong."""
        self._flush()
        if isinstance(count, int):
            self._offset += count * size
            return
        self._settle()
        amount = times(count, size)
        self._require(0, str(amount))
        self._move(amount)

    def _each(self, value: Value, type_: Array, count: int | str, scope: Scope) -> None:
        size = type_.element.sizes.fixed
        if size is not None:
            self._each_of(size, value, type_, count, scope)
            return
        self._settle()
        with self.loop(count) as index:
            self._secured = 0
            self.value(self.element(value, type_, index), scope)
            self._settle()
        self._secured = 0

    def _each_of(
        self, size: int, value: Value, type_: Array, count: int | str, scope: Scope
    ) -> None:
        """Elements of one size."""
        self._flush()
        self._require(0)
        before = self._at, self._offset
        with self.loop(count) as index:
            step = f"{size} * {index}" if size > 1 else index
            start = self._sum(self._offset)
            start = step if start == "0" else f"{start} + {step}"
            self._at, self._offset, self._secured = f"at_{index}", 0, 0
            self.lines.add(f"const size_t {self._at} = {start};")
            self.value(self.element(value, type_, index), scope)
            self._flush()
            self._require(0)
            self._at, self._offset = before
        if isinstance(count, int):
            self._offset += count * size
            self._secured = self._offset
        else:
            self._require_nothing(times(count, size))

    def _require_nothing(self, distance: int | str) -> None:
        """Go on behind bytes that were looked at."""
        self._secured = self._offset
        self._move(f"{self._offset}u + {distance}" if self._offset else distance)

    def _filling(self, value: Value, type_: Array, extent: Fill, scope: Scope) -> None:
        if self._fixed:
            return
        self._settle()
        size = type_.element.sizes.fixed
        if size and not self._needs and not can_be_wrong(type_.element):
            self._filling_of(size, extent)
            return
        index = free_name("count", self._locals)
        self._locals.add(index)
        with self.lines.block(f"for (size_t {index} = 0; at < size; {index}++)"):
            self._refuse(f"{index} == {unsigned(extent.greatest)}", "SIZE")
            self._secured = 0
            self.value(self.element(value, type_, index), scope)
            self._settle()
        self._ended = self._branches == 0
        self._secured = 0

    def _filling_of(self, size: int, extent: Fill) -> None:
        """Elements of one size that can't be wrong: their number alone matters.

        Small controllers do not divide.
        """
        self._refuse(f"size - at > {unsigned(extent.greatest * size)}", "SIZE")
        if size > 1 and extent.greatest:
            with self.lines.block("while (at < size)"):
                self.lines.add(f"at += {size};")
            self._refuse("at != size", "SIZE")
        self._end()
        self._secured = 0

    # --- switches -------------------------------------------------------------------------------

    def switch(self, value: Value, type_: Switch, scope: Scope) -> None:
        """One of several cases; behind it, `at` stands where the case has ended."""
        self._flush()
        if isinstance(scope[type_.selector], int):
            super().switch(value, type_, scope)
            return
        size = type_.sizes.fixed
        if size is None:
            self._settle()
        super().switch(value, type_, scope)
        if size is None:
            self._offset, self._secured = 0, 0
        else:
            self._offset += size
            self._secured = self._offset

    @contextmanager
    def branch(self) -> Iterator[None]:
        """Every case begins where the switch does."""
        before = self._at, self._offset, self._secured
        self._branches += 1
        yield
        self._branches -= 1
        self._at, self._offset, self._secured = before

    def end_case(self, value: Value) -> None:
        """It has to be clear where the case has ended."""
        self._flush()
        if value.type.sizes.fixed is None:
            self._settle()
        else:
            self._require(0)

    def rest(self, value: Value, type_: Switch) -> None:
        """The bytes of a value without a case."""
        self._filled(type_.rest or 0, seven=type_.byte_bits == 7)

    def no_case(self) -> None:
        """A value without a case."""
        self.lines.add(f"{self._error}VALUE;")
