"""The texts of the files that were read, so that a problem can show its line."""

from __future__ import annotations

import re
from typing import NamedTuple

# What counts as a line break in a schema; the document layer refuses the other ones of Unicode.
_LINE_BREAK = re.compile(r"\r\n|\n|\r")


class Position(NamedTuple):
    """A line and a column, both counted from 1."""

    line: int
    column: int


_START = Position(1, 1)


def split_lines(text: str) -> list[str]:
    """Return the lines of ``text`` without their breaks."""
    return _LINE_BREAK.split(text)


def end_of(text: str, start: Position = _START) -> Position:
    """Return the place behind ``text``, which starts at ``start``."""
    first, *others = split_lines(text)
    if not others:
        return Position(start.line, start.column + len(first))
    return Position(start.line + len(others), len(others[-1]) + 1)


class SourceMap:
    """Maps a file, named as in spans, to its text."""

    def __init__(self) -> None:
        self._texts: dict[str, str] = {}
        self._lines: dict[str, list[str]] = {}

    def add(self, file: str, text: str) -> None:
        """Remember the text of ``file``."""
        self._texts[file] = text
        self._lines.pop(file, None)

    @property
    def files(self) -> tuple[str, ...]:
        """Every file that was read."""
        return tuple(self._texts)

    def text(self, file: str) -> str | None:
        """Return the text of ``file``, or None if it was never read."""
        return self._texts.get(file)

    def line(self, file: str, number: int) -> str | None:
        """Return line ``number``, counted from 1, or None if there is no such line."""
        if file not in self._texts:
            return None
        if file not in self._lines:
            self._lines[file] = split_lines(self._texts[file])
        lines = self._lines[file]
        return lines[number - 1] if 1 <= number <= len(lines) else None
