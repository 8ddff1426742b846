"""`dataclass` and `field` of the standard library, made when they are used and not before.

The module `dataclasses` imports `inspect`, and writes and compiles half a dozen methods for each
class: with the messages of a protocol, most of the time that it takes to import one. Here a class
gets its slots at once, and a method when it is first called. Only what the runtime and generated
modules need is here; classes have slots always. Type checkers see the standard library's.

What `dataclasses.fields`, `asdict`, `replace` and their kind look for is made by the standard
library itself, when they ask:

    >>> import dataclasses
    >>> @dataclass(slots=True, kw_only=True)
    ... class Point:
    ...     x: int
    ...     y: int = 0
    >>> dataclasses.replace(Point(x=1), y=2)
    Point(x=1, y=2)
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

__all__ = ["dataclass", "field"]


class _Missing:
    """What a default is that there is not; as a parameter's default, one that a factory makes."""

    __slots__ = ()

    def __repr__(self) -> str:
        return "<factory>"


_MISSING = _Missing()


class _Field:
    """A field: what the standard library's has of the same name."""

    __slots__ = ("compare", "default", "default_factory", "hash", "init", "name", "repr", "type")

    def __init__(
        self,
        default: Any,
        default_factory: Any,
        init: bool,
        repr: bool,
        hash: bool | None,
        compare: bool,
    ) -> None:
        self.name = ""
        self.type: Any = None
        self.default = default
        self.default_factory = default_factory
        self.init = init
        self.repr = repr
        self.hash = hash
        self.compare = compare

    def settings(self) -> dict[str, Any]:
        """What the standard library's `field` is called with."""
        given = {name: getattr(self, name) for name in self.__slots__ if name not in _OF_CLASS}
        return {name: value for name, value in given.items() if value is not _MISSING}


_OF_CLASS = ("name", "type")
"""What a field has of the class that it stands in."""


def _field(
    *,
    default: Any = _MISSING,
    default_factory: Any = _MISSING,
    init: bool = True,
    repr: bool = True,
    hash: bool | None = None,
    compare: bool = True,
) -> Any:
    """As `dataclasses.field`."""
    return _Field(default, default_factory, init, repr, hash, compare)


def _dataclass(
    cls: type[Any] | None = None,
    /,
    *,
    slots: bool,
    frozen: bool = False,
    kw_only: bool = False,
    repr: bool = True,
    init: bool = True,
) -> Any:
    """As `dataclasses.dataclass`, with slots always."""
    assert slots, "these classes have slots"
    left_out = {
        name for name, is_made in {"__repr__": repr, "__init__": init}.items() if not is_made
    }

    def decorated(cls: type[Any]) -> type[Any]:
        return _Methods(cls, frozen, kw_only).added_to(cls, left_out)

    return decorated if cls is None else decorated(cls)


if TYPE_CHECKING:
    from dataclasses import dataclass, field
else:
    dataclass, field = _dataclass, _field


# --- the class ----------------------------------------------------------------------------------

_OWN = "__own_fields__"
"""The attribute with the fields of a class that are not those of its bases."""


class _Late:
    """An attribute of a class that is made when it is first looked at."""

    __slots__ = ("_make", "_methods", "_name")

    def __init__(self, methods: _Methods, name: str, make: Callable[[_Methods], Any]) -> None:
        self._methods = methods
        self._name = name
        self._make = make

    def __get__(self, instance: object | None, owner: type[Any]) -> Any:
        value = self._make(self._methods)
        setattr(self._methods.cls, self._name, value)
        bind = getattr(type(value), "__get__", None)
        return value if bind is None else bind(value, instance, owner)


