"""A `FORMAT` does in its direct way what construct does in its own."""

from __future__ import annotations

import copy
import io
from collections import UserDict
from collections.abc import Callable, Iterator
from decimal import Decimal
from enum import IntEnum
from types import MappingProxyType
from typing import Any

import construct
from hypothesis import strategies as st

from protogen.runtime import constructs as c


def check_parsing(format: Any, data: bytes) -> Any:
    """`parse` and `parse_stream` give what construct gives, or its errors. Returns what they do."""
    due = outcome(c.Struct.parse, format, data)
    assert outcome(format.parse, data) == due
    assert outcome(construct.Struct(*format.subcons).parse, data) == due
    own, plain = io.BytesIO(b"in front" + data), io.BytesIO(b"in front" + data)
    own.seek(8)
    plain.seek(8)
    assert outcome(format.parse_stream, own) == outcome(c.Struct.parse_stream, format, plain)
    assert own.tell() == plain.tell()
    return due


def check_building(format: Any, values: Any) -> Any:
    """`build` gives the bytes that construct gives, or its errors. Returns what it does."""
    due = outcome(c.Struct.build, format, values)
    assert outcome(format.build, values) == due
    return due


def outcome(call: Callable[..., Any], *arguments: Any) -> Any:
    """What a call gives, in a form in which what is not a number equals itself."""
    try:
        return shown(call(*arguments))
    except Exception as error:
        return type(error), str(error), shown(vars(error))


def shown(value: Any) -> Any:
    """Kinds and values, in order, without the stream that construct leaves behind."""
    if isinstance(value, dict):
        items = [(name, shown(item)) for name, item in value.items() if name != "_io"]
        return type(value), items
    if isinstance(value, list | tuple):
        return type(value), [shown(item) for item in value]
    return type(value), repr(value)


class Numbered(IntEnum):
    ONE = 1


class Text(str):
    __slots__ = ()


class OtherList(list[Any]):
    """A list that says that it has other elements."""

    def __iter__(self) -> Iterator[Any]:
        return iter([1])


class OtherContainer(c.Container):  # type: ignore[misc]
    """A container that says that it has other values."""

    def __getitem__(self, name: str) -> Any:
        return 1


STRANGE = (
    *(None, True, False, Numbered.ONE, 0, 1, -1, 2, 127, 128, -64, 1 << 13, 1 << 70),
    *(0.0, 1.0, -0.5, float("nan"), float("inf"), 1e300, Decimal(1), 1j),
    *("", "a", "ab\0", "\x80", "\u0100", Text("a"), b"", b"a", b"\x80a", bytearray(b"a")),
    *((), (1, 2), [], [1], [1, None], [1.0, 2], OtherList([1, 2]), range(2), {1}),
    *({}, {"a": 1}, c.Container(), OtherContainer(a=2), UserDict(a=1), MappingProxyType({"a": 1})),
)


@st.composite
def spoilt(draw: Any, values: Any) -> Any:
    """The values with one of them left out, added or replaced, somewhere inside."""
    values = copy.deepcopy(values)
    strange = st.sampled_from(range(len(STRANGE))).map(STRANGE.__getitem__)
    places = list(_places(values))
    inside, key = draw(st.sampled_from(places)) if places else (values, None)
    change = draw(st.sampled_from(["other", "other", "kind", "less", "more"]))
    if change == "kind" or not isinstance(inside, dict | list):
        kinds = [dict, c.Container, OtherContainer, UserDict, lambda mapping: None, list]
        return draw(st.sampled_from(kinds))(values)
    if change == "more":
        if isinstance(inside, dict):
            name = draw(st.sampled_from(["strange", "_private", "_io", 5]))
            inside[name] = draw(strange)
        else:
            inside.append(draw(strange))
    elif key is not None and change == "less":
        del inside[key]
    elif key is not None:
        inside[key] = draw(strange)
    return values


def _places(values: Any) -> Iterator[tuple[Any, Any]]:
    items = values.items() if isinstance(values, dict) else enumerate(values)
    for key, item in items:
        yield values, key
        if isinstance(item, dict | list):
            yield from _places(item)
