"""Places of the parser's events in a text, as a reader sees them.

The marks of PyYAML count from 0, take anchors and tags for a part of their node, and let block
scalars and block collections reach to the next token.
"""

from __future__ import annotations

import re
from typing import Any

from protogen.problems import Span
from protogen.problems.sources import Position, end_of, split_lines

_PROPERTIES = re.compile(r"(?:(?:&[\w-]+|![^\s,\[\]{}]*)\s*(?:#.*\s*)*)+", re.ASCII)
"""Anchor and tag before a node, with the white space and comments behind them."""
_TAG = re.compile(r"![^\s,\[\]{}]*")
_BLOCK_STYLES = ("|", ">")


class Places:
    """Turns the marks of events in the text of one file into spans."""

    def __init__(self, text: str, file: str) -> None:
        self._text = text
        self._file = file

    def span(self, start: Position, end: Position) -> Span:
        """Return the span between two positions."""
        return Span(self._file, start.line, start.column, end.line, end.column)

    def at(self, start: Position, width: int) -> Span:
        """Return the span of ``width`` characters on one line."""
        return Span.at(self._file, start.line, start.column, width)

    def point(self, start: Position) -> Span:
        """Return the span of the character at a position, which may lie behind all text.

        The parser sees that something is missing where the file ends, on a line that need not be
        there; to a reader that is behind the last character.
        """
        lines = split_lines(self._text)
        if start.line <= len(lines) and start.column <= len(lines[start.line - 1]):
            return self.at(start, 1)
        behind = end_of(self._text.rstrip())
        return self.at(min(start, behind), 0)

    def of_file(self) -> Span:
        """Return the span for what concerns the file as a whole."""
        return Span.of_file(self._file)

    def begin(self, event: Any) -> Position:
        """Return where a node starts, behind its anchor and tag."""
        mark = event.start_mark
        if event.anchor is None and event.tag is None:
            return position_of(mark)
        properties = _PROPERTIES.match(self._text, mark.index)
        return end_of("" if properties is None else properties[0], position_of(mark))

    def scalar(self, event: Any) -> Span:
        """Return the span of a scalar that is written out."""
        start, end = event.start_mark, event.end_mark
        if event.style not in _BLOCK_STYLES:
            if event.anchor is None and event.tag is None:  # As nearly all, so in one step.
                line, end_line = start.line + 1, end.line + 1
                return Span(self._file, line, start.column + 1, end_line, end.column + 1)
            return self.span(self.begin(event), position_of(end))
        text = self._text[start.index : end.index].rstrip()
        return self.span(self.begin(event), end_of(text, position_of(start)))

    def tag(self, event: Any) -> tuple[str, Span]:
        """Return the tag of a node as it is written, and its span."""
        mark = event.start_mark
        # An anchor may stand before the tag; it has no exclamation mark.
        start = self._text.index("!", mark.index)
        match = _TAG.match(self._text, start)
        tag = "!" if match is None else match[0]
        place = end_of(self._text[mark.index : start], position_of(mark))
        return tag, self.at(place, len(tag))


def position_of(mark: Any) -> Position:
    """Return the position of a mark of PyYAML."""
    return Position(mark.line + 1, mark.column + 1)
