"""Statements that tell whether bytes are a message's payload.

Values are looked at in wire order. Bytes are asked for before anything else is said of them, in one
comparison for as many as follow each other. Top bits of 7-bit bytes are collected, and checked in
one call.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from protogen.model.packing import Packing
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    Check,
    ChooseStep,
    ConstantStep,
    Count,
    FloatStep,
    Formula,
    IntegerStep,
    NumberStep,
    OptionalStep,
    RecordStep,
    Reference,
    RegionStep,
    RepeatStep,
    RestStep,
    packed_numbers,
)
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.checked_places import CheckedWalk
from protogen.targets.c.payload.free_numerals import FreeDigits
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.loading import loaded
from protogen.targets.c.payload.numerals import Digits
from protogen.targets.c.payload.packing import Placed, faults_in, number_in
from protogen.targets.c.payload.walk import amount, is_unfit, out_of_bounds, times, type_of
from protogen.targets.c.spelling import hexadecimal, integer_type, unsigned


def _carried(step: BytesStep | NumberStep) -> int:
    """Bits that a byte may have set before anything else is asked of it; a boolean is 0 or 1."""
    return 8 if Check.BOOLEAN in step.checks else step.type.byte_bits


def _outside(count: Count, number: str, size: int) -> str:
    """The condition that as many bytes are no number of elements that may fill the payload."""
    greatest = count.greatest * size
    return out_of_bounds(number, count.least * size, greatest, greatest + 1)


def _is_needed(step: RecordStep | RepeatStep) -> bool:
    """True if a packed number counts or selects something behind it."""
    inner = step.steps if isinstance(step, RecordStep) else ()
    return any(item.step.is_needed for item in packed_numbers(inner))


class Checker(CheckedWalk):
    """Prints a check of the payload."""

    def __init__(
        self, helpers: Helpers, lines: Lines, prefix: str, *, fixed: bool, needs: bool
    ) -> None:
        super().__init__(helpers, lines, prefix, fixed=fixed, needs=needs)
        self._ended = False  # True once something has taken all bytes that there were.
        self._numbers: dict[str, str] = {}  # Variables, by the places of the numbers they hold.
        self._branches = 0

    def finish(self, unfit: str) -> None:
        """Say what is left to say at the end of the payload, and refuse sizes that are unfit."""
        self._flush()
        if self._fixed:
            return
        self._require(0)
        if not self._ended:
            self._refuse(f"size != {self._sum(self._offset)}", "SIZE")
        self._refuse(unfit, "SIZE")

    # --- numbers that count and select ----------------------------------------------------------

    def referred(self, number: Reference) -> str:
        """The variable of an earlier number."""
        return self._numbers[super().referred(number)]

    def count(self, count: Count) -> int | str:
        """Number of elements or bytes."""
        if count.by is None:
            return super().count(count)
        if count.by.plain is not None:
            self._bounded(count, count.by.plain)
        elif count.known is not None and is_unfit("", count, count.by):
            self._flush()
            self._refuse(is_unfit(self.declared(count.by), count, count.by), "SIZE")
        return super().count(count)

    def worked_out(self, count: Count, by: Formula) -> str:
        """A variable with a number that a struct has room for."""
        self._flush()
        name = self.declared(by)
        self._refuse(is_unfit(name, count, by), "SIZE")
        if not type_of(by).signed:
            return f"(size_t){name}" if type_of(by).bits > 16 else name
        return self.amount_of(by, name)

    def filled(self, count: Count) -> str:
        """Nothing that was read says how much there is of what fills."""
        return ""

    def _bounded(self, count: Count, by: Reference) -> None:
        """Refuse numbers of elements that a struct has no room for."""
        self._flush()
        most = count.greatest if by.type is None else by.type.greatest
        test = out_of_bounds(self.referred(by), count.least, count.greatest, most)
        self._refuse(test, "SIZE")

    # --- numbers ----------------------------------------------------------------------------------

    def _written(self, step: IntegerStep, place: str) -> None:
        """A number that takes all characters that are left, or those up to the next separator."""
        digits = FreeDigits.of(step.type)
        if not step.type.takes_rest:
            self._separated(step, digits, place)
            return
        self._flush()
        self._require(0)
        self._text(step, digits, self._left())
        self._end()

    def _separated(self, step: IntegerStep, digits: FreeDigits, place: str) -> None:
        self._settle()
        if digits.leads:
            self._require(1)
            self._refuse(f"{self._byte()} != {digits.leads}", "VALUE")
            self._offset = 1
        size = self.variable("length")
        found = digits.text_size(self.helpers, self._address(), self._left())
        self.lines.add(f"const size_t {size} = {found};")
        self._text(step, digits, size)
        if step.is_needed:
            self._keep(step, place, digits.value(self.helpers, self._address(), size))
        self._move(f"{self._offset}U + {size}" if self._offset else size)

    def _text(self, step: IntegerStep, digits: FreeDigits, size: str) -> None:
        """So many characters, which have to stand for something."""
        address = self._address()
        self._refuse(digits.misfit(size), "SIZE")
        self._refuse(digits.fault(self.helpers, address, size), "VALUE")
        if Check.CLOSED in step.checks:
            value = digits.value(self.helpers, address, size)
            self._refuse(f"!{self.helpers.known(step.type)}({value})", "VALUE")

    def _left(self) -> str:
        """The number of bytes that are left."""
        offset = self._sum(self._offset)
        if offset == "0":
            return "size"
        return f"size - ({offset})" if "+" in offset else f"size - {offset}"

    def number(self, step: NumberStep, place: str) -> None:
        """A number."""
        if isinstance(step, IntegerStep) and step.type.is_free:
            self._written(step, place)
            return
        self._begin(_carried(step))
        is_needed = isinstance(step, IntegerStep) and step.is_needed
        if step.can_be_wrong or is_needed:
            self._require(step.type.size)
        if step.can_be_wrong:
            self._number(step)
        elif is_needed:
            self._flush()
        self._offset += step.type.size
        if isinstance(step, IntegerStep) and step.is_needed:
            self._remember(step, place)

    def _remember(self, step: IntegerStep, place: str) -> None:
        """Put the number in front of the place into a variable, as it counts or selects."""
        size = step.type.size
        address = self._address(self._offset - size)
        self._keep(step, place, loaded(self.helpers, step.type, self._byte(-size), address))

    def _keep(self, step: IntegerStep, place: str, value: str) -> None:
        name = self.variable(self.helpers.member(step.name))
        self.lines.add(f"const {integer_type(step.type)} {name} = {value};")
        self._numbers[place] = name

    def _number(self, step: NumberStep) -> None:
        type_ = step.type
        if _carried(step) == 7:
            self._seven_bit(type_.size)
        if step.has_wrong_values:
            self._flush(type_.size)
        if Check.BOOLEAN in step.checks:
            self._refuse(f"{self._byte()} > 1U", "VALUE")
            return
        if isinstance(step, IntegerStep) and Check.DIGITS in step.checks:
            for fault in Digits.of(step.type).faults(self.helpers, self._address()):
                self._refuse(fault, "VALUE")
        if Check.PADDING in step.checks:
            unused = type_.byte_bits * type_.size - type_.bits
            top = type_.size - 1 if type_.byte_order == "little" else 0
            greatest = (1 << (type_.byte_bits - unused)) - 1
            self._refuse(f"{self._byte(top)} > {hexadecimal(greatest)}", "VALUE")
        if isinstance(step, IntegerStep) and Check.CLOSED in step.checks:
            known = self.helpers.known(step.type)
            number = loaded(self.helpers, type_, self._byte(), self._address())
            self._refuse(f"!{known}({number})", "VALUE")

    # --- packed numbers ---------------------------------------------------------------------------

    def packed(self, step: RecordStep | RepeatStep, place: str) -> None:
        """Numbers that are packed; where none of them can be wrong, only what is left behind."""
        if step.packing is not None and not step.checks - {Check.PADDING} and not _is_needed(step):
            self.run(step.packing, ())
        else:
            self.runs(step, place)

    def run(self, packing: Packing, placed: Sequence[Placed]) -> None:
        """Numbers that are packed."""
        items = [item for item, _ in placed]
        faults = list(faults_in(self.helpers, packing, items, self._byte))
        self._flush()
        needed = [(item, place) for item, place in placed if item.step.is_needed]
        if faults or needed:
            self._require(packing.size)
        for fault in faults:
            self._refuse(fault, "VALUE")
        for item, place in needed:
            value = number_in(self.helpers, packing, item, self._byte)
            self._keep(item.step, place, value)
        self._offset += packing.size

    @contextmanager
    def group(self, count: int, size: int) -> Iterator[str]:
        """A loop over groups of packed numbers."""
        self._require(count * size)
        with self._places(size, count) as index:
            self._secured = size
            yield index
        self._offset += count * size

    # --- constants --------------------------------------------------------------------------------

    def constant(self, step: ConstantStep) -> None:
        """Its bytes, after its elements have been looked at."""
        value, data = step.value, step.data
        match value:
            case RepeatStep() if value.packing is not None:
                self._flush()
                self._require(len(data))
                self._offset += len(data)
                self._same(data)
            case RepeatStep():
                self._constant_elements(value, data)
            case BytesStep() | NumberStep():
                self._constant_value(value, data)
                if step.field.const == 0 and isinstance(value, FloatStep):
                    self._zero(value)
                else:
                    self._same(data)

    def _constant_value(self, step: BytesStep | NumberStep, data: bytes) -> None:
        if isinstance(step, BytesStep):
            self._right_count(step.count, len(data), 1)
        carried = _carried(step)
        self._begin(carried)
        self._require(len(data))
        if carried == 7:
            self._seven_bit(len(data))
        self._offset += len(data)

    def _constant_elements(self, step: RepeatStep, data: bytes) -> None:
        element, size = step.element, step.element.sizes.least
        count = len(data) // size if size else 0
        self._right_count(step.count, count, size)
        if not element.can_be_wrong:
            self._flush()
        for _ in range(count):
            if isinstance(element, NumberStep) and element.can_be_wrong:
                self._require(size)
                self._number(element)
            self._offset += size
        self._require(0)
        self._same(data)

    def _right_count(self, found: Count, count: int, size: int) -> None:
        """Refuse another size: a constant of another size is another constant."""
        if found.known is not None and found.expression is None:
            return
        self._flush()
        self._require(0)
        if found.by is not None:
            self._refuse(self.differs(found.by, count), "VALUE")
        elif found.fills:
            here = f"size - {self._sum(self._offset)}" if self._at or self._offset else "size"
            self._refuse(f"{here} != {unsigned(count * size)}", "VALUE")

    def _same(self, data: bytes) -> None:
        """Refuse other bytes than these in front of the place."""
        self._flush()
        for index, byte in enumerate(data):
            self._refuse(f"{self._byte(index - len(data))} != {hexadecimal(byte)}", "VALUE")

    def _zero(self, step: FloatStep) -> None:
        """Refuse other numbers than 0 in front of the place; its sign does not matter."""
        self._flush()
        type_ = step.type
        sign = (type_.bits - 1) // type_.byte_bits
        place = sign if type_.byte_order == "little" else type_.size - 1 - sign
        mask = ((1 << type_.byte_bits) - 1) & ~(1 << (type_.bits - 1) % type_.byte_bits)
        for index in range(type_.size):
            byte = self._byte(index - type_.size)
            other = f"({byte} & {hexadecimal(mask)}) != 0U"
            self._refuse(other if index == place else f"{byte} != 0U", "VALUE")

    # --- bytes ------------------------------------------------------------------------------------

    def bytes(self, step: BytesStep | RestStep, place: str, count: int | str) -> None:
        """A text, or bytes."""
        seven = Check.SEVEN_BIT in step.checks
        if step.fills:
            self._filled(step.count, seven=seven)
            return
        if step.count is not None and step.count.until is not None:
            self._up_to(step.count, step.count.until, seven=seven)
            return
        self._begin(7 if seven else 8)
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

    def _filled(self, count: Count, *, seven: bool) -> None:
        """All bytes that are left; where the size is always the same there are none."""
        self._flush()
        if self._fixed:
            return
        self._require(0)
        left = self._left()
        self._refuse(_outside(count, left, 1), "SIZE")
        if seven:
            check = f"!{self.helpers.seven_bit()}({self._address()}, {left})"
            self._refuse(check, "ENCODING")
        if count.greatest:
            self._end()

    def _up_to(self, count: Count, byte: int, *, seven: bool) -> None:
        """Bytes in front of a terminator, which has to be among those that are left."""
        self._settle()
        self._require(count.least + 1)
        size, left, address = self.variable("length"), self._left(), self._address()
        found = f"{self.helpers.text_size()}({address}, {left}, {hexadecimal(byte)})"
        self.lines.add(f"const size_t {size} = {found};")
        self._refuse(f"{size} > {unsigned(count.greatest)}", "SIZE")
        with self.lines.block(f"if ({size} == {left})"):
            if self._needs:
                self.lines.add(f"return {self.helpers.missing()}(need, size + 1U);")
            else:
                self.lines.add(f"{self._error}SIZE;")
        if count.least:
            self._refuse(f"{size} < {unsigned(count.least)}", "SIZE")
        if seven:
            self._refuse(f"!{self.helpers.seven_bit()}({address}, {size})", "ENCODING")
        self._move(f"{size} + 1U")

    def _end(self) -> None:
        """Nothing is left."""
        if self._branches:
            self._settle()
            self.lines.add("at = size;")
            self._secured = 0
        else:
            self._ended = True

    # --- elements ---------------------------------------------------------------------------------

    def repeat(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Elements."""
        element, size = step.element, step.element.known_size
        if step.count.fills:
            self._filling(step, place)
        elif step.count.mark is not None:
            self._up_to_last(step, place, step.count.mark)
        elif size is not None and not element.can_be_wrong:
            self._run(count, size)
        elif isinstance(count, int) and self._is_seven_bit_run(element):
            self._seven_bit(count * (size or 0))
            self._offset += count * (size or 0)
        elif size is not None:
            self._each_of(size, element, place, count)
        else:
            self._each(element, place, count)

    def _is_seven_bit_run(self, element: AnyStep) -> bool:
        is_seven_bit = isinstance(element, NumberStep) and element.checks == {Check.SEVEN_BIT}
        return self._fixed and is_seven_bit

    def _run(self, count: int | str, size: int) -> None:
        """Elements that can't be wrong."""
        self._flush()
        amount = times(count, size)
        if isinstance(amount, int):
            self._offset += amount
            return
        self._settle()
        self._require(0, amount)
        self._move(amount)

    def _each(self, element: AnyStep, place: str, count: int | str) -> None:
        """Check elements of different sizes."""
        self._settle()
        with self.loop(count) as index:
            self._secured = 0
            self.step(element, f"{place}[{index}]")
            self._settle()
        self._secured = 0

    def _each_of(self, size: int, element: AnyStep, place: str, count: int | str) -> None:
        """Check elements of one size."""
        self._flush()
        self._require(0)
        with self._places(size, count) as index:
            self.step(element, f"{place}[{index}]")
            self._flush()
            self._require(0)
        if isinstance(count, int):
            self._offset += count * size
            self._secured = self._offset
        else:
            self._require_nothing(times(count, size))

    def _up_to_last(self, step: RepeatStep, place: str, mark: Formula) -> None:
        """Check elements up to the one that says that it is the last."""
        self._settle()
        count, index, last = step.count, self.variable("count"), self.variable("is_last")
        self.lines.add(f"size_t {index} = 0U;", f"bool {last} = false;")
        with self.lines.block(f"while (!{last})"):
            self._refuse(f"{index} == {unsigned(count.greatest)}", "SIZE")
            self._secured = 0
            self.step(step.element, f"{place}[{index}]")
            self._settle()
            self.lines.add(f"{last} = {self.is_last(mark, f'{place}[{index}]')};", f"{index}++;")
        if count.least > 1:
            self._refuse(f"{index} < {unsigned(count.least)}", "SIZE")
        self._secured = 0

    @contextmanager
    def _places(self, size: int, count: int | str) -> Iterator[str]:
        """A loop over elements of one size, each of which has a place of its own."""
        before = self._at, self._offset
        with self.loop(count) as index:
            step = f"{size} * {index}" if size > 1 else index
            start = self._sum(self._offset)
            start = step if start == "0" else f"{start} + {step}"
            self._at, self._offset, self._secured = f"at_{index}", 0, 0
            self.lines.add(f"const size_t {self._at} = {start};")
            yield index
            self._at, self._offset = before

    def _require_nothing(self, distance: int | str) -> None:
        """Go on behind bytes that were looked at."""
        self._secured = self._offset
        self._move(f"{self._offset}U + {distance}" if self._offset else distance)

    def _filling(self, step: RepeatStep, place: str) -> None:
        """Check as many elements as the payload has left."""
        if self._fixed:
            return
        self._settle()
        size, count = step.element.known_size, step.count
        if size and not self._needs and not step.element.can_be_wrong:
            self._filling_of(size, count)
            return
        index = self.variable("count")
        begin = f"size_t {index} = 0"
        if count.least:
            self.lines.add(f"{begin};")
            begin = ""
        with self.lines.block(f"for ({begin}; at < size; {index}++)"):
            self._refuse(f"{index} == {unsigned(count.greatest)}", "SIZE")
            self._secured = 0
            self.step(step.element, f"{place}[{index}]")
            self._settle()
        if count.least:
            self._refuse(f"{index} < {unsigned(count.least)}", "SIZE")
        self._ended = self._branches == 0
        self._secured = 0

    def _filling_of(self, size: int, count: Count) -> None:
        """Check the number of elements of one size that can't be wrong.

        Small controllers do not divide.
        """
        self._refuse(_outside(count, "size - at", size), "SIZE")
        if size > 1 and count.greatest:
            with self.lines.block("while (at < size)"):
                self.lines.add(f"at += {size};")
            self._refuse("at != size", "SIZE")
        self._end()
        self._secured = 0

    # --- cases ------------------------------------------------------------------------------------

    def choose(self, step: ChooseStep, place: str) -> None:
        """One of several cases; behind it, `at` stands where the case has ended."""
        self._flush()
        if isinstance(step.selector, int):
            super().choose(step, place)
            return
        with self._joined(step.known_size):
            super().choose(step, place)

    def optional(self, step: OptionalStep, place: str) -> None:
        """A step that may be there; behind it, `at` stands where it has ended."""
        self._flush()
        if isinstance(step.condition, int):
            super().optional(step, place)
            return
        with self._joined(step.known_size):
            super().optional(step, place)

    def region(self, step: RegionStep, place: str) -> None:
        """What takes just so many bytes: inside of it, `size` is where they end."""
        self._settle()
        bytes_ = amount(self.count(step.region))
        before = self._fixed, self._needs, self._ended
        if self._fixed and step.region.known is None:
            self._fixed = self._needs = False  # The number may be wrong, whatever has one size.
        self._require(0, bytes_)
        whole = self.variable("whole")
        self.lines.add(f"const size_t {whole} = size;", f"size = at + {bytes_};")
        self._fixed = self._needs = False
        self._secured = 0
        with self.branch():
            self.step(step.step, place)
            self._settle()
        self._refuse("at != size", "SIZE")
        self._fixed, self._needs, self._ended = before
        self.lines.add(f"size = {whole};")
        self._offset = self._secured = 0

    @contextmanager
    def _joined(self, size: int | None) -> Iterator[None]:
        """Several ways of this size, which go on together."""
        if size is None:
            self._settle()
        yield
        if size is None:
            self._offset, self._secured = 0, 0
        else:
            self._offset += size
            self._secured = self._offset

    @contextmanager
    def branch(self) -> Iterator[None]:
        """Every way begins where the choice does."""
        before = self._at, self._offset, self._secured
        self._branches += 1
        yield
        self._branches -= 1
        self._at, self._offset, self._secured = before

    def end_branch(self, step: ChooseStep | OptionalStep) -> None:
        """Make clear where this way has ended."""
        self._flush()
        if step.known_size is None:
            self._settle()
        else:
            self._require(0)

    def no_case(self) -> None:
        """A value without a case."""
        self.lines.add(f"{self._error}VALUE;")
