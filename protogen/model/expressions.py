"""Expressions: whole numbers worked out of earlier fields, and conditions on them.

`n - 2`, `words * 2`, `key.size`, `flags.has_gps and mode in [1, 2]`. A comparison is a condition,
as is what `and`, `or` and `not` make of others; a number is one that holds unless it is 0. Division
rounds down, and what remains is never negative: divisors are numbers above 0.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from functools import reduce
from typing import Any, ClassVar, Literal

from protogen.copying import replace

ArithmeticOperator = Literal["+", "-", "*", "//", "%"]
ComparisonOperator = Literal["==", "!=", "<", "<=", ">", ">="]


class Level(IntEnum):
    """How tightly what is printed binds, as in Python; within brackets it is an atom."""

    LOOSE = 0
    OR = 1
    AND = 2
    NOT = 3
    COMPARISON = 4
    SUM = 5
    PRODUCT = 6
    SIGN = 7
    ATOM = 8


_LEVELS: Mapping[str, Level] = {
    "or": Level.OR,
    "and": Level.AND,
    "+": Level.SUM,
    "-": Level.SUM,
    "*": Level.PRODUCT,
    "//": Level.PRODUCT,
    "%": Level.PRODUCT,
}

GREATEST_BITS = 62
"""Bits of the greatest number on the way, so that every target has one to hold it."""


class _Node:
    """Base of expressions."""

    __slots__ = ()
    is_condition: ClassVar[bool] = False
    """True if it is true or false rather than a number."""

    def __str__(self) -> str:
        """The expression with plain numbers, the same for all that mean the same values."""
        return Printer().text(self)  # type: ignore[arg-type]

    @property
    def text(self) -> str:
        """The expression as people write it, with the names of values."""
        return _Named().text(self)  # type: ignore[arg-type]


@dataclass(frozen=True, slots=True)
class Number(_Node):
    """A number, or the name of a value that stands for it."""

    value: int
    name: str = field(default="", compare=False)
    at: int = field(default=0, compare=False)
    """Offset of its first character in the text."""

    __str__ = _Node.__str__


@dataclass(frozen=True, slots=True)
class Operand(_Node):
    """An earlier field: its own name, those of members, and the run of bits of it that counts."""

    path: tuple[str, ...]
    run: tuple[int, int] | None = None
    """The lowest and the highest bit; None: the whole number."""
    bits: str = field(default="", compare=False)
    """The name of the run."""
    at: int = field(default=0, compare=False)

    __str__ = _Node.__str__

    @property
    def name(self) -> str:
        """The field as people write it, without bits: `header.key`."""
        return ".".join(self.path)

    @property
    def label(self) -> str:
        """The same with the name of the bits."""
        return f"{self.name}.{self.bits}" if self.bits else self.name

    def of(self, number: Any) -> Any:
        """The bits that count of the field's number."""
        if self.run is None:
            return number
        low, high = self.run
        return (number >> low) & ((1 << (high - low + 1)) - 1)


@dataclass(frozen=True, slots=True)
class Minus(_Node):
    """A number with the other sign."""

    operand: Expression
    at: int = field(default=0, compare=False)

    __str__ = _Node.__str__


@dataclass(frozen=True, slots=True)
class Arithmetic(_Node):
    """Two numbers put together."""

    operator: ArithmeticOperator
    left: Expression
    right: Expression
    at: int = field(default=0, compare=False)
    """Offset of the operator."""

    __str__ = _Node.__str__


@dataclass(frozen=True, slots=True)
class Quotient(_Node):
    """A number of bytes as one of elements, each of which has `size`; -1 where a part is left.

    No schema writes it: it is what counts where a size is given in bytes.
    """

    operand: Expression
    size: int
    at: int = field(default=0, compare=False)

    __str__ = _Node.__str__


@dataclass(frozen=True, slots=True)
class Comparison(_Node):
    """Two numbers compared."""

    operator: ComparisonOperator
    left: Expression
    right: Expression
    at: int = field(default=0, compare=False)
    is_condition: ClassVar[bool] = True

    __str__ = _Node.__str__


@dataclass(frozen=True, slots=True)
class Membership(_Node):
    """True if a number is one of some."""

    operand: Expression
    values: tuple[Expression, ...]
    """Numerals, once it is known what names stand for."""
    at: int = field(default=0, compare=False)
    is_condition: ClassVar[bool] = True

    __str__ = _Node.__str__


