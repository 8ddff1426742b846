"""Places in a payload whose numbers of elements are given first, when its frame is begun.

They stand in the payload then. What is in front of a place is worked out of them, wherever a field
is written or read.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from protogen.c_language.numbers import hexadecimal, unsigned, unsigned_type
from protogen.model.constants import raw_bytes
from protogen.model.initial_payload import initial_bytes
from protogen.model.payload_plan import RepeatStep
from protogen.model.types import NumberType
from protogen.targets.c.lines import WIDTH, Lines
from protogen.targets.c.payload.given_amounts import (
    CheckedAmounts,
    GivenAmount,
    ReadAmounts,
    count_of,
    sizes_of,
)
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.number_bytes import cut, parted
from protogen.targets.c.payload.storing import Store, raw_of
from protogen.targets.c.payload.walk import amount, times
from protogen.targets.c.payload.written_places import Amount, Place, Places

_LONG = 60
"""Columns of an address that leave room for a declaration and an index."""


class StoreAt(Store):
    """Stores values at a place behind a variable, and behind what `ahead` says."""

    def __init__(
        self, helpers: Helpers, lines: Lines, start: str, at: int, ahead: Sequence[str] = ()
    ) -> None:
        super().__init__(helpers, lines)
        self._name, self._offset, self._index = start, at, " + ".join(ahead)

    def _number(self, type_: NumberType, value: str) -> None:
        if not self._index:
            super()._number(type_, value)
            return
        for place, byte in enumerate(parted(cut(type_), raw_of(type_, value))):
            self.lines.add(f"{self.byte(place)} = {byte};")


class FirstAmounts:
    """Prints what goes by the numbers; of a message that has none, places are where they are."""

    def __init__(
        self, places: Places, amounts: Mapping[str, GivenAmount], helpers: Helpers
    ) -> None:
        self._places, self._amounts, self._helpers = places, amounts, helpers
        self._varied = [it for it in places.places if it.varies and not it.amount]
        self._counts: dict[str, str] = {}
        self._ahead: dict[str, tuple[str, ...]] = {}
        self.sizing = self._sizing() if places.first else ()
        """Statements that refuse numbers, and declare how many bytes `payload` has room for."""

    def reading(self, lines: Lines, payload: str = "payload") -> ReadAmounts:
        """Declares variables for numbers that a payload has."""
        return ReadAmounts(self._helpers, lines, self._amounts, payload)

    def address(self, place: Place, start: str, reading: ReadAmounts, offset: int = 0) -> str:
        """Where a field stands, or something in it."""
        sizes = sizes_of(reading, place.ahead)
        at = " + ".join([offset_by(start, place.at + offset), *sizes])
        if len(at) <= _LONG:
            return at
        terms = [unsigned(place.at + offset), *sizes]
        _add_up(reading.lines, "size_t ahead", terms, "const ")
        return f"{start} + ahead"

    def most(self, place: Place, body: Lines, reading: ReadAmounts) -> list[str]:
        """How many elements a place has, or can have: no more than each of these."""
        if not place.varies or not self._places.first:
            return [amount(place.most)]
        if not place.amount:
            return [amount(count_of(reading, place))]
        body.add(f"const size_t most = {self._left(place, sizes_of(reading, place.ahead))};")
        behind = place.at + sum(it.width * it.least for it in place.ahead)
        is_less = place.most * place.width < self._places.size - behind
        return ["most", *[unsigned(place.most)] * is_less]

    def members_of(self, place: Place) -> Iterator[Amount]:
        """The numbers that are members of a struct."""
        for it in self._places.first:
            if it.place == place.step.name != it.name:
                yield it

    def _left(self, place: Place, ahead: Sequence[str]) -> str:
        """How many elements there is room for in what fills the payload."""
        left = " - ".join([unsigned(self._places.size - place.at), *ahead])
        return left if place.width == 1 else f"({left}) / {unsigned(place.width)}"

    def _sizing(self) -> tuple[str, ...]:
        places, lines = self._places, Lines()
        checked = CheckedAmounts(self._helpers, lines, self._amounts)
        for item in places.first:
            checked.given(item)
        fills = [it for it in places.places if it.amount]
        least = places.fixed + sum(it.width * it.least for it in fills)
        most = least + sum(it.size for it in self._varied)
        kind = "size_t" if most <= 0xFFFF else unsigned_type(most.bit_length())
        sizes: list[str] = []
        terms = [unsigned(least)] if least else []
        for place in places.places:
            self._ahead[place.step.name] = tuple(sizes)
            if place in self._varied:
                count = count_of(checked, place)
                sizes.append(str(times(count, place.width)))
                terms.append(sizes[-1] if kind == "size_t" else _wide(count, place.width, kind))
                self._counts[place.step.name] = amount(count)
        is_bounded = most > places.size
        name = "needed" if fills or kind != "size_t" else "payload"
        if is_bounded or not fills:
            _add_up(lines, f"{kind} {name}", terms, "const ")
        if is_bounded:
            with lines.block(f"if ({name} > {unsigned(places.size)})"):
                lines.add("return NULL;")
        if name == "needed":
            size = unsigned(places.size) if fills else f"(size_t){name}"
            lines.add(f"const size_t payload = {size};")
        return tuple(lines.lines)

    def begun(self, place: Place) -> Iterator[str]:
        """Statements that store a default at `at`, or numbers that are given first."""
        ahead = self._ahead.get(place.step.name, ())
        numbers = [it for it in self._places.first if it.place == place.step.name]
        if not any(it.name == place.step.name for it in numbers):
            yield from _defaults(place, ahead, self._begun_count(place, ahead))
        for item in numbers:
            assert item.step is not None
            lines = Lines(0)
            store = StoreAt(self._helpers, lines, "at", place.at + item.at, ahead)
            store.step(item.step, self._amounts[item.name].name)
            yield from lines.lines

    def _begun_count(self, place: Place, ahead: Sequence[str]) -> str:
        """How many elements there is room for when a frame is begun."""
        if self._places.first and place.amount:
            return self._left(place, ahead)
        return self._counts.get(place.step.name, amount(place.most))

    def measuring(self) -> tuple[str, ...]:
        """Statements that work out the bytes of a payload that has its numbers."""
        lines, places = Lines(), self._places
        if not places.first:
            return ()
        sizes = sizes_of(self.reading(lines, "written"), self._varied)
        for place in places.places:
            if place.amount:
                number = self._amounts[place.amount].number
                with lines.block(f"if ({number} > {self._left(place, sizes)})"):
                    lines.add("return 0U;")
                sizes.append(str(times(number, place.width)))
        start = [unsigned(places.fixed)] if places.fixed else []
        _add_up(lines, "payload", [*start, *sizes])
        return tuple(lines.lines)


def offset_by(start: str, offset: int) -> str:
    """So many bytes behind a place."""
    return f"{start} + {unsigned(offset)}" if offset else start


def _add_up(lines: Lines, variable: str, terms: Sequence[str], constant: str = "") -> None:
    """Give a variable the sum: in one statement, or in several where that is too long a line."""
    whole = f"{constant}{variable} = {' + '.join(terms)};"
    if len(lines.margin + whole) <= WIDTH:
        lines.add(whole)
        return
    lines.add(f"{variable} = {terms[0]};")
    name = variable.rpartition(" ")[2]
    lines.add(*(f"{name} += {term};" for term in terms[1:]))


def _wide(count: int | str, width: int, kind: str) -> str:
    """The bytes of so many elements, in a type that holds those of all arrays."""
    return f"({kind}){unsigned(width)} * {count}" if width > 1 else f"({kind}){count}"


def _defaults(place: Place, ahead: Sequence[str], count: str) -> Iterator[str]:
    """Statements that store what is not 0 of a default, behind what is ahead of it."""
    step, at = place.step, place.at
    if isinstance(step, RepeatStep) and step.field.default is None:
        element = initial_bytes(step.element)
        assert element is not None
        places = [(index, byte) for index, byte in enumerate(element) if byte]
        if places:
            yield f"for (size_t i = 0; i < {count}; i++) {{"
            for index, byte in places:
                start = f"{len(element)}U * i" if len(element) > 1 else "i"
                start = " + ".join([offset_by(start, at + index), *ahead])
                yield f"    at[{start}] = {hexadecimal(byte)};"
            yield "}"
        return
    for index, byte in enumerate(_default(place)):
        if byte:
            start = " + ".join([unsigned(at + index), *ahead]) if ahead else str(at + index)
            yield f"at[{start}] = {hexadecimal(byte)};"


def _default(place: Place) -> bytes:
    """The bytes that a field begins with."""
    step, given = place.step, place.step.field.default
    if place.varies and isinstance(given, str | bytes):
        return raw_bytes(step.type, given)
    return initial_bytes(step) or b""
