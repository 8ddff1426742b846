"""Place in a source file."""

from __future__ import annotations

import msgspec


class Span(msgspec.Struct, frozen=True, order=True, gc=False):
    """A stretch of a source file.

    Lines and columns count from 1, columns in characters. The end is exclusive: ``end_column``
    is the column behind the last character. An empty stretch marks the place between two
    characters. Spans order by file, line and column. Every value of a schema has one, so the
    garbage collector is not told of them: they hold nothing but a text and numbers.
    """

    file: str
    line: int
    column: int
    end_line: int
    end_column: int

    @classmethod
    def at(cls, file: str, line: int, column: int, width: int = 1) -> Span:
        """Return the span of ``width`` characters on one line."""
        return cls(file, line, column, line, column + width)

    @classmethod
    def of_file(cls, file: str) -> Span:
        """Return the empty span at the start of ``file``, for what concerns the file as a whole."""
        return cls(file, 1, 1, 1, 1)

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"