@dataclass(frozen=True, slots=True)
class Junction(_Node):
    """Both of two conditions, or one of them."""

    operator: Literal["and", "or"]
    left: Expression
    right: Expression
    at: int = field(default=0, compare=False)
    is_condition: ClassVar[bool] = True

    __str__ = _Node.__str__


@dataclass(frozen=True, slots=True)
class Not(_Node):
    """A condition that does not hold."""

    operand: Expression
    at: int = field(default=0, compare=False)
    is_condition: ClassVar[bool] = True

    __str__ = _Node.__str__


Expression = (
    Number | Operand | Minus | Arithmetic | Quotient | Comparison | Membership | Junction | Not
)


def named(name: str) -> Operand:
    """The expression that is nothing but an earlier field."""
    return Operand((name,))


def plain_name(expression: Expression) -> str | None:
    """The field, where the expression is nothing else; one beside it or around it."""
    if isinstance(expression, Operand) and expression.run is None and len(expression.path) == 1:
        return expression.path[0]
    return None


def inside(expression: Expression) -> tuple[Expression, ...]:
    """The expressions directly inside of one."""
    match expression:
        case Arithmetic() | Comparison() | Junction():
            return expression.left, expression.right
        case Minus() | Not() | Quotient():
            return (expression.operand,)
        case Membership():
            return (expression.operand, *expression.values)
    return ()


def every(expression: Expression) -> Iterator[Expression]:
    """The expression and all that are inside of it, those in front first."""
    yield expression
    for inner in inside(expression):
        yield from every(inner)


def operands(expression: Expression) -> tuple[Operand, ...]:
    """The fields that it is worked out of, in the order of its text."""
    return tuple(item for item in every(expression) if isinstance(item, Operand))


def names_in(expression: Expression) -> frozenset[str]:
    """The names of the fields that it is worked out of, each with its members."""
    return frozenset(item.name for item in operands(expression))


def rebuilt(expression: Expression, change: Callable[[Expression], Expression]) -> Expression:
    """The expression with everything in it changed, the innermost first."""
    match expression:
        case Arithmetic() | Comparison() | Junction():
            left, right = rebuilt(expression.left, change), rebuilt(expression.right, change)
            return change(replace(expression, left=left, right=right))
        case Minus() | Not() | Quotient():
            return change(replace(expression, operand=rebuilt(expression.operand, change)))
        case Membership():
            values = tuple(rebuilt(value, change) for value in expression.values)
            inner = rebuilt(expression.operand, change)
            return change(replace(expression, operand=inner, values=values))
    return change(expression)


# --- values ---------------------------------------------------------------------------------------

