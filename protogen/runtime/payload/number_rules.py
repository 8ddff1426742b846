"""Rules of integers, floats and truth values."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from numbers import Integral, Number, Real
from typing import Any, Literal

from protogen.runtime.errors import EncodeError
from protogen.runtime.payload.enums import Flags, OpenEnum
from protogen.runtime.payload.nearest import nearest_reading
from protogen.runtime.payload.number import as_integer
from protogen.runtime.payload.rules import Rule, Scope, Violation, refuse

_NOTHING: Mapping[str, int] = {}


class IntegerRule(Rule):
    """An integer of `bits` bits; whatever Python takes where it needs one is one.

    `named` is the enum or flags class of its values. `least` and `greatest` are the range that the
    schema gives; a `special` value may be outside of it. The physical value is
    raw x scale + offset, in `unit`. `holds` are the least and the greatest value that the wire can
    hold, where that is less than the bits can.
    """

    def __init__(  # noqa: PLR0913 - an argument for each field
        self,
        bits: int,
        signed: bool = False,
        named: type[OpenEnum | Flags] | None = None,
        closed: bool = False,
        least: int | None = None,
        greatest: int | None = None,
        const: int | None = None,
        special: Mapping[str, int] = _NOTHING,
        scale: Fraction = Fraction(1),
        offset: Fraction = Fraction(0),
        unit: str | None = None,
        holds: tuple[int, int] | None = None,
    ) -> None:
        self.bits = bits
        self.signed = signed
        self.holds = holds
        self.named = named
        self.closed = closed
        self.least = least
        self.greatest = greatest
        self.const = const
        self.special = special
        self.scale = scale
        self.offset = offset
        self.unit = unit

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> int:
        """The raw value."""
        raw = as_integer(value)
        low, high = self._capacity()
        if not low <= raw <= high:
            raise EncodeError("", self._out_of_range(raw, low, high))
        if strict:
            refuse(self._violations(raw))
        return raw

    def from_wire(self, raw: int, scope: Scope) -> int:
        """The raw value, as a member of its enum where it has one."""
        return raw if self.named is None else self.named(raw)

    def violations(self, value: int, scope: Scope) -> list[Violation]:
        """A constant or range that does not hold; a value or bits without a name."""
        return self._violations(as_integer(value))

    def _violations(self, value: int) -> list[Violation]:
        if self.const is not None and value != self.const:
            return [Violation("", f"must be {self.const}, not {value}")]
        if value in self.special.values():
            return []
        if not _within(value, self.least, self.greatest):
            return [Violation("", self._out_of_range(value, self.least, self.greatest))]
        return self._unnamed(value)

    def to_json(self, value: int, scope: Scope) -> int:
        """The raw value."""
        return int(value)

    def from_json(self, data: Any, scope: Scope) -> int:
        """A raw value, the name of one, or a list of flags' names."""
        if isinstance(data, str):
            return self._called(data)
        if isinstance(data, list) and self._is_flags():
            flags = 0
            for name in data:
                flags |= self._called(str(name))
            return self.from_wire(flags, scope)
        if not isinstance(data, int) or isinstance(data, bool):
            raise EncodeError("", f"must be an integer, not {data!r}")
        if data < 0 and self._is_flags():
            # Python's flags would take a negative number for all bits but some.
            raise EncodeError("", self._out_of_range(data, *self._capacity()))
        return self.from_wire(data, scope)

    def physical(self, raw: int) -> Fraction | None:
        """The exact physical value in `unit`; None for a special value."""
        if raw in self.special.values():
            return None
        return raw * self.scale + self.offset

    def nearest(self, physical: float | Fraction | None) -> int:
        """The raw value nearest to a physical value, ties to even. Raises ValueError.

        None stands for the special value, where there is exactly one. A number never does: it would
        be read back as no reading at all.
        """
        if physical is None:
            return self._only_special()
        exact = (_exact(physical) - self.offset) / self.scale
        raw = round(exact)
        low, high = self._capacity()
        if not low <= raw <= high:
            bounds = sorted((low, high), key=lambda bound: bound * self.scale)
            raise ValueError(f"{physical} is not in {'..'.join(map(self._shown, bounds))}")
        if raw in self.special.values():
            raise ValueError(self._means_no_reading(exact, raw))
        return raw

    def _means_no_reading(self, exact: Fraction, raw: int) -> str:
        name = next(name for name, value in self.special.items() if value == raw)
        text = f"{self._shown(exact)} would be sent as {raw}, which means {name}"
        low, high = self._capacity()
        least = low if self.least is None else self.least
        greatest = high if self.greatest is None else self.greatest
        other = nearest_reading(exact, self.special.values(), least, greatest)
        return text if other is None else f"{text}; the nearest reading is {self._shown(other)}"

    def _shown(self, raw: int | Fraction) -> str:
        value = f"{float(raw * self.scale + self.offset):.10g}"
        return f"{value} {self.unit}" if self.unit else value

    def _capacity(self) -> tuple[int, int]:
        """The least and the greatest value that the wire can hold."""
        if self.holds is not None:
            return self.holds
        low = -(1 << (self.bits - 1)) if self.signed else 0
        return low, (1 << (self.bits - self.signed)) - 1

    def _only_special(self) -> int:
        if len(self.special) != 1:
            names = ", ".join(self.special) or "none"
            raise ValueError(f"None stands for the only special value, but there are: {names}")
        return next(iter(self.special.values()))

    def _is_flags(self) -> bool:
        return self.named is not None and issubclass(self.named, Flags)

    def _out_of_range(self, value: int, least: int | None, greatest: int | None) -> str:
        unit = f" ({self.unit})" if self.unit and self.scale == 1 and not self.offset else ""
        return f"{value} is not in {_bounds(least, greatest)}{unit}"

    def _unnamed(self, value: int) -> list[Violation]:
        if self.named is None:
            return []
        member = self.named(value)
        if isinstance(member, Flags):
            bits = member.unknown
            return [Violation("", f"bits {bits:#x} have no name", False)] if bits else []
        if member.is_known:
            return []
        allowed = ", ".join(f"{known.name} = {known.value}" for known in self.named)
        problem = f"{value} has no name; there are {allowed}"
        return [Violation("", problem, self.closed)]

    def _called(self, name: str) -> int:
        if name in self.special:
            return self.special[name]
        members: Mapping[str, int] = {} if self.named is None else self.named.__members__
        if name.upper() not in members:
            names = ", ".join([*map(str.lower, members), *self.special])
            raise EncodeError("", f"{name!r} is no name of a value here; there are: {names}")
        return members[name.upper()]


