"""Properties of generated dataclasses that show a raw value in another way.

Each stands in a class body beside the field that holds the raw value:

    steer: int
    steer_deg = Physical("steer")       # reads and writes `steer` in degrees
    mode = BitRange("control", 6, 7)    # reads and writes two bits of `control`
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, Self, TypeVar, cast, overload

from protogen.runtime.attributes import attribute
from protogen.runtime.errors import EncodeError
from protogen.runtime.payload.number import as_integer

if TYPE_CHECKING:
    from protogen.runtime.payload.number_rules import FloatRule, IntegerRule

EnumT = TypeVar("EnumT", bound=int)
ValueT = TypeVar("ValueT")


class _View(Generic[ValueT]):
    """A property that reads and writes another attribute."""

    def __init__(self, field: str) -> None:
        self._field = field
        self._attribute = attribute(field)

    @overload
    def __get__(self, record: None, owner: type) -> Self: ...
    @overload
    def __get__(self, record: object, owner: type) -> ValueT: ...
    def __get__(self, record: object | None, owner: type) -> Self | ValueT:
        return self if record is None else self._read(record)

    def __set__(self, record: object, value: ValueT) -> None:
        setattr(record, self._attribute, self._raw(record, value))

    def _read(self, record: object) -> ValueT:
        raise NotImplementedError

    def _raw(self, record: object, value: ValueT) -> Any:
        raise NotImplementedError


class _PhysicalView(_View[ValueT]):
    """A property that follows the field's rule."""

    def __set_name__(self, owner: Any, name: str) -> None:
        self._owner = owner

    @cached_property
    def _rule(self) -> IntegerRule | FloatRule:
        rule = dict(self._owner.RULES)[self._field]
        held = getattr(rule, "rule", rule)  # What may be absent has a rule for where it is there.
        chosen: Any = getattr(held, "element", held)  # An array's says it of each element.
        return cast("IntegerRule | FloatRule", chosen)

    def _shown(self, raw: Any) -> Any:
        value = self._rule.physical(raw)
        return None if value is None else float(value)


class _PhysicalValue(_PhysicalView[ValueT]):
    def _read(self, record: object) -> Any:
        return self._shown(getattr(record, self._attribute))

    def _raw(self, record: object, value: Any) -> Any:
        return self._rule.nearest(value)


class _PhysicalValues(_PhysicalView[ValueT]):
    def _read(self, record: object) -> Any:
        return [self._shown(raw) for raw in getattr(record, self._attribute)]

    def _raw(self, record: object, value: Any) -> Any:
        if isinstance(value, str) or not isinstance(value, Iterable):
            raise EncodeError("", f"must be a list of numbers, not {value!r}")
        return [self._rule.nearest(element) for element in value]


class Physical(_PhysicalValue[float]):
    """The field's physical value. Writing takes the nearest raw value, ties to even."""


class PhysicalOrNone(_PhysicalValue[float | None]):
    """The same for a field with special values: None while there is no reading.

    Writing refuses a number whose nearest raw value is a special one.
    """


class PhysicalList(_PhysicalValues[list[float]]):
    """The physical values of an array's elements."""


class PhysicalListOrNone(_PhysicalValues[list[float | None]]):
    """The physical values of an array's elements, None for those without a reading."""


class BitRange(_View[int]):
    """The bits `low` to `high` of an integer field, both included, without the `gaps` in between.

    The gaps are a mask of bits of the field; in the value they are 0.
    """

    def __init__(self, field: str, low: int, high: int, gaps: int = 0) -> None:
        super().__init__(field)
        self._low = low
        self._greatest = ((1 << (high - low + 1)) - 1) & ~(gaps >> low)

    def _read(self, record: object) -> int:
        return (int(getattr(record, self._attribute)) >> self._low) & self._greatest

    def _raw(self, record: object, value: int) -> int:
        run = as_integer(value)
        if not 0 <= run <= self._greatest:
            raise ValueError(f"{run} is not in 0..{self._greatest}")
        if run & ~self._greatest:
            raise ValueError(f"{run:#x} has bits that are none of {self._greatest:#x}")
        whole = getattr(record, self._attribute)
        others = 0 if whole is None else as_integer(whole) & ~(self._greatest << self._low)
        return others | run << self._low


class EnumRange(BitRange, Generic[EnumT]):
    """Such bits of an integer field, whose values have names."""

    def __init__(self, field: str, low: int, high: int, named: type[EnumT], gaps: int = 0) -> None:
        super().__init__(field, low, high, gaps)
        self._named = named

    @overload
    def __get__(self, record: None, owner: type) -> Self: ...
    @overload
    def __get__(self, record: object, owner: type) -> EnumT: ...
    def __get__(self, record: object | None, owner: type) -> Self | EnumT:
        return self if record is None else self._named(self._read(record))


class IfThere(_View[ValueT | None], Generic[ValueT]):
    """What another view shows of a field that may be absent: None while it is.

    Writing None makes the field absent.
    """

    def __init__(self, view: _View[ValueT]) -> None:
        super().__init__(view._field)
        self._view = view

    def __set_name__(self, owner: Any, name: str) -> None:
        prepare = getattr(self._view, "__set_name__", None)
        if prepare is not None:
            prepare(owner, name)

    def _read(self, record: object) -> ValueT | None:
        if getattr(record, self._field) is None:
            return None
        return self._view.__get__(record, type(record))

    def _raw(self, record: object, value: ValueT | None) -> Any:
        return None if value is None else self._view._raw(record, value)
