"""Packed numbers, whose bits are read and written all at once, as one great integer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import groupby

import msgspec

from protogen.model.packing import FilledPacking, Packing
from protogen.model.payload_builder import plan_of_struct
from protogen.model.payload_plan import AnyStep, IntegerStep, RecordStep, RepeatStep
from protogen.model.payload_walks import PackedNumber, packed_numbers
from protogen.model.types import Struct
from protogen.runtime.attributes import attribute
from protogen.targets.python.engine.layout import outside_of
from protogen.targets.python.engine.lines import Lines
from protogen.targets.python.literals import number

Named = Callable[[str, IntegerStep], str]
"""Gives the expression of an enum's member or of flags for that of a number."""


class Record(msgspec.Struct, frozen=True):
    """A packed struct: its name, its fields, and their bits."""

    name: str
    steps: Sequence[AnyStep]
    packing: Packing

    @classmethod
    def of_struct(cls, struct: Struct) -> Record:
        """The struct by itself."""
        plan = plan_of_struct(struct)
        assert plan.packing is not None
        return cls(struct.name, plan.steps, plan.packing)

    @classmethod
    def of_step(cls, step: RecordStep) -> Record:
        """The struct that a step is."""
        assert step.packing is not None
        return cls(step.type.name, step.steps, step.packing)


def unpacked(lines: Lines, data: str, step: RecordStep | RepeatStep, named: Named) -> str:
    """Take the numbers out of the bytes `data`; the expression of the record or list."""
    if isinstance(step, RecordStep):
        value = lines.local("s")
        unpack_record(lines, data, value, Record.of_step(step), named)
        return value
    assert isinstance(step.packing, Packing)
    return _Unpacking(lines, step.packing, data, named).elements(step)


def unpacked_fill(lines: Lines, data: str, step: RepeatStep, named: Named) -> str:
    """Take as many numbers as there are out of the bytes `data`; the expression of the list."""
    assert isinstance(step.packing, FilledPacking)
    return _UnpackingFill(lines, step.packing, data, named).elements(step)


def unpack_record(lines: Lines, data: str, target: str, record: Record, named: Named) -> None:
    """Make the record `target` of the bytes `data`."""
    _Unpacking(lines, record.packing, data, named).record(target, record)


class _Numbers:
    """Prints expressions of the numbers of one run, which is read as an integer."""

    def __init__(
        self, lines: Lines, packing: Packing | FilledPacking, data: str, named: Named
    ) -> None:
        self._lines = lines
        self._named = named
        self._run = lines.local("bits")
        lines.add(f'{self._run} = int.from_bytes({data}, "{packing.byte_order}")')

    def _number(self, shift: str, step: IntegerStep) -> str:
        type_ = step.type
        moved = self._run if shift == "0" else f"{self._run} >> {shift}"
        raw = f"{moved} & {(1 << type_.bits) - 1}"
        if type_.role == "bool":
            return f"({raw}) == 1"
        if not type_.signed:
            return self._named(raw, step)
        sign = 1 << type_.bits - 1
        return self._named(f"(({raw}) ^ {sign}) - {sign}", step)


