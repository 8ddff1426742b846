"""Bases of the classes with slots that messages, parts, events and rules are.

Their classes say `__slots__` and `__init__` themselves. That takes the standard library's
`dataclass` a millisecond for each class, and `inspect` before the first: most of the time in which
a generated module is imported.
"""

from __future__ import annotations

from reprlib import recursive_repr
from typing import Any, ClassVar, NoReturn, Self, TypeVar, dataclass_transform

from protogen.runtime.attributes import schema_name

OMITTED: Any = type("Omitted", (), {"__repr__": lambda self: "..."})()
"""Default of an argument for which each object gets a new list, or a number of its own."""


def count_of(values: Any) -> int:
    """The number of elements or bytes of a field; 0 of what is no value of it."""
    try:
        return len(values)
    except TypeError:
        return 0


ItemT = TypeVar("ItemT", bound="Value")


class Value:
    """Base of classes whose objects are equal where their fields are."""

    __slots__ = ()

    __fields__: ClassVar[tuple[str, ...]] = ()
    """The parameters of `__init__`, in order: attributes of the same names."""
    __compared__: ClassVar[tuple[str, ...]] = ()
    """The fields that make objects equal: all, unless the class says otherwise."""

    def __init_subclass__(cls, **others: Any) -> None:
        """Collect the fields of the class and its bases; `others` are for other bases."""
        super().__init_subclass__(**others)
        if "__init__" in cls.__dict__:
            code = cls.__dict__["__init__"].__code__
            cls.__fields__ = code.co_varnames[1 : code.co_argcount + code.co_kwonlyargcount]
        if "__compared__" not in cls.__dict__:
            cls.__compared__ = cls.__fields__

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self is other or _values(self) == _values(other)

    __hash__: ClassVar[Any] = None

    @recursive_repr()
    def __repr__(self) -> str:
        shown = ", ".join(f"{name}={getattr(self, name)!r}" for name in self.__fields__)
        return f"{type(self).__qualname__}({shown})"

    def __replace__(self, /, **changes: Any) -> Self:
        """The same with other values, as `copy.replace` of Python 3.13 makes it."""
        return type(self)(**{name: getattr(self, name) for name in self.__fields__} | changes)


def _values(item: Any) -> tuple[Any, ...]:
    return tuple([getattr(item, name) for name in item.__compared__])


@dataclass_transform(frozen_default=True)
class Frozen(Value):
    """Base of those that don't change and can be hashed. Their `__init__` calls `_set`."""

    __slots__ = ()

    def __init_subclass__(cls, **others: Any) -> None:
        """Let `match` take the fields by position."""
        super().__init_subclass__(**others)
        type.__setattr__(cls, "__match_args__", cls.__fields__)  # Type checkers make their own.

    def __init__(self) -> None:
        """Without fields, unless the class has some."""

    def _set(self, *values: Any) -> None:
        """Set the fields, in order."""
        for name, value in zip(self.__fields__, values, strict=True):
            object.__setattr__(self, name, value)

    def __hash__(self) -> int:
        return hash(_values(self))

    def __setattr__(self, name: str, value: Any) -> NoReturn:
        raise AttributeError(f"cannot assign to field {name!r}")

    def __delattr__(self, name: str) -> NoReturn:
        raise AttributeError(f"cannot delete field {name!r}")

    def __setstate__(self, state: Any) -> None:
        """Take what `pickle` or `copy` kept: the attributes of a `__dict__`, and the slots."""
        for attributes in state:
            for name, value in (attributes or {}).items():
                object.__setattr__(self, name, value)


def replace(item: ItemT, /, **changes: Any) -> ItemT:
    """The message, event or parts with other values."""
    return item.__replace__(**changes)


def as_dict(item: Value) -> dict[str, Any]:
    """The fields by the schema's names; what is inside of them becomes a `dict` as well.

    `Message.to_dict` gives what JSON can show.
    """
    return {schema_name(name): _plain(getattr(item, name)) for name in item.__fields__}


def _plain(value: Any) -> Any:
    if isinstance(value, Value):
        return as_dict(value)
    return [_plain(item) for item in value] if isinstance(value, list) else value
