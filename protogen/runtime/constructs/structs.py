"""Several values: structs, arrays, and one of several pieces; and whole payloads."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any, BinaryIO, NamedTuple

import construct  # type: ignore[import-untyped,unused-ignore]
from construct import Construct, Container

from protogen.runtime.constructs.pieces import (
    Around,
    Count,
    Extent,
    PayloadError,
    Piece,
    bytes_left,
    extent_of,
    fixed_extent,
    read,
    said,
)
from protogen.runtime.constructs.progress import read_elements
from protogen.runtime.payload.formula import Formula, number_of


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


class Counted(Around):
    """A number of elements, or as many as an earlier field says."""

    def __init__(self, count: Extent, element: Construct) -> None:
        super().__init__(element)
        self._count = count
        self.flagbuildnone = False

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> list[Any]:
        count = extent_of(self._count, context, path)
        return read_elements(self.subcon, stream, context, path, lambda found: len(found) < count)

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        count = extent_of(self._count, context, path)
        elements = as_list(obj, path, stream)
        if len(elements) != count:
            problem = f"needs exactly {count} elements, not {len(elements)}"
            raise PayloadError("size", path, stream.tell(), problem)
        for index, element in enumerate(elements):
            self.subcon._build(element, stream, context, f"{path} -> [{index}]")
        return obj

    def _sizeof(self, context: Any, path: str) -> int:
        return fixed_extent(self._count, path) * int(self.subcon._sizeof(context, path))


class Tail(NamedTuple):
    """What stands behind elements, in bytes, or in fields with a `separator` in front of each."""

    element: int
    """Bytes or fields of an element."""
    least: int
    """Bytes or fields that always stand behind."""
    separator: int | None = None

    def elements(self, stream: BinaryIO) -> int:
        """The number of elements that the stream has left in front of the tail."""
        offset = stream.tell()
        data = stream.read()
        stream.seek(offset)
        left = len(data) if self.separator is None else data.count(self.separator)
        return max(0, left - self.least) // self.element


class Fill(Around):
    """Elements to the end, or up to a tail, `least` to `greatest`.

    At the end, what is no whole element is an error.
    """

    def __init__(
        self,
        element: Construct,
        greatest: int | None = None,
        least: int = 0,
        tail: Tail | None = None,
    ) -> None:
        super().__init__(element)
        self._tail = tail
        self._least = least
        self._greatest = greatest
        self.flagbuildnone = False

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> list[Any]:
        if self._tail is not None:
            return self._in_front(self._tail.elements(stream), stream, context, path)
        elements: list[Any] = []
        while bytes_left(stream):
            self._check(len(elements) + 1, path, stream.tell())
            here = stream.tell()
            place = f"{path} -> [{len(elements)}]"
            elements.append(self.subcon._parsereport(stream, context, place))
            if stream.tell() == here:
                raise PayloadError("size", place, here, "an element of no bytes fills nothing")
        self._check_least(len(elements), path, stream.tell())
        return elements

    def _in_front(self, count: int, stream: BinaryIO, context: Any, path: str) -> list[Any]:
        self._check_number(count, path, stream.tell())
        parse = self.subcon._parsereport
        return [parse(stream, context, f"{path} -> [{index}]") for index in range(count)]

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        elements = as_list(obj, path, stream)
        self._check_number(len(elements), path, stream.tell())
        for index, element in enumerate(elements):
            self.subcon._build(element, stream, context, f"{path} -> [{index}]")
        return obj

    def _check_number(self, count: int, path: str, offset: int) -> None:
        self._check(count, path, offset)
        self._check_least(count, path, offset)

    def _check(self, count: int, path: str, offset: int) -> None:
        if self._greatest is not None and count > self._greatest:
            problem = f"at most {self._greatest} elements are allowed"
            raise PayloadError("size", path, offset, problem)

    def _check_least(self, count: int, path: str, offset: int) -> None:
        if count < self._least:
            problem = f"at least {self._least} elements are needed, and there are {count}"
            raise PayloadError("size", path, offset, problem)

    def _sizeof(self, context: Any, path: str) -> int:
        raise construct.SizeofError("the size depends on what is left", path=path)


class UpToLast(Around):
    """Elements up to the first whose mark is not 0, `least` to `greatest` of them."""

    def __init__(
        self, element: Construct, mark: str | Formula, greatest: int, least: int = 1
    ) -> None:
        super().__init__(element)
        self._mark = mark
        self._least = least
        self._greatest = greatest
        self.flagbuildnone = False

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> list[Any]:
        def goes_on(elements: list[Any]) -> bool:
            if elements and self._is_last(elements[-1]):
                return False
            if len(elements) == self._greatest:
                problem = f"no {self._mark} of {self._greatest} elements says that it is the last"
                raise PayloadError("size", path, stream.tell(), problem)
            return True

        elements = read_elements(self.subcon, stream, context, path, goes_on)
        if len(elements) < self._least:
            problem = f"at least {self._least} elements are needed, and there are {len(elements)}"
            raise PayloadError("size", path, stream.tell(), problem)
        return elements

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        elements = as_list(obj, path, stream)
        if not self._least <= len(elements) <= self._greatest:
            problem = f"needs {self._least} to {self._greatest} elements, not {len(elements)}"
            raise PayloadError("size", path, stream.tell(), problem)
        for index, element in enumerate(elements):
            place = f"{path} -> [{index}]"
            if self._is_last(element) != (index == len(elements) - 1):
                problem = f"only the last element is the last, by {self._mark}"
                raise PayloadError("value", place, stream.tell(), problem)
            self.subcon._build(element, stream, context, place)
        return obj

    def _is_last(self, element: Any) -> bool:
        return number_of(self._mark, element.__getitem__) != 0

    def _sizeof(self, context: Any, path: str) -> int:
        raise construct.SizeofError("the size depends on the elements", path=path)


def as_list(obj: Any, path: str, stream: BinaryIO) -> list[Any]:
    """The elements of a sequence. Raises PayloadError where it is none."""
    if isinstance(obj, str | bytes | Mapping):
        raise PayloadError("value", path, stream.tell(), f"must be a sequence, not {obj!r}")
    try:
        return list(obj)
    except TypeError:
        problem = f"must be a sequence, not {obj!r}"
        raise PayloadError("value", path, stream.tell(), problem) from None


class Cases(Piece):
    """One of several pieces, chosen by earlier fields.

    The case under None is that of all other values. Without it, a value without a case is parsed by
    `rest`, or is an error where there is none.
    """

    def __init__(
        self,
        selector: str | Formula,
        cases: Mapping[int | None, Construct],
        rest: Construct | None = None,
    ) -> None:
        super().__init__()
        self._selector = selector
        self._cases = dict(cases)
        self._rest = rest
        self.flagbuildnone = all(case.flagbuildnone for case in self._cases.values())

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        return self.case(stream, context, path)._parsereport(stream, context, path)

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        return self.case(stream, context, path)._build(obj, stream, context, path)

    def case(self, stream: BinaryIO, context: Any, path: str) -> Any:
        """The piece that the earlier fields choose. Raises PayloadError if there is none."""
        value = said(self._selector, context, path)
        case = self._cases.get(value, self._cases.get(None, self._rest))
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


class When(Around):
    """A piece that is there only where a condition on earlier fields holds; else its value is None.

    Building takes None for a constant that is there, too.
    """

    def __init__(self, condition: str | Formula, subcon: Construct) -> None:
        super().__init__(subcon)
        self._condition = condition
        self.flagbuildnone = True

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        if not said(self._condition, context, path):
            return None
        return self.subcon._parsereport(stream, context, path)

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        is_there = bool(said(self._condition, context, path))
        if is_there and (obj is not None or self._takes_none(stream, context, path)):
            return self.subcon._build(obj, stream, context, path)
        if is_there or obj is not None:
            problem = "is missing" if is_there else f"must be None, not {obj!r}"
            problem = f"{problem}, as {self._condition} {'holds' if is_there else 'does not hold'}"
            raise PayloadError("value", path, stream.tell(), problem)
        return None

    def _takes_none(self, stream: BinaryIO, context: Any, path: str) -> bool:
        """True if None is what is built, as of a constant, or of a case without bytes."""
        piece: Any = self.subcon
        if isinstance(piece, Cases):
            piece = piece.case(stream, context, path)
        return bool(piece.flagbuildnone)

    def _sizeof(self, context: Any, path: str) -> int:
        raise construct.SizeofError(f"the size depends on {self._condition}", path=path)


class IfLeft(Around):
    """A piece that is there only where the stream goes on; else its value is None.

    `behind` is the piece in front that may be left out as well.
    """

    def __init__(self, subcon: Construct, behind: str | None = None) -> None:
        super().__init__(subcon)
        self._behind = behind
        self.flagbuildnone = True

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        return self.subcon._parsereport(stream, context, path) if bytes_left(stream) else None

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        if obj is None:
            return None
        if self._behind is not None and context[self._behind] is None:
            problem = f"must be None, as {self._behind} in front of it is left out"
            raise PayloadError("value", path, stream.tell(), problem)
        return self.subcon._build(obj, stream, context, path)

    def _sizeof(self, context: Any, path: str) -> int:
        raise construct.SizeofError("the size depends on what is left", path=path)


class Region(Around):
    """A piece that takes just so many bytes; its end is the end for all that is inside."""

    def __init__(self, size: Extent, subcon: Construct) -> None:
        super().__init__(subcon)
        self._size = size

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        start = stream.tell()
        inside = io.BytesIO(read(stream, extent_of(self._size, context, path), path))
        try:
            parsed = self.subcon._parsereport(inside, context, path)
        except PayloadError as error:
            error.offset += start
            error.missing = 0  # More bytes behind the region would not help.
            raise
        left = bytes_left(inside)
        if left:
            problem = f"{left} of the bytes that {self._said} says are left over"
            raise PayloadError("size", path, start + inside.tell(), problem)
        return parsed

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        inside = io.BytesIO()
        built = self.subcon._build(obj, inside, context, path)
        size, data = extent_of(self._size, context, path), inside.getvalue()
        if len(data) != size:
            says = "" if isinstance(self._size, int) else f", as {self._said} says"
            problem = f"needs exactly {size} bytes{says}, not {len(data)}"
            raise PayloadError("size", path, stream.tell(), problem)
        stream.write(data)
        return built

    @property
    def _said(self) -> Any:
        return self._size.by if isinstance(self._size, Count) else self._size

    def _sizeof(self, context: Any, path: str) -> int:
        return fixed_extent(self._size, path)


class Part(Piece):
    """A number of the frame, of which the payload has no bytes.

    Parsing takes it by its name, `FORMAT.parse(payload, mode=2)`; building leaves it to the frame.
    """

    def __init__(self, name: str, role: type[int] = int) -> None:
        super().__init__()
        self._name = name
        self._role = role

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> int:
        try:
            return self._role(context._params[self._name])
        except KeyError:
            problem = f"the frame says what it is: parse(..., {self._name}=...)"
            raise PayloadError("value", path, stream.tell(), problem) from None

    def _build(self, obj: Any, stream: BinaryIO, context: Any, path: str) -> Any:
        return obj

    def _sizeof(self, context: Any, path: str) -> int:
        return 0


def region_bytes(format: Struct, name: str, values: Mapping[str, Any]) -> bytes:
    """The bytes in the region of a struct's field, however many it should have.

    `values` are those of the field and of the fields in front. None is a value that is not there.
    Raises PayloadError.
    """
    piece: Any = next(subcon for subcon in format.subcons if subcon.name == name)
    while not isinstance(piece, Region):
        piece = piece.subcon
    if values[name] is None:
        return b""
    context = Container(values, _parsing=False, _building=True, _sizing=False)
    context._params = context
    inside = io.BytesIO()
    piece.subcon._build(values[name], inside, context, f"(building) -> {name}")
    return inside.getvalue()


class Whole(Around):
    """A format that has to take all bytes."""

    def _parse(self, stream: BinaryIO, context: Any, path: str) -> Any:
        parsed = self.subcon._parsereport(stream, context, path)
        left = bytes_left(stream)
        if left:
            raise PayloadError("size", path, stream.tell(), f"{left} bytes too many")
        return parsed


def prefix_size(format: Construct, data: bytes, held: Mapping[str, int]) -> int:
    """Number of bytes at the start of `data` that the format takes.

    `held` has the numbers of the frame among its fields.

    Raises PayloadError; its `missing` is greater than 0 where `data` is a good start but too short.
    """
    stream = io.BytesIO(data)
    format.parse_stream(stream, **held)
    return stream.tell()
