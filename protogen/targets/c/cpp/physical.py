"""Functions between raw and physical values, of fields whose schema states a scale or an offset."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

import msgspec

from protogen.c_language.numbers import constant, integer_type, number
from protogen.model.types import Field
from protogen.targets.c.comments import comment
from protogen.targets.c.cpp.names import CppNames
from protogen.targets.naming import inside


class CppPhysical(msgspec.Struct, frozen=True):
    """The two functions of a field."""

    doc: tuple[str, ...]
    to_physical: str
    to_raw: str
    type: str
    """The type of the raw value."""
    physical: str
    """The physical value of `raw`."""
    scaled: str
    """The raw value of `physical`, not rounded yet."""
    least: str
    greatest: str


def cpp_physical(record: str, fields: Sequence[Field], cpp: CppNames) -> Iterator[CppPhysical]:
    """The functions of a record's fields."""
    for field in fields:
        integer = field.integer
        if not field.scaled or integer is None or field.least is None or field.greatest is None:
            continue
        thing = inside(record, "field", field.name)
        unit = f", in {field.unit}" if field.unit else ""
        yield CppPhysical(
            doc=comment(
                [f"{record}.{field.name}{unit}: the physical value, and the nearest raw one."]
            ),
            to_physical=cpp.of(thing, record, field.name, "physical"),
            to_raw=cpp.of(thing, record, field.name, "raw"),
            type=integer_type(integer),
            physical=_sum(_product("static_cast<Real>(raw)", field.scale), field.offset),
            scaled=_product(
                _group(_sum("static_cast<Real>(physical)", -field.offset)), 1 / field.scale
            ),
            least=constant(int(field.least), integer),
            greatest=constant(int(field.greatest), integer),
        )


def _product(value: str, factor: Fraction) -> str:
    times = "" if factor.numerator == 1 else f" * {_real(factor.numerator)}"
    return value + times + ("" if factor.denominator == 1 else f" / {_real(factor.denominator)}")


def _sum(value: str, offset: Fraction) -> str:
    if not offset:
        return value
    sign = "-" if offset < 0 else "+"
    return (
        f"{value} {sign} {_product(_real(abs(offset.numerator)), Fraction(1, offset.denominator))}"
    )


def _group(value: str) -> str:
    return f"({value})" if " " in value else value


def _real(value: int) -> str:
    # No integer of C holds such a one; `L`, so that it is as exact as any `Real`.
    text = number(value) if value < 1 << 63 else f"{value}.0L"
    return f"static_cast<Real>({text})"
