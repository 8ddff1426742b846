"""Steps that print values as CDR, and what is known of the places where they come to stand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from protogen.convert.ros2.cdr import CdrWriter, missing
from protogen.convert.ros2.layout import ListOf, Message, Number, RosType, String
from protogen.convert.writers.value_steps import Spot, told_presence
from protogen.model.types import Field
from protogen.native import cdr_steps as cdr
from protogen.native.cdr_steps import Alignment
from protogen.native.print_steps import Count, Step

Make = Callable[[], list[Step]]
"""Makes steps, from the place that the message has come to."""


class CdrPrinter:
    """Prints values, and keeps in mind what is known of the place that comes next."""

    def __init__(self) -> None:
        self._at = Alignment()

    def align(self, size: int) -> list[Step]:
        """Zeros up to a multiple of a size."""
        padding = self._at.padding(size)
        self._at = self._at.aligned(size)
        if padding is None:
            return [cdr.pad(size)]
        return [cdr.fixed(bytes(padding))] if padding else []

    def aligned(self, size: int, step: Step) -> list[Step]:
        """A number of that size, at a multiple of it."""
        front = self.align(size)
        self._at = self._at.after(size)
        return [*front, step]

    def flag(self, holds: bool) -> list[Step]:
        """A bool."""
        return self.aligned(1, cdr.fixed(bytes((holds,))))

    def constant(self, type: RosType, value: Any) -> list[Step]:
        """A value that is always the same; None: what stands where there is none."""
        match type:
            case Number(size=size):
                return self.aligned(size, cdr.fixed(constant_bytes(type, value)))
            case String():
                found = self.align(4)
                self._at = Alignment(1)
                return [*found, cdr.fixed(constant_bytes(type, value))]
            case ListOf(element=element, count=count):
                values = value if value is not None else ()
                found = self.count(len(values)) if count is None else []
                for item in values:
                    found += self.constant(element, missing(element) if item is None else item)
                return found
            case Message(is_list=True):
                return self.constant(type.members[0].type, value)
        return self._constant_members(type, value or {})

    def _constant_members(self, type: Message, values: Mapping[str, Any]) -> list[Step]:
        found = []
        for member in type.members:
            value = values.get(member.source)
            if member.flag is not None:
                found += self.flag(value is not None)
            found += self.constant(member.type, value)
        return found

    def count(self, count: Count) -> list[Step]:
        """A number of elements."""
        return self.aligned(4, cdr.count(count))

    def octets(self, step: Step) -> list[Step]:
        """A number of bytes that depends."""
        self._at = Alignment(1)
        return [step]

    # --- choices ----------------------------------------------------------------------------------

    def fork(self, makers: Sequence[Make]) -> list[list[Step]]:
        """Steps of which one or the other are taken."""
        start, found = self._at, []
        ends = []
        for make in makers:
            self._at = start
            found.append(make())
            ends.append(self._at)
        for end in ends:
            self._at = self._at.joined(end)
        return found

    def either(self, condition: str, body: Make, other: Make) -> list[Step]:
        """Steps by a condition of C."""
        return [cdr.either(condition, *self.fork([body, other]))]

    def loop(self, body: Make) -> list[Step]:
        """Steps that are taken several times, or not at all."""
        start = self._at
        while True:
            self._at = start
            found = body()
            again = start.joined(self._at)
            if again == start:
                self._at = start
                return found
            start = again

    def if_there(self, item: Field, at: Spot, body: Make, other: Make) -> list[Step]:
        """Steps of a field where it is there, and others where it is not."""
        condition = told_presence(item, at)
        if isinstance(condition, int):
            return body() if condition else other()
        return [cdr.where(condition, *self.fork([body, other]))]

    def chosen(self, selector: Count, bodies: Mapping[int, Make], rest: Make) -> list[Step]:
        """Steps of the case that a number chooses; those of `rest` for all others."""
        if isinstance(selector, int):
            return bodies.get(selector, rest)()
        *found, last = self.fork([*bodies.values(), rest])
        return [cdr.choose(selector, dict(zip(bodies, found, strict=True)), last)]


def constant_bytes(type: RosType, value: Any) -> bytes:
    """A value at a place that is a multiple of eight."""
    writer = CdrWriter()
    writer.value(type, value)
    return bytes(writer.data)
