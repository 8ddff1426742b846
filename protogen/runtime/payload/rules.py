"""Rules: what the values of a field mean, which of them can be sent, and how JSON shows them.

A rule stands between the attribute of a message and the value that its `FORMAT` builds and parses:
`FORMAT` knows bytes, rules know values. Strict encoding refuses what `violations` calls forbidden;
with `strict=False` only what does not fit the wire is refused.
"""

from __future__ import annotations

from collections import ChainMap
from typing import Any, Generic, NamedTuple, TypeVar

from protogen.runtime.errors import EncodeError, join_path
from protogen.runtime.payload.formula import Formula, number_of

ConstT = TypeVar("ConstT")

Scope = ChainMap[str, Any]
"""Raw values of the fields in front, of this struct and of those around it."""


class Violation(NamedTuple):
    """A value that the schema does not foresee.

    `forbidden`: strict encoding refuses it. Otherwise it has no name in the schema, but it may be
    sent.
    """

    path: str
    problem: str
    forbidden: bool = True

    def inside(self, outer: str) -> Violation:
        """The same violation as seen by what holds the field."""
        return self._replace(path=join_path(outer, self.path))

    def __str__(self) -> str:
        return f"{self.path}: {self.problem}" if self.path else self.problem


class Rule:
    """Base of all rules. `scope` holds the raw values of the fields in front."""

    def chosen(self, scope: Scope) -> Rule:
        """The rule that holds here. Raises EncodeError if there is none."""
        return self

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> Any:
        """The value that FORMAT builds. Raises EncodeError."""
        raise NotImplementedError

    def from_wire(self, raw: Any, scope: Scope) -> Any:
        """The attribute's value for what FORMAT parsed."""
        return raw

    def violations(self, value: Any, scope: Scope) -> list[Violation]:
        """Violations of the schema by a value that fits the wire."""
        return []

    def to_json(self, value: Any, scope: Scope) -> Any:
        """The value as JSON shows it."""
        return value

    def from_json(self, data: Any, scope: Scope) -> Any:
        """The value of what JSON shows. Raises EncodeError where it is of another kind."""
        return data


def refuse(violations: list[Violation]) -> None:
    """Raise EncodeError for the first forbidden value."""
    for violation in violations:
        if violation.forbidden:
            raise EncodeError(violation.path, violation.problem)


class SeveralRule(Rule, Generic[ConstT]):
    """Base of rules for values of which there may be several: `size`, or as earlier fields say.

    None: to the end of the payload, or in front of the byte `until`, `least` to `greatest`.
    """

    def __init__(
        self,
        size: int | str | Formula | None = None,
        greatest: int | None = None,
        const: ConstT | None = None,
        least: int = 0,
        until: int | None = None,
    ) -> None:
        self.size = size
        self.until = until
        self.least = least
        self.greatest = greatest
        self.const = const

    def _check_count(self, count: int, scope: Scope, what: str) -> None:
        exactly, says = self.size, ""
        if isinstance(exactly, str | Formula):
            exactly, says = number_of(exactly, scope.__getitem__), f", as {self.size} says"
        if exactly is not None and exactly < 0:
            raise EncodeError("", f"has {count} {what}, and {self.size} is no number of them")
        if exactly is not None and count != exactly:
            raise EncodeError("", f"needs exactly {exactly} {what}{says}, not {count}")
        check_most(count, self.greatest, what)
        if count < self.least:
            raise EncodeError("", f"has {count} {what}, at least {self.least} are needed")

    def _check_end(self, data: bytes) -> None:
        """Refuse bytes of which one would end them."""
        if self.until is not None and self.until in data:
            place = f"byte {data.index(self.until) + 1} of {len(data)}"
            raise EncodeError("", f"has {self.until:02X}, which would end it, as {place}")


def check_most(count: int, greatest: int | None, what: str) -> None:
    """Refuse more than `greatest` elements or bytes."""
    if greatest is not None and count > greatest:
        raise EncodeError("", f"has {count} {what}, at most {greatest} are allowed")