class _Methods:
    """What a class gets for its fields."""

    def __init__(self, cls: type[Any], frozen: bool, kw_only: bool) -> None:
        self.cls = cls
        self.frozen = frozen
        self.kw_only = kw_only
        self.own = _own_fields(cls)
        inherited = [item for base in reversed(cls.__mro__) for item in base.__dict__.get(_OWN, ())]
        self.fields = list({item.name: item for item in (*inherited, *self.own)}.values())

    def added_to(self, cls: type[Any], left_out: set[str]) -> type[Any]:
        """The class once more, with all methods but some, and with slots, which come first."""
        kind: Any = type(cls)
        inside = self._with_slots(cls) | self._made(cls, left_out | set(cls.__dict__))
        self.cls = kind(cls.__name__, cls.__bases__, inside)
        self.cls.__qualname__ = cls.__qualname__
        return self.cls

    def _with_slots(self, cls: type[Any]) -> dict[str, Any]:
        """What stands in the class, with slots instead of the fields' defaults."""
        inside = dict(cls.__dict__)
        for name in ("__dict__", "__weakref__", *(item.name for item in self.own)):
            inside.pop(name, None)
        base_slots = {name for base in cls.__mro__[1:] for name in _slots(base)}
        inside["__slots__"] = tuple(i.name for i in self.own if i.name not in base_slots)
        inside[_OWN] = tuple(self.own)
        return inside

    def _made(self, cls: type[Any], left_out: set[str]) -> dict[str, Any]:
        """What is added."""
        made: dict[str, Any] = {
            name: _Late(self, name, make) for name, make in _LATE.items() if name not in left_out
        }
        if "__match_args__" not in left_out:
            positional = (item.name for item in self.fields if item.init and not self.kw_only)
            made["__match_args__"] = tuple(positional)
        if cls.__dict__.get("__hash__") is None:
            made["__hash__"] = _Late(self, "__hash__", _hash) if self.frozen else None
        return made | _frozen_methods(self) if self.frozen else made

    def names(self) -> tuple[str, ...]:
        """The names of all fields."""
        return tuple(item.name for item in self.fields)

    def compiled(
        self, name: str, parameters: Iterable[str], body: Iterable[str], **known: Any
    ) -> Any:
        """A method of its text; `known` are names that are not the caller's.

        Its other names are those of the class's module, where `typing` looks annotations up.
        """
        head = f"def __make({', '.join(known)}):\n def {name}({', '.join(parameters)}):\n  "
        text = head + "\n  ".join(body) + f"\n return {name}"
        module = self.cls.__module__
        home = vars(sys.modules[module]) if module in sys.modules else {"__name__": module}
        made: dict[str, Any] = {}
        exec(text, home, made)  # noqa: S102 - our own text
        method = made["__make"](**known)
        method.__qualname__ = f"{self.cls.__qualname__}.{name}"
        return method


def _slots(base: type[Any]) -> Iterable[str]:
    slots = base.__dict__.get("__slots__", ())
    return (slots,) if isinstance(slots, str) else slots


def _own_fields(cls: type[Any]) -> list[_Field]:
    """The fields of the class's own annotations."""
    fields = []
    for name, type_ in cls.__annotations__.items():
        if str(type_).startswith("ClassVar["):
            continue
        given = cls.__dict__.get(name, _MISSING)
        own = given if isinstance(given, _Field) else _field(default=given)
        own.name, own.type = name, type_
        fields.append(own)
    return fields


# --- methods ------------------------------------------------------------------------------------


def _init(methods: _Methods) -> Any:
    # A field may be called as anything but a name with two underscores at its start.
    self = "__self" if "self" in methods.names() else "self"
    known: dict[str, Any] = {"__set": object.__setattr__, "__missing": _MISSING}
    parameters = [self]
    if methods.kw_only and any(item.init for item in methods.fields):
        parameters.append("*")
    body = ["pass"]
    for item in methods.fields:
        default = f"__default_{item.name}"
        known[default] = item.default
        known[f"__factory_{item.name}"] = item.default_factory
        has_factory = item.default_factory is not _MISSING
        if item.init:
            is_optional = has_factory or item.default is not _MISSING
            parameters.append(f"{item.name}={default}" if is_optional else item.name)
        value = _initial(item, has_factory)
        if value is None:
            continue
        plain = f"{self}.{item.name} = {value}"
        body.append(f"__set({self}, {item.name!r}, {value})" if methods.frozen else plain)
    if hasattr(methods.cls, "__post_init__"):
        body.append(f"{self}.__post_init__()")
    made = methods.compiled("__init__", parameters, body, **known)
    made.__annotations__ = {item.name: item.type for item in methods.fields if item.init}
    made.__annotations__["return"] = None
    return made


