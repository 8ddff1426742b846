"""Encodings of numbers in Parquet files: which columns are differences, and which compressed.

Parquet has no numbers of fewer than 32 bits. As differences (`DELTA_BINARY_PACKED`, which every
reader of the format knows) those of sensors and counters take a fraction of that, and less time
than compressing them does. Numbers at random are neither close to each other nor compressed.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

if TYPE_CHECKING:
    import pyarrow as pa

COMPRESSION = "snappy"
_DIFFERENCES = "DELTA_BINARY_PACKED"
_BLOCK = 32
"""Differences that are packed with the same number of bits."""
_SAMPLE = 512 * _BLOCK
"""Numbers that are looked at: the first ones. Others may take more time or space, nothing else."""
_CLOSE = 3 / 8
"""Differences are written where they take at most this part of what the numbers take."""
_LITTLE = 9 / 10
"""Numbers are compressed where at most this part of them is left."""


class Spelling(msgspec.Struct):
    """Encodings of columns, by their paths."""

    encodings: dict[str, str] = msgspec.field(default_factory=dict)
    """Encodings of those that are not written as they are."""
    compression: dict[str, str] = msgspec.field(default_factory=dict)
    """Compressions of all."""


def spelling_of(rows: pa.Table) -> Spelling:
    """Choose encodings that suit a file whose first rows are these."""
    found = Spelling()
    for name, column in zip(rows.schema.names, rows.columns, strict=True):
        for path, values in _leaves(name, column.chunk(0)):
            found.compression[path] = COMPRESSION
            numbers = _numbers(values)
            if numbers is None:
                continue
            if numbers.dtype.kind in "iu" and _are_close(numbers):
                found.encodings[path] = _DIFFERENCES
            elif not _shrinks(numbers):
                found.compression[path] = "none"
    return found


def _leaves(path: str, values: pa.Array) -> Iterator[tuple[str, pa.Array]]:
    """Parts of a column, each with its path as Parquet has it."""
    import pyarrow as pa

    if pa.types.is_struct(values.type):
        for member, inner in zip(values.type, values.flatten(), strict=True):
            yield from _leaves(f"{path}.{member.name}", inner)
    elif pa.types.is_list(values.type) or pa.types.is_fixed_size_list(values.type):
        yield from _leaves(f"{path}.list.element", values.flatten())
    else:
        yield path, values


def _numbers(values: pa.Array) -> Any:
    """The first integers or floats as Parquet stores them; None where there are few."""
    import pyarrow as pa

    if not (pa.types.is_integer(values.type) or pa.types.is_floating(values.type)):
        return None
    found = values.slice(0, _SAMPLE).drop_null().to_numpy(zero_copy_only=False)
    if len(found) < _BLOCK:
        return None
    return found.astype("i4") if found.dtype.itemsize < 4 else found


def _are_close(numbers: Any) -> bool:
    """True if numbers are near those in front. Where all are the same, they shrink to nothing."""
    steps = np.diff(numbers.astype("i8"))
    blocks = steps[: len(steps) // _BLOCK * _BLOCK].reshape(-1, _BLOCK)
    if not blocks.any():
        return False
    # As numbers without a sign: wide ones may be further apart than the signed ones reach.
    spread = (blocks.max(axis=1) - blocks.min(axis=1)).view("u8").astype("f8")
    return bool(np.log2(spread + 1).mean() <= _CLOSE * 8 * numbers.itemsize)


def _shrinks(numbers: Any) -> bool:
    import pyarrow as pa

    data = numbers.tobytes()
    return len(pa.compress(data, codec=COMPRESSION, asbytes=True)) <= _LITTLE * len(data)
