"""Modules of JavaScript as one script, which a page holds.

A module becomes a function that gives what it exports; those that it imports stand in front of it.
So it needs no module loader, which no page has that is opened as a file.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache

from protogen.targets.html.needs import Needed, needed

_TOKEN = re.compile(
    r"(?P<remark>//[^\n]*|/\*.*?\*/)"
    r"|(?P<text>'(?:\\.|[^'\\\n])*'|\"(?:\\.|[^\"\\\n])*\")"
    r"|(?P<word>[\w$]+)|(?P<line>\s*\n\s*)|(?P<blank>[^\S\n]+)|(?P<mark>.)",
    re.DOTALL,
)
_REGEX = re.compile(r"/(?:\\.|\[(?:\\.|[^\]\\\n])*\]|[^/\\\[\n])+/[a-z]*")
_BEFORE_REGEX = re.compile(r"(?:^|[({\[,;:=!&|?+\n>~]|\b(?:return|typeof|case|of|in))$")
"""What stands in front of a regular expression, and of no division."""
_NO_BREAK_BEHIND = "\n{([,;:?=&|"
_NO_BREAK_BEFORE = "})],;:?.&|="

_ARROW = 6
"""Tokens of an arrow function with one parameter, and what stands in front."""
_CLOSING = ("}", "]", ")")
_HEADS = ("for", "while", "if")
"""Words in front of brackets behind which an empty statement may stand."""
_SHORTER = {"const": "let", "undefined": "void 0", "true": "!0", "false": "!1"}
"""Words, and what means the same where they are no names of members."""

_KEPT = 4096
"""Statements of which is remembered what was made of them: most are the same on each page."""


def bundled(modules: Mapping[str, str], entry: str, taken: Mapping[str, Collection[str]]) -> str:
    """The script that runs the module `entry`, with what it needs of the others.

    `taken` names what is taken of modules that others take whole; they need not export it.
    """
    found = needed(modules, entry, taken)
    numbers = {path: f"m{index}" for index, path in enumerate(found)}
    parts = [_module(own, numbers[path], numbers) for path, own in found.items()]
    return '(() => {\n"use strict";\n' + "".join(parts) + "})();\n"


def _module(own: Needed, number: str, numbers: Mapping[str, str]) -> str:
    """A module as a function that gives what others need of it."""
    bound: dict[str, list[str]] = {}
    text = ""
    for name, item in own.module.imports.items():
        if name in own.names and not item.name:
            text += f"let {name}={numbers[item.path]};"
        elif name in own.names:
            is_same = name == item.name
            bound.setdefault(item.path, []).append(name if is_same else f"{item.name}:{name}")
    text += "".join(f"let{{{','.join(names)}}}={numbers[path]};" for path, names in bound.items())
    text += "".join(_short(item.text) for item in own.statements())
    passed = own.module.passed_on
    given = [
        f"{name}:{numbers[passed[name].path]}.{passed[name].name}" if name in passed else name
        for name in sorted(own.given)
    ]
    return f"let {number}=(()=>{{\n{text}return{{{','.join(given)}}};}})();\n"


@lru_cache(_KEPT)
def _short(text: str) -> str:
    """A statement without comments, and without blanks and line breaks that nothing needs."""
    parts, end, blank = ["\n"], 0, ""
    while end < len(text):
        token, kind = _token(text, end, parts[-1])
        end += len(token)
        if kind in ("remark", "blank", "line"):
            blank = "\n" if kind == "line" else blank or " "
            continue
        if kind == "word" and not _is_member(text, end, parts[-1]):
            token = _SHORTER.get(token, token)
        if blank and _needs(blank, parts[-1], token):
            parts.append(blank)
        else:
            _drop_mark(parts, token)
        parts.append(token)
        if parts[-2:] == ["=", ">"] and len(parts) > _ARROW:
            _unwrap(parts)
        blank = ""
    found = "".join(parts[1:])
    return found if not found or found[-1] in ";}" else f"{found}\n"


def _is_member(text: str, end: int, last: str) -> bool:
    """True if a word that ends there may be the name of a member."""
    return last in (".", "?.") or text[end : end + 1] == ":"


def _drop_mark(parts: list[str], behind: str) -> None:
    """Leave out the last comma or semicolon where a bracket behind it makes it needless."""
    is_comma = parts[-1] == "," and behind in _CLOSING
    if is_comma or (parts[-1] == ";" and behind == "}" and not _is_empty(parts)):
        parts.pop()


def _unwrap(parts: list[str]) -> None:
    """Leave out the brackets around the only parameter of an arrow function."""
    before, opening, name, closing = parts[-_ARROW:-2]
    is_alone = opening == "(" and closing == ")" and name.isidentifier()
    if is_alone and before in ("(", ",", "=", ":", "?", "{", "["):
        parts[-_ARROW + 1 : -2] = [name]


def _is_empty(parts: Sequence[str]) -> bool:
    """True if the last semicolon may be a statement by itself."""
    depth, index = 0, len(parts) - 2
    while parts[index] == ")" or depth:
        depth += (parts[index] == ")") - (parts[index] == "(")
        index -= 1
        if not depth:
            return parts[index] in _HEADS
    return parts[index] in (";", "{", "}", "else", "do")


def _token(text: str, start: int, last: str) -> tuple[str, str]:
    """The token that begins there, and its kind; `last` is what was kept in front of it."""
    if text[start] == "`":
        return _template(text, start), "text"
    is_remark = text[start : start + 2] in ("//", "/*")
    if text[start] == "/" and not is_remark and _BEFORE_REGEX.search(last):
        found = _REGEX.match(text, start)
        if found is not None:
            return found[0], "text"
    token = _TOKEN.match(text, start)
    assert token is not None
    assert token.lastgroup is not None
    return token[0], token.lastgroup


def _template(text: str, start: int) -> str:
    """The template literal that begins there, with those inside of it."""
    end, depth = start + 1, 0
    while depth or text[end] != "`":
        if depth and text[end] == "`":
            end += len(_template(text, end))
            continue
        if text[end] == "\\":
            end += 1
        elif text.startswith("${", end):
            depth, end = depth + 1, end + 1
        elif depth:
            depth += (text[end] == "{") - (text[end] == "}")
        end += 1
    return text[start : end + 1]


def _needs(blank: str, last: str, token: str) -> bool:
    """True if a blank or a line break between two tokens means something."""
    before, behind = last[-1], token[0]
    if blank == "\n":
        return before not in _NO_BREAK_BEHIND and behind not in _NO_BREAK_BEFORE
    words = (before.isalnum() or before in "_$") and (behind.isalnum() or behind in "_$")
    return words or (before == behind and before in "+-/") or (before == "/" and behind == "*")
