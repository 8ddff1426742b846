"""The pieces of construct that a generated `FORMAT` is made of, strict and lossless.

This is the only module that knows construct. Each piece here is a construct object like any other:
it parses, builds, tells its size where that is fixed, and can be embedded in a larger declaration.

    >>> point = Struct("x" / Int(16, signed=True), "y" / Int(16, signed=True))
    >>> point.build({"x": -2, "y": 3}).hex()
    'feff0300'
    >>> point.sizeof()
    4

What parses builds the same bytes again. What does not parse raises `PayloadError`, which says where
and why. construct's own pieces are wrapped where they lose bytes or say too little: they ignore
bytes behind the last field, keys that no field has, and a bad tail of a greedy range.
"""

from __future__ import annotations

import copyreg
import io
from collections.abc import Iterable, Mapping
from typing import Any, BinaryIO, Literal, NamedTuple, Protocol

import construct  # type: ignore[import-untyped,unused-ignore]
from construct import Construct, Container, Pass, Renamed

from protogen.runtime.errors import ByteError, PayloadFault, Reason
from protogen.runtime.number import ByteOrder, Number

__all__ = [
    "Cases",
    "Closed",
    "Construct",
    "Container",
    "Count",
    "Counted",
    "Fill",
    "Fixed",
    "Flag01",
    "Float",
    "Int",
    "Latin1",
    "Latin1Fill",
    "Octets",
    "OctetsFill",
    "Pass",
    "PayloadError",
    "Piece",
    "Renamed",
    "SevenBit",
    "SevenBitFloat",
    "Struct",
    "Whole",
    "prefix_size",
    "whole",
]


class Count(NamedTuple):
    """The earlier field that gives a number of bytes or elements, from `least` to `greatest`."""

    field: str
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


class _Around(Piece, construct.Subconstruct):  # type: ignore[misc]
    """Base of the pieces that change how another one behaves."""

    def __init__(self, subcon: Construct) -> None:
        construct.Subconstruct.__init__(self, subcon)


def _read(stream: BinaryIO, size: int, path: str) -> bytes:
    offset = stream.tell()
    data = stream.read(size)
    if len(data) < size:
        raise _short(path, offset, size, len(data))
    return data


def _short(path: str, offset: int, size: int, left: int) -> PayloadError:
    problem = f"needs {size} bytes, but only {left} are left"
    return PayloadError("size", path, offset, problem, size - left)


def _bytes_left(stream: BinaryIO) -> int:
    here = stream.tell()
    left = stream.seek(0, io.SEEK_END) - here
    stream.seek(here)
    return left


def _look_up(context: Any, name: str, path: str) -> Any:
    """The value of an earlier field, of this struct or of one around it."""
    while context is not None:
        if name in context:
            return context[name]
        context = context.get("_")
    raise PayloadError("value", path, 0, f"there is no field {name} in front of it")


# --- numbers ----------------------------------------------------------------------------------


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
        data = _read(stream, self._size, path)
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


class _Native(_Around):
    """construct's own FormatField, with errors that say where."""

    def __init__(self, code: str, order: ByteOrder) -> None:
        super().__init__(construct.FormatField("<" if order == "little" else ">", code))

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        offset = stream.tell()
        try:
            return self.subcon._parse(stream, context, path)
        except construct.StreamError:
            left = stream.tell() - offset
            raise _short(path, offset, self.subcon.sizeof(), left) from None

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        try:
            return self.subcon._build(obj, stream, context, path)
        except (construct.ConstructError, OverflowError) as error:
            problem = str(error).splitlines()[-1]
            raise PayloadError("value", path, stream.tell(), problem) from None


_NATIVE_INTEGERS = {8: "B", 16: "H", 32: "L", 64: "Q"}
_FLOATS = {32: "f", 64: "d"}


def Int(bits: int, signed: bool = False, order: ByteOrder = "little") -> Piece:  # noqa: N802
    """An integer of 1 to 64 bits in as many whole bytes as it needs; padding bits are zero."""
    code = _NATIVE_INTEGERS.get(bits)
    if code is None:
        return _Scalar(Number(bits, signed, order))
    return _Native(code.lower() if signed else code, order)


