"""Expressions as Python."""

from __future__ import annotations

from collections.abc import Callable

from protogen.model.expressions import (
    Arithmetic,
    Expression,
    Level,
    Membership,
    Minus,
    Operand,
    Printer,
    Quotient,
    every,
    operands,
    plain_name,
)
from protogen.runtime.attributes import attribute
from protogen.targets.python.literals import call, text, tuple_of


class _PythonPrinter(Printer):
    def __init__(self, whole: Callable[[Operand], str]) -> None:
        self._whole = whole

    def operand(self, operand: Operand) -> str:
        """A field, or bits of one."""
        found = self._whole(operand)
        if operand.run is None:
            return found
        low, high = operand.run
        shifted = f"{found} >> {low}" if low else found
        return f"{shifted} & {hex((1 << (high - low + 1)) - 1)}"

    def level(self, expression: Expression) -> Level:
        """How tightly the expression binds; bits do so more loosely than sums."""
        is_run = isinstance(expression, Operand) and expression.run is not None
        return Level.COMPARISON if is_run else super().level(expression)

    def membership(self, membership: Membership) -> str:
        """A number that is one of some."""
        values = tuple_of(map(self.text, membership.values))
        return f"{self.inside(membership.operand, Level.SUM)} in {values}"

    def quotient(self, quotient: Quotient) -> str:
        """Elements in so many bytes, or -1."""
        number, size = self.inside(quotient.operand, Level.SIGN), quotient.size
        return f"(-1 if {number} % {size} else {number} // {size})"


def in_python(expression: Expression, whole: Callable[[Operand], str]) -> str:
    """The Python of an expression; `whole` gives that of a field."""
    return _PythonPrinter(whole).text(expression)


def in_integers(expression: Expression, whole: Callable[[Operand], str]) -> str:
    """The Python of an expression over what users give: NumPy's numbers would wrap around."""
    if not any(isinstance(item, Arithmetic | Minus) for item in every(expression)):
        return in_python(expression, whole)
    return in_python(expression, lambda operand: f"int({whole(operand)})")


def formula(expression: Expression) -> str:
    """What `FORMAT` and rules take: the name of a field, or a function of fields."""
    name = plain_name(expression)
    if name is not None:
        return text(name)
    names = dict.fromkeys(operand.path[0] for operand in operands(expression))
    function = f"lambda {', '.join(map(attribute, names))}: {in_python(expression, _member)}"
    return call("_rt.Formula", text(expression.text), function)


def _member(operand: Operand) -> str:
    first, *rest = operand.path
    return attribute(first) + "".join(f"[{text(name)}]" for name in rest)
