"""Marked blocks in hand-written Markdown: what stands between two marks is generated.

    <!-- protogen:rover.drive -->
    <!-- /protogen -->

Marks stand on lines of their own and outside of fenced code. Everything around them stays as it is.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec

from protogen.problems import Problems, SourceMap, Span

_OPENING = re.compile(r" {0,3}<!--\s*protogen:\s*(\S+?)\s*-->\s*")
_CLOSING = re.compile(r" {0,3}<!--\s*/protogen\s*-->\s*")
_FENCE = re.compile(r" {0,3}(`{3,}|~{3,})")

Lookup = Callable[[str, Span], str | None]
"""Gives the text for a name that stands at a place; None where there is none, which is reported."""


class Page(msgspec.Struct, frozen=True):
    """A hand-written file, and what should stand in it."""

    path: Path
    old: bytes
    new: bytes

    @property
    def is_current(self) -> bool:
        """True if there is nothing to write."""
        return self.old == self.new


class _Block(msgspec.Struct, frozen=True):
    """A block: the numbers of the lines of its marks, counted from 0, and the name in it."""

    opening: int
    closing: int
    name: str
    place: Span


def fill_page(path: Path, lookup: Lookup, problems: Problems, sources: SourceMap) -> Page | None:
    """Return the file with its blocks filled; None if it can't be read, which is reported."""
    try:
        old = path.read_bytes()
        text = old.decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        problems.add("PG033", Span.of_file(str(path)), f"the file can't be read: {error}")
        return None
    sources.add(str(path), text)
    return Page(path, old, _filled(text, str(path), lookup, problems).encode("utf-8"))


def write_page(page: Page) -> None:
    """Write the file in one step. It keeps its permissions, and a link to it stays one."""
    path = page.path.resolve()
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        temporary.write_bytes(page.new)
        shutil.copymode(path, temporary)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def _filled(text: str, file: str, lookup: Lookup, problems: Problems) -> str:
    lines = re.findall(r"[^\n]*\n|[^\n]+", text)
    pieces: list[str] = []
    behind = 0
    for block in _blocks(lines, file, problems):
        content = lookup(block.name, block.place)
        if content is None:
            continue
        pieces += lines[behind : block.opening + 1]
        ending = "\r\n" if lines[block.opening].endswith("\r\n") else "\n"
        pieces.append(f"\n{content}\n\n".replace("\n", ending))
        behind = block.closing
    return "".join([*pieces, *lines[behind:]])


def _blocks(lines: list[str], file: str, problems: Problems) -> Iterator[_Block]:
    """Yield the blocks in order; marks without their counterparts are reported."""
    opening: tuple[int, re.Match[str]] | None = None
    for number, line in _lines_of_text(lines):
        if mark := _OPENING.fullmatch(line):
            if opening is not None:
                _report_open(*opening, file, problems)
            opening = (number, mark)
        elif closing := _CLOSING.fullmatch(line):
            if opening is None:
                place = _span(closing, file, number)
                problems.add("PG035", place, "here a block ends, but none has begun")
                continue
            start, mark = opening
            place = Span.at(file, start + 1, mark.start(1) + 1, len(mark[1]))
            yield _Block(start, number, mark[1], place)
            opening = None
    if opening is not None:
        _report_open(*opening, file, problems)


def _report_open(number: int, mark: re.Match[str], file: str, problems: Problems) -> None:
    hint = "end it with `<!-- /protogen -->` on a line of its own"
    problems.add("PG035", _span(mark, file, number), f"the block `{mark[1]}` has no end", hint)


def _span(mark: re.Match[str], file: str, number: int) -> Span:
    text = mark[0].rstrip()
    start = len(text) - len(text.lstrip())
    return Span.at(file, number + 1, start + 1, len(text) - start)


def _lines_of_text(lines: list[str]) -> Iterator[tuple[int, str]]:
    """Yield the lines outside of fenced code, with their numbers."""
    fence = ""
    for number, line in enumerate(lines):
        mark = _FENCE.match(line)
        if not fence:
            fence = mark[1] if mark else ""
            if not fence:
                yield number, line
        elif mark and mark[1].startswith(fence) and not line[mark.end() :].strip():
            fence = ""
