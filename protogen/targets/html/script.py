"""Modules of JavaScript as one script, which a page holds.

A module becomes a function that gives what it exports; those that it imports stand in front of it.
So it needs no module loader, which no page has that is opened as a file.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from posixpath import dirname, join, normpath

_IMPORT = re.compile(
    r"^(?P<kind>import|export)\s+(?:\*\s+as\s+(?P<whole>\w+)|\{(?P<names>[^}]*)\})"
    r'\s+from\s+"(?P<path>[^"]+)";[^\S\n]*\n?',
    re.MULTILINE,
)
_EXPORTED = re.compile(
    r"^export (?:async )?(?:function\*?|class|const) (?P<name>\w+)", re.MULTILINE
)
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

_KEPT = 128
"""Modules of which is remembered what was made of them: most are the same on each page."""


def bundled(modules: Mapping[str, str], entry: str, more: Mapping[str, Iterable[str]]) -> str:
    """The script that runs the module `entry`; `more` names what modules give besides exports."""
    order: list[str] = []
    _visit(entry, modules, order, ())
    numbers = {path: f"m{index}" for index, path in enumerate(order)}
    parts = [_module(path, modules[path], numbers, more.get(path, ())) for path in order]
    return '(() => {\n"use strict";\n' + "".join(parts) + "})();\n"


def _visit(
    path: str, modules: Mapping[str, str], order: list[str], around: tuple[str, ...]
) -> None:
    """Put a module behind those that it imports."""
    assert path not in around, f"{path} imports itself by {around}"
    if path in order:
        return
    for found in _IMPORT.finditer(modules[path]):
        _visit(_resolved(path, found["path"]), modules, order, (*around, path))
    order.append(path)


def _resolved(importer: str, path: str) -> str:
    return normpath(join(dirname(importer), path))


def _module(path: str, text: str, numbers: Mapping[str, str], more: Iterable[str]) -> str:
    given: list[str] = [*more]

    def bind(found: re.Match[str]) -> str:
        name = numbers[_resolved(path, found["path"])]
        if found["whole"]:
            return f"const {found['whole']} = {name};\n"
        names = [item.strip() for item in found["names"].split(",") if item.strip()]
        if found["kind"] == "export":
            given.extend(
                f"{item.split(' as ')[-1]}:{name}.{item.split(' as ')[0]}" for item in names
            )
            return ""
        bound = ", ".join(item.replace(" as ", ": ") for item in names)
        return f"const {{ {bound} }} = {name};\n" if names else ""

    text = _IMPORT.sub(bind, text)
    given += [found["name"] for found in _EXPORTED.finditer(text)]
    text = re.sub(r"^export (?=async|function|class|const)", "", text, flags=re.MULTILINE)
    assert not re.search(r"^export ", text, re.MULTILINE), f"{path} exports in a way not known here"
    exports = f"return{{{','.join(given)}}};"
    return f"let {numbers[path]}=(()=>{{\n{_short(text)}{exports}}})();\n"


@lru_cache(_KEPT)
def _short(text: str) -> str:
    """The module without comments, and without blanks and line breaks that nothing needs."""
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
    return "".join(parts[1:]) + "\n"


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
