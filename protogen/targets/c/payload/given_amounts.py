"""Numbers of elements as parameters, and variables for those that a payload has already."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import msgspec

from protogen.c_language.numbers import (
    constant,
    counting_type,
    integer_type,
    unsigned,
    unsigned_type,
)
from protogen.model.payload_plan import Count, Formula, Reference
from protogen.model.types import counting_bits
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.validating import Validate
from protogen.targets.c.payload.walk import Walk, is_unfit, times, type_of
from protogen.targets.c.payload.written_places import Amount, Place


class GivenAmount(msgspec.Struct, frozen=True):
    """A number of elements or bytes, as a parameter."""

    name: str
    type: str
    number: str
    """The expression of a `size_t`."""
    refused: str
    """The condition that no frame has so many; empty if there is none."""
    read: str
    """The function that reads it in a payload; empty where a frame is ended with it."""


def given_amount(item: Amount, name: str, fills: Count | None, read: str) -> GivenAmount:
    """The parameter of this name; `fills` is the number of what fills the payload."""
    if item.step is None:
        assert fills is not None
        bits = counting_bits(fills.greatest)
        kind, spelled = counting_type(fills.greatest), unsigned
        least, greatest = 0, (1 << bits) - 1
    else:
        type_ = item.step.type
        kind, spelled = integer_type(type_), lambda value: constant(value, type_)
        least, greatest = type_.machine_bounds
    below = f"{name} < {spelled(item.least)}" if item.least > least else ""
    above = f"{name} > {spelled(item.greatest)}" if item.greatest < greatest else ""
    number = name if kind in ("uint8_t", "uint16_t") else f"(size_t){name}"
    return GivenAmount(name, kind, number, " || ".join(filter(None, (below, above))), read)


class ReadAmounts(Walk):
    """Numbers that stand in a payload, in variables that are declared as they are asked for."""

    def __init__(
        self, helpers: Helpers, lines: Lines, amounts: Mapping[str, GivenAmount], payload: str
    ) -> None:
        super().__init__(helpers, lines)
        self._amounts, self._payload = amounts, payload
        self._locals |= {it.name for it in amounts.values()}
        self._read: set[str] = set()
        self._worked_out: dict[Formula, str] = {}

    def referred(self, number: Reference) -> str:
        """The variable for a number."""
        given = self._amounts[number.name]
        if number.name not in self._read:
            self._read.add(number.name)
            self.lines.add(f"const {given.type} {given.name} = {given.read}({self._payload});")
        return given.name

    def worked_out(self, count: Count, by: Formula) -> str:
        """A variable with the number that a formula says; one for each."""
        if by not in self._worked_out:
            self._worked_out[by] = super().worked_out(count, by)
        return self._worked_out[by]


class CheckedAmounts(Validate):
    """Numbers that are parameters; NULL is returned where an encoder refuses one of them."""

    def __init__(self, helpers: Helpers, lines: Lines, amounts: Mapping[str, GivenAmount]) -> None:
        super().__init__(helpers, lines, lambda _: "NULL")
        self._amounts = amounts
        self._locals |= {it.name for it in amounts.values()}

    def given(self, amount: Amount) -> None:
        """Refuse what the field itself can't be."""
        assert amount.step is not None
        self.number(amount.step, self._amounts[amount.name].name)

    def worked_out(self, count: Count, by: Formula) -> str:
        """A variable with a number that is not below 0 any more."""
        name, type_ = self.declared(by), type_of(by)
        self._refuse(is_unfit(name, count, by))
        cast = f"({unsigned_type(type_.bits)})" if type_.signed else ""
        return f"(size_t){cast}{name}"

    def referred(self, number: Reference) -> str:
        """The parameter."""
        return self._amounts[number.name].name


def sizes_of(walk: Walk, places: Iterable[Place]) -> list[str]:
    """The bytes that so many elements have, in each of the places."""
    return [str(times(count_of(walk, it), it.width)) for it in places]


def count_of(walk: Walk, place: Place) -> int | str:
    """The number of elements in a place."""
    assert place.step.count is not None
    return walk.count(place.step.count)
