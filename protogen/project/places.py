"""Places of keys in a TOML file. The parser of the standard library does not tell.

The file was parsed before, so a search line by line is enough: it knows headers of tables, dotted
keys and inline tables. What it does not find has the place of the table around it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from protogen.problems import Span
from protogen.problems.sources import split_lines

Steps = Sequence[str | int]
Names = tuple[str, ...]

_NAME = r"""(?:[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*')"""
_DOTTED = rf"{_NAME}(?:\s*\.\s*{_NAME})*"
_HEADER = re.compile(rf"\s*\[\[?\s*({_DOTTED})\s*\]")
_KEY = re.compile(rf"\s*({_DOTTED})\s*=")
_WORD = re.compile(_NAME)


class _Key(NamedTuple):
    """A key, or the header of a table, with its whole path."""

    path: Names
    span: Span


def place_of(text: str, file: str, loc: Steps, value: object = None) -> Span:
    """Return the place of the key at `loc`; where `value` is a text, the value's own."""
    names = tuple(step for step in loc if isinstance(step, str))
    key = _closest(_keys(text, file), names)
    if key is None:
        return Span.of_file(file)
    inside = names[len(key.path) :]
    words = [inside[-1]] if inside else [f'"{value}"', f"'{value}'"]
    found = (_below(text, key.span, word) for word in words) if inside or value else ()
    return next(filter(None, found), key.span)


def _closest(keys: Iterable[_Key], names: Names) -> _Key | None:
    """Return the key itself, or what is nearest around it."""
    around = [key for key in keys if key.path == names[: len(key.path)]]
    return max(around, key=lambda key: len(key.path), default=None)


def _keys(text: str, file: str) -> Iterator[_Key]:
    table: Names = ()
    for number, line in enumerate(split_lines(text), start=1):
        if header := _HEADER.match(line):
            table = _names(header[1])
            yield _Key(table, _span(file, number, header))
        elif key := _KEY.match(line):
            yield _Key((*table, *_names(key[1])), _span(file, number, key))


def _names(dotted: str) -> Names:
    return tuple(name.strip("\"'") for name in _WORD.findall(dotted))


def _span(file: str, number: int, match: re.Match[str]) -> Span:
    return Span.at(file, number, match.start(1) + 1, len(match[1]))


def _below(text: str, key: Span, word: str) -> Span | None:
    """Return the first place of a word behind a key, up to the next key."""
    pattern = re.compile(rf"(?<![\w-]){re.escape(word)}(?![\w-])")
    for number, line in enumerate(split_lines(text)[key.line - 1 :], start=key.line):
        start = key.end_column - 1 if number == key.line else 0
        if number > key.line and (_KEY.match(line) or _HEADER.match(line)):
            return None
        if found := pattern.search(line, start):
            return Span.at(key.file, number, found.start() + 1, len(word))
    return None
