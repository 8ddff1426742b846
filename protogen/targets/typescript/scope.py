"""What a generated function has said so far: its lines, its variables, and constants beside it."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.model.payload_plan import Reference
from protogen.targets.braces import BracedLines
from protogen.targets.naming import NameTable, Thing
from protogen.targets.typescript.literals import Code
from protogen.targets.typescript.names import Names, locals_table


class Constants:
    """Constants of a module that functions share, each made once."""

    def __init__(self, names: Names) -> None:
        self._names = names
        self._made: dict[tuple[str, str], str] = {}

    def add(self, word: str, type_: str, value: str) -> Code:
        """The name of a constant with this value."""
        found = self._made.get((type_, value))
        if found is None:
            found = self._names.module.add(f"{word}_{len(self._made) + 1}", Thing(value))
            self._made[type_, value] = found
        return Code(found)

    def __iter__(self) -> Iterator[tuple[str, str, str]]:
        """The name, the type and the value of each."""
        return ((name, type_, value) for (type_, value), name in self._made.items())


class Scope(BracedLines):
    """Lines and variables of one function."""

    def __init__(self, names: Names, constants: Constants) -> None:
        super().__init__(indent=2)
        self.names = names
        self.constants = constants
        self._locals: NameTable = locals_table()
        self._count = 0
        self._numbers: dict[tuple[int, str], str] = {}
        """Expressions of earlier numbers, by the level of their record and their names."""

    def variable(self, word: str) -> Code:
        """A new variable, called like this if nothing else is."""
        self._count += 1
        return Code(self._locals.add(word or "value", Thing("variable", ("local", self._count))))

    def know(self, level: int, name: str, expression: str) -> None:
        """Keep where an earlier number is."""
        self._numbers[level, name] = expression

    def inner(self, level: int, name: str) -> None:
        """Keep the numbers of a record at the next level as those of a member at this one."""
        for (own, inside), expression in list(self._numbers.items()):
            if own == level + 1:
                self._numbers[level, f"{name}.{inside}"] = expression

    def forget(self, level: int) -> None:
        """Forget the numbers of a record that begins anew."""
        for key in [key for key in self._numbers if key[0] >= level]:
            del self._numbers[key]

    def known(self, level: int, name: str) -> str:
        """What `know` kept."""
        return self._numbers[level, name]

    def look(self, reference: Reference) -> str:
        """The expression of an earlier number."""
        return self._numbers[reference.level, reference.name]
