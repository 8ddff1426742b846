"""Numbers of frames as C reads and writes them: bytes of bits, or digits."""

from __future__ import annotations

from collections.abc import Container

from protogen.c_language.numbers import unsigned_type
from protogen.model.frame_plan import FramePlan
from protogen.model.numbers import Numeral
from protogen.model.parts import BitsPart, ChecksumPart, NumberPart, PartType, TypedPart
from protogen.model.types import storage_bits
from protogen.targets.c.frame import expressions
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.numerals import Digits


class PartNumbers:
    """Fragments of C for the numbers of a frame; digits have functions, which payloads share."""

    def __init__(self, helpers: Helpers) -> None:
        self._helpers = helpers

    def value(self, type_: PartType, at: str, offset: int, less: str = "") -> str:
        """The value of the bytes from `at[offset]` on, with bits that have to be zero.

        `less` is C that is put behind each index.
        """
        if isinstance(type_.text, Numeral):
            return Digits.of(type_).value(self._helpers, _address(at, offset, less))
        if type_.within is not None:
            return self.bits(type_, at, f"{offset}{less}")
        return expressions.number_of(type_, at, offset, less)

    def bits(self, type_: PartType, at: str, index: str) -> str:
        """The value of bits of the bytes from `at[index]` on."""
        number = self.whole(type_.whole, at, index)
        return expressions.bits_of(type_, number, storage_bits(type_.whole.bits))

    def whole(self, type_: PartType, at: str, offset: int | str, less: str = "") -> str:
        """The number of all bits of some bytes, whose bits are parts."""
        place = f"{at}[{offset}{less}]"
        return place if type_.size == 1 else f"{self._helpers.load(type_)}(&{place})"

    def shown(self, type_: PartType, at: str, offset: int, less: str) -> str:
        """The same value, in the type of a member that holds it."""
        value = self.value(type_, at, offset, less)
        if type_.within is not None:
            return value
        is_wider = type_.text is None and storage_bits(type_.byte_bits * type_.size) > type_.width
        return f"({unsigned_type(type_.bits)})({value})" if is_wider else value

    def fault(self, type_: PartType, at: str, offset: int, less: str) -> str:
        """The condition that no value has these bytes; empty where each has one."""
        if isinstance(type_.text, Numeral):
            address = _address(at, offset, less)
            return " || ".join(Digits.of(type_).faults(self._helpers, address))
        if type_.within is not None or type_.byte_bits * type_.size == type_.bits:
            return ""
        return f"({expressions.number_of(type_, at, offset, less)} >> {type_.bits}) != 0U"

    def bytes_of(self, type_: PartType, value: str) -> tuple[str, ...]:
        """The bytes of an unsigned `value`, in wire order."""
        if isinstance(type_.text, Numeral):
            return Digits.of(type_).characters(self._helpers, value)
        return expressions.wire_bytes(type_, value)


def fills_bytes(part: ChecksumPart) -> bool:
    """True if the result of a checksum has all bits of the bytes that are sent."""
    type_, width = part.type, part.algorithm.width
    return type_.text is None and type_.byte_bits == 8 and 8 * type_.size == type_.bits == width


def claim_functions(plan: FramePlan, compared: Container[str], numbers: PartNumbers) -> None:
    """Ask for the functions that read and write numbers of a frame, so that they are printed.

    Of checksums, these are compared.
    """
    for virtual in plan.frame.virtual:
        numbers.bytes_of(virtual.type, "value")
    for item in plan.placed:
        if isinstance(item.part, TypedPart):
            numbers.bytes_of(item.part.type, "value")
        if isinstance(item.part, ChecksumPart) and fills_bytes(item.part) and item.name in compared:
            numbers.whole(item.part.type, "content", 0)
        if isinstance(item.part, NumberPart):
            numbers.value(item.part.type, "content", 0)
            numbers.fault(item.part.type, "content", 0, "")
        if isinstance(item.part, BitsPart):
            numbers.whole(item.part.type.whole, "content", 0)


def _address(at: str, offset: int, less: str) -> str:
    return f"&{at}[{offset}{less}]"
