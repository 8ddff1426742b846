"""Statements that tell whether bytes are a message's payload.

Values are looked at in wire order. Bytes are asked for before anything else is said of them, in one
comparison for as many as follow each other. Top bits of 7-bit bytes are collected, and checked in
one call.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from protogen.c_language.numbers import hexadecimal, unsigned
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    Check,
    ChooseStep,
    ConditionalPresence,
    Count,
    Formula,
    NumberStep,
    OptionalStep,
    RegionStep,
    RepeatStep,
    RestStep,
    TrailingPresence,
)
from protogen.model.types import Between, Tail
from protogen.targets.c.payload.between import count_elements, is_text, separator_of, text_size
from protogen.targets.c.payload.filled_packing import FilledRun
from protogen.targets.c.payload.number_checks import NumberChecker
from protogen.targets.c.payload.texts import PaddedText
from protogen.targets.c.payload.walk import amount, out_of_bounds, times


def _outside(count: Count, number: str, size: int) -> str:
    """The condition that as many bytes are no number of elements that may fill the payload."""
    greatest = count.greatest * size
    return out_of_bounds(number, count.least * size, greatest, greatest + 1)


class Checker(NumberChecker):
    """Prints a check of the payload."""

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
        if step.count is not None and step.count.between is not None:
            self._between(step.count, step.count.between)
            return
        self._begin(7 if seven else 8)
        if isinstance(count, int):
            if seven:
                self._require(count)
                self._seven_bit(count)
            self._characters(PaddedText.of(step.type), count, seven=seven)
            self._offset += count
            return
        self._settle()
        self._require(0, count)
        if seven:
            self._refuse(f"!{self.helpers.seven_bit()}(payload + at, {count})", "ENCODING")
        self._move(count)

    def _characters(self, text: PaddedText | None, count: int, *, seven: bool) -> None:
        """Bytes that have to stand for characters."""
        if text is None:
            return
        self._flush(count if seven else 0)
        self._require(count)
        is_sound = text.is_sound(self.helpers)
        self._refuse(f"!{is_sound}({self._address()}, {amount(count)})", "VALUE")

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

    def _between(self, count: Count, between: Between) -> None:
        """The characters in front of the next separator, or of the end."""
        self._settle()
        if between.leads:
            self._require(1)
            self._refuse(f"{self._byte()} != {separator_of(between)}", "VALUE")
            self._offset = 1
        size, address = self.variable("length"), self._address()
        found = text_size(self.helpers, between, address, self._left())
        self.lines.add(f"const size_t {size} = {found};")
        self._refuse(out_of_bounds(size, count.least, count.greatest, count.greatest + 1), "SIZE")
        self._refuse(f"!{is_text(self.helpers, between, address, size)}", "VALUE")
        self._move(f"{self._offset}U + {size}" if self._offset else size)

    def packed_fill(self, step: RepeatStep, place: str, count: str) -> None:
        """Packed numbers, as many as there are bytes for; where those never vary there are none."""
        self._flush()
        if self._fixed:
            return
        self._require(0)
        run, left, address = FilledRun.of(step), self._left(), self._address()
        least, greatest = map(run.packing.size_of, (step.count.least, step.count.greatest))
        self._refuse(out_of_bounds(left, least, greatest, greatest + 1), "SIZE")
        if run.packing.width > 8 and greatest:
            spare = self.variable("spare")
            self.lines.add(f"const uint8_t {spare} = {run.spare(left)};")
            self._refuse(f"{spare} > 7U", "SIZE")
            if Check.PADDING in step.checks:
                is_set = run.padding("payload[size - 1U]", spare)
                self._refuse(f"size > {self._sum(self._offset)} && {is_set}", "VALUE")
        if Check.CLOSED in step.checks:
            self._refuse(f"!{run.are_known(self.helpers)}({address}, {left})", "VALUE")
        if greatest:
            self._end()

    # --- elements ---------------------------------------------------------------------------------

    def repeat(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Elements."""
        if step.count.fills:
            self._filling(step, place)
        elif step.count.mark is not None:
            self._up_to_last(step, place, step.count.mark)
        elif step.count.tail is not None:
            self._counted(step, place, self._in_front(step.count, step.count.tail))
        else:
            self._counted(step, place, count)

    def _counted(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Check so many elements."""
        element, size = step.element, step.element.known_size
        if size is not None and not element.can_be_wrong:
            self._run(count, size)
        elif isinstance(count, int) and self._is_seven_bit_run(element):
            self._seven_bit(count * (size or 0))
            self._offset += count * (size or 0)
        elif size is not None:
            self._each_of(size, element, place, count)
        else:
            self._each(element, place, count)

    def _in_front(self, count: Count, tail: Tail) -> str:
        """The variable of the number of elements that stand in front of a tail."""
        self._settle()
        number, left = self.variable("count"), self.variable("left")
        self.lines.add(f"size_t {number} = 0U;")
        here = (self._address(), self._left(), left)
        count_elements(self.helpers, self.lines, tail, number, here)
        most = count.greatest + 1
        self._refuse(out_of_bounds(number, count.least, count.greatest, most), "SIZE")
        return number

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
                self.lines.add(f"at += {unsigned(size)};")
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
        if isinstance(step.presence.holds, int):
            super().optional(step, place)
            return
        with self._joined(step.known_size):
            match step.presence:
                case ConditionalPresence():
                    super().optional(step, place)
                case TrailingPresence():
                    self._if_left(step, place)

    def _if_left(self, step: OptionalStep, place: str) -> None:
        """A step that is there if bytes are left."""
        self._settle()
        with self.lines.block("if (at < size)"), self.branch():
            self._secured = 1
            self.step(step.step, place)
            self.end_branch(step)

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
