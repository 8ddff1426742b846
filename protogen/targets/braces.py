"""Statements of a language with braces, one below the other."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


class BracedLines:
    """A growing list of lines, each with its indent."""

    def __init__(self, indent: int, depth: int = 0) -> None:
        self._lines: list[str] = []
        self._indent = indent
        self._depth = depth

    @property
    def margin(self) -> str:
        """The blanks in front of a line at the current depth."""
        return " " * (self._indent * self._depth)

    def add(self, *lines: str) -> None:
        """Add lines at the current depth."""
        self._lines += [self.margin + line for line in lines]

    @contextmanager
    def block(self, head: str, end: str = "}") -> Iterator[None]:
        """Lines between braces."""
        self.add(f"{head} {{")
        self._depth += 1
        yield
        self._depth -= 1
        self.add(end)

    @property
    def lines(self) -> tuple[str, ...]:
        """All lines."""
        return tuple(self._lines)
