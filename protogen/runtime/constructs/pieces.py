"""Base of the pieces, their error, and numbers that earlier fields give."""

from __future__ import annotations

import copyreg
import io
from typing import Any, BinaryIO, NamedTuple

import construct  # type: ignore[import-untyped,unused-ignore]
from construct import Construct

from protogen.runtime.errors import PayloadFault, Reason
from protogen.runtime.payload.formula import Formula, number_of


class Count(NamedTuple):
    """What earlier fields say: a number of bytes or elements, from `least` to `greatest`."""

    by: str | Formula
    least: int
    greatest: int


Extent = int | str | Count
"""A number of bytes or elements, or the earlier field that gives it."""


class PayloadError(construct.ConstructError, PayloadFault):  # type: ignore[misc]
    """Bytes are not this payload, or a value is not what the payload can hold.

    `reason` is `size` (bytes are missing or left over), `value` (constant, padding, closed enum,
    boolean, no case) or `encoding` (a byte has its most significant bit set); for a whole frame it
    may be any other. `path` names the field and `offset` is where it starts, counted from the start
    of the stream. `missing` is how many more bytes the field needs at least, where the bytes ended
    too early.
    """

    def __init__(
        self, reason: Reason, path: str, offset: int, problem: str, missing: int = 0
    ) -> None:
        self.reason: Reason = reason
        self.problem = problem
        self.offset = offset
        self.missing = missing
        place = _dotted(path)
        super().__init__(f"byte {offset}{place and ', '}{place}: {problem} ({reason})")
        self.path: str = place

    def __reduce__(self) -> Any:
        """As it is: Python would make it anew of its text alone."""
        return copyreg.__newobj__, (type(self), *self.args), vars(self)  # type: ignore[attr-defined]


def _dotted(path: str) -> str:
    """Write construct's `(parsing) -> points -> [2] -> x` as `points[2].x`."""
    return ".".join(path.split(" -> ")[1:]).replace(".[", "[")


class Piece(Construct):  # type: ignore[misc]
    """Base of the pieces that this module adds to construct."""

    def __rtruediv__(self, name: str) -> Any:
        """`"speed" / Int(16)` is a field called `speed`."""
        return super().__rtruediv__(name)


class Around(Piece, construct.Subconstruct):  # type: ignore[misc]
    """Base of the pieces that change how another one behaves."""

    def __init__(self, subcon: Construct) -> None:
        construct.Subconstruct.__init__(self, subcon)


def read(stream: BinaryIO, size: int, path: str) -> bytes:
    """The next bytes, as many as `size` says. Raises PayloadError."""
    offset = stream.tell()
    data = stream.read(size)
    if len(data) < size:
        problem = f"needs {size} bytes, but only {len(data)} are left"
        raise PayloadError("size", path, offset, problem, size - len(data))
    return data


def bytes_left(stream: BinaryIO) -> int:
    """Number of bytes to the end of the stream."""
    here = stream.tell()
    left = stream.seek(0, io.SEEK_END) - here
    stream.seek(here)
    return left


def look_up(context: Any, name: str, path: str) -> Any:
    """The value of an earlier field, of this struct or of one around it."""
    while context is not None:
        if name in context:
            return context[name]
        context = context.get("_")
    raise PayloadError("value", path, 0, f"there is no field {name} in front of it")


def extent_of(extent: Extent, context: Any, path: str) -> int:
    """The number of bytes or elements here. Raises PayloadError where it is out of bounds."""
    if isinstance(extent, int):
        return extent
    if isinstance(extent, str):
        return int(look_up(context, extent, path))
    number = said(extent.by, context, path)
    if not extent.least <= number <= extent.greatest:
        problem = f"{extent.by} counts {extent.least} to {extent.greatest}, not {number}"
        raise PayloadError("size", path, 0, problem)
    return number


def said(what: str | Formula, context: Any, path: str) -> int:
    """The number that an earlier field has, or that is worked out of some."""
    return number_of(what, lambda name: look_up(context, name, path))


def fixed_extent(extent: Extent, path: str) -> int:
    """The number, if it is always the same. Raises construct's SizeofError."""
    if isinstance(extent, int):
        return extent
    what = extent.by if isinstance(extent, Count) else extent
    raise construct.SizeofError(f"the size depends on {what}", path=path)
