"""Bounds of expressions, whatever the fields are, and the lines that some of them are."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from protogen.model.expressions import (
    COMPARISONS,
    Arithmetic,
    ArithmeticOperator,
    Comparison,
    Expression,
    Membership,
    Minus,
    Number,
    Operand,
    Quotient,
    every,
    names_in,
    nothing,
    value_of,
)

Interval = tuple[int, int]
"""The least and the greatest number that something can be."""

# --- bounds ---------------------------------------------------------------------------------------


def bounds_of(expression: Expression, of: Callable[[Operand], Interval]) -> Interval:
    """The bounds of the value, where those of each operand (the bits that count) are known."""
    match expression:
        case Number():
            return expression.value, expression.value
        case Operand():
            return of(expression)
        case Minus():
            low, high = bounds_of(expression.operand, of)
            return -high, -low
        case Arithmetic():
            left, right = bounds_of(expression.left, of), bounds_of(expression.right, of)
            return _arithmetic_bounds(expression.operator, left, right)
        case Quotient():
            low, high = bounds_of(expression.operand, of)
            return min(-1, low // expression.size), max(-1, high // expression.size)
    return 0, 1


def is_settled(expression: Expression, of: Callable[[Operand], Interval]) -> bool | None:
    """True or False where a comparison always or never holds, whatever the fields are; else None.

    A list of values of which one is never met is settled, too, as that one is.
    """
    if isinstance(expression, Membership):
        low, high = bounds_of(expression.operand, of)
        values = (value_of(value, nothing) for value in expression.values)
        return None if all(low <= value <= high for value in values) else False
    if not isinstance(expression, Comparison):
        return None
    left, right = bounds_of(expression.left, of), bounds_of(expression.right, of)
    compare = COMPARISONS[expression.operator]
    if expression.operator in ("==", "!="):
        is_apart = left[1] < right[0] or right[1] < left[0]
        return expression.operator == "!=" if is_apart else None
    ends = {compare(one, other) for one in left for other in right}
    return ends.pop() if len(ends) == 1 else None


def hull_of(expression: Expression, of: Callable[[Operand], Interval]) -> Interval:
    """The bounds of all numbers on the way to the value, itself included."""
    found = [bounds_of(item, of) for item in every(expression)]
    return min(low for low, _ in found), max(high for _, high in found)


def _arithmetic_bounds(operator: ArithmeticOperator, left: Interval, right: Interval) -> Interval:
    match operator:
        case "+":
            return left[0] + right[0], left[1] + right[1]
        case "-":
            return left[0] - right[1], left[1] - right[0]
        case "*":
            ends = [one * other for one in left for other in right]
            return min(ends), max(ends)
    divisor = right[0]
    if divisor < 1:
        return left  # Reported where it is seen; nothing is worked out of it.
    if operator == "//":
        return left[0] // divisor, left[1] // divisor
    same = left[0] // divisor == left[1] // divisor
    return (left[0] % divisor, left[1] % divisor) if same else (0, divisor - 1)


# --- inversion ------------------------------------------------------------------------------------


class Linear(NamedTuple):
    """`factor` x the field `name` + `offset`, which is `size` times the value."""

    name: str
    factor: int
    offset: int
    size: int = 1

    def inverse(self, value: int) -> int:
        """The field's number for a value; rounded down where none has just that."""
        return (value * self.size - self.offset) // self.factor

    def within(self, least: int, greatest: int) -> Interval:
        """The least and the greatest number of the field whose value is within these bounds."""
        if self.size > 1:
            whole = Linear(self.name, self.factor, self.offset)
            return whole.within(least * self.size, greatest * self.size)
        if self.factor < 0:
            return Linear(self.name, -self.factor, -self.offset).within(-greatest, -least)
        return -((self.offset - least) // self.factor), (greatest - self.offset) // self.factor


def linear(expression: Expression) -> Linear | None:
    """The expression as a line over one field; None where it is none."""
    if isinstance(expression, Quotient):
        whole = linear(expression.operand)
        return None if whole is None else whole._replace(size=expression.size)
    names = names_in(expression)
    found = _factors(expression)
    if len(names) != 1 or found is None or found[0] == 0:
        return None
    return Linear(next(iter(names)), *found)


def _factors(expression: Expression) -> tuple[int, int] | None:
    match expression:
        case Number():
            return 0, expression.value
        case Operand(run=None):
            return 1, 0
        case Minus():
            found = _factors(expression.operand)
            return None if found is None else (-found[0], -found[1])
        case Arithmetic():
            left, right = _factors(expression.left), _factors(expression.right)
            if left is not None and right is not None:
                return _joined(expression.operator, left, right)
    return None


def _joined(
    operator: ArithmeticOperator, left: tuple[int, int], right: tuple[int, int]
) -> tuple[int, int] | None:
    match operator:
        case "+":
            return left[0] + right[0], left[1] + right[1]
        case "-":
            return left[0] - right[0], left[1] - right[1]
        case "*" if 0 in (left[0], right[0]):
            return left[0] * right[1] + right[0] * left[1], left[1] * right[1]
    return None
