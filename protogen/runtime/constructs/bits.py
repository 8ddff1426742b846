"""Numbers whose bits follow each other without byte boundaries."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, BinaryIO

from construct import Construct  # type: ignore[import-untyped,unused-ignore]

from protogen.runtime.constructs.pieces import Around, PayloadError, Piece, bytes_left, read
from protogen.runtime.constructs.structs import Counted, Fill, as_list
from protogen.runtime.errors import ByteError
from protogen.runtime.payload.bits import BitOrder, BitReader, BitWriter
from protogen.runtime.payload.number import Number


class _BitStream:
    """Run of bits in the place of a stream of bytes. `base` is where its first byte lies."""

    def __init__(self, run: BitReader | BitWriter, base: int) -> None:
        self.run = run
        self._base = base

    def tell(self) -> int:
        """Place of the byte that has the next bit."""
        return self._base + self.run.position // 8


class Packed(Around):
    """The bits of what is inside, one behind another; the last byte is filled up with zeros.

    Inside are pieces of bits: `Bits` and `Bit`, also in a `Struct`, counted, constant or closed.
    """

    def __init__(self, order: BitOrder, subcon: Construct) -> None:
        super().__init__(subcon)
        self._order = order
        self._bits = int(subcon.sizeof())

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        base = stream.tell()
        run = BitReader(read(stream, self._sizeof(context, path), path), self._order)
        found = self.subcon._parsereport(_BitStream(run, base), context, path)
        try:
            run.finish()
        except ByteError as error:
            raise PayloadError(error.reason, path, base + run.position // 8, str(error)) from None
        return found

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        run = BitWriter(self._order)
        built = self.subcon._build(obj, _BitStream(run, stream.tell()), context, path)
        stream.write(run.finish())
        return built

    def _sizeof(self, context: Any, path: str) -> int:
        return -(-self._bits // 8)


class PackedFill(Fill):
    """Packed elements of `bits` bits, 8 or more, to the end: `least` to `greatest` of them.

    The last byte is filled up with zeros. A byte that has no bit of an element is an error.
    """

    def __init__(
        self,
        order: BitOrder,
        bits: int,
        element: Construct,
        greatest: int | None = None,
        least: int = 0,
    ) -> None:
        super().__init__(element, greatest, least)
        self._order = order
        self._bits = bits

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        size, offset = bytes_left(stream), stream.tell()
        count = 8 * size // self._bits
        self._check_number(count, path, offset)
        taken = -(-count * self._bits // 8)
        if taken != size:
            problem = f"{count} elements of {self._bits} bits take {taken} bytes, not {size}"
            raise PayloadError("size", path, offset + taken, problem)
        return self._packed(count)._parsereport(stream, context, path)

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        elements = as_list(obj, path, stream)
        self._check_number(len(elements), path, stream.tell())
        return self._packed(len(elements))._build(elements, stream, context, path)

    def _packed(self, count: int) -> Packed:
        return Packed(self._order, Counted(count, self.subcon))


class _Bits(Piece):
    """A value of so many bits among packed ones. Its size is in bits."""

    def __init__(self, bits: int, value: Callable[[int], Any], raw: Callable[[Any], int]) -> None:
        super().__init__()
        self._bits = bits
        self._value = value
        self._raw = raw

    def _parse(self, stream: _BitStream, context: Any, path: str) -> Any:
        assert isinstance(stream.run, BitReader)
        return self._value(stream.run.take(self._bits))

    def _build(self, obj: Any, stream: _BitStream, context: Any, path: str) -> Any:
        assert isinstance(stream.run, BitWriter)
        try:
            raw = self._raw(obj)
        except (ValueError, TypeError) as error:
            raise PayloadError("value", path, stream.tell(), str(error)) from None
        stream.run.put(self._bits, raw)
        return obj

    def _sizeof(self, context: Any, path: str) -> int:
        return self._bits


def Bits(bits: int, signed: bool = False) -> Piece:  # noqa: N802
    """An integer of 1 to 64 bits among packed ones."""
    number = Number(bits, signed)
    return _Bits(bits, number.value_of, number.raw_of)


def _raw_flag(value: bool) -> int:
    if value not in (0, 1):
        raise ValueError(f"{value!r} is neither true nor false")
    return int(value)


Bit = _Bits(1, bool, _raw_flag)
"""A boolean among packed values."""
