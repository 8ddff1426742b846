"""Values inside of lists, laid out as the printer walks them: those of one element side by side.

Batches hold what is inside of lists column by column. The printer goes from element to element, so
lists become a matrix whose rows have room for the longest one, with the counts beside it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from protogen.convert.arrays import Array, Lists, Numbers
from protogen.convert.composed import ListsOf, Structs
from protogen.convert.programs import Programs, operand
from protogen.convert.values import Values
from protogen.native.printer import Operand

NUMBERS = ("NaN", "Infinity", "-Infinity")
"""As `json.dumps` has them."""
_DEEPEST = 8
"""Lists in lists. The printer has room for twice as many."""
_MOST_ROOM = 16
"""Room for elements to each that is there, where lists are long and short by turns."""
_SMALL = 1 << 16
"""Elements that may have any room."""
_MOST_BYTES = 1 << 25
"""Of the room, as lists in lists multiply it: several times what a batch of one size takes."""

Step = Callable[[Programs, int], None]
"""Print what lies so many bytes behind the start of the element at hand."""


@dataclass(frozen=True, slots=True)
class Laid:
    """Values of rows, one behind the other, and how each is printed."""

    values: Array
    step: Step


def laid(values: Values, deep: int = 0) -> Laid | None:
    """The layout of values; None for those of which the printer knows nothing."""
    match values:
        case Numbers(values=numbers, missing=None):
            return _numbers(numbers)
        case Lists(values=matrix, missing=None) if deep < _DEEPEST:
            counts = values.counts
            if counts is None:
                counts = np.full(len(matrix), matrix.shape[1], "i4")
            flat = _numbers(matrix.reshape(-1))
            return _lists(Laid(flat.values.reshape(matrix.shape), flat.step), counts)
        case Structs(members=members) if members:
            inner = {name: laid(member, deep) for name, member in members.items()}
            known = {name: it for name, it in inner.items() if it is not None}
            return _structs(known, len(values)) if len(known) == len(inner) else None
        case ListsOf(elements=elements, counts=counts) if deep < _DEEPEST:
            found = spread(laid(elements, deep + 1), counts)
            return None if found is None else _lists(found, counts)
    return None


def spread(elements: Laid | None, counts: Array) -> Laid | None:
    """The elements of all lists, each list in a row of its own; None where few rows need the room.

    Rows have room for a power of two, so that programs for them can be used again.
    """
    most = 1 << max(0, int(counts.max(initial=0)) - 1).bit_length()
    if elements is None:
        return None
    room = most * len(counts)
    if room > max(_SMALL, _MOST_ROOM * len(elements.values)):
        return None
    if room * elements.values.itemsize > _MOST_BYTES:
        return None
    found = np.zeros((len(counts), most), elements.values.dtype)
    found[np.arange(most) < counts.reshape(-1, 1)] = elements.values
    return Laid(found, elements.step)


def code_of(values: Array) -> str:
    """The printer's name of a type."""
    return "?" if values.dtype == np.bool_ else values.dtype.str[1:]


def _numbers(values: Array) -> Laid:
    code = code_of(values)

    def step(programs: Programs, offset: int) -> None:
        programs.number(_at(code, offset), code, NUMBERS)

    return Laid(values, step)


def _lists(elements: Laid, counts: Array) -> Laid:
    matrix = elements.values
    record = np.dtype([("count", "i4"), ("values", matrix.dtype, matrix.shape[1:])])
    found = np.zeros(len(matrix), record)
    found["count"] = counts
    found["values"] = matrix
    places = _places(record)

    def step(programs: Programs, offset: int) -> None:
        first = Operand(source=-1, offset=offset + places["values"])
        count = _at("i4", offset + places["count"])
        programs.text("[")
        programs.listed(first, matrix.itemsize, count, lambda: elements.step(programs, 0))
        programs.text("]")

    return Laid(found, step)


def _structs(members: Mapping[str, Laid], rows: int) -> Laid:
    record = np.dtype([(f"{place}", it.values.dtype) for place, it in enumerate(members.values())])
    found = np.zeros(rows, record)
    for place, it in enumerate(members.values()):
        found[f"{place}"] = it.values
    places = _places(record)

    def step(programs: Programs, offset: int) -> None:
        for place, (name, it) in enumerate(members.items()):
            programs.text(f"{', ' if place else '{'}{json.dumps(name)}: ")
            it.step(programs, offset + places[f"{place}"])
        programs.text("}")

    return Laid(found, step)


def _at(code: str, offset: int) -> Operand:
    return operand(code, offset)


def _places(record: np.dtype[Any]) -> dict[str, int]:
    fields = record.fields
    assert fields is not None
    return {name: place for name, (_, place, *_) in fields.items()}
