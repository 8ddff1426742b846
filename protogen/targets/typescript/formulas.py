"""Formulas of earlier numbers, in JavaScript."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from protogen.model.expressions import (
    Arithmetic,
    Expression,
    Level,
    Membership,
    Not,
    Number,
    Operand,
    Printer,
    Quotient,
)
from protogen.model.payload_plan import Formula, Reference
from protogen.targets.typescript.literals import GREATEST_BITS, integer, is_big

Look = Callable[[Reference], str]
"""Gives the JavaScript for an earlier number."""

_SHIFTED_BITS = 31


class _JavaScript(Printer):
    """Prints with numbers, or all with `bigint`."""

    words: Mapping[str, str] = {"and": "&&", "or": "||", "==": "===", "!=": "!=="}

    def __init__(self, formula: Formula, look: Look) -> None:
        self._formula = formula
        self._look = look
        self.big = _needs_big(formula)

    def numeral(self, numeral: Number) -> str:
        return integer(numeral.value, big=self.big)

    def operand(self, operand: Operand) -> str:
        reference = self._formula.references[operand.name]
        found = self._look(reference)
        type_ = reference.type
        if operand.run is not None:
            low, high = operand.run
            if type_ is None or type_.bits > _SHIFTED_BITS or type_.role == "bool":
                found = f"rt.bits({found}, {low}, {high})"
            else:
                moved = f"{found} >> {low}" if low else found
                found = f"({moved} & {(1 << high - low + 1) - 1})"
            return f"BigInt({found})" if self.big else found
        if self.big and not (type_ is not None and is_big(type_.bits)):
            return f"BigInt({found})"
        is_truth = type_ is None or type_.role == "bool"
        return f"Number({found})" if is_truth and not self.big else found

    def membership(self, membership: Membership) -> str:
        values = ", ".join(map(self.text, membership.values))
        return f"[{values}].includes({self.text(membership.operand)})"

    def arithmetic(self, arithmetic: Arithmetic) -> str:
        if arithmetic.operator not in ("//", "%"):
            return super().arithmetic(arithmetic)
        name = "floor" if arithmetic.operator == "//" else "modulo"
        given = f"{self.text(arithmetic.left)}, {self.text(arithmetic.right)}"
        return f"rt.{name}({given})"

    def quotient(self, quotient: Quotient) -> str:
        size = integer(quotient.size, big=self.big)
        return f"rt.elements({self.text(quotient.operand)}, {size})"

    def bare(self, expression: Expression) -> str:
        if isinstance(expression, Not):
            return f"!({self.text(expression.operand)})"
        return super().bare(expression)

    def level(self, expression: Expression) -> Level:
        is_called = isinstance(expression, Membership | Not) or (
            isinstance(expression, Arithmetic) and expression.operator in ("//", "%")
        )
        return Level.ATOM if is_called else super().level(expression)


def _needs_big(formula: Formula) -> bool:
    types = [item.type for item in formula.references.values()]
    has_big = any(type_ is not None and is_big(type_.bits) for type_ in types)
    least, greatest = formula.hull
    return has_big or max(-least, greatest) >> GREATEST_BITS > 0


def number(formula: int | Formula, look: Look) -> str:
    """A number that counts or selects."""
    if isinstance(formula, int):
        return str(formula)
    printer = _JavaScript(formula, look)
    found = printer.text(formula.expression)
    is_number = not printer.big and not formula.expression.is_condition
    return found if is_number else f"Number({found})"


def condition(formula: int | Formula, look: Look) -> str:
    """A condition; a number is one that holds unless it is 0."""
    if isinstance(formula, int):
        return "true" if formula else "false"
    printer = _JavaScript(formula, look)
    found = printer.text(formula.expression)
    if formula.expression.is_condition:
        return found
    return f"{found} !== {integer(0, big=printer.big)}"
