"""Bytes of memory that structs take."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import prod

from protogen.model.payload_plan import AnyStep, RecordStep
from protogen.model.types import Float
from protogen.targets.c.payload.struct_members import Member, Union, members_of

NATURAL, BYTES = 8, 1
"""The greatest alignment of anything: on 32-bit machines, and on an AVR."""
_SIZES = {
    "bool": 1,
    "char": 1,
    **{f"{sign}int{bits}_t": bits // 8 for sign in ("", "u") for bits in (8, 16, 32, 64)},
}


class StructSizes:
    """The sizes on machines that align nothing to more than so many bytes."""

    def __init__(self, alignment: int) -> None:
        self._alignment = alignment
        self._known: dict[str, tuple[int, int]] = {}

    def of(self, steps: Sequence[AnyStep]) -> int:
        """The size of the struct that holds the values of these steps."""
        return self._struct(members_of(steps))[0]

    def _struct(self, members: Iterable[Member]) -> tuple[int, int]:
        """Its size and alignment."""
        end, greatest = 0, 1
        for member in members:
            size, alignment = self._member(member)
            end = _aligned(end, alignment) + size
            greatest = max(greatest, alignment)
        return _aligned(end, greatest), greatest

    def _member(self, member: Member) -> tuple[int, int]:
        size, alignment = self._type(member)
        return size * prod(member.counts), alignment

    def _type(self, member: Member) -> tuple[int, int]:
        match member.type:
            case Float(bits=bits):
                return self._number(bits // 8)
            case RecordStep():
                return self._named(member.type)
            case Union():
                return self._union(member.type)
            case tuple():
                return self._struct(member.type)
            case name:
                return self._number(_SIZES[name])

    def _number(self, size: int) -> tuple[int, int]:
        return size, min(size, self._alignment)

    def _named(self, step: RecordStep) -> tuple[int, int]:
        """Worked out once: structs that hold each other are asked at every level."""
        name = step.type.name
        if name not in self._known:
            self._known[name] = self._struct(members_of(step.steps))
        return self._known[name]

    def _union(self, union: Union) -> tuple[int, int]:
        found = [self._member(case) for case in union.cases]
        if union.rest is not None:
            found.append(self._member(union.rest))
        greatest = max(alignment for _, alignment in found)
        return _aligned(max(size for size, _ in found), greatest), greatest


def _aligned(size: int, alignment: int) -> int:
    return -(-size // alignment) * alignment
