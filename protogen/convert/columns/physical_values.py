"""Physical values and names of raw numbers, for whole columns."""

from __future__ import annotations

from typing import Any

import numpy as np

from protogen.convert.columns.arrays import Array, Codes, Lists, Numbers
from protogen.convert.columns.tables import Naming, Physical

_EXACT = 1 << 53
"""Whole numbers up to here are floats without loss."""
_SMALL = 1 << 16


def physical(meaning: Physical, raw: Numbers | Lists) -> Numbers | Lists:
    """The physical values of a column: the same as those of its rows, to the last bit."""
    values = raw.values
    missing = _special(meaning, values)
    found = values if meaning.is_plain else _computed(meaning, values)
    if isinstance(raw, Numbers):
        return Numbers(found, missing)
    return Lists(found, raw.counts, missing)


def _special(meaning: Physical, values: Array) -> Array | None:
    missing = None
    for value in meaning.special:
        here = values == value
        missing = here if missing is None else missing | here
    return missing


def _computed(meaning: Physical, values: Array) -> Array:
    if meaning.is_float:
        # As Python does it: a float and a fraction meet as floats, and too great ones are infinite.
        with np.errstate(all="ignore"):
            return values.astype("f8") * float(meaning.scale) + float(meaning.offset)
    limits = np.iinfo(values.dtype)
    most = max(abs(int(limits.min)), int(limits.max))
    if most * abs(meaning.times) + abs(meaning.plus) < _EXACT and meaning.over < _EXACT:
        # Everything up to the division is exact, so that it rounds once, as it does for fractions.
        whole = values.astype("f8")
        if meaning.times != 1:
            whole *= meaning.times
        if meaning.plus or meaning.times < 0:
            whole += meaning.plus  # A fraction has no negative zero: adding 0 makes it one.
        return whole / meaning.over
    plain = Physical(meaning.scale, meaning.offset, frozenset(), is_float=False)
    flat = [plain.of(value) for value in values.reshape(-1).tolist()]
    return np.array(flat, "f8").reshape(values.shape)


class NameFinder:
    """Finds the names of raw numbers."""

    def __init__(self, naming: Naming) -> None:
        self.texts = tuple(dict.fromkeys(naming.names.values()))
        places = {text: place for place, text in enumerate(self.texts)}
        self._names = {value: places[text] for value, text in naming.names.items()}
        self._keys = np.array(sorted(self._names), object)
        self._small: dict[Any, Array] = {}

    def find(self, raw: Numbers) -> Codes:
        """The names of a column."""
        values = raw.values
        if values.dtype.itemsize <= 2:
            lookup = self._small.get(values.dtype)
            if lookup is None:
                lookup = self._small[values.dtype] = self._lookup(values.dtype)
            # A negative index counts from the end, which is where its number stands.
            return Codes(lookup.take(values), self.texts)
        codes = np.full(len(values), -1, "i2")
        for value, place in self._names.items():
            codes[values == value] = place
        return Codes(codes, self.texts)

    def _lookup(self, dtype: Any) -> Array:
        limits = np.iinfo(dtype)
        lookup = np.full(int(limits.max) - int(limits.min) + 1, -1, "i2")
        for value, place in self._names.items():
            if limits.min <= value <= limits.max:
                lookup[value] = place
        return lookup
