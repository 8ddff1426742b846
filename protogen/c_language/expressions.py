"""Expressions as C: in one type that holds every number on the way, so that none overflows."""

from __future__ import annotations

from collections.abc import Callable

from protogen.c_language.numbers import constant, integer_type, unsigned
from protogen.model.expression_bounds import Interval, bounds_of
from protogen.model.expressions import (
    Arithmetic,
    ArithmeticOperator,
    Comparison,
    Expression,
    Junction,
    Level,
    Membership,
    Not,
    Number,
    Operand,
    Printer,
    Quotient,
)
from protogen.model.payload_plan import Formula
from protogen.model.types import Integer

WIDEST = Integer(bits=64, signed=True)
"""The type of numbers of which nothing is known."""


def type_for(hull: Interval) -> Integer:
    """The narrowest type for numbers within bounds; none is narrower than every `int`."""
    least, greatest = hull
    bits = max(greatest.bit_length(), (-least - 1).bit_length() if least < 0 else 0)
    bits = max(16, 1 << (bits + (least < 0) - 1).bit_length())
    return Integer(bits=bits, signed=least < 0)


def floored(operator: ArithmeticOperator, number: str, divisor: str) -> str:
    """C that rounds down, from which nothing negative remains; in it no number overflows."""
    word = "/" if operator == "//" else operator
    return f"{number} < 0 ? {_below_zero(operator, number, divisor)} : {number} {word} {divisor}"


def _below_zero(operator: ArithmeticOperator, number: str, divisor: str) -> str:
    """The same of a number below 0."""
    turned = f"(-1 - {number})"
    return (
        f"-1 - {turned} / {divisor}"
        if operator == "//"
        else f"{divisor} - 1 - {turned} % {divisor}"
    )


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

    def numeral(self, numeral: Number) -> str:
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
        least, greatest = bounds_of(arithmetic.left, self.bounds)
        if arithmetic.operator not in ("//", "%") or least >= 0:
            return super().arithmetic(arithmetic)
        assert isinstance(arithmetic.right, Number)
        if greatest >= 0:
            return self.floored(arithmetic.operator, arithmetic.left, arithmetic.right)
        number = self.inside(arithmetic.left, Level.SIGN)
        return f"({_below_zero(arithmetic.operator, number, self.numeral(arithmetic.right))})"

    def quotient(self, quotient: Quotient) -> str:
        """Elements in so many bytes, or -1; a number of one type with a sign."""
        number, size = self.inside(quotient.operand, Level.SIGN), Number(quotient.size)
        divisor, zero, none = map(self.numeral, (size, Number(0), Number(-1)))
        return f"({number} % {divisor} == {zero} ? {number} / {divisor} : {none})"

    def floored(self, operator: ArithmeticOperator, left: Expression, right: Number) -> str:
        """A quotient that is rounded down, or what remains of it, of what may be negative."""
        number, divisor = self.inside(left, Level.SIGN), self.numeral(right)
        return f"({floored(operator, number, divisor)})"

    def membership(self, membership: Membership) -> str:
        """One comparison for each value."""
        number = self.compared(membership.operand)
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
        return self.truth(expression, holds=True)

    def truth(self, expression: Expression, *, holds: bool) -> str:
        """The condition that a number is not 0, or that it is."""
        word = "!=" if holds else "=="
        return f"{self.compared(expression)} {word} {constant(0, self.type)}"

    def compared(self, expression: Expression) -> str:
        """A number beside a comparison; narrow ones that are put together are a signed `int`."""
        is_narrow = not self.type.signed and self.type.bits < 32
        if is_narrow and isinstance(expression, Arithmetic):
            return f"({integer_type(self.type)})({self.text(expression)})"
        return self.inside(expression, Level.SUM)

    def bare(self, expression: Expression) -> str:
        """The expression without brackets around it."""
        match expression:
            case Junction():
                sides = (self._side(it, expression) for it in (expression.left, expression.right))
                return f" {self.word(expression.operator)} ".join(sides)
            case Not() if expression.operand.is_condition:
                return f"!{self.inside(expression.operand, Level.ATOM)}"
            case Not():
                return self.truth(expression.operand, holds=False)
            case Comparison():
                left, right = self.compared(expression.left), self.compared(expression.right)
                return f"{left} {expression.operator} {right}"
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

    def operand(self, operand: Operand) -> str:
        """A field, or bits of one."""
        if self._is_bool(operand):
            ends = constant(1, self.type), constant(0, self.type)
            return f"({self.whole(operand)} ? {' : '.join(ends)})"
        return super().operand(operand)

    def truth(self, expression: Expression, *, holds: bool) -> str:
        """The condition that a number is not 0, or that it is."""
        if isinstance(expression, Operand) and self._is_bool(expression):
            return f"{'' if holds else '!'}{self.whole(expression)}"
        return super().truth(expression, holds=holds)

    def _is_bool(self, operand: Operand) -> bool:
        type_ = self._formula.references[operand.name].type
        return type_ is not None and type_.role == "bool"

    def cast(self, operand: Operand) -> str:
        """What makes a field's number one of the common type; nothing where it is one."""
        type_ = self._formula.references[operand.name].type
        is_same = type_ is not None and integer_type(type_) == integer_type(self.type)
        return "" if is_same else super().cast(operand)
