"""A problem in what the user wrote, and the collector that every stage reports to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import msgspec

from protogen.problems.catalogue import CODES
from protogen.problems.severity import Severity
from protogen.problems.span import Span

Note = tuple[Span | None, str]
"""A further place, where there is one, and what is to be seen there."""

SortKey = tuple[str, int, int, str, str]


class Problem(msgspec.Struct, frozen=True):
    """A problem, its place, and how to fix it. Problems order by file, line, column and code."""

    code: str
    severity: Severity
    span: Span | None
    message: str
    hint: str | None = None
    notes: tuple[Note, ...] = ()

    @classmethod
    def of(
        cls,
        code: str,
        span: Span | None,
        message: str,
        hint: str | None = None,
        notes: Iterable[Note] = (),
    ) -> Problem:
        """Return the problem with the severity that the catalogue gives to ``code``.

        Raises KeyError if the catalogue has no such code, which is a bug in the caller.
        """
        return cls(code, CODES[code].severity, span, message, hint, tuple(notes))

    @property
    def sort_key(self) -> SortKey:
        """Key that problems are ordered by; those without a place come first."""
        file, line, column = _place(self.span)
        return file, line, column, self.code, self.message

    def __lt__(self, other: Problem) -> bool:
        return self.sort_key < other.sort_key


class Problems:
    """Collects problems. Iterating yields each distinct problem once, in order of place."""

    def __init__(self, problems: Iterable[Problem] = ()) -> None:
        # A dictionary rather than a set keeps the order of arrival among equal sort keys.
        self._problems: dict[Problem, None] = dict.fromkeys(problems)

    def add(
        self,
        code: str,
        span: Span | None,
        message: str,
        hint: str | None = None,
        notes: Iterable[Note] = (),
    ) -> None:
        """Report the problem that `Problem.of` makes of the arguments."""
        self.extend([Problem.of(code, span, message, hint, notes)])

    def extend(self, problems: Iterable[Problem]) -> None:
        """Take over problems that were collected elsewhere."""
        self._problems.update(dict.fromkeys(problems))

    @property
    def errors(self) -> list[Problem]:
        """The problems that stop the compiler, in order of place."""
        return [problem for problem in self if problem.severity is Severity.ERROR]

    def __iter__(self) -> Iterator[Problem]:
        return iter(sorted(self._problems, key=lambda problem: problem.sort_key))

    def __len__(self) -> int:
        return len(self._problems)


def _place(span: Span | None) -> tuple[str, int, int]:
    return ("", 0, 0) if span is None else (span.file, span.line, span.column)
