"""Statements that take a message out of a payload that was checked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from protogen.c_language.numbers import counting_type, hexadecimal, integer_type
from protogen.model.packing import Packing
from protogen.model.payload_plan import (
    BytesStep,
    ConstantStep,
    Count,
    Formula,
    IntegerStep,
    NumberStep,
    OptionalStep,
    PartStep,
    PayloadPlan,
    RecordStep,
    RegionStep,
    RepeatStep,
    RestStep,
    TrailingPresence,
)
from protogen.model.types import Between, Float, NumberType, Tail
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.between import count_elements, text_size
from protogen.targets.c.payload.filled_packing import FilledRun
from protogen.targets.c.payload.free_numerals import FreeDigits
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.number_bytes import is_plain, is_whole
from protogen.targets.c.payload.numerals import Digits
from protogen.targets.c.payload.packing import Placed, members_of, number_in
from protogen.targets.c.payload.placed import PlacedWalk
from protogen.targets.c.payload.storing import is_bytes
from protogen.targets.c.payload.texts import PaddedText
from protogen.targets.c.payload.walk import amount, parameter_for, times


def loaded(helpers: Helpers, type_: NumberType, byte: str, address: str) -> str:
    """The number that lies there; `byte` is its first byte."""
    if isinstance(type_, Float):
        return f"{helpers.load(type_)}({address})"
    if type_.text is not None:
        return Digits.of(type_).value(helpers, address)
    if type_.role == "bool":
        return f"{byte} != 0U"
    if is_plain(type_):
        return f"({integer_type(type_)}){byte}" if type_.signed else byte
    if type_.signed and is_whole(type_):
        return f"({integer_type(type_)}){helpers.load(type_.unsigned)}({address})"
    return f"{helpers.load(type_)}({address})"


class Load(PlacedWalk):
    """Takes values out of memory. Where the size varies, there is a variable `size`."""

    def __init__(self, helpers: Helpers, lines: Lines) -> None:
        super().__init__(helpers, lines, "const uint8_t *")
        self._lengths = 0  # Variables for the lengths of texts.
        self.reads_size = False
        """True once something was read whose end the payload's size tells."""
        self.moves_size = False
        """True once `size` was the end of something else."""

    def pointed(self, plan: PayloadPlan, base: str) -> None:
        """Take a record that lies where there is an `at` already; what counts is in it."""
        self.settled()
        if plan.packing is None:
            self.record(plan.steps, base)
        else:
            self.run(plan.packing, members_of(self.helpers, plan.steps, base))

    def constant(self, step: ConstantStep) -> None:
        """It was checked, and nothing keeps it."""
        self.skip(len(step.data))

    def number(self, step: NumberStep, place: str) -> None:
        """A number."""
        if isinstance(step, IntegerStep) and step.type.is_free:
            self._written(step, place)
            return
        value = loaded(self.helpers, step.type, self.byte(), self.address())
        self.lines.add(f"{place} = {value};")
        self.skip(step.type.size)

    def part(self, step: PartStep, place: str) -> None:
        """A number of the frame."""
        name = parameter_for(self.helpers.member(step.name))
        self._locals.add(name)
        self.lines.add(f"{place} = {name};")

    def optional(self, step: OptionalStep, place: str) -> None:
        """A step that may be there; where the payload's end says it, a member keeps that."""
        if isinstance(step.presence, TrailingPresence):
            self.catch_up()
            self.reads_size = True
            goes_on = f"{self.address()} < payload + size"
            if self._name == "payload":
                goes_on = f"size > {self._offset}U"
            self.lines.add(f"{self._records[-1]}{step.presence.member} = {goes_on};")
        super().optional(step, place)

    def _written(self, step: IntegerStep, place: str) -> None:
        """A number that takes all characters that are left, or those up to the next separator."""
        digits = FreeDigits.of(step.type)
        if step.type.takes_rest:
            self.catch_up()
            written = digits.value(self.helpers, self.address(), self._left())
            self.lines.add(f"{place} = {written};")
            return
        self.settle()
        if digits.leads:
            self.skip(1)
        if digits.is_single:
            self.lines.add(f"{place} = {self.byte()};")
            self.skip(1)
            return
        size = "1U" if digits.is_digit else self._text_size(digits)
        present = f"{place} = {digits.present(self.helpers, self.address(), size)};"
        if digits.absent:
            self.lines.add(f"{place} = {digits.absent};")
            with self.lines.block(f"if ({size} > 0U)"):
                self.lines.add(present)
        else:
            self.lines.add(present)
        self.skip(size)

    def _text_size(self, digits: FreeDigits) -> str:
        """The name of the number of bytes in front of the next separator."""
        self._lengths += 1
        size = f"length_{self._lengths}" if self._lengths > 1 else "length"
        found = digits.text_size(self.helpers, self.address(), self._left())
        self.lines.add(f"const size_t {size} = {found};")
        return size

    def packed(self, step: RecordStep | RepeatStep, place: str) -> None:
        """Numbers that are packed."""
        self.runs(step, place)

    def run(self, packing: Packing, placed: Sequence[Placed]) -> None:
        """Numbers that are packed."""
        for item, place in placed:
            if item.constant is None:
                self.lines.add(f"{place} = {number_in(self.helpers, packing, item, self.byte)};")
        self.skip(packing.size)

    def packed_fill(self, step: RepeatStep, place: str, count: str) -> None:
        """Packed numbers, as many as there are bytes for."""
        unpack = FilledRun.of(step).unpack(self.helpers)
        found = f"{unpack}({place}, {self.address()}, {self._left()})"
        self.lines.add(f"{count} = ({counting_type(step.count.greatest)}){found};")

    def bytes(self, step: BytesStep | RestStep, place: str, count: int | str) -> None:
        """A text, or bytes."""
        if step.fills:
            self._rest(place, str(count), step.count.greatest)
        elif step.count.until is not None:
            self._up_to(place, str(count), step.count, step.count.until)
        elif step.count.between is not None:
            self._between(place, str(count), step.count, step.count.between)
        elif (text := PaddedText.of(step.type)) is not None:
            load = text.load(self.helpers)
            self.lines.add(f"{load}({place}, {self.address()}, {amount(count)});")
            self.skip(count)
        else:
            self._copy(place, count)

    def _rest(self, place: str, count: str, greatest: int) -> None:
        """Take all bytes that are left."""
        if greatest == 0:
            self.lines.add(f"{count} = 0U;")
            return
        self.catch_up()
        self.lines.add(f"{count} = ({counting_type(greatest)})({self._left()});")
        self._copy(place, count)

    def _up_to(self, place: str, member: str, count: Count, byte: int) -> None:
        """Take the bytes in front of a terminator."""
        self.catch_up()
        found = f"{self.helpers.text_size()}({self.address()}, {self._left()}, {hexadecimal(byte)})"
        self.lines.add(f"{member} = ({counting_type(count.greatest)}){found};")
        self.lines.add(f"{self.helpers.copy()}({place}, {self.address()}, {member});")
        self.skip(f"1U + {member}")

    def _between(self, place: str, member: str, count: Count, between: Between) -> None:
        """Take the characters in front of the next separator, or of the end."""
        self.catch_up()
        if between.leads:
            self.skip(1)
        found = text_size(self.helpers, between, self.address(), self._left())
        self.lines.add(f"{member} = ({counting_type(count.greatest)})({found});")
        self._copy(place, member)

    @contextmanager
    def inside(self, size: str, step: RegionStep) -> Iterator[None]:
        """Inside of a region, `size` is where it ends, if anything in it asks for that."""
        begin, reads_outside = len(self.lines), self.reads_size
        self.reads_size = False
        yield
        if self.reads_size:
            self.moves_size = True
            moved = [f"size = (size_t)(at - payload) + {size};"]
            if not step.is_last:
                whole = self.variable("whole")
                moved.insert(0, f"const size_t {whole} = size;")
                self.lines.add(f"size = {whole};")
            self.lines.put_at(begin, *moved)
        self.reads_size |= reads_outside

    def _left(self) -> str:
        """The number of bytes that are left."""
        self.reads_size = True
        left = "size" if self._name == "payload" else "(size_t)(payload + size - at)"
        return f"{left} - {self._offset}U" if self._offset else left

    def _copy(self, place: str, count: int | str) -> None:
        self.lines.add(f"{self.helpers.copy()}({place}, {self.address()}, {amount(count)});")
        self.skip(count)

    def repeat(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Elements."""
        element, size = step.element, step.element.known_size
        if step.count.tail is not None:
            self._in_front(str(count), step.count.tail)
        if step.count.fills:
            self._filling(step, place, str(count))
        elif step.count.mark is not None:
            self._up_to_last(step, place, str(count), step.count.mark)
        elif is_bytes(element):
            self._copy(place, count)
        elif size is not None and not element.holds_values:
            self.skip(times(count, size))
        elif isinstance(element, IntegerStep) and self.helpers.loads_runs(element.type):
            run = self.helpers.load_run(element.type)
            self.lines.add(f"{run}({place}, {self.address()}, {amount(count)});")
            self.skip(times(count, element.type.size))
        else:
            self.elements(step, place, count)

    def _in_front(self, member: str, tail: Tail) -> None:
        """Count the elements that stand in front of a tail."""
        self.catch_up()
        self.lines.add(f"{member} = 0U;")
        here = (self.address(), self._left(), self.variable("left"))
        count_elements(self.helpers, self.lines, tail, member, here)

    def _up_to_last(self, step: RepeatStep, place: str, member: str, mark: Formula) -> None:
        """Take elements up to the one that says that it is the last."""
        self.settle()
        last = self.variable("is_last")
        self.lines.add(f"{member} = 0U;", f"bool {last} = false;")
        with self.lines.block(f"while (!{last})"):
            self.step(step.element, f"{place}[{member}]")
            self.settle()
            condition = self.is_last(mark, f"{place}[{member}]")
            self.lines.add(f"{last} = {condition};", f"{member}++;")

    def _filling(self, step: RepeatStep, place: str, member: str) -> None:
        if is_bytes(step.element) or step.count.greatest == 0:
            self._rest(place, member, step.count.greatest)
            return
        self.settle()
        self.reads_size = True
        end, count = self.variable("stop"), self.variable("count")
        self.lines.add(f"const uint8_t *const {end} = payload + size;", f"size_t {count} = 0U;")
        with self.lines.block(f"while (at < {end})"):
            index = count if step.element.holds_values else "0"
            self.step(step.element, f"{place}[{index}]")
            self.settle()
            self.lines.add(f"{count}++;")
        self.lines.add(f"{member} = ({counting_type(step.count.greatest)}){count};")