def SevenBit(bits: int, signed: bool = False, order: ByteOrder = "little") -> Piece:  # noqa: N802
    """An integer of 1 to 64 bits, 7 bits a byte; the top bit of each byte and padding are zero."""
    return _Scalar(Number(bits, signed, order, seven_bit=True))


def Float(bits: Literal[32, 64], order: ByteOrder = "little") -> Piece:  # noqa: N802
    """An IEEE 754 number of 4 or 8 bytes."""
    return _Native(_FLOATS[bits], order)


class _SevenBitFloat:
    """The bits of a float as those of an unsigned integer, 7 bits a byte."""

    def __init__(self, bits: int, order: ByteOrder) -> None:
        self._integer = Number(bits, order=order, seven_bit=True)
        self._float = construct.FormatField("<", _FLOATS[bits])

    @property
    def size(self) -> int:
        return self._integer.size

    def encode(self, value: float, /) -> bytes:
        try:
            plain = self._float.build(value)
        except (construct.ConstructError, OverflowError):
            raise ValueError(f"{value!r} does not fit") from None
        return self._integer.encode(int.from_bytes(plain, "little"))

    def decode(self, data: bytes, /) -> Any:
        plain = self._integer.decode(data).to_bytes(self._float.sizeof(), "little")
        return self._float.parse(plain)


def SevenBitFloat(bits: Literal[32, 64], order: ByteOrder = "little") -> Piece:  # noqa: N802
    """An IEEE 754 number, 7 bits a byte: 5 or 10 bytes."""
    return _Scalar(_SevenBitFloat(bits, order))


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


class Fixed(_Around):
    """A constant. Building needs no value; another one is an error, either way."""

    def __init__(self, subcon: Construct, value: Any) -> None:
        super().__init__(subcon)
        self._value = value
        self.flagbuildnone = True

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        offset = stream.tell()
        found = self.subcon._parsereport(stream, context, path)
        self._check(found, path, offset)
        return found

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        if obj is not None:
            self._check(obj, path, stream.tell())
        return self.subcon._build(self._value, stream, context, path)

    def _check(self, found: Any, path: str, offset: int) -> None:
        if found != self._value:
            raise PayloadError("value", path, offset, f"must be {self._value!r}, not {found!r}")


class Closed(_Around):
    """A value out of a closed set."""

    def __init__(self, subcon: Construct, values: Iterable[int]) -> None:
        super().__init__(subcon)
        self._values = frozenset(values)

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        offset = stream.tell()
        found = self.subcon._parsereport(stream, context, path)
        self._check(found, path, offset)
        return found

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


# --- bytes and text -----------------------------------------------------------------------------


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
        data = _read(stream, _extent(self._extent, context, path), path)
        if self._seven_bit:
            _check_seven_bits(data, path, stream.tell() - len(data))
        return data

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> bytes:
        size = _extent(self._extent, context, path)
        data = _as_bytes(obj, path, stream)
        if len(data) != size:
            problem = f"needs exactly {size} bytes, not {len(data)}"
            raise PayloadError("size", path, stream.tell(), problem)
        if self._seven_bit:
            _check_seven_bits(data, path, stream.tell())
        stream.write(data)
        return data

    def _sizeof(self, context: Any, path: str) -> int:
        return _fixed_extent(self._extent, path)


class OctetsFill(Piece):
    """All bytes that are left, at most `greatest` of them."""

    def __init__(self, greatest: int | None = None, seven_bit: bool = False) -> None:
        super().__init__()
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
        if self._seven_bit:
            _check_seven_bits(data, path, offset)


def _as_bytes(obj: Any, path: str, stream: BinaryIO) -> bytes:
    if isinstance(obj, bytes | bytearray | memoryview):
        return bytes(obj)
    raise PayloadError("value", path, stream.tell(), f"must be bytes, not {obj!r}")


