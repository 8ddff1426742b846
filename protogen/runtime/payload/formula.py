"""Numbers and conditions that are worked out of earlier fields."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from protogen.runtime.attributes import schema_name


class Formula:
    """A function of earlier fields, and its text in the schema.

    Its parameters are called after the fields, whose values it is given raw: integers, or for a
    struct a mapping of its members.

        >>> Formula("n - 2", lambda n: n - 2).of({"n": 5}.__getitem__)
        3
    """

    __slots__ = ("_function", "_names", "_text")

    def __init__(self, text: str, function: Callable[..., int]) -> None:
        code = function.__code__
        self._names = [schema_name(name) for name in code.co_varnames[: code.co_argcount]]
        self._function = function
        self._text = text

    def of(self, look: Callable[[str], Any]) -> int:
        """The value, where `look` gives that of a field; of a condition, 0 or 1."""
        return int(self._function(*map(look, self._names)))

    def __str__(self) -> str:
        return self._text


def number_of(what: str | Formula, look: Callable[[str], Any]) -> int:
    """The number that a field has, or that a formula makes of fields."""
    return what.of(look) if isinstance(what, Formula) else int(look(what))
