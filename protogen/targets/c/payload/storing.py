"""Statements that put a valid message's payload into memory, or into a writer byte by byte."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.c_language.numbers import hexadecimal, unsigned_type
from protogen.model.packing import Packing
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ConstantStep,
    FloatStep,
    IntegerStep,
    NumberStep,
    RecordStep,
    RepeatStep,
    RestStep,
)
from protogen.model.types import NumberType
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.between import separator_of
from protogen.targets.c.payload.filled_packing import FilledRun
from protogen.targets.c.payload.free_numerals import FreeDigits
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.number_bytes import is_plain, parted, stored_type
from protogen.targets.c.payload.numerals import Digits
from protogen.targets.c.payload.packing import Placed, bytes_of
from protogen.targets.c.payload.placed import PlacedWalk
from protogen.targets.c.payload.texts import PaddedText
from protogen.targets.c.payload.walk import Walk, amount


def is_bytes(element: AnyStep) -> bool:
    """True if elements lie in memory as they lie on the wire."""
    if not isinstance(element, IntegerStep):
        return False
    return is_plain(element.type) and element.type.role != "bool"


def _byte_of(type_: NumberType, value: str) -> str:
    """The only byte of a number."""
    if type_.role == "bool" or (is_plain(type_) and type_.signed):
        return f"(uint8_t){value}"
    return value if is_plain(type_) else parted(type_, raw_of(type_, value))[0]


def raw_of(type_: NumberType, value: str) -> str:
    """The unsigned value of a number."""
    return f"({unsigned_type(type_.bits)}){value}" if type_.signed else value


class _Output(Walk):
    """Takes all values of a message in wire order."""

    def _byte(self, value: str) -> None:
        """Put a byte."""
        raise NotImplementedError

    def _number(self, type_: NumberType, value: str) -> None:
        """Put a number of several bytes."""
        raise NotImplementedError

    def _bytes(self, place: str, count: int | str) -> None:
        """Put several bytes that lie in memory."""
        raise NotImplementedError

    def _padded(self, text: PaddedText, place: str, count: int | str) -> None:
        """Put a text in a code, or with padding behind it."""
        raise NotImplementedError

    def _digits(self, digits: Digits, value: str) -> None:
        """Put an integer that is written as text."""
        raise NotImplementedError

    def _free(self, digits: FreeDigits, step: IntegerStep, value: str) -> None:
        """Put an integer that is written in as many digits as it needs."""
        raise NotImplementedError

    def constant(self, step: ConstantStep) -> None:
        """Its bytes."""
        for byte in step.data:
            self._byte(hexadecimal(byte))

    def number(self, step: NumberStep, place: str) -> None:
        """A number."""
        type_: NumberType = step.type
        if isinstance(step, FloatStep):
            place = f"{self.helpers.bits_of_float(step.type)}({place})"
            type_ = step.type.unsigned
        if isinstance(step, IntegerStep) and step.type.is_free:
            self._text(FreeDigits.of(step.type), step, place)
        elif type_.text is not None:
            self._digits(Digits.of(type_), place)
        elif type_.size == 1:
            self._byte(_byte_of(type_, place))
        else:
            self._number(type_, place)

    def _text(self, digits: FreeDigits, step: IntegerStep, value: str) -> None:
        """Put what stands for a number, behind the separator; one that is absent has no text."""
        if digits.leads:
            self._byte(digits.leads)
        if not digits.absent:
            self._free(digits, step, value)
            return
        self._join()
        with self.lines.block(f"if ({value} != {digits.absent})"):
            self._free(digits, step, value)
            self._join()

    def _join(self) -> None:
        """Be where two ways on meet."""

    def packed(self, step: RecordStep | RepeatStep, place: str) -> None:
        """Numbers that are packed."""
        self.runs(step, place)

    def run(self, packing: Packing, placed: Sequence[Placed]) -> None:
        """Numbers that are packed."""
        for byte in bytes_of(packing, placed):
            self._byte(byte)

    def bytes(self, step: BytesStep | RestStep, place: str, count: int | str) -> None:
        """A text, or bytes, with what ends them, or stands in front."""
        text = PaddedText.of(step.type)
        if text is not None:
            self._padded(text, place, count)
            return
        if step.count.between is not None and step.count.between.leads:
            self._byte(separator_of(step.count.between))
        self._bytes(place, count)
        if step.count.until is not None:
            self._byte(hexadecimal(step.count.until))

    def repeat(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Elements."""
        if is_bytes(step.element):
            self._bytes(place, count)
        else:
            self.elements(step, place, count)