def _extent(extent: Extent, context: Any, path: str) -> int:
    if isinstance(extent, int):
        return extent
    if isinstance(extent, str):
        return int(_look_up(context, extent, path))
    number = int(_look_up(context, extent.field, path))
    if not extent.least <= number <= extent.greatest:
        problem = f"{extent.field} counts {extent.least} to {extent.greatest}, not {number}"
        raise PayloadError("size", path, 0, problem)
    return number


def _fixed_extent(extent: Extent, path: str) -> int:
    if isinstance(extent, int):
        return extent
    name = extent if isinstance(extent, str) else extent.field
    raise construct.SizeofError(f"the size depends on {name}", path=path)


class _Text(_Around):
    """Text, one byte a character (Latin-1, of which ASCII is a part)."""

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> str:
        data: bytes = self.subcon._parsereport(stream, context, path)
        return data.decode("latin-1")

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> str:
        self.subcon._build(_latin1(obj, path, stream), stream, context, path)
        return str(obj)


class _PaddedText(_Around):
    """Text in a fixed number of bytes, padded with NUL at the end."""

    def __init__(self, size: int, seven_bit: bool) -> None:
        super().__init__(Octets(size, seven_bit))
        self._size = size

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> str:
        data: bytes = self.subcon._parsereport(stream, context, path)
        return data.rstrip(b"\0").decode("latin-1")

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> str:
        data = _latin1(obj, path, stream)
        if len(data) > self._size:
            problem = f"has {len(data)} characters, at most {self._size} are allowed"
            raise PayloadError("size", path, stream.tell(), problem)
        if data.endswith(b"\0"):
            problem = "ends with NUL, which a receiver takes for padding"
            raise PayloadError("value", path, stream.tell(), problem)
        self.subcon._build(data.ljust(self._size, b"\0"), stream, context, path)
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
        return _PaddedText(size, seven_bit)
    return _Text(Octets(size, seven_bit))


def Latin1Fill(greatest: int | None = None, seven_bit: bool = False) -> Piece:  # noqa: N802
    """Text that takes all bytes that are left, at most `greatest` of them."""
    return _Text(OctetsFill(greatest, seven_bit))


# --- several values -----------------------------------------------------------------------------


class Struct(construct.Struct):  # type: ignore[misc]
    """construct's Struct, which also rejects missing values and those that no field has."""

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        values = {} if obj is None else obj
        if not isinstance(values, Mapping):
            raise PayloadError("value", path, stream.tell(), f"must be a mapping, not {obj!r}")
        known = {subcon.name for subcon in self.subcons}
        strange = [key for key in values if key not in known and not str(key).startswith("_")]
        missing = [
            subcon.name
            for subcon in self.subcons
            if subcon.name not in values and not subcon.flagbuildnone
        ]
        if strange or missing:
            problem = "there is no such field" if strange else "the value is missing"
            raise PayloadError("value", f"{path} -> {(strange or missing)[0]}", 0, problem)
        return self._build_in_order(values, stream, context, path)

    def _build_in_order(
        self, values: Mapping[str, Any], stream: BinaryIO, context: Any, path: str
    ) -> Container:
        """Build field after field, each of which sees those in front of it and no others.

        construct shows a field all values from the start, and its own. Where one of them is called
        like the field of an outer struct that counts or selects, that one would not be seen.
        """
        inside = Container(
            _=context,
            _params=context._params,
            _root=None,
            _parsing=context._parsing,
            _building=context._building,
            _sizing=context._sizing,
            _subcons=self._subcons,
            _io=stream,
            _index=context.get("_index", None),
        )
        inside._root = context.get("_root", inside)
        for subcon in self.subcons:
            built = subcon._build(values.get(subcon.name), stream, inside, path)
            if subcon.name:
                inside[subcon.name] = built
        return inside


class Counted(_Around):
    """A number of elements, or as many as an earlier field says."""

    def __init__(self, count: Extent, element: Construct) -> None:
        super().__init__(element)
        self._count = count
        self.flagbuildnone = False

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> list[Any]:
        count = _extent(self._count, context, path)
        parse = self.subcon._parsereport
        return [parse(stream, context, f"{path} -> [{index}]") for index in range(count)]

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        count = _extent(self._count, context, path)
        elements = _as_list(obj, path, stream)
        if len(elements) != count:
            problem = f"needs exactly {count} elements, not {len(elements)}"
            raise PayloadError("size", path, stream.tell(), problem)
        for index, element in enumerate(elements):
            self.subcon._build(element, stream, context, f"{path} -> [{index}]")
        return obj

    def _sizeof(self, context: Any, path: str) -> int:
        return _fixed_extent(self._count, path) * int(self.subcon._sizeof(context, path))


