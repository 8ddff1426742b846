"""Long expressions over several lines, as formatters lay them out."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable

from protogen.targets.folding import folded

WIDTH = 100
_INDENT = 4
_OPENING = "([{"
_CLOSING = ")]}"
_SIGN = re.compile(r'"(?:[^"\\]|\\.)*"?|[](){}[,]', re.DOTALL)
"""A string, a bracket or a comma."""


def wrapped(expression: str, column: int, indent: int, after: int = 1) -> str:
    """The expression, broken at commas where it does not fit.

    It starts at `column` of a line that is indented by `indent`; `after` characters follow it.
    """
    if column + len(expression) + after <= WIDTH:
        return expression
    opening = _last_opening(expression)
    if opening is None:
        return expression
    head, items = expression[: opening + 1], _items(expression[opening + 1 : -1])
    if not items:
        return expression
    inner = indent + _INDENT
    is_several = len(items) > 1 or expression[-2] == ","
    comma = "," if is_several or _takes_a_comma(head) else ""
    lines = [f"{' ' * inner}{wrapped(item, inner, inner)}{comma}" for item in items]
    return "\n".join([head, *lines, " " * indent + expression[-1]])


def _takes_a_comma(head: str) -> bool:
    """True if a comma behind the only item in the brackets that `head` opens changes nothing.

    Behind an index, or what only stands in brackets, it makes a tuple.
    """
    is_behind_value = head[-2:-1].isalnum() or head[-2:-1] in ("_", *_CLOSING)
    return is_behind_value == (head[-1] == "(")


def _last_opening(expression: str) -> int | None:
    """Place of the bracket that opens what closes at the end of the expression."""
    if expression[-1] not in _CLOSING:
        return None
    opened: list[int] = []
    for place, sign in _signs(expression):
        if sign in _OPENING:
            opened.append(place)
        elif sign in _CLOSING:
            start = opened.pop()
            if place == len(expression) - 1:
                return start
    return None


def _items(inside: str) -> list[str]:
    """The parts between the commas that are in no further brackets."""
    items: list[str] = []
    depth = start = 0
    for place, sign in _signs(inside):
        depth += (sign in _OPENING) - (sign in _CLOSING)
        if sign == "," and depth == 0:
            items.append(inside[start:place].strip())
            start = place + 1
    items.append(inside[start:].strip())
    return [item for item in items if item]


def _signs(expression: str) -> list[tuple[int, str]]:
    """The brackets and commas outside of strings, with their places."""
    found = ((sign.start(), sign[0]) for sign in _SIGN.finditer(expression))
    return [(place, sign) for place, sign in found if sign[0] != '"']


_LONGEST_CHAIN = 200
"""Python nests each `|` in the next, and compiles only so many levels."""
_UNION = "_typing.Union["


def one_of(members: Iterable[str]) -> str:
    """The union of these types."""
    listed = list(dict.fromkeys(members))
    long = len(listed) > _LONGEST_CHAIN
    return f"{_UNION}{', '.join(listed)}]" if long else " | ".join(listed)


def union(start: str, members: str, indent: int) -> str:
    """`start` and a union of types, in brackets where it does not fit one line."""
    if indent + len(start) + len(members) <= WIDTH:
        return start + members
    if _UNION in members:
        return start + _long_union(members, indent)
    margin, inner = " " * indent, " " * (indent + _INDENT)
    if len(inner) + len(members) <= WIDTH:
        return f"{start}(\n{inner}{members}\n{margin})"
    first, *others = members.split(" | ")
    lines = [f"{inner}{first}", *(f"{inner}| {other}" for other in others)]
    return "\n".join([f"{start}(", *lines, f"{margin})"])


def _long_union(members: str, indent: int) -> str:
    text = wrapped(members, WIDTH, indent)
    return text.replace(f"{_UNION}\n", f"{_UNION}  # noqa: UP007\n")


def method(start: str, parameters: str, end: str, indent: int, after: int = 0) -> str:
    """The head of a function; its parameters have lines of their own where they do not fit.

    `after` characters follow it.
    """
    if indent + len(start) + len(parameters) + len(end) + after <= WIDTH:
        return f"{start}{parameters}{end}"
    margin = " " * indent
    if indent + _INDENT + len(parameters) > WIDTH:
        inner = " " * (indent + _INDENT)
        lines = [f"{_parameter(item, inner)}," for item in _items(parameters)]
        return "\n".join([start, *lines, f"{margin}{end}"])
    return f"{start}\n{margin}{' ' * _INDENT}{parameters}\n{margin}{end}"


def _parameter(text: str, margin: str) -> str:
    """One parameter; the members of a union stand below each other where they do not fit."""
    if len(margin) + len(text) + 1 <= WIDTH:
        return margin + text
    head, found, default = text.partition(" = ")
    if _UNION in head:
        return margin + _long_union(head, len(margin)) + found + default
    return margin + f"\n{margin}| ".join(text.split(" | "))


def docstring(paragraphs: list[str], indent: int) -> str:
    """A docstring of paragraphs that are already escaped, without the indent of its first line."""
    margin = " " * indent
    first, *rest = _with_short_summary(paragraphs, WIDTH - indent - 6)
    if not rest and indent + len(first) + 6 <= WIDTH:
        return f'"""{first}"""'
    lines = [first]
    for paragraph in rest:
        lines += ["", *folded(paragraph, WIDTH - indent)]
    body = "\n".join(margin + line if line else "" for line in lines)
    return '"""' + body[indent:] + f'\n{margin}"""'


def _with_short_summary(paragraphs: list[str], width: int) -> list[str]:
    """The paragraphs, the first of them one line: a sentence, or as many words as fit."""
    first, *rest = paragraphs
    if len(first) <= width:
        return paragraphs
    sentence, stop, others = first.partition(". ")
    if stop and len(sentence) + 1 <= width:
        return [f"{sentence}.", others, *rest]
    short = textwrap.shorten(first, width, placeholder=" ...")
    return [short, first, *rest]


def remark(paragraphs: list[str], indent: int) -> str:
    """The text below an attribute: a docstring that needs no summary."""
    margin = " " * indent
    first, *rest = paragraphs
    lines = folded(first, WIDTH - indent - 3)
    for paragraph in rest:
        lines += ["", *folded(paragraph, WIDTH - indent)]
    fits = indent + len(lines[-1]) + (6 if len(lines) == 1 else 3) <= WIDTH
    closing = '"""' if fits else f'\n{margin}"""'
    return '"""' + "\n".join(margin + line if line else "" for line in lines)[indent:] + closing
