"""The part of a reader that reads arrays: all elements together, or one by one."""

from __future__ import annotations

from abc import abstractmethod
from functools import partial

import msgspec

from protogen.model.packing import FilledPacking
from protogen.model.payload_plan import (
    AnyStep,
    Count,
    Formula,
    IntegerStep,
    RecordStep,
    RepeatStep,
)
from protogen.model.sizes import SizeSet
from protogen.model.types import Tail
from protogen.runtime.attributes import attribute
from protogen.targets.python.engine.converting import Converter
from protogen.targets.python.engine.layout import (
    array_code,
    code_of,
    common_order,
    is_pair,
    order_of,
    outer_names,
    outside_of,
)
from protogen.targets.python.engine.lines import Lines
from protogen.targets.python.engine.packing import unpacked_fill
from protogen.targets.python.engine.place import Place
from protogen.targets.python.engine.raw import Raw, member_of
from protogen.targets.python.formulas import in_python
from protogen.targets.python.literals import octets_in_class, tuple_of


class Run(msgspec.Struct):
    """Values that one `struct` reads together."""

    order: str = ""
    codes: str = ""
    size: int = 0
    variables: list[str] = msgspec.field(default_factory=list)
    after: list[tuple[str, str, AnyStep]] = msgspec.field(default_factory=list)
    """Target, variable and step of each value that is to be converted."""