class FloatRule(Rule):
    """An IEEE 754 number of 32 or 64 bits; `least` and `greatest` as for integers.

    In JSON, which has no numbers for them, not-a-number and the infinities are the texts `nan`,
    `inf` and `-inf`.
    """

    def __init__(
        self,
        bits: Literal[32, 64],
        least: Fraction | None = None,
        greatest: Fraction | None = None,
        const: float | None = None,
        scale: Fraction = Fraction(1),
        offset: Fraction = Fraction(0),
        unit: str | None = None,
    ) -> None:
        self.bits = bits
        self.least = least
        self.greatest = greatest
        self.const = const
        self.scale = scale
        self.offset = offset
        self.unit = unit

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> float:
        """The number, if it is not too large for its bits."""
        number = _float(value, "a number")
        if math.isfinite(number) and abs(number) > _GREATEST_FLOAT[self.bits]:
            raise EncodeError("", f"{value} is too large for {self.bits} bits")
        if strict:
            refuse(self.violations(number, scope))
        return number

    def violations(self, value: float, scope: Scope) -> list[Violation]:
        """A constant or range that does not hold."""
        value = float(value)
        if self.const is not None and value != self.const:
            return [Violation("", f"must be {self.const}, not {value}")]
        if _within(value, self.least, self.greatest):
            return []
        return [Violation("", f"{value} is not in {_bounds(self.least, self.greatest)}")]

    def to_json(self, value: float, scope: Scope) -> float | str:
        """The number, or a text for one that JSON does not have."""
        return float(value) if math.isfinite(value) else str(float(value))

    def from_json(self, data: Any, scope: Scope) -> float:
        """A number, or the text of one that JSON does not have."""
        if data in ("nan", "inf", "-inf"):
            return float(data)
        return _float(data, "a number, nan, inf or -inf")

    def physical(self, raw: float) -> float:
        """The physical value in `unit`."""
        scaled = raw * self.scale
        return float(scaled + self.offset if self.offset else scaled)  # -0.0 + 0 is 0.0.

    def nearest(self, physical: float | Fraction) -> float:
        """The raw value for a physical value. Raises ValueError if it does not fit the bits."""
        number = _float(physical, "a number")
        if math.isnan(number):
            return number
        if math.isinf(number) or not (number or self.offset):  # -0.0 is no Fraction.
            return number if self.scale > 0 else -number
        raw = (_exact(physical) - self.offset) / self.scale
        if abs(raw) > _GREATEST_FLOAT[self.bits]:
            raise ValueError(f"{physical} is too large for {self.bits} bits")
        return float(raw)


def _float(value: Any, kind: str) -> float:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise EncodeError("", f"must be {kind}, not {value!r}")
    try:
        return float(value)
    except OverflowError:
        raise EncodeError("", "is an integer that is too large for a float") from None


_GREATEST_FLOAT = {32: (2 - 2**-23) * 2.0**127, 64: (2 - 2**-52) * 2.0**1023}


def _exact(physical: Any) -> Fraction:
    if isinstance(physical, Fraction):
        return physical
    number = _float(physical, "a number")  # A text may have an exponent that fills the memory.
    if not math.isfinite(number):
        raise ValueError(f"{physical!r} is no physical value")
    return Fraction(int(physical) if isinstance(physical, Integral) else number)


def _within(value: float, least: int | Fraction | None, greatest: int | Fraction | None) -> bool:
    """True if the value is in the range; not-a-number is in none that has a bound."""
    return (least is None or value >= least) and (greatest is None or value <= greatest)


def _bounds(least: object, greatest: object) -> str:
    if least is None:
        return f"..{greatest}"
    return f"{least}.." if greatest is None else f"{least}..{greatest}"


class BoolRule(Rule):
    """False or true."""

    def __init__(self, const: bool | None = None) -> None:
        self.const = const

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> bool:
        """False or true; 0 and 1 are taken as well."""
        if not _is_bit(value):
            raise EncodeError("", f"must be false or true, not {value!r}")
        if strict:
            refuse(self.violations(value, scope))
        return bool(value)

    def violations(self, value: bool, scope: Scope) -> list[Violation]:
        """A constant that does not hold."""
        if self.const is None or value == self.const:
            return []
        return [Violation("", f"must be {self.const}")]

    def to_json(self, value: bool, scope: Scope) -> bool:
        """False or true, also where the attribute is 0 or 1."""
        return bool(value)


def _is_bit(value: Any) -> bool:
    """True for a bool, also NumPy's, and for the integers 0 and 1."""
    if isinstance(value, Number) and not isinstance(value, Integral):
        return False
    try:
        return value in (0, 1)
    except ValueError:  # Whether an array of numbers equals one is no single question.
        return False
