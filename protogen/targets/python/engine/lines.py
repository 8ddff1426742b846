"""Lines of a printed function, and the constants that it uses."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

from protogen.model.types import NumberType, Text
from protogen.targets.python.formats import numeral, padded_text
from protogen.targets.python.names import Names
from protogen.targets.python.wrapping import WIDTH, wrapped

_INDENT = "    "


class Constants:
    """The module's constants of the fast engine: each expression gets one name."""

    def __init__(self, names: Names) -> None:
        self.classes = names.types
        """The class of each message and type."""
        self._names: dict[str, str] = {}
        self._counts: Counter[str] = Counter()

    def named(self, kind: str, expression: str) -> str:
        """The name of an expression's value; `kind` begins it."""
        if expression not in self._names:
            self._names[expression] = f"_{kind}_{self._counts[kind]}"
            self._counts[kind] += 1
        return self._names[expression]

    def number(self, type_: NumberType) -> str:
        """The name of what reads and writes an integer that `struct` does not know."""
        if type_.text is not None:
            return self.named("NUMBER", numeral(type_))
        seven = type_.byte_bits == 7
        arguments = f'{type_.bits}, {type_.signed}, "{type_.byte_order}", {seven}'
        return self.named("NUMBER", f"_rt.Number({arguments})")

    def padded(self, type_: Text) -> str:
        """The name of what reads and writes a text with another padding, or in a code."""
        return self.named("TEXT", padded_text(type_))

    def use(self, name: str) -> bool:
        """True if some constant so far is made by something of that name."""
        return any(expression.startswith(name) for expression in self._names)

    @property
    def text(self) -> tuple[str, ...]:
        """One assignment for each."""
        return tuple(
            # A table is laid out already.
            f"{name} = {expression}"
            if "\n" in expression
            else f"{name} = {wrapped(expression, len(name) + 3, 0, after=0)}"
            for expression, name in self._names.items()
        )


class Lines:
    """The body of a function, written from top to bottom."""

    def __init__(self, constants: Constants) -> None:
        self.constants = constants
        self.classes = constants.classes
        self._lines: list[str] = []
        self._depth = 0
        self._locals = 0

    @property
    def is_nested(self) -> bool:
        """True if statements are inside of a compound one."""
        return self._depth > 0

    def add(self, line: str) -> None:
        """One statement."""
        self._lines.append(_INDENT * self._depth + self._broken(line))

    def _broken(self, line: str) -> str:
        """A statement whose expression is broken at commas where it does not fit."""
        if len(_INDENT) * (self._depth + 1) + len(line) <= WIDTH:
            return line
        for word in ("return ", " = "):
            start, found, expression = line.partition(word)
            if found and " for " not in expression:
                indent = len(_INDENT) * (self._depth + 1)
                column = indent + len(start + word)
                return start + word + wrapped(expression, column, indent, after=0)
        return line

    def refuse_if(self, condition: str) -> None:
        """Leave it to the reference where the condition holds."""
        self.add(f"if {condition}:")
        self.add(f"{_INDENT}raise _fast.NeedsReference")

    def local(self, kind: str = "v") -> str:
        """A fresh local name."""
        self._locals += 1
        return f"{kind}{self._locals}"

    @contextmanager
    def block(self, head: str) -> Iterator[None]:
        """A compound statement."""
        self.add(head)
        self._depth += 1
        yield
        self._depth -= 1

    @property
    def text(self) -> tuple[str, ...]:
        """All lines so far."""
        return tuple(self._lines)