class Fill(_Around):
    """Elements to the end, at most `greatest`. A tail that is no whole element is an error."""

    def __init__(self, element: Construct, greatest: int | None = None) -> None:
        super().__init__(element)
        self._greatest = greatest
        self.flagbuildnone = False

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> list[Any]:
        elements: list[Any] = []
        while _bytes_left(stream):
            self._check(len(elements) + 1, path, stream.tell())
            here = stream.tell()
            place = f"{path} -> [{len(elements)}]"
            elements.append(self.subcon._parsereport(stream, context, place))
            if stream.tell() == here:
                raise PayloadError("size", place, here, "an element of no bytes fills nothing")
        return elements

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        elements = _as_list(obj, path, stream)
        self._check(len(elements), path, stream.tell())
        for index, element in enumerate(elements):
            self.subcon._build(element, stream, context, f"{path} -> [{index}]")
        return obj

    def _check(self, count: int, path: str, offset: int) -> None:
        if self._greatest is not None and count > self._greatest:
            problem = f"at most {self._greatest} elements are allowed"
            raise PayloadError("size", path, offset, problem)

    def _sizeof(self, context: Any, path: str) -> int:
        raise construct.SizeofError("the size depends on what is left", path=path)


def _as_list(obj: Any, path: str, stream: BinaryIO) -> list[Any]:
    if isinstance(obj, str | bytes | Mapping):
        raise PayloadError("value", path, stream.tell(), f"must be a sequence, not {obj!r}")
    try:
        return list(obj)
    except TypeError:
        problem = f"must be a sequence, not {obj!r}"
        raise PayloadError("value", path, stream.tell(), problem) from None


class Cases(Piece):
    """One of several pieces, chosen by an earlier field.

    A value without a case is parsed by `rest`, or is an error where there is none.
    """

    def __init__(
        self, selector: str, cases: Mapping[int, Construct], rest: Construct | None = None
    ) -> None:
        super().__init__()
        self._selector = selector
        self._cases = dict(cases)
        self._rest = rest
        self.flagbuildnone = all(case.flagbuildnone for case in self._cases.values())

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        return self._case(stream, context, path)._parsereport(stream, context, path)

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        return self._case(stream, context, path)._build(obj, stream, context, path)

    def _case(self, stream: BinaryIO, context: Any, path: str) -> Any:
        value = _look_up(context, self._selector, path)
        case = self._cases.get(value, self._rest)
        if case is None:
            problem = f"there is no case for {self._selector} = {value}"
            raise PayloadError("value", path, stream.tell(), problem)
        return case

    def _sizeof(self, context: Any, path: str) -> int:
        choices = [*self._cases.values(), *([] if self._rest is None else [self._rest])]
        sizes = {int(choice._sizeof(context, path)) for choice in choices}
        if len(sizes) != 1:
            raise construct.SizeofError(f"the size depends on {self._selector}", path=path)
        return sizes.pop()


# --- a whole payload, or the start of one --------------------------------------------------------


class Whole(_Around):
    """A format that has to take all bytes."""

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        parsed = self.subcon._parsereport(stream, context, path)
        left = _bytes_left(stream)
        if left:
            raise PayloadError("size", path, stream.tell(), f"{left} bytes too many")
        return parsed


def whole(format: Construct) -> Whole:
    """The format as one that has to take all bytes."""
    return Whole(format)


def prefix_size(format: Construct, data: bytes) -> int:
    """How many bytes at the start of `data` the format takes.

    Raises PayloadError; its `missing` is greater than 0 where `data` is a good start but too short.
    """
    stream = io.BytesIO(data)
    format.parse_stream(stream)
    return stream.tell()
