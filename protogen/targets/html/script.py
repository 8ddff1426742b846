"""Modules of JavaScript as one script, which a page holds.

A module becomes a function that gives what it exports; those that it imports stand in front of it. So
it needs no module loader, which no page has that is opened as a file.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from posixpath import dirname, join, normpath

_IMPORT = re.compile(
    r'^(?P<kind>import|export)\s+(?:\*\s+as\s+(?P<whole>\w+)|\{(?P<names>[^}]*)\})'
    r'\s+from\s+"(?P<path>[^"]+)";[^\S\n]*\n?',
    re.MULTILINE,
)
_EXPORTED = re.compile(r"^export (?:async )?(?:function\*?|class|const) (?P<name>\w+)", re.MULTILINE)
_DOC = re.compile(r"^[^\S\n]*/\*\*.*?\*/[^\S\n]*\n", re.MULTILINE | re.DOTALL)
_REMARK = re.compile(r"^[^\S\n]*//.*\n", re.MULTILINE)
_INDENT = re.compile(r"^[^\S\n]+", re.MULTILINE)
_BLANK = re.compile(r"\n{2,}")


def bundled(modules: Mapping[str, str], entry: str, more: Mapping[str, Iterable[str]]) -> str:
    """The script that runs the module `entry`; `more` names what modules give besides exports."""
    order: list[str] = []
    _visit(entry, modules, order, ())
    numbers = {path: f"m{index}" for index, path in enumerate(order)}
    parts = [_module(path, modules[path], numbers, more.get(path, ())) for path in order]
    return '(() => {\n"use strict";\n' + "".join(parts) + "})();\n"


def _visit(path: str, modules: Mapping[str, str], order: list[str], around: tuple[str, ...]) -> None:
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
            given.extend(f"{item.split(' as ')[-1]}: {name}.{item.split(' as ')[0]}" for item in names)
            return ""
        bound = ", ".join(item.replace(" as ", ": ") for item in names)
        return f"const {{ {bound} }} = {name};\n" if names else ""

    text = _IMPORT.sub(bind, text)
    given += [found["name"] for found in _EXPORTED.finditer(text)]
    text = re.sub(r"^export (?=async|function|class|const)", "", text, flags=re.MULTILINE)
    assert not re.search(r"^export ", text, re.MULTILINE), f"{path} exports in a way not known here"
    own = f"const {numbers[path]} = (() => {{\n{_short(text)}return {{ {', '.join(given)} }};\n}})();\n"
    return own


def _short(text: str) -> str:
    """The module without comments and indentation. No text in it may span lines."""
    for pattern in (_DOC, _REMARK, _INDENT):
        text = pattern.sub("", text)
    return _BLANK.sub("\n", text)