def _initial(item: _Field, has_factory: bool) -> str | None:
    """The expression of a field's first value; None where `__post_init__` sets it."""
    if has_factory:
        made = f"__factory_{item.name}()"
        return f"{made} if {item.name} is __missing else {item.name}" if item.init else made
    if item.init:
        return item.name
    return None if item.default is _MISSING else f"__default_{item.name}"


def _repr(methods: _Methods) -> Any:
    names = [item.name for item in methods.fields if item.repr]

    def __repr__(self: Any) -> str:  # noqa: N807 - it becomes one
        shown = ", ".join(f"{name}={getattr(self, name)!r}" for name in names)
        return f"{type(self).__qualname__}({shown})"

    # By this `pprint` knows that it may lay out the fields itself.
    __repr__.__qualname__ = "__create_fn__.<locals>.__repr__"
    made: Any = recursive_repr()(__repr__)
    made.__wrapped__ = __repr__
    made.__qualname__ = f"{methods.cls.__qualname__}.__repr__"
    return made


def _values(owner: str, names: Iterable[str]) -> str:
    """The values of fields, as the text of a tuple."""
    return "(" + "".join(f"{owner}.{name}, " for name in names) + ")"


def _eq(methods: _Methods) -> Any:
    names = [item.name for item in methods.fields if item.compare]
    body = (
        "if other.__class__ is self.__class__:",
        f"  return {_values('self', names)} == {_values('other', names)}",
        "return __not_implemented",
    )
    # A message may be called like what is built in.
    known = {"__not_implemented": NotImplemented}
    return methods.compiled("__eq__", ("self", "other"), body, **known)


def _hash(methods: _Methods) -> Any:
    hashed = [i.name for i in methods.fields if (i.compare if i.hash is None else i.hash)]
    return methods.compiled(
        "__hash__", ("self",), (f"return __hash({_values('self', hashed)})",), __hash=hash
    )


def _replace(methods: _Methods) -> Any:
    """What `copy.replace` calls from Python 3.13 on."""
    from dataclasses import replace

    def __replace__(self: Any, /, **changes: Any) -> Any:  # noqa: N807 - it becomes one
        return replace(self, **changes)

    return __replace__


def _frozen_methods(methods: _Methods) -> dict[str, Any]:
    """Nothing can be set any more, so that `pickle` and `copy` need a way of their own."""

    def refuse(self: Any, verb: str, name: str) -> None:
        if type(self) is methods.cls or name in methods.names():
            from dataclasses import FrozenInstanceError

            raise FrozenInstanceError(f"cannot {verb} field {name!r}")

    def __setattr__(self: Any, name: str, value: Any) -> None:  # noqa: N807 - it becomes one
        refuse(self, "assign to", name)
        super(methods.cls, self).__setattr__(name, value)

    def __delattr__(self: Any, name: str) -> None:  # noqa: N807 - it becomes one
        refuse(self, "delete", name)
        super(methods.cls, self).__delattr__(name)

    def __getstate__(self: Any) -> list[Any]:  # noqa: N807 - it becomes one
        return [getattr(self, name) for name in methods.names()]

    def __setstate__(self: Any, state: Iterable[Any]) -> None:  # noqa: N807 - it becomes one
        for name, value in zip(methods.names(), state, strict=True):
            object.__setattr__(self, name, value)

    made = (__setattr__, __delattr__, __getstate__, __setstate__)
    return {method.__name__: method for method in made}


# --- what the standard library looks for --------------------------------------------------------


def _standard(methods: _Methods, name: str) -> Any:
    """An attribute of the standard library's dataclass of the same fields."""
    import dataclasses

    fields = [(i.name, i.type, dataclasses.field(**i.settings())) for i in methods.fields]
    made = dataclasses.make_dataclass(
        methods.cls.__name__,
        fields,
        frozen=methods.frozen,
        kw_only=methods.kw_only,
        slots=True,
    )
    return getattr(made, name)


def _standard_fields(methods: _Methods) -> Any:
    return _standard(methods, "__dataclass_fields__")


def _standard_params(methods: _Methods) -> Any:
    return _standard(methods, "__dataclass_params__")


_LATE: Mapping[str, Callable[[_Methods], Any]] = {
    "__init__": _init,
    "__repr__": _repr,
    "__eq__": _eq,
    "__replace__": _replace,
    "__dataclass_fields__": _standard_fields,
    "__dataclass_params__": _standard_params,
}