class _Unpacking(_Numbers):
    """Numbers of a run whose length is known."""

    def __init__(self, lines: Lines, packing: Packing, data: str, named: Named) -> None:
        """See that what belongs to no number is zero."""
        super().__init__(lines, packing, data, named)
        self._packing = packing
        left = 8 * packing.size - packing.bits
        if left:
            is_above = packing.order == "lsb_first"
            rest = f">> {packing.bits}" if is_above else f"& {(1 << left) - 1}"
            lines.refuse_if(f"{self._run} {rest}")

    def elements(self, step: RepeatStep) -> str:
        """The list of all elements."""
        element, count = step.element, step.count.known or 0
        assert isinstance(element, IntegerStep)
        bits = element.type.bits
        first = self._packing.shift(0, bits)
        last = self._packing.shift((count - 1) * bits, bits)
        way = bits if last >= first else -bits
        stop = last + (1 if way > 0 else -1)
        value = self._number("at", element)
        return f"[{value} for at in range({first}, {stop}, {way})]"

    def record(self, target: str, record: Record) -> None:
        """A record with all fields."""
        self._lines.add(f"{target} = _new({self._lines.classes[record.name]})")
        for name, numbers in groupby(packed_numbers(record.steps), lambda item: item.name):
            self._field(f"{target}.{attribute(name)}", list(numbers))

    def _field(self, target: str, numbers: list[PackedNumber]) -> None:
        values = [self._placed(item) for item in numbers]
        is_list = numbers[0].index is not None
        self._lines.add(f"{target} = {'[' + ', '.join(values) + ']' if is_list else values[0]}")
        constants = [item.constant for item in numbers if item.constant is not None]
        if constants:
            self._lines.refuse_if(f"{target} != {constants if is_list else constants[0]}")

    def _placed(self, item: PackedNumber) -> str:
        return self._number(str(self._packing.shift(item.first, item.step.type.bits)), item.step)


class _UnpackingFill(_Numbers):
    """Numbers of a run that is as long as its bytes say."""

    def __init__(self, lines: Lines, packing: FilledPacking, data: str, named: Named) -> None:
        super().__init__(lines, packing, data, named)
        self._packing = packing
        self._size = f"len({data})"

    def elements(self, step: RepeatStep) -> str:
        """The list of all elements, after what belongs to none has been seen to be zero."""
        assert isinstance(step.element, IntegerStep)
        lines, width, run = self._lines, self._packing.width, self._run
        count, left = lines.local("n"), lines.local("left")
        lines.add(f"{count}, {left} = divmod(8 * {self._size}, {width})")
        lines.refuse_if(f"{left} > 7 or {outside_of(step.count, count)}")
        is_last_first = self._packing.order == "lsb_first"
        if width % 8 and is_last_first:
            lines.refuse_if(f"{run} >> {count} * {width}")
        elif width % 8:
            lines.refuse_if(f"{run} & (1 << {left}) - 1")
            lines.add(f"{run} >>= {left}")
        places = f"0, {count} * {width}, {width}"
        if not is_last_first:
            places = f"({count} - 1) * {width}, -1, -{width}"
        return f"[{self._number('at', step.element)} for at in range({places})]"


def packed(lines: Lines, value: str, step: RecordStep | RepeatStep) -> str:
    """Check the numbers of a record or list; the expression of their bytes."""
    if isinstance(step, RecordStep):
        return packed_record(lines, value, Record.of_step(step))
    assert isinstance(step.packing, Packing)
    return _Packing(lines, step.packing).elements(value, step)


def packed_fill(lines: Lines, value: str, step: RepeatStep) -> str:
    """Check as many numbers as a list has; the expression of their bytes."""
    assert isinstance(step.packing, FilledPacking)
    return _PackingFill(lines, step.packing).elements(value, step)


def packed_record(lines: Lines, value: str, record: Record) -> str:
    """Check the numbers of a record; the expression of their bytes."""
    return _Packing(lines, record.packing).record(value, record)