_ARITHMETIC: Mapping[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "//": operator.floordiv,
    "%": operator.mod,
}
COMPARISONS: Mapping[str, Callable[[Any, Any], Any]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
"""What the operators of comparisons do."""


def value_of(expression: Expression, look: Callable[[Operand], Any]) -> Any:
    """The value, a number or a boolean; `look` gives the number of a field, whole.

    NumPy's arrays of signed integers are numbers, too: then it is an array.
    """
    match expression:
        case Number():
            return expression.value
        case Operand():
            return expression.of(look(expression))
        case Minus() | Quotient():
            number = value_of(expression.operand, look)
            return -number if isinstance(expression, Minus) else _elements(number, expression.size)
        case Arithmetic():
            left, right = value_of(expression.left, look), value_of(expression.right, look)
            return _ARITHMETIC[expression.operator](left, right)
        case Comparison():
            left, right = value_of(expression.left, look), value_of(expression.right, look)
            return COMPARISONS[expression.operator](left, right)
        case Membership():
            number = value_of(expression.operand, look)
            found = (number == value_of(value, look) for value in expression.values)
            return reduce(operator.or_, found)
        case Junction():
            left, right = condition_of(expression.left, look), condition_of(expression.right, look)
            return left & right if expression.operator == "and" else left | right
        case Not():
            return condition_of(expression.operand, look) == False  # noqa: E712 - also of arrays


def _elements(number: Any, size: int) -> Any:
    """The elements of this size in so many bytes, or -1; also of arrays."""
    count, left = number // size, number % size
    return count - (left != 0) * (count + 1)


def condition_of(expression: Expression, look: Callable[[Operand], Any]) -> Any:
    """True where the condition holds; a number does unless it is 0."""
    found = value_of(expression, look)
    return found if expression.is_condition else found != 0


def reached(values: Mapping[str, Any], name: str) -> Any:
    """The value of a field, or of a member inside of one: `header.count`."""
    found: Any = values
    for step in name.split("."):
        found = found[step]
    return found


def folded(expression: Expression, known: Callable[[Operand], int | None]) -> Expression:
    """The expression with the numbers that never change in place of their fields."""

    def change(item: Expression) -> Expression:
        if isinstance(item, Operand):
            value = known(item)
            return item if value is None else Number(item.of(value))
        if all(isinstance(inner, Number) for inner in inside(item)):
            return Number(int(value_of(item, nothing)))
        return item

    return rebuilt(expression, change)


def nothing(operand: Operand) -> int:
    """Look nothing up: the expression has no fields. Raises AssertionError."""
    raise AssertionError(operand)


# --- text -----------------------------------------------------------------------------------------


class Printer:
    """Prints expressions, here with plain numbers; subclasses print them for a language."""

    words: Mapping[str, str] = {}
    """What stands for an operator where the language has another one."""

    def text(self, expression: Expression) -> str:
        """The expression."""
        return self.inside(expression, Level.LOOSE)

    def numeral(self, numeral: Number) -> str:
        """A number."""
        return str(numeral.value)

    def operand(self, operand: Operand) -> str:
        """A field, or bits of one."""
        if operand.run is None:
            return operand.name
        return f"{operand.name}[{operand.run[0]}..{operand.run[1]}]"

    def membership(self, membership: Membership) -> str:
        """A number that is one of some."""
        values = ", ".join(map(self.text, membership.values))
        operand = self.inside(membership.operand, Level.SUM)
        return f"{operand} {self.word('in')} [{values}]"

    def arithmetic(self, arithmetic: Arithmetic) -> str:
        """Two numbers put together."""
        level = _LEVELS[arithmetic.operator]
        return self._between(arithmetic, level, Level(level + 1))

    def quotient(self, quotient: Quotient) -> str:
        """A number of bytes as one of elements, in brackets."""
        return f"({self.inside(quotient.operand, Level.PRODUCT)} / {quotient.size})"

    def word(self, operator: str) -> str:
        """An operator."""
        return self.words.get(operator, operator)

    def inside(self, expression: Expression, level: Level) -> str:
        """The expression, in brackets where those around it bind as tightly as `level` says."""
        text = self.bare(expression)
        return f"({text})" if self.level(expression) < level else text

    def level(self, expression: Expression) -> Level:
        """How tightly the expression binds."""
        match expression:
            case Arithmetic() | Junction():
                return _LEVELS[expression.operator]
            case Comparison() | Membership():
                return Level.COMPARISON
            case Not():
                return Level.NOT
            case Minus():
                return Level.SIGN
            case Number() if expression.value < 0:
                return Level.SIGN
        return Level.ATOM

    def bare(self, expression: Expression) -> str:
        """The expression without brackets around it."""
        match expression:
            case Number():
                return self.numeral(expression)
            case Operand():
                return self.operand(expression)
            case Minus():
                return f"-{self.inside(expression.operand, Level.ATOM)}"
            case Arithmetic():
                return self.arithmetic(expression)
            case Quotient() | Membership():
                return self._special(expression)
            case Not():
                return f"{self.word('not ')}{self.inside(expression.operand, Level.NOT)}"
            case Comparison():
                return self._between(expression, Level.SUM, Level.SUM)
            case Junction():
                level = _LEVELS[expression.operator]
                return self._between(expression, level, level)

    def _special(self, item: Quotient | Membership) -> str:
        return self.quotient(item) if isinstance(item, Quotient) else self.membership(item)

    def _between(
        self, item: Arithmetic | Comparison | Junction, in_front: Level, behind: Level
    ) -> str:
        """Both sides of an operator, each in brackets unless it binds as tightly as it has to."""
        left, right = self.inside(item.left, in_front), self.inside(item.right, behind)
        return f"{left} {self.word(item.operator)} {right}"


class _Named(Printer):
    """Prints with the names that people gave to values and bits."""

    def numeral(self, numeral: Number) -> str:
        return numeral.name or super().numeral(numeral)

    def operand(self, operand: Operand) -> str:
        return operand.label

    def quotient(self, quotient: Quotient) -> str:
        return super().quotient(quotient)[1:-1]  # There is nothing around it.
