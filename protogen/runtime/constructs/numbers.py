"""Numbers, and values out of a set."""

from __future__ import annotations

import struct
from collections.abc import Iterable
from typing import Any, BinaryIO, Literal, Protocol

import construct  # type: ignore[import-untyped,unused-ignore]
from construct import Construct

from protogen.runtime.constructs.pieces import Around, PayloadError, Piece, read
from protogen.runtime.errors import ByteError
from protogen.runtime.payload.number import ByteOrder, Number
from protogen.runtime.payload.numerals import FreeNumeral, Numeral


class _Codec(Protocol):
    """A value of a fixed number of bytes."""

    @property
    def size(self) -> int: ...

    def encode(self, value: Any, /) -> bytes: ...

    def decode(self, data: bytes, /) -> Any: ...


class _Scalar(Piece):
    """One value of a fixed number of bytes."""

    def __init__(self, codec: _Codec) -> None:
        super().__init__()
        self._codec = codec
        self._size = codec.size

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        data = read(stream, self._size, path)
        try:
            return self._codec.decode(data)
        except ByteError as error:
            offset = stream.tell() - self._size
            raise PayloadError(error.reason, path, offset, str(error)) from None

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        try:
            data = self._codec.encode(obj)
        except (ValueError, TypeError) as error:
            raise PayloadError("value", path, stream.tell(), str(error)) from None
        stream.write(data)
        return obj

    def _sizeof(self, context: Any, path: str) -> int:
        return self._size


def Int(bits: int, signed: bool = False, order: ByteOrder = "little") -> Piece:  # noqa: N802
    """An integer of 1 to 64 bits in as many whole bytes as it needs; padding bits are zero."""
    return _Scalar(Number(bits, signed, order))


def SevenBit(bits: int, signed: bool = False, order: ByteOrder = "little") -> Piece:  # noqa: N802
    """An integer of 1 to 64 bits, 7 bits a byte; the top bit of each byte and padding are zero."""
    return _Scalar(Number(bits, signed, order, seven_bit=True))


def Digits(bits: int, alphabet: bytes, size: int, signed: bool = False) -> Piece:  # noqa: N802
    """An integer of 1 to 64 bits as text: `size` digits out of `alphabet`, the highest one first.

    >>> Digits(16, b"0123456789ABCDEF", 4).build(0xC0DE)
    b'C0DE'
    """
    return _Scalar(Numeral(bits, alphabet, size, signed))


class Written(Piece):
    """An integer as text, as `numeral` reads and writes it; it knows where the text ends."""

    def __init__(self, numeral: FreeNumeral) -> None:
        super().__init__()
        self._numeral = numeral

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> int:
        offset, data = stream.tell(), stream.read()
        try:
            value, size = self._numeral.take(data)
        except ByteError as error:
            raise PayloadError(error.reason, path, offset, str(error)) from None
        stream.seek(offset + size)
        return value

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        try:
            data = self._numeral.encode(obj)
        except (ValueError, TypeError) as error:
            raise PayloadError("value", path, stream.tell(), str(error)) from None
        stream.write(data)
        return obj

    def _sizeof(self, context: Any, path: str) -> int:
        raise construct.SizeofError("the size depends on the number", path=path)


class _FloatCodec:
    """The bits of a float as those of an unsigned integer."""

    def __init__(self, bits: Literal[32, 64], order: ByteOrder, seven_bit: bool = False) -> None:
        self._integer = Number(bits, order=order, seven_bit=seven_bit)
        self._layout = "<f" if bits == 32 else "<d"
        self._bits = bits

    @property
    def size(self) -> int:
        return self._integer.size

    def encode(self, value: float, /) -> bytes:
        try:
            plain = struct.pack(self._layout, value)
        except (struct.error, OverflowError):
            raise ValueError(f"{value!r} is no number that {self._bits} bits hold") from None
        return self._integer.encode(int.from_bytes(plain, "little"))

    def decode(self, data: bytes, /) -> Any:
        plain = self._integer.decode(data).to_bytes(self._bits // 8, "little")
        return struct.unpack(self._layout, plain)[0]


def Float(bits: Literal[32, 64], order: ByteOrder = "little") -> Piece:  # noqa: N802
    """An IEEE 754 number of 4 or 8 bytes."""
    return _Scalar(_FloatCodec(bits, order))


def SevenBitFloat(bits: Literal[32, 64], order: ByteOrder = "little") -> Piece:  # noqa: N802
    """An IEEE 754 number, 7 bits a byte: 5 or 10 bytes."""
    return _Scalar(_FloatCodec(bits, order, seven_bit=True))


class _Boolean:
    size = 1

    def encode(self, value: bool, /) -> bytes:
        if value not in (0, 1):
            raise ValueError(f"{value!r} is neither true nor false")
        return b"\1" if value else b"\0"

    def decode(self, data: bytes, /) -> bool:
        if data[0] > 1:
            raise ByteError("value", f"{data[0]:02X} is neither 00 (false) nor 01 (true)")
        return data == b"\1"


Flag01 = _Scalar(_Boolean())
"""A boolean of one byte, 0 or 1."""


# --- values that are checked --------------------------------------------------------------------


class _Checked(Around):
    """Values that are looked at, either way."""

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        offset = stream.tell()
        found = self.subcon._parsereport(stream, context, path)
        self._check(found, path, offset)
        return found

    def _check(self, found: Any, path: str, offset: int) -> None:
        raise NotImplementedError


class Fixed(_Checked):
    """A constant. Building needs no value; another one is an error, either way."""

    def __init__(self, subcon: Construct, value: Any) -> None:
        super().__init__(subcon)
        self._value = value
        self.flagbuildnone = True

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        if obj is not None:
            self._check(obj, path, stream.tell())
        return self.subcon._build(self._value, stream, context, path)

    def _check(self, found: Any, path: str, offset: int) -> None:
        if found != self._value:
            raise PayloadError("value", path, offset, f"must be {self._value!r}, not {found!r}")


class Closed(_Checked):
    """A value out of a closed set."""

    def __init__(self, subcon: Construct, values: Iterable[int]) -> None:
        super().__init__(subcon)
        self._values = frozenset(values)

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        self._check(obj, path, stream.tell())
        return self.subcon._build(obj, stream, context, path)

    def _check(self, found: Any, path: str, offset: int) -> None:
        try:
            is_known = found in self._values
        except TypeError:  # It has no hash, as a list.
            is_known = False
        if not is_known:
            allowed = ", ".join(map(str, sorted(self._values)))
            raise PayloadError("value", path, offset, f"{found!r} is not one of {allowed}")
