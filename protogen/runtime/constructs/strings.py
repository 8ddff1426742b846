"""Bytes and text."""

from __future__ import annotations

from typing import Any, BinaryIO

from protogen.runtime.constructs.pieces import (
    Around,
    Extent,
    PayloadError,
    Piece,
    extent_of,
    fixed_extent,
    read,
)
from protogen.runtime.errors import ByteError
from protogen.runtime.payload.texts import PaddedText


def _check_seven_bits(data: bytes, path: str, offset: int) -> None:
    if not data.isascii():
        index = next(index for index, byte in enumerate(data) if byte > 0x7F)
        problem = f"{data[index]:02X} has its most significant bit set"
        raise PayloadError("encoding", path, offset + index, problem)


class Octets(Piece):
    """Bytes that nobody interprets: a number of them, or as many as an earlier field says."""

    def __init__(self, size: Extent, seven_bit: bool = False) -> None:
        super().__init__()
        self._extent = size
        self._seven_bit = seven_bit

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> bytes:
        data = read(stream, extent_of(self._extent, context, path), path)
        if self._seven_bit:
            _check_seven_bits(data, path, stream.tell() - len(data))
        return data

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> bytes:
        size = extent_of(self._extent, context, path)
        data = _as_bytes(obj, path, stream)
        if len(data) != size:
            problem = f"needs exactly {size} bytes, not {len(data)}"
            raise PayloadError("size", path, stream.tell(), problem)
        if self._seven_bit:
            _check_seven_bits(data, path, stream.tell())
        stream.write(data)
        return data

    def _sizeof(self, context: Any, path: str) -> int:
        return fixed_extent(self._extent, path)


class OctetsFill(Piece):
    """All bytes that are left, `least` to `greatest` of them."""

    def __init__(
        self, greatest: int | None = None, seven_bit: bool = False, least: int = 0
    ) -> None:
        super().__init__()
        self._least = least
        self._greatest = greatest
        self._seven_bit = seven_bit

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> bytes:
        offset = stream.tell()
        data = stream.read()
        self._check(data, path, offset)
        return data

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> bytes:
        data = _as_bytes(obj, path, stream)
        self._check(data, path, stream.tell())
        stream.write(data)
        return data

    def _check(self, data: bytes, path: str, offset: int) -> None:
        if self._greatest is not None and len(data) > self._greatest:
            problem = f"has {len(data)} bytes, at most {self._greatest} are allowed"
            raise PayloadError("size", path, offset + self._greatest, problem)
        if len(data) < self._least:
            problem = f"has {len(data)} bytes, at least {self._least} are needed"
            raise PayloadError("size", path, offset + len(data), problem)
        if self._seven_bit:
            _check_seven_bits(data, path, offset)


class OctetsUntil(Piece):
    """Bytes in front of a terminator, `least` to `greatest` of them; it stands behind them."""

    def __init__(self, byte: int, greatest: int, seven_bit: bool = False, least: int = 0) -> None:
        super().__init__()
        self._end = bytes((byte,))
        self._least = least
        self._greatest = greatest
        self._seven_bit = seven_bit

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> bytes:
        offset = stream.tell()
        # More bytes are looked at than there may be, so that too many are told from a bad end.
        found = stream.read(self._greatest + 1)
        size = found.find(self._end)
        if len(found) <= self._least or (size < 0 and len(found) <= self._greatest):
            missing = max(1, self._least + 1 - len(found))
            problem = f"ends with {self._end.hex().upper()}, which is missing"
            raise PayloadError("size", path, offset, problem, missing)
        data = found if size < 0 else found[:size]
        stream.seek(offset + len(data) + 1)
        self._check(data, path, offset)
        return data

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> bytes:
        data = _as_bytes(obj, path, stream)
        self._check(data, path, stream.tell())
        if self._end in data:
            problem = f"has a byte {self._end.hex().upper()}, which would end it"
            raise PayloadError("value", path, stream.tell() + data.index(self._end), problem)
        stream.write(data + self._end)
        return data

    def _check(self, data: bytes, path: str, offset: int) -> None:
        if len(data) > self._greatest:
            problem = f"has more than {self._greatest} bytes in front of {self._end.hex().upper()}"
            raise PayloadError("size", path, offset + self._greatest, problem)
        if len(data) < self._least:
            problem = f"has {len(data)} bytes, at least {self._least} are needed"
            raise PayloadError("size", path, offset + len(data), problem)
        if self._seven_bit:
            _check_seven_bits(data, path, offset)


