"""Prints problems: as text with the source line, as JSON, and as annotations of GitHub.

Whether a console takes colour is for the caller to decide: `render_text` is plain, `render_rich`
has styles, and both have the same characters.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from protogen.problems.problem import Problem
from protogen.problems.severity import Severity
from protogen.problems.sources import SourceMap
from protogen.problems.span import Span

if TYPE_CHECKING:
    from rich.text import Text

_Segment = tuple[str, str]
"""Text and its rich style."""

_STYLES = {Severity.ERROR: "bold red", Severity.WARNING: "bold yellow", Severity.NOTE: "bold cyan"}
_GITHUB_COMMANDS = {
    Severity.ERROR: "error",
    Severity.WARNING: "warning",
    Severity.NOTE: "notice",
}
_GREATEST_EXCERPT = 160
"""The most characters of a source line that are shown."""
_EXCERPT_LEAD = 40
"""Number of characters kept before the place in a line that is cut."""
_STAND_INS = {"\t": " ", "\xa0": " "}


def render_text(problem: Problem, sources: SourceMap) -> str:
    """Return the problem as lines of plain text, without a line break at the end."""
    return "".join(text for text, _ in _segments(problem, sources))


def render_rich(problem: Problem, sources: SourceMap) -> Text:
    """Return the same text as `render_text`, with styles."""
    from rich.text import Text

    return Text.assemble(*_segments(problem, sources))


def to_json(problems: Iterable[Problem]) -> list[dict[str, object]]:
    """Return the problems as objects that `json.dumps` takes."""
    return [
        {
            "code": problem.code,
            "severity": problem.severity.value,
            **_json_place(problem.span),
            "message": problem.message,
            "hint": problem.hint,
            "notes": [{**_json_place(span), "message": text} for span, text in problem.notes],
        }
        for problem in problems
    ]


def to_github(problem: Problem) -> str:
    """Return the workflow command that makes GitHub show the problem beside its line."""
    span = problem.span
    properties = {"title": problem.code}
    if span is not None:
        place = {"file": span.file, "line": str(span.line), "col": str(span.column)}
        properties = place | properties
    listed = ",".join(f"{name}={_github_property(value)}" for name, value in properties.items())
    lines = [problem.message] if problem.hint is None else [problem.message, problem.hint]
    message = "%0A".join(map(_github_data, lines))
    return f"::{_GITHUB_COMMANDS[problem.severity]} {listed}::{message}"


def printable(text: str) -> str:
    """Return ``text`` with every character that a terminal might obey written as an escape."""
    return "".join(
        character if character.isprintable() else _escaped(character) for character in text
    )


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")


def _segments(problem: Problem, sources: SourceMap) -> Iterator[_Segment]:
    style = _STYLES[problem.severity]
    yield _place(problem.span), "bold"
    yield f"{problem.severity.value}[{problem.code}]", style
    yield f": {printable(problem.message)}", "bold"
    yield from _excerpt(problem.span, sources, style)
    if problem.hint is not None:
        yield from (("\n  hint: ", "green"), (printable(problem.hint), ""))
    for span, text in problem.notes:
        yield from (("\n  note: ", "cyan"), (_place(span), ""), (printable(text), ""))
        yield from _excerpt(span, sources, "cyan")


def _place(span: Span | None) -> str:
    return "" if span is None else f"{printable(span.file)}:{span.line}:{span.column}: "


def _excerpt(span: Span | None, sources: SourceMap, style: str) -> Iterator[_Segment]:
    line = None if span is None else sources.line(span.file, span.line)
    if span is None or line is None:
        return
    start = min(span.column - 1, len(line))
    end = min(span.end_column - 1, len(line)) if span.end_line == span.line else len(line)
    before, marked, after = _cut(line, start, max(start, end))
    gutter = f"{span.line:>5} | "
    yield f"\n{gutter}", "dim"
    yield before + marked + after, ""
    yield f"\n{' ' * (len(gutter) - 2)}| {' ' * _columns(before)}", "dim"
    yield "^" + "~" * (_columns(marked) - 1), style


def _cut(line: str, start: int, end: int) -> tuple[str, str, str]:
    """Return what of ``line`` is shown before, inside and behind the place from start to end."""
    first = 0 if len(line) <= _GREATEST_EXCERPT else max(0, start - _EXCERPT_LEAD)
    last = min(len(line), first + _GREATEST_EXCERPT)
    before = ("…" if first else "") + _one_cell(line[first:start])
    after = _one_cell(line[min(end, last) : last]) + ("…" if last < len(line) else "")
    return before, _one_cell(line[start : min(end, last)]), after


def _one_cell(text: str) -> str:
    """Return ``text`` with one printable character for each of its characters."""
    return "".join(
        character if character.isprintable() else _STAND_INS.get(character, "\ufffd")
        for character in text
    )


def _columns(text: str) -> int:
    """Count the columns of a terminal that ``text`` takes."""
    return sum(_width(character) for character in text)


def _width(character: str) -> int:
    if unicodedata.combining(character):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


def _json_place(span: Span | None) -> dict[str, object]:
    if span is None:
        return {"file": None, "line": None, "column": None, "end_line": None, "end_column": None}
    return {
        "file": span.file,
        "line": span.line,
        "column": span.column,
        "end_line": span.end_line,
        "end_column": span.end_column,
    }


def _github_data(text: str) -> str:
    return printable(text).replace("%", "%25")


def _github_property(text: str) -> str:
    return _github_data(text).replace(":", "%3A").replace(",", "%2C")
