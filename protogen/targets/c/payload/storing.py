"""Statements that put a valid message's payload into memory, or into a writer byte by byte."""

from __future__ import annotations

from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ConstantStep,
    IntegerStep,
    NumberStep,
    RepeatStep,
    RestStep,
)
from protogen.model.types import Float, NumberType
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.helpers import Helpers, is_plain, parted
from protogen.targets.c.payload.placed import PlacedWalk
from protogen.targets.c.payload.walk import Walk, amount
from protogen.targets.c.spelling import hexadecimal, unsigned_type


def byte_of(type_: NumberType, expression: str) -> str:
    """The only byte of a number."""
    if type_.role == "bool":
        return f"(uint8_t){expression}"
    if is_plain(type_):
        return f"(uint8_t){expression}" if type_.signed else expression
    return parted(type_, raw_of(type_, expression))[0]


def raw_of(type_: NumberType, expression: str) -> str:
    """The unsigned value of a number."""
    return f"({unsigned_type(type_.bits)}){expression}" if type_.signed else expression


def is_bytes(element: AnyStep) -> bool:
    """True if elements lie in memory as they lie on the wire."""
    if not isinstance(element, IntegerStep):
        return False
    return is_plain(element.type) and element.type.role != "bool"


def _raw(helpers: Helpers, step: NumberStep, place: str) -> tuple[NumberType, str]:
    """The integer to write for a number, and its value."""
    if isinstance(step.type, Float):
        return step.type.unsigned, f"{helpers.bits_of_float(step.type)}({place})"
    return step.type, place


class Store(PlacedWalk):
    """Puts values into memory."""

    def __init__(self, helpers: Helpers, lines: Lines) -> None:
        super().__init__(helpers, lines, "uint8_t *")

    def constant(self, step: ConstantStep) -> None:
        """Its bytes."""
        for index, byte in enumerate(step.data):
            self.lines.add(f"{self._place.byte(index)} = {hexadecimal(byte)};")
        self._place.skip(len(step.data))

    def number(self, step: NumberStep, place: str) -> None:
        """A number."""
        type_, value = _raw(self.helpers, step, place)
        if type_.size == 1:
            self.lines.add(f"{self._place.byte()} = {byte_of(type_, value)};")
        else:
            store = self.helpers.store(type_)
            self.lines.add(f"{store}({self._place.address()}, {raw_of(type_, value)});")
        self._place.skip(type_.size)

    def bytes(self, step: BytesStep, place: str, count: int | str) -> None:
        """A text, or bytes."""
        self._copy(place, count)

    def _copy(self, place: str, count: int | str) -> None:
        copy = self.helpers.copy()
        self.lines.add(f"{copy}({self._place.address()}, {place}, {amount(count)});")
        self._place.skip(count)

    def repeat(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Elements."""
        if is_bytes(step.element):
            self._copy(place, count)
        else:
            self.elements(step, place, count)

    def rest(self, step: RestStep, place: str) -> None:
        """The bytes of a value without a case."""
        self._copy(f"{place}.bytes", f"{place}.size")


class Put(Walk):
    """Puts values into a writer."""

    def __init__(self, helpers: Helpers, lines: Lines, prefix: str, writing: str) -> None:
        super().__init__(helpers, lines)
        self._write = f"{prefix}_write"
        self._writing = writing

    def constant(self, step: ConstantStep) -> None:
        """Its bytes."""
        for byte in step.data:
            self.lines.add(f"{self._write}({self._writing}, {hexadecimal(byte)});")

    def number(self, step: NumberStep, place: str) -> None:
        """A number."""
        type_, value = _raw(self.helpers, step, place)
        if type_.size == 1:
            self.lines.add(f"{self._write}({self._writing}, {byte_of(type_, value)});")
        else:
            write = self.helpers.write(type_)
            self.lines.add(f"{write}({self._writing}, {raw_of(type_, value)});")

    def bytes(self, step: BytesStep, place: str, count: int | str) -> None:
        """A text, or bytes."""
        self._bytes(place, count)

    def _bytes(self, place: str, count: int | str) -> None:
        write = self.helpers.write_bytes()
        self.lines.add(f"{write}({self._writing}, {place}, {amount(count)});")

    def repeat(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Elements."""
        if is_bytes(step.element):
            self._bytes(place, count)
            return
        with self.loop(count) as index:
            self.step(step.element, f"{place}[{index}]")

    def rest(self, step: RestStep, place: str) -> None:
        """The bytes of a value without a case."""
        self._bytes(f"{place}.bytes", f"{place}.size")
