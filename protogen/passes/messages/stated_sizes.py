"""Sizes that a schema insists on.

A count without a `range`, and a fill or data up to a terminator without `max`, take what the
frame has room for. Everything else states how large it can be, and the frame has to do.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from protogen.model.nesting import inner_types
from protogen.model.packing import FilledPacking
from protogen.model.types import (
    Array,
    Delimited,
    Extent,
    Field,
    NumberType,
    Octets,
    Struct,
    Text,
    Type,
    packing_of,
)

_Count = Callable[[Extent], int]
_Choose = Callable[[Iterable[int]], int]


def greatest_stated(fields: Iterable[Field]) -> int:
    """The bytes that the frame must have room for."""
    return sum(_size_of(field, _most, max) for field in fields)


def least_stated(fields: Iterable[Field]) -> int:
    """The bytes that a payload can be as short as, where what may vary freely is as long as it can.

    A frame that has to be longer than that can't carry some payload that the schema states.
    """
    return sum(_size_of(field, _fewest, min) for field in fields)


def _most(extent: Extent) -> int:
    return extent.counts.greatest if extent.stated else extent.counts.least


def _fewest(extent: Extent) -> int:
    stated = extent.stated and not isinstance(extent, Delimited)
    return extent.counts.least if stated else extent.counts.greatest


def _size_of(field: Field, count: _Count, choose: _Choose) -> int:
    size = _size(field.type, count, choose)
    if field.region is not None:
        size = min(size, field.region.counts.greatest)
    return choose((0, size)) if field.may_be_absent else size


def _size(type_: Type, count: _Count, choose: _Choose) -> int:
    sizes = type_.sizes
    if sizes.fixed is not None:
        return sizes.fixed
    if isinstance(type_, NumberType):
        return choose((sizes.least, sizes.greatest))
    match type_:
        case Text() | Octets():
            return count(type_.extent) + len(type_.terminator)
        case Array():
            packing = packing_of(type_)
            if isinstance(packing, FilledPacking):
                return packing.size_of(count(type_.extent))
            return count(type_.extent) * _size(type_.element, count, choose)
        case Struct():
            return sum(_size_of(field, count, choose) for field in type_.fields)
    return choose(_size(case, count, choose) for case in inner_types(type_))
