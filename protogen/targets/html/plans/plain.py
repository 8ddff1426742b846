"""Plain data: what JSON and JavaScript hold.

Numbers that a JavaScript number does not hold exactly are texts, as are fractions. What most things
do not have is left out.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from protogen.model.expressions import (
    Arithmetic,
    Comparison,
    Expression,
    Junction,
    Membership,
    Minus,
    Not,
    Number,
    Operand,
    Quotient,
)

_EXACT = 1 << 53
Json = dict[str, Any]


def number(value: int) -> int | str:
    """The number, as a text where JavaScript would round it."""
    return value if abs(value) < _EXACT else str(value)


def fraction(value: Fraction) -> str:
    """Numerator and denominator."""
    return f"{value.numerator}/{value.denominator}"


def expression(item: Expression) -> Any:
    """An expression as a list: what it is, and what is inside of it."""
    match item:
        case Number():
            return number(item.value)
        case Operand():
            return ["field", item.name, *(item.run or ())]
        case Minus():
            return ["minus", expression(item.operand)]
        case Quotient():
            return ["elements", expression(item.operand), item.size]
        case Arithmetic() | Comparison() | Junction():
            return [item.operator, expression(item.left), expression(item.right)]
        case Membership():
            return ["in", expression(item.operand), *map(expression, item.values)]
        case Not():
            return ["not", expression(item.operand)]


def lean(found: Json) -> Json:
    """What is there; a number is, also 0."""
    return {key: value for key, value in found.items() if not _is_nothing(value)}


def _is_nothing(value: Any) -> bool:
    return value is None or value is False or (not value and isinstance(value, str | list | dict))