class _OctetsBetween(Piece):
    """Bytes in front of a separator or the end, `least` to `greatest`, all among `characters`."""

    def __init__(
        self, separator: int, greatest: int, characters: bytes, leads: bool, least: int
    ) -> None:
        super().__init__()
        self._separator = bytes((separator,))
        self._front = self._separator if leads else b""
        self._characters = characters
        self._takes_rest = separator in characters
        self._least = least
        self._greatest = greatest

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> bytes:
        start = stream.tell()
        front = stream.read(len(self._front))
        if front != self._front:
            problem = "the separator in front is missing"
            raise PayloadError("value" if front else "size", path, start, problem)
        offset = stream.tell()
        data = stream.read()
        if not self._takes_rest:
            data = data.partition(self._separator)[0]
            stream.seek(offset + len(data))
        self._check(data, path, offset)
        return data

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> bytes:
        data = _as_bytes(obj, path, stream)
        self._check(data, path, stream.tell())
        stream.write(self._front + data)
        return data

    def _check(self, data: bytes, path: str, offset: int) -> None:
        if not self._least <= len(data) <= self._greatest:
            problem = f"needs {self._least} to {self._greatest} characters, not {len(data)}"
            raise PayloadError("size", path, offset, problem)
        wrong = data.translate(None, self._characters)
        if wrong:
            place = offset + data.index(wrong[:1])
            raise PayloadError("value", path, place, f"{wrong[0]:02X} is no character of it")


def _as_bytes(obj: Any, path: str, stream: BinaryIO) -> bytes:
    if isinstance(obj, bytes | bytearray | memoryview):
        return bytes(obj)
    raise PayloadError("value", path, stream.tell(), f"must be bytes, not {obj!r}")


class _Text(Around):
    """Text, one byte a character (Latin-1, of which ASCII is a part)."""

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> str:
        data: bytes = self.subcon._parsereport(stream, context, path)
        return data.decode("latin-1")

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> str:
        self.subcon._build(_latin1(obj, path, stream), stream, context, path)
        return str(obj)


class _Padded(Around):
    """Text in a fixed number of bytes, with padding at the end."""

    def __init__(self, text: PaddedText, seven_bit: bool) -> None:
        super().__init__(Octets(text.size, seven_bit))
        self._text = text

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> str:
        data: bytes = self.subcon._parsereport(stream, context, path)
        try:
            return self._text.decode(data)
        except ByteError as error:
            place = stream.tell() - len(data) + (self._text.first_foreign(data) or 0)
            raise PayloadError(error.reason, path, place, str(error)) from None

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> str:
        text = _latin1(obj, path, stream).decode("latin-1")
        if len(text) > self._text.size:
            problem = f"has {len(text)} characters, at most {self._text.size} are allowed"
            raise PayloadError("size", path, stream.tell(), problem)
        problem = self._text.fault_of(text)
        if problem:
            raise PayloadError("value", path, stream.tell(), problem)
        self.subcon._build(self._text.encode(text), stream, context, path)
        return str(obj)


def _latin1(obj: Any, path: str, stream: BinaryIO) -> bytes:
    try:
        return bytes(obj.encode("latin-1"))
    except (AttributeError, UnicodeEncodeError):
        problem = f"must be text of characters up to U+00FF, not {obj!r}"
        raise PayloadError("value", path, stream.tell(), problem) from None


def Latin1(size: Extent, seven_bit: bool = False) -> Piece:  # noqa: N802
    """Text of one byte a character.

    Of a fixed size it is padded with NUL at the end, so the text itself does not end with NUL. Of
    a size that an earlier field gives it has exactly that many characters.
    """
    if isinstance(size, int):
        return _Padded(PaddedText(size), seven_bit)
    return _Text(Octets(size, seven_bit))


def Padded(  # noqa: N802
    size: int,
    padding: int = 0,
    bits: int = 8,
    shift: int = 0,
    add: int = 0,
    seven_bit: bool = False,
) -> Piece:
    """Text in a fixed number of bytes, with another padding than NUL, or in a code."""
    return _Padded(PaddedText(size, padding, bits, shift, add), seven_bit)


def Latin1Fill(  # noqa: N802
    greatest: int | None = None, seven_bit: bool = False, least: int = 0
) -> Piece:
    """Text that takes all bytes that are left, `least` to `greatest` of them."""
    return _Text(OctetsFill(greatest, seven_bit, least))


def Latin1Until(  # noqa: N802
    byte: int, greatest: int, seven_bit: bool = False, least: int = 0
) -> Piece:
    """Text in front of a terminator, `least` to `greatest` characters; it stands behind them."""
    return _Text(OctetsUntil(byte, greatest, seven_bit, least))


def TextBetween(  # noqa: N802
    separator: int, greatest: int, characters: bytes, leads: bool = False, least: int = 0
) -> Piece:
    """Text in front of a separator or of the end, `least` to `greatest` of these characters.

    Where the separator is one of them, the text goes to the end. With `leads` a separator stands in
    front of it.
    """
    return _Text(_OctetsBetween(separator, greatest, characters, leads, least))