class Store(_Output, PlacedWalk):
    """Puts values into memory."""

    def __init__(self, helpers: Helpers, lines: Lines) -> None:
        super().__init__(helpers, lines, "uint8_t *")

    def _byte(self, value: str) -> None:
        self.lines.add(f"{self.byte()} = {value};")
        self.skip(1)

    def _number(self, type_: NumberType, value: str) -> None:
        raw = f"({stored_type(type_)}){value}" if type_.signed else value
        self.lines.add(f"{self.helpers.store(type_)}({self.address()}, {raw});")
        self.skip(type_.size)

    def _digits(self, digits: Digits, value: str) -> None:
        stored = f"{digits.store(self.helpers)}({self.address()}, {digits.raw(value)})"
        self.lines.add(f"(void){stored};")
        self.skip(digits.form.size)

    def _join(self) -> None:
        self.settle()

    def _free(self, digits: FreeDigits, step: IntegerStep, value: str) -> None:
        if digits.form.base == 256:
            self._byte(value)
            return
        if step.is_last:
            self.lines.add(f"(void){digits.stored(self.helpers, self.address(), value)};")
            return
        self.settle()
        self.lines.add(f"at += {digits.stored(self.helpers, 'at', value)};")

    def _bytes(self, place: str, count: int | str) -> None:
        self.lines.add(f"{self.helpers.copy()}({self.address()}, {place}, {amount(count)});")
        self.skip(count)

    def packed_fill(self, step: RepeatStep, place: str, count: str) -> None:
        """As many packed numbers as there are."""
        pack = FilledRun.of(step).store(self.helpers)
        self.lines.add(f"{pack}({self.address()}, {place}, {count});")

    def _padded(self, text: PaddedText, place: str, count: int | str) -> None:
        store = text.store(self.helpers)
        self.lines.add(f"{store}({self.address()}, {place}, {amount(count)});")
        self.skip(count)


class Put(_Output):
    """Puts values into a writer."""

    def __init__(self, helpers: Helpers, lines: Lines, prefix: str, writing: str) -> None:
        super().__init__(helpers, lines)
        self._prefix = prefix
        self._write = f"{prefix}_write"
        self._writing = writing

    def _byte(self, value: str) -> None:
        self.lines.add(f"{self._write}({self._writing}, {value});")

    def _number(self, type_: NumberType, value: str) -> None:
        raw = raw_of(type_, value)
        self.lines.add(f"{self.helpers.write(type_)}({self._writing}, {raw});")

    def _digits(self, digits: Digits, value: str) -> None:
        write = digits.write(self.helpers)
        self.lines.add(f"{write}({self._writing}, {digits.raw(value)});")

    def _free(self, digits: FreeDigits, step: IntegerStep, value: str) -> None:
        if digits.form.base == 256:
            self._byte(value)
            return
        self.lines.add(f"{digits.written(self.helpers, self._writing, value)};")

    def _bytes(self, place: str, count: int | str) -> None:
        write = self.helpers.write_bytes()
        self.lines.add(f"{write}({self._writing}, {place}, {amount(count)});")

    def packed_fill(self, step: RepeatStep, place: str, count: str) -> None:
        """As many packed numbers as there are."""
        write = FilledRun.of(step).write(self.helpers, self._prefix, self._writing)
        self.lines.add(f"{write}({self._writing}, {place}, {count});")

    def _padded(self, text: PaddedText, place: str, count: int | str) -> None:
        write = text.write(self.helpers, self._prefix, self._writing)
        self.lines.add(f"{write}({self._writing}, {place}, {amount(count)});")
