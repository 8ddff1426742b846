"""Checks of numbers and constants of a payload."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from protogen.c_language.numbers import hexadecimal, integer_type, unsigned
from protogen.model.packing import FilledPacking, Packing
from protogen.model.payload_plan import (
    BytesStep,
    Check,
    ConstantStep,
    Count,
    FloatStep,
    Formula,
    IntegerStep,
    NumberStep,
    PartStep,
    RecordStep,
    Reference,
    RepeatStep,
)
from protogen.model.payload_walks import packed_numbers
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.checked_places import CheckedWalk
from protogen.targets.c.payload.filled_packing import FilledRun
from protogen.targets.c.payload.free_numerals import FreeDigits
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.loading import loaded
from protogen.targets.c.payload.numerals import Digits
from protogen.targets.c.payload.packing import Placed, faults_in, number_in
from protogen.targets.c.payload.walk import is_unfit, out_of_bounds, parameter_for, type_of


def _carried(step: BytesStep | NumberStep) -> int:
    """Bits that a byte may have set before anything else is asked of it; a boolean is 0 or 1."""
    return 8 if Check.BOOLEAN in step.checks else step.type.byte_bits


def _is_needed(step: RecordStep | RepeatStep) -> bool:
    """True if a packed number counts or selects something behind it."""
    inner = step.steps if isinstance(step, RecordStep) else ()
    return any(item.step.is_needed for item in packed_numbers(inner))


class NumberChecker(CheckedWalk):
    """Prints the checks of numbers, and of what is the same in each payload."""

    def __init__(
        self, helpers: Helpers, lines: Lines, prefix: str, *, fixed: bool, needs: bool
    ) -> None:
        super().__init__(helpers, lines, prefix, fixed=fixed, needs=needs)
        self._ended = False  # True once something has taken all bytes that there were.
        self._numbers: dict[str, str] = {}  # Variables, by the places of the numbers they hold.
        self._bounds: set[str] = set()  # Conditions of which any refuses the payload.
        self._outermost = lines.margin
        self._branches = 0

    def finish(self, unfit: str, *, leaves: bool) -> None:
        """Say what is left to say at the end of the payload, and refuse sizes that are unfit.

        What is behind may be left for whoever asks how many bytes are needed.
        """
        self._flush()
        if self._fixed:
            return
        self._require(0)
        if leaves:
            with self.lines.block("if (need != NULL)"):
                self.lines.add(f"size = {self._sum(self._offset)};", "*need = size;")
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
            self._refuse_unfit(self.declared(count.by), count, count.by)
        return super().count(count)

    def worked_out(self, count: Count, by: Formula) -> str:
        """A variable with a number that a struct has room for."""
        self._flush()
        name = self.declared(by)
        self._refuse_unfit(name, count, by)
        if not type_of(by).signed:
            return f"(size_t){name}" if type_of(by).bits > 16 else name
        return self.amount_of(by, name)

    def filled(self, count: Count) -> str:
        """Nothing that was read says how much there is of what fills."""
        return ""

    def _refuse_unfit(self, name: str, count: Count, by: Formula) -> None:
        """Refuse a number that a struct has no room for, once all in front of it is there."""
        test = is_unfit(name, count, by)
        if test:
            self._require(0)
        self._refuse(test, "SIZE")

    def _bounded(self, count: Count, by: Reference) -> None:
        """Refuse numbers of elements that a struct has no room for."""
        self._flush()
        most = count.greatest if by.type is None else by.type.greatest
        test = out_of_bounds(self.referred(by), count.least, count.greatest, most)
        if test not in self._bounds:
            self._refuse(test, "SIZE")
            if self.lines.margin == self._outermost:
                self._bounds.add(test)

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
        return f"size - ({offset})" if "+" in offset else f"size - {offset}{'U' * offset.isdigit()}"

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

    def part(self, step: PartStep, place: str) -> None:
        """A number of the frame, which may be none that the message knows."""
        name = parameter_for(self.helpers.member(step.name))
        self._locals.add(name)
        self._numbers[place] = name
        if Check.CLOSED in step.checks:
            self._refuse(f"!{self.helpers.known(step.type)}({name})", "VALUE")

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
        assert isinstance(step.packing, Packing)
        if not step.checks - {Check.PADDING} and not _is_needed(step):
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
                if isinstance(value.packing, FilledPacking):
                    self._require(0)
                    self._refuse(FilledRun.of(value).misfit(self._left()), "SIZE")
                self._right_count(value.count, len(data), 1)
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
            here = self._left()
            self._refuse(f"({here}) % {unsigned(size)} != 0U" if size > 1 else "", "SIZE")
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

    # --- places -----------------------------------------------------------------------------------

    def _end(self) -> None:
        """Nothing is left."""
        if self._branches:
            self._settle()
            self.lines.add("at = size;")
            self._secured = 0
        else:
            self._ended = True

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
