"""Long lines of C, broken as clang-format lays out what is broken."""

from __future__ import annotations

import re
from collections.abc import Iterator

import msgspec

from protogen.targets.c.lines import WIDTH, prototype
from protogen.targets.folding import block_comment, folded

_OPENING, _CLOSING = "([{", ")]}"
_HEAD = re.compile(r"(?P<function>\w[\w *]*)\((?P<arguments>[^()]+)\)(?P<end>;| \{)$")
"""The head of a function without functions among its arguments."""
_VALUE = re.compile(r"\s*(?:return |[^=(]* = )?")
"""Text in front of a value outside of brackets."""
_OPERATOR = re.compile(r"(?:&&| \||\|\|)$")
"""Operators behind which a line is broken."""
_CONDITION = re.compile(r"(?:&&|\|\|)$")
"""Operators behind which it is broken even where what stands in front is too long."""


_STARRED = re.compile(r" *\* (?=\S)(?!.*\*/)")
"""A line of a comment in front of its last one; not one of an example, which is indented."""
_OPENED = re.compile(r"(?P<indent> *)/\*\*? (?=\S)(?!.*\*/.)")
"""The first line of a comment that begins there, and has nothing behind it."""

_END = "\N{NO-BREAK SPACE}*/"
"""The end of a comment, which stays behind its last word."""


class _Break(msgspec.Struct, frozen=True):
    """A place where a line can be broken."""

    end: int
    """Column behind what stays on the line."""
    margins: tuple[int, ...]
    """Columns behind the brackets that are open there."""
    column: int
    """Column at which the rest is aligned."""
    asked: dict[int, int]
    """Columns of the question marks whose answers go on, by how many brackets are open."""
    joins: bool = True
    """True behind an operator, or in front of what a condition else comes to."""


def wrapped(text: str) -> str:
    """The text with every line on at most so many columns, where that can be.

    A macro that goes on below is left as it is.
    """
    lines = list(_folded_comments(text.split("\n")))
    before = ["", *lines]
    return "\n".join(
        [
            line if len(line) <= WIDTH or above.endswith("\\") else _broken(line)
            for above, line in zip(before, lines, strict=False)
        ]
    )


def _folded_comments(lines: list[str]) -> Iterator[str]:
    """The lines, with those of a comment's paragraph anew where one of them is too long."""
    end = 0
    while end < len(lines):
        start, line = end, lines[end]
        end += 1
        starred, opened = _STARRED.match(line), _OPENED.match(line)
        if starred:
            while _STARRED.match(lines[end]) and lines[end].startswith(starred[0]):
                end += 1
        elif opened:
            while not lines[end - 1].endswith("*/"):
                end += 1
        paragraph = lines[start:end]
        if max(map(len, paragraph)) <= WIDTH or not (starred or opened):
            yield from paragraph
        elif starred:
            text = " ".join(item.removeprefix(starred[0]) for item in paragraph)
            yield from _folded(text, starred[0], starred[0])
        elif opened:
            indent, text = opened["indent"], " ".join(map(str.strip, paragraph))
            if text.startswith("/** "):
                doc = block_comment([text[len("/** ") : -len(" */")]], WIDTH - len(indent))
                yield from (f"{indent}{item}" for item in doc)
            else:
                text = text[len("/* ") : -len(" */")] + _END
                yield from _folded(text, f"{indent}/* ", f"{indent}   ")


def _folded(text: str, lead: str, behind: str) -> Iterator[str]:
    for number, line in enumerate(folded(text, WIDTH - len(lead), at_hyphens=False)):
        yield f"{behind if number else lead}{line}".replace(_END, " */")


def _broken(line: str) -> str:
    head = _HEAD.match(line)
    if head is None:
        return "\n".join(_parts(line, (), {}))
    return prototype(head["function"], tuple(head["arguments"].split(", ")), head["end"])


def _parts(line: str, margins: tuple[int, ...], asked: dict[int, int]) -> Iterator[str]:
    is_code = not line.lstrip().startswith(("*", "/*", "#"))
    breaks = _breaks(line, margins, asked) if is_code and (margins or len(line) > WIDTH) else []
    # What stands on several lines is alone in front of an operator.
    found = next(
        (b for b in breaks if b.joins and len(b.margins) < len(margins) and b.end <= WIDTH), None
    )
    if found is None and len(line) > WIDTH:
        found = min(
            (item for item in breaks if item.end <= WIDTH),
            key=lambda item: (len(item.margins), -item.end),
            default=next((item for item in breaks if _CONDITION.search(line, 0, item.end)), None),
        )
    if found is None:
        yield line
        return
    yield line[: found.end]
    rest = " " * found.column + line[found.end :].lstrip()
    yield from _parts(rest, found.margins, found.asked)


def _breaks(line: str, margins: tuple[int, ...], before: dict[int, int]) -> list[_Break]:
    """The places behind commas and operators, and in front of what a condition else comes to."""
    indent = len(line) - len(line.lstrip())
    value = None if margins else _VALUE.match(line)
    outside = value.end() if value and value.end() > indent else indent + (0 if margins else 4)
    opened = list(margins)
    asked = dict(before)
    found: list[_Break] = []
    for column, sign in enumerate(line):
        if sign in _OPENING:
            opened.append(column + 1)
        elif sign in _CLOSING and opened:
            asked.pop(len(opened), None)
            opened.pop()
        elif sign == "?":
            asked[len(opened)] = column
            # A condition on several lines would want its question on one of its own.
            found = [item for item in found if len(item.margins) < len(opened)]
        elif sign == ":" and len(opened) in asked:
            found.append(_Break(column - 1, tuple(opened), asked[len(opened)], {}))
        elif column > indent and line[column + 1 : column + 2] == " ":
            is_operator = _OPERATOR.search(line, max(column - 2, 0), column + 1) is not None
            if (sign in ",;" and opened) or (is_operator and len(opened) not in asked):
                margin = opened[-1] if opened else outside
                found.append(
                    _Break(column + 1, tuple(opened), margin, dict(asked), joins=is_operator)
                )
    return found
