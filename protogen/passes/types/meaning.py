"""Meaning of a field's values, checked to fit the field."""

from __future__ import annotations

import sys
from fractions import Fraction
from functools import lru_cache

from protogen.model.meanings import NamedValue
from protogen.model.numbers import FreeNumeral
from protogen.model.reading.readings import decimal
from protogen.model.types import (
    NO_OFFSET,
    UNSCALED,
    Array,
    Constant,
    Field,
    Float,
    NumberType,
    Type,
    is_integer,
)
from protogen.passes.context import Context, about
from protogen.passes.types.constants import read_constant
from protogen.passes.types.declared import Effective
from protogen.passes.types.separators import absent_value
from protogen.passes.types.type_names import UNKNOWN_TYPE
from protogen.passes.types.value_names import named_values
from protogen.schema.text.scalars import exact_number

_NUMERIC_KEYS = ("range", "scale", "offset", "special", "unit")


def attach(context: Context, name: str, type_: Type, item: Effective) -> Field:
    """The field of this type, with bounds, constants, scale and special values checked."""
    check = _Check(context, name, type_, item)
    check.keys_fit()
    least, greatest = check.bounds()
    const = read_constant(context, "const", type_, item)
    default = read_constant(context, "default", type_, item)
    check.constants_agree(const, default)
    syntax = item.syntax
    return Field(
        name=name,
        type=type_,
        position=item.setting.position,
        const=const,
        default=default,
        least=least,
        greatest=greatest,
        ranged=syntax.range is not None,
        scale=check.scale(),
        offset=syntax.offset if syntax.offset is not None else NO_OFFSET,
        unit=syntax.unit,
        special=check.special(),
        unknown=syntax.unknown,
        renamed_from=syntax.renamed_from,
        about=about(syntax.doc, syntax.source, context.find_key(item.chain[0][1])),
    )


@lru_cache(maxsize=256)
def _whole(number: int) -> Fraction:
    """The number as a fraction, made once for all types that have it as a bound."""
    return Fraction(number)


class _Check:
    """The questions about one field; each answers with a value that is safe to go on with."""

    def __init__(self, context: Context, name: str, type_: Type, item: Effective) -> None:
        self._context = context
        self._name = name
        self._element = type_.element if isinstance(type_, Array) else type_
        self._field = item
        self._item = item.syntax

    def keys_fit(self) -> None:
        """Keys about numbers stand only on numbers, `closed` only on enums."""
        number = isinstance(self._element, NumberType) and self._element.role != "bool"
        for key in _NUMERIC_KEYS:
            if getattr(self._item, key) is not None and not number:
                self._error("PG110", key, f"`{key}` is for numbers, and `{self._name}` is none")
        unit = self._item.unit
        if unit is not None and unit != "1" and exact_number(unit) is not None:
            text = f"the unit of `{self._name}` is a number, {unit}"
            hint = f"name the unit, such as `mm`; a factor is `scale: {unit}`"
            self._context.warning("PG125", self._field.at("unit"), text, hint)
        if self._item.closed and self._item.values is None:
            self._error("PG110", "closed", "`closed` is for a field that has `values`")

    def constants_agree(self, const: Constant | None, default: Constant | None) -> None:
        """Nothing but the constant can be the default."""
        if const is not None and default is not None and const != default:
            self._error("PG114", "default", "`default` differs from `const`")

    def bounds(self) -> tuple[Fraction | None, Fraction | None]:
        """The raw bounds: the range, else what the type can hold (None for floats)."""
        type_, written = self._element, self._item.range
        if type_ is UNKNOWN_TYPE:
            return None, None  # Reported where it is named.
        if not is_integer(type_):
            if written is None or not isinstance(type_, NumberType):
                return None, None
            if isinstance(type_, Float) and any(abs(end) > type_.greatest for end in written):
                text = f"`range` goes beyond what {type_.name} holds: {float(type_.greatest)}"
                self._error("PG114", "range", text)
                return None, None
            return self._ordered(*written)
        form = type_.text
        # A number that is absent is none of those that digits can have.
        most = form.greatest if isinstance(form, FreeNumeral) else type_.greatest
        least, greatest = _whole(type_.least), _whole(most)
        if written is None:
            return least, greatest
        low, high = self._ordered(*written)
        for end in (low, high):
            if end.denominator != 1 or not least <= end <= greatest:
                text = f"{decimal(end)} is not a raw value of {self._item.type}: "
                text += f"{least} to {greatest}"
                self._error("PG114", "range", text, self._raw_range(low, high))
                return least, greatest
        return low, high

    def _raw_range(self, low: Fraction, high: Fraction) -> str | None:
        """What to write if the bounds are physical values."""
        scale, offset = self._item.scale or self._usual_scale, self._item.offset or NO_OFFSET
        raw = [(end - offset) / scale for end in (low, high)]
        if raw == [low, high] or any(end.denominator != 1 for end in raw):
            return None
        words = f"for {decimal(low)} to {decimal(high)} write [{raw[0]}, {raw[1]}]"
        return f"a range is one of raw values: {words}"

    def _ordered(self, low: Fraction, high: Fraction) -> tuple[Fraction, Fraction]:
        if low > high:
            self._error("PG115", "range", f"the range is empty: {low} is greater than {high}")
            return high, low
        return low, high

    def scale(self) -> Fraction:
        """The scale; zero would lose every value."""
        if self._item.scale is None and self._item.offset is None:
            return self._usual_scale
        scale = self._item.scale if self._item.scale is not None else self._usual_scale
        if scale == 0:
            self._error("PG123", "scale", "a scale of zero makes every value the same")
            return UNSCALED
        for key, offset in (("scale", NO_OFFSET), ("offset", self._item.offset)):
            if offset is not None and not self._is_readable(scale, offset):
                self._error("PG123", key, f"`{key}` makes physical values that no float64 holds")
                return UNSCALED
        return scale

    @property
    def _usual_scale(self) -> Fraction:
        """The scale where none is stated: of a decimal, that of its last digit."""
        form = self._element.text if is_integer(self._element) else None
        if isinstance(form, FreeNumeral) and form.fraction:
            return Fraction(1, 10**form.fraction)
        return UNSCALED

    def _is_readable(self, scale: Fraction, offset: Fraction) -> bool:
        """True if physical values, and the scale itself, fit the numbers that programs use."""
        ends = (self._element.least, self._element.greatest) if is_integer(self._element) else (1,)
        greatest = max(abs(scale), abs(offset), *(abs(end * scale + offset) for end in ends))
        return greatest <= sys.float_info.max and abs(scale) >= sys.float_info.min

    def special(self) -> tuple[NamedValue, ...]:
        """The raw values that mean that there is no reading."""
        absent = absent_value(self._element, self._field)
        if self._item.special is None or not is_integer(self._element):
            return absent
        bounds = (self._element.least, self._element.greatest)
        here = self._field.at("special")
        named = named_values(self._context, bounds, self._item.special, here, self._item.type)
        return (*named, *absent)

    def _error(self, code: str, key: str, text: str, hint: str | None = None) -> None:
        self._context.error(code, self._field.at(key), text, hint)