class ArrayReader(Converter, Raw):
    """Base of the printer of a reader; what it leaves open reads values, fields and counts."""

    def __init__(
        self, lines: Lines, place: Place, *, sizes: SizeSet | None = None, is_ascii: bool = False
    ) -> None:
        """With the `sizes` of a message, which are checked in front, to read that."""
        Converter.__init__(self, lines, is_ascii=is_ascii)
        Raw.__init__(self)
        self.place = place
        self.sizes = sizes
        self.is_at_end = False
        """True once a field of the message itself has taken all that was left."""
        self.whole: tuple[int, int] | None = None
        """Bytes around the message, where one `struct` reads it and checks its size."""
        self._run = Run()

    @abstractmethod
    def _field(self, target: str, step: AnyStep) -> None:
        """Read a field into `target`."""

    @abstractmethod
    def _value(self, step: AnyStep) -> str:
        """Read a value, and give it as an expression."""

    @abstractmethod
    def _count(self, count: Count) -> str:
        """The number of elements that earlier fields give, or that never changes."""

    @abstractmethod
    def _convert(self, run: Run) -> None:
        """Convert the values of a run that are not taken as they are."""

    @abstractmethod
    def _move_to(self, expression: str) -> None:
        """From here on places are counted from `expression`."""

    @abstractmethod
    def _move_to_end(self, expression: str) -> None:
        """The same for what takes all that is left; nothing stands behind it."""

    def _array(self, step: RepeatStep) -> str:
        if isinstance(step.packing, FilledPacking):
            return self._packed_fill(step)
        if step.count.mark is not None:
            return self._up_to_last(step, step.count.mark)
        element, size = step.element, step.element.known_size
        if not size:
            in_front = None if step.count.tail is None else self._array_count(step.count, 0)
            return self._array_of_varying(step, in_front)
        together = isinstance(element, RecordStep) and common_order(element.steps) is not None
        if together and self._fills_message(step.count, size):
            assert isinstance(element, RecordStep)
            return self._elements_together(element, f"data[{self.place.offset}:]")
        count = self._array_count(step.count, size)
        values = self._elements(step, size, count)
        if step.count.is_fixed:
            self.place.offset += size * (step.count.known or 0)
            return values
        name = self.lines.local()
        self.lines.add(f"{name} = {values}")
        end = f"{self.place.text} + {size} * {count}"
        if step.fills:
            self._move_to_end(end)
        else:
            self._move_to(end)
        return name

    def _packed_fill(self, step: RepeatStep) -> str:
        """Packed numbers to the end."""
        data, start = "data", self.place.text
        if start != "0":
            data = self.lines.local("data")
            self.lines.add(f"{data} = data[{start}:]")
        value = self.lines.local()
        self.lines.add(f"{value} = {unpacked_fill(self.lines, data, step, self.named)}")
        self._move_to_end("len(data)")
        return value

    def _fills_message(self, count: Count, size: int) -> bool:
        """True if records are all the rest of a message, whose size says that they are whole.

        Then nothing can be wrong with their number.
        """
        sizes, first = self.sizes, self.place.offset
        if sizes is None or self.lines.is_nested or self.place.variable:
            return False
        if not count.fills:
            return False
        self.is_at_end = sizes == SizeSet(first, first + size * count.greatest, size)
        return self.is_at_end

    def _array_count(self, number: Count, size: int) -> str:
        if number.tail is not None:
            return self._in_front(number, number.tail)
        if not number.fills:
            return self._count(number)
        count, left = self.lines.local("n"), self.lines.local("left")
        self.lines.add(f"{count}, {left} = divmod(len(data) - {self.place.grouped}, {size})")
        self.lines.refuse_if(f"{left} or {outside_of(number, count)}")
        return count

    def _in_front(self, number: Count, tail: Tail) -> str:
        """The number of elements in front of a tail."""
        count, left = self.lines.local("n"), f"len(data) - {self.place.grouped}"
        if tail.separator is not None:
            separator = octets_in_class(bytes((tail.separator,)))
            left = f"data.count({separator}, {self.place.text})"
        kept = f"{left} - {tail.least}" if tail.least else left
        self.lines.add(f"{count} = max(0, {kept}) // {tail.element}")
        self.lines.refuse_if(outside_of(number, count))
        return count

    def _elements(self, step: RepeatStep, size: int, count: str) -> str:
        element = step.element
        if isinstance(element, IntegerStep) and is_pair(element):
            return self._pair_elements(element, count)
        code = array_code(step)
        if code is not None:
            return f"list({self._unpack_array(code, step, count)})"
        if isinstance(element, RecordStep):
            return self._struct_elements(element, size, count)
        code = code_of(element)
        if code is None:
            return self._array_of_varying(step, count)
        return self._converted_elements(code, step, count)

    def _unpack_array(self, code: str, step: RepeatStep, count: str) -> str:
        order = order_of(step.element) or "<"
        if step.count.is_fixed:
            layout = f"{order}{count}{code}"
            if code.endswith("s"):
                layout = order + code * (step.count.known or 0)
            expression = f'_struct.Struct("{layout}").unpack_from'
            unpack = self.lines.constants.named("UNPACK", expression)
            return f"{unpack}(data, {self.place.text})"
        layout = f'f"{order}{{{count}}}{code}"'
        if code.endswith("s"):
            layout = f'"{order}" + "{code}" * {count}'
        return f"_struct.unpack_from({layout}, data, {self.place.text})"

    def _pair_elements(self, element: IntegerStep, count: str) -> str:
        values = self.lines.local()
        start, type_ = self.place.text, element.type
        arguments = f'{type_.bits}, {type_.signed}, "{type_.byte_order}"'
        unpack = self.lines.constants.named("PAIR_LIST", f"_fast.PairLists({arguments}).decode")
        end = f"{start} + 2 * {count}"
        if count.isdigit() and not self.place.variable:
            end = str(self.place.offset + 2 * int(count))
        self.lines.add(f"{values} = {unpack}(data[{start} : {end}])")
        self.lines.refuse_if(f"len({values}) != {count}")
        if not type_.is_named:
            return values
        return f"[{self.named('value', element)} for value in {values}]"

    def _struct_elements(self, element: RecordStep, size: int, count: str) -> str:
        outer = "".join(f", {self.raw_at(name)}" for name in outer_names(element.type))
        start = self.place.text
        stop = f"{start} + {size} * {count}"
        if common_order(element.steps) is not None:
            data = self.lines.local("data")
            self.lines.add(f"{data} = data[{start} : {start} + {size} * {count}]")
            self.lines.refuse_if(f"len({data}) != {size} * {count}")
            return self._elements_together(element, data)
        call = f"_read_{element.type.name}(data, place{outer})"
        places = self.lines.local("places")
        self.lines.add(f"{places} = range({start}, {stop}, {size})")
        return f"[{call} for place in {places}]"

    def _elements_together(self, element: RecordStep, data: str) -> str:
        """The elements whose bytes an expression gives, each read by one `struct`."""
        values, item = self.lines.local(), self.lines.local("s")
        self.lines.add(f"{values}: list[_typing.Any] = []")
        outside, self._run, raw = self._run, Run(), dict(self.raw)
        for step in element.steps:
            self._field(f"{item}.{attribute(step.name)}", step)
        run, self._run, self.raw = self._run, outside, raw
        layout = f'_struct.Struct("{run.order or "<"}{run.codes}").iter_unpack'
        unpack = self.lines.constants.named("ITERATE", layout)
        names = [self.lines.local() if "." in name else name for name in run.variables]
        with self.lines.block(f"for {tuple_of(names)[1:-1]} in {unpack}({data}):"):
            self.lines.add(f"{item} = _new({self.lines.classes[element.type.name]})")
            for name, variable in zip(names, run.variables, strict=True):
                if "." in variable:
                    self.lines.add(f"{variable} = {name}")
            self._convert(run)
            self.lines.add(f"{values}.append({item})")
        return values

    def _converted_elements(self, code: str, step: RepeatStep, count: str) -> str:
        values, value = self.lines.local(), self.lines.local()
        unpacked = self._unpack_array(code, step, count)
        if self.is_seen(step.element):
            return f"list({unpacked})"
        self.lines.add(f"{values}: list[_typing.Any] = []")
        with self.lines.block(f"for {value} in {unpacked}:"):
            self.lines.add(f"{values}.append({self.converted(value, step.element)})")
        return values

    def _up_to_last(self, step: RepeatStep, mark: Formula) -> str:
        """Elements one by one, up to the one that says that it is the last."""
        values, count = self.lines.local(), step.count
        self.lines.add(f"{values}: list[_typing.Any] = []")
        self._move_to(self.place.text)
        at = self.place.text
        with self.lines.block("while True:"):
            item = self._value(step.element)
            self._move_to(self.place.text)
            self.lines.add(f"{values}.append({item})")
            with self.lines.block(f"if {in_python(mark.expression, partial(member_of, item))}:"):
                self.lines.add("break")
            self.lines.refuse_if(f"len({values}) == {count.greatest}")
            assert self.place.text == at
        if count.least > 1:
            self.lines.refuse_if(f"len({values}) < {count.least}")
        return values

    def _array_of_varying(self, step: RepeatStep, count: str | None = None) -> str:
        """Elements one by one, each from where the one before ended."""
        values = self.lines.local()
        self.lines.add(f"{values}: list[_typing.Any] = []")
        outside = self.place.text
        if step.fills and count is None:
            self._move_to(outside)
            head = f"while {self.place.text} < len(data):"
        else:
            number = self._count(step.count) if count is None else count
            self._move_to(outside)
            head = f"for _ in range({number}):"
        at = self.place.text
        with self.lines.block(head):
            before = self.lines.local("before")
            if step.fills:
                self.lines.add(f"{before} = {at}")
            self.lines.add(f"{values}.append({self._value(step.element)})")
            self._move_to(self.place.text)
            if step.fills:
                self.lines.refuse_if(f"{at} == {before}")
            assert self.place.text == at
        if step.fills:
            self.lines.refuse_if(outside_of(step.count, f"len({values})"))
        return values
