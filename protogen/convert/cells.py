"""Texts of whole columns at once: matrices of bytes, a row for each value, filled up with NUL.

No text of JSON holds a NUL byte, so the filling goes in one sweep when the lines are put together.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np

from protogen.convert.arrays import Array, Lists, Octets

_BLOCK = 1 << 18
"""Bytes of a block of lines."""
_GROUP = 10_000
"""Long numbers are written four digits at a time."""


def integers(values: Array) -> Array:
    """Decimal digits."""
    if values.dtype == np.bool_:
        return _as_bytes(np.array([b"false", b"true"])[values.view("u1")])
    if values.dtype.itemsize <= 2:
        return _as_bytes(_small(values.dtype.str)[values.astype("i4", copy=False)])
    if values.dtype.kind == "i" and len(values) and int(values.min()) < 0:
        sign = np.where(values < 0, ord("-"), 0).astype("u1").reshape(-1, 1)
        # The least number has no positive counterpart of its type, but an unsigned one.
        absolute = np.where(values < 0, -values.astype("u8"), values.astype("u8"))
        return np.concatenate([sign, _natural(absolute)], axis=1)
    return _natural(values)


@cache
def _small(dtype: str) -> Array:
    """The digits of every number of a type of at most 16 bits; negative ones count from the end."""
    limits = np.iinfo(dtype)
    numbers = [*range(int(limits.max) + 1), *range(int(limits.min), 0)]
    return np.array([str(number).encode() for number in numbers])


@cache
def _groups() -> tuple[Array, Array]:
    """Four digits of each number below 10,000, and its digits without zeros in front."""
    padded = np.array([f"{number:04}".encode() for number in range(_GROUP)])
    plain = np.array([b"", *(str(number).encode() for number in range(1, _GROUP))], "S4")
    return padded, plain


def _natural(values: Array) -> Array:
    padded, plain = _groups()
    groups = []
    rest = values
    most = int(values.max()) if len(values) else 0
    while most >= _GROUP:
        if rest.dtype.itemsize > 4 and most < 1 << 32:
            rest = rest.astype("u4")  # divides several times as fast
        higher = rest // rest.dtype.type(_GROUP)
        low = (rest - higher * rest.dtype.type(_GROUP)).astype("i4")
        digits = padded[low]
        first = higher == 0
        if first.any():
            digits[first] = plain[low[first]]
        groups.append(_as_bytes(digits))
        rest, most = higher, most // _GROUP
    groups.append(_as_bytes(plain[rest.astype("i4")]))
    found = np.concatenate(groups[::-1], axis=1)
    zeros = values == 0
    if zeros.any():
        found[zeros, -1] = ord("0")
    return found


def floats(values: Array) -> Array:
    """Floats as Python writes them; what JSON has no number for is a text."""
    texts = [repr(value) if value - value == 0 else f'"{value}"' for value in values.tolist()]
    return _as_bytes(np.array(texts or [""], "S")[: len(values)])


def numbers(values: Array) -> Array:
    """Integers, bools or floats."""
    return floats(values) if values.dtype.kind == "f" else integers(values)


def lists(column: Lists) -> Array:
    """The elements of lists with commas between them."""
    rows, most = column.values.shape
    cells = numbers(np.ascontiguousarray(column.values).reshape(-1))
    width = cells.shape[1]
    found = np.zeros((rows, most, width + 2), "u1")
    found[:, :, :width] = cells.reshape(rows, most, width)
    found[:, :, width] = ord(",")
    found[:, :, width + 1] = ord(" ")
    if column.counts is None:
        found[:, -1:, width:] = 0  # There may be no last one.
    else:
        places = np.arange(most)
        found[places >= column.counts.reshape(-1, 1)] = 0
        found[:, :, width:][places == column.counts.reshape(-1, 1) - 1] = 0
    return found.reshape(rows, -1)


def hexadecimal(column: Octets) -> Array:
    """Two digits a byte."""
    rows, most = column.values.shape
    found = _as_bytes(_hex_digits()[column.values.reshape(-1)]).reshape(rows, most, 2)
    if column.counts is not None:
        found[np.arange(most) >= column.counts.reshape(-1, 1)] = 0
    return found.reshape(rows, -1)


@cache
def _hex_digits() -> Array:
    return np.array([f"{number:02x}".encode() for number in range(256)])


def texts(values: list[str]) -> Array:
    """Texts in quotes."""
    quoted = [json.dumps(value, ensure_ascii=False).encode() for value in values]
    return _as_bytes(np.array(quoted or [b""])[: len(values)])


def _as_bytes(found: Array) -> Array:
    size = found.dtype.itemsize
    return np.ascontiguousarray(found).view("u1").reshape(len(found), size)


def put_together(template: list[bytes | Array], rows: int) -> Iterator[bytes]:
    """Lines of fixed texts and cells by turns, many in each text."""
    blank = b"".join(it if isinstance(it, bytes) else bytes(it.shape[1]) for it in template)
    # One block that the processor's cache holds is filled again and again.
    most = max(1, min(rows, _BLOCK // len(blank)))
    buffer = bytearray(blank * most)
    matrix: Any = np.frombuffer(buffer, "u1").reshape(most, len(blank))
    for first in range(0, rows, most):
        count = min(most, rows - first)
        place = 0
        for it in template:
            if isinstance(it, bytes):
                place += len(it)
                continue
            matrix[:count, place : place + it.shape[1]] = it[first : first + count]
            place += it.shape[1]
        whole = buffer if count == most else buffer[: count * len(blank)]
        # That of a bytearray is several times as fast as that of bytes.
        yield bytes(whole.translate(None, b"\0"))
