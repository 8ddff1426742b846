"""Columns in NumPy arrays: what a batch holds, and how lists and Arrow arrays come of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from protogen.convert.columns.tables import ColumnType, Listed, Names

if TYPE_CHECKING:
    import pyarrow as pa

Array = np.ndarray[Any, np.dtype[Any]]


class Numbers(msgspec.Struct, frozen=True):
    """Numbers; those where `missing` holds are not there."""

    values: Array
    missing: Array | None = None

    def __len__(self) -> int:
        return len(self.values)

    def tolist(self) -> list[Any]:
        """Each number, None where it is missing."""
        return _with_none(self.values, self.missing)

    def to_arrow(self, type: ColumnType) -> pa.Array:
        """The Arrow array."""
        return _numbers(self.values, self.missing)


class Nothing(msgspec.Struct, frozen=True):
    """A column without a single value."""

    count: int

    def __len__(self) -> int:
        return self.count

    def tolist(self) -> list[Any]:
        """None, for each row."""
        return [None] * self.count

    def to_arrow(self, type: ColumnType) -> pa.Array:
        """The Arrow array."""
        import pyarrow as pa

        from protogen.convert.columns.arrow_tables import type_of

        return pa.nulls(self.count, type_of(type))


class Codes(msgspec.Struct, frozen=True):
    """Places in a list of texts; -1: none of them."""

    codes: Array
    texts: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.codes)

    def tolist(self) -> list[Any]:
        """The text of each row, or None."""
        # The last one stands for -1.
        found: list[Any] = np.array([*self.texts, None], object)[self.codes].tolist()
        return found

    def to_arrow(self, type: ColumnType) -> pa.Array:
        """The Arrow array."""
        import pyarrow as pa

        assert isinstance(type, Names)
        indices = _numbers(self.codes, self.codes < 0)
        return pa.DictionaryArray.from_arrays(indices, pa.array(type.texts, pa.string()))


class Lists(msgspec.Struct, frozen=True):
    """A list in each row: the first `counts` numbers of the row of a matrix; None: all of them."""

    values: Array
    counts: Array | None = None
    missing: Array | None = None

    def __len__(self) -> int:
        return len(self.values)

    @property
    def there(self) -> Array:
        """Mask of the numbers that belong to a list."""
        assert self.counts is not None
        return np.arange(self.values.shape[1]) < self.counts.reshape(-1, 1)

    def tolist(self) -> list[Any]:
        """The list of each row."""
        rows = _with_none(self.values, self.missing)
        if self.counts is None:
            return rows
        return [row[:count] for row, count in zip(rows, self.counts.tolist(), strict=True)]

    def to_arrow(self, type: ColumnType) -> pa.Array:
        """The Arrow array."""
        import pyarrow as pa

        from protogen.convert.columns.arrow_tables import type_of

        assert isinstance(type, Listed)
        if type.count is not None:
            missing = None if self.missing is None else self.missing.reshape(-1)
            flat = _numbers(self.values.reshape(-1), missing)
            return pa.FixedSizeListArray.from_arrays(flat, type=type_of(type))
        if self.counts is None:
            size = self.values.shape[1]
            ends = np.arange(len(self.values) + 1, dtype="i4") * np.int32(size)
            return pa.ListArray.from_arrays(pa.array(ends), self._flat(None), type=type_of(type))
        ends = _ends(self.counts)
        return pa.ListArray.from_arrays(pa.array(ends), self._flat(self.there), type=type_of(type))

    def _flat(self, there: Array | None) -> pa.Array:
        chosen = self.values.reshape(-1) if there is None else self.values[there]
        if self.missing is None:
            return _numbers(chosen, None)
        return _numbers(chosen, self.missing.reshape(-1) if there is None else self.missing[there])


class Octets(msgspec.Struct, frozen=True):
    """Bytes in each row: the first `counts` of the row of a matrix; None: all of them."""

    values: Array
    counts: Array | None = None

    def __len__(self) -> int:
        return len(self.values)

    def tolist(self) -> list[bytes]:
        """The bytes of each row."""
        counts = [self.values.shape[1]] * len(self) if self.counts is None else self.counts.tolist()
        return [row[:count].tobytes() for row, count in zip(self.values, counts, strict=True)]

    def to_arrow(self, type: ColumnType) -> pa.Array:
        """The Arrow array."""
        import pyarrow as pa

        counts = self.counts
        if counts is None:
            counts = np.full(len(self), self.values.shape[1])
        flat = Lists(self.values, counts)
        data = np.ascontiguousarray(self.values[flat.there])
        buffers = [None, pa.py_buffer(_ends(counts)), pa.py_buffer(data)]
        return pa.Array.from_buffers(pa.binary(), len(self), buffers)


class Spans(msgspec.Struct, frozen=True):
    """Bytes in each row: from `starts` on, up to `ends`, of what all rows share."""

    data: bytes
    starts: Array
    ends: Array

    def __len__(self) -> int:
        return len(self.starts)

    def tolist(self) -> list[bytes]:
        """The bytes of each row."""
        places = zip(self.starts.tolist(), self.ends.tolist(), strict=True)
        return [self.data[start:end] for start, end in places]

    def to_arrow(self, type: ColumnType) -> pa.Array:
        """The Arrow array."""
        import pyarrow as pa

        return pa.array(self.tolist(), pa.binary())


def _with_none(values: Array, missing: Array | None) -> list[Any]:
    if missing is None or not missing.any():
        plain: list[Any] = values.tolist()
        return plain
    objects = values.astype(object)
    objects[missing] = None
    found: list[Any] = objects.tolist()
    return found


def _numbers(values: Array, missing: Array | None) -> pa.Array:
    import pyarrow as pa

    plain = pa.array(np.ascontiguousarray(values))
    if missing is None or not missing.any():
        return plain
    # Arrow makes bits of a mask many times as slowly.
    there = np.packbits(~missing, bitorder="little")
    return pa.Array.from_buffers(
        plain.type, len(plain), [pa.py_buffer(there), plain.buffers()[1]], int(missing.sum())
    )


def _ends(counts: Array) -> Array:
    ends = np.zeros(len(counts) + 1, "i4")
    np.cumsum(counts, out=ends[1:])
    return ends
