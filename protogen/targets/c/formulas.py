"""Expressions as C: in one type that holds every number on the way, so that none overflows."""

from __future__ import annotations

from collections.abc import Callable

from protogen.model.expressions import (
    Arithmetic,
    ArithmeticOperator,
    Expression,
    Interval,
    Junction,
    Level,
    Membership,
    Not,
    Numeral,
    Operand,
    Printer,
    bounds_of,
)
from protogen.model.payload_plan import Formula
from protogen.model.types import Integer
from protogen.targets.c.spelling import constant, integer_type, unsigned


def type_for(hull: Interval) -> Integer:
    """The narrowest type for numbers within bounds; none is narrower than every `int`."""
    least, greatest = hull
    bits = max(greatest.bit_length(), (-least - 1).bit_length() if least < 0 else 0)
    bits = max(16, 1 << (bits + (least < 0) - 1).bit_length())
    return Integer(bits=bits, signed=least < 0)


def floored(operator: ArithmeticOperator, number: str, divisor: str) -> str:
    """C that rounds down, from which nothing negative remains; in it no number overflows."""
    turned = f"(-1 - {number})"
    if operator == "//":
        return f"{number} < 0 ? -1 - {turned} / {divisor} : {number} / {divisor}"
    return f"{number} < 0 ? {divisor} - 1 - {turned} % {divisor} : {number} % {divisor}"


class CPrinter(Printer):
    """Prints expressions whose numbers all have one type."""

    words = {"and": "&&", "or": "||", "not ": "!", "//": "/"}  # noqa: RUF012 - as that of the base

    def __init__(self, type_: Integer) -> None:
        self.type = type_

    def whole(self, operand: Operand) -> str:
        """The C of a field."""
        raise NotImplementedError

    def bounds(self, operand: Operand) -> Interval:
        """The bounds of a field, or of the bits that count of it."""
        raise NotImplementedError

    def cast(self, operand: Operand) -> str:
        """What makes a field's number one of the common type."""
        return f"({integer_type(self.type)})"

    def numeral(self, numeral: Numeral) -> str:
        """A number of the common type."""
        return constant(numeral.value, self.type)

    def operand(self, operand: Operand) -> str:
        """A field, or bits of one."""
        found = self.whole(operand)
        if operand.run is None:
            return f"{self.cast(operand)}{found}"
        low, high = operand.run
        shifted = f"({found} >> {low}U)" if low else found
        mask = unsigned((1 << (high - low + 1)) - 1)
        return f"({integer_type(self.type)})({shifted} & {mask})"

    def arithmetic(self, arithmetic: Arithmetic) -> str:
        """C rounds towards 0, and what remains of a negative number is negative."""
        least, _ = bounds_of(arithmetic.left, self.bounds)
        if arithmetic.operator not in ("//", "%") or least >= 0:
            return super().arithmetic(arithmetic)
        assert isinstance(arithmetic.right, Numeral)
        return self.floored(arithmetic.operator, arithmetic.left, arithmetic.right)

    def floored(self, operator: ArithmeticOperator, left: Expression, right: Numeral) -> str:
        """A quotient that is rounded down, or what remains of it, of what may be negative."""
        number, divisor = self.inside(left, Level.SIGN), self.numeral(right)
        return f"({floored(operator, number, divisor)})"

    def membership(self, membership: Membership) -> str:
        """One comparison for each value."""
        number = self.inside(membership.operand, Level.SUM)
        return " || ".join(f"{number} == {self.text(value)}" for value in membership.values)

    def level(self, expression: Expression) -> Level:
        """How tightly the expression binds."""
        match expression:
            case Membership():
                return Level.OR if len(expression.values) > 1 else Level.COMPARISON
            case Not():
                return Level.SIGN if expression.operand.is_condition else Level.COMPARISON
        return super().level(expression)

    def condition(self, expression: Expression, level: Level = Level.LOOSE) -> str:
        """A condition, also where it is written as a number."""
        if expression.is_condition:
            return self.inside(expression, level)
        return self._compared(expression, "!=")

    def _compared(self, expression: Expression, operator: str) -> str:
        return f"{self.inside(expression, Level.SUM)} {operator} {constant(0, self.type)}"

    def bare(self, expression: Expression) -> str:
        """The expression without brackets around it."""
        match expression:
            case Junction():
                sides = (self._side(it, expression) for it in (expression.left, expression.right))
                return f" {self.word(expression.operator)} ".join(sides)
            case Not() if expression.operand.is_condition:
                return f"!{self.inside(expression.operand, Level.ATOM)}"
            case Not():
                return self._compared(expression.operand, "==")
        return super().bare(expression)

    def _side(self, side: Expression, around: Junction) -> str:
        """A condition in brackets where the other operator joins it."""
        level = self.level(side)
        is_joined = level in (Level.OR, Level.AND) and level is not self.level(around)
        return self.condition(side, Level.ATOM if is_joined else Level.LOOSE)


class FormulaPrinter(CPrinter):
    """Prints a formula of a payload plan; `whole` gives the C of a field."""

    def __init__(self, formula: Formula, whole: Callable[[Operand], str]) -> None:
        super().__init__(type_for(formula.hull))
        self._formula = formula
        self._whole = whole

    def whole(self, operand: Operand) -> str:
        """The C of a field."""
        return self._whole(operand)

    def bounds(self, operand: Operand) -> Interval:
        """The bounds of a field, or of the bits that count of it."""
        return self._formula.bounds_of(operand)

    def cast(self, operand: Operand) -> str:
        """What makes a field's number one of the common type; nothing where it is one."""
        type_ = self._formula.references[operand.name].type
        is_same = type_ is not None and integer_type(type_) == integer_type(self.type)
        return "" if is_same else super().cast(operand)