class _Joining:
    """Prints checks of the numbers of one run, and statements that join them to an integer."""

    def __init__(self, lines: Lines, is_last_first: bool) -> None:
        self._lines = lines
        self._is_last_first = is_last_first
        self._run = lines.local("bits")

    def _join(self, value: str, element: AnyStep) -> None:
        """Join all elements of a list, the ones of greater significance first."""
        assert isinstance(element, IntegerStep)
        bits = element.type.bits
        self._lines.add(f"{self._run} = 0")
        each = f"reversed({value})" if self._is_last_first else value
        with self._lines.block(f"for each in {each}:"):
            self._check("each", element)
            raw = f"each & {(1 << bits) - 1}" if element.type.signed else "each"
            self._lines.add(f"{self._run} = {self._run} << {bits} | {raw}")

    def _check(self, value: str, step: IntegerStep) -> None:
        """See to it that a value may be sent."""
        type_, field = step.type, step.field
        if type_.role == "bool":
            self._lines.refuse_if(f"type({value}) is not bool")
            return
        named = type_.enum or type_.flags
        other = f" and type({value}) is not {self._lines.classes[named.name]}" if named else ""
        self._lines.refuse_if(f"type({value}) is not int{other}")
        if type_.enum is not None and type_.is_closed:
            members = f"frozenset(map(int, {self._lines.classes[type_.enum.name]}))"
            self._lines.refuse_if(
                f"{value} not in {self._lines.constants.named('VALUES', members)}"
            )
        least, greatest = step.bounds
        allowed = f"not {number(least)} <= {value} <= {number(greatest)}"
        if field.ranged and field.special:
            special = ", ".join(str(item.value) for item in field.special)
            allowed += f" and {value} not in ({special},)"
        self._lines.refuse_if(allowed)


class _PackingFill(_Joining):
    """A run of as many numbers as there are."""

    def __init__(self, lines: Lines, packing: FilledPacking) -> None:
        super().__init__(lines, packing.order == "lsb_first")
        self._packing = packing

    def elements(self, value: str, step: RepeatStep) -> str:
        """All elements of a list."""
        lines, width = self._lines, self._packing.width
        lines.refuse_if(f"type({value}) is not list or {outside_of(step.count, f'len({value})')}")
        self._join(value, step.element)
        size = lines.local("size")
        lines.add(f"{size} = (len({value}) * {width} + 7) // 8")
        if width % 8 and not self._is_last_first:
            lines.add(f"{self._run} <<= 8 * {size} - len({value}) * {width}")
        return f'{self._run}.to_bytes({size}, "{self._packing.byte_order}")'


class _Packing(_Joining):
    """A run whose length is known."""

    def __init__(self, lines: Lines, packing: Packing) -> None:
        super().__init__(lines, packing.order == "lsb_first")
        self._packing = packing

    @property
    def _bytes(self) -> str:
        return f'{self._run}.to_bytes({self._packing.size}, "{self._packing.byte_order}")'

    def elements(self, value: str, step: RepeatStep) -> str:
        """All elements of a list."""
        self._list(value, step.count.known or 0)
        self._join(value, step.element)
        left = 8 * self._packing.size - self._packing.bits
        if left and not self._is_last_first:
            self._lines.add(f"{self._run} <<= {left}")
        return self._bytes

    def record(self, value: str, record: Record) -> str:
        """All fields of a record."""
        self._lines.refuse_if(f"type({value}) is not {self._lines.classes[record.name]}")
        self._lines.add(f"{self._run} = 0")
        for name, numbers in groupby(packed_numbers(record.steps), lambda item: item.name):
            self._field(f"{value}.{attribute(name)}", list(numbers))
        return self._bytes

    def _list(self, value: str, count: int) -> None:
        self._lines.refuse_if(f"type({value}) is not list or len({value}) != {count}")

    def _field(self, source: str, numbers: list[PackedNumber]) -> None:
        value = self._lines.local()
        self._lines.add(f"{value} = {source}")
        is_list = numbers[0].index is not None
        if is_list:
            self._list(value, len(numbers))
        for item in numbers:
            each = value
            if is_list:
                each = self._lines.local()
                self._lines.add(f"{each} = {value}[{item.index}]")
            if item.constant is not None:
                self._lines.refuse_if(f"{each} != {item.constant}")
            self._check(each, item.step)
            self._put(each, item)

    def _put(self, value: str, item: PackedNumber) -> None:
        type_ = item.step.type
        shift = self._packing.shift(item.first, type_.bits)
        raw = f"int({value})" if type_.is_named else value
        if type_.signed:
            raw = f"({value} & {(1 << type_.bits) - 1})"
        self._lines.add(f"{self._run} |= {raw} << {shift}" if shift else f"{self._run} |= {raw}")
