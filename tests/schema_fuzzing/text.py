"""Plain data as YAML text, in one plain style or in any other that means the same."""

from __future__ import annotations

import json
import random
import re
from typing import Any

_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]*(?:(?:\.\.|[-./ ])[A-Za-z0-9_]+)*|[0-9]+\.\.[0-9]+")
_WORDS = frozenset({"true", "false", "null", "True", "False", "Null", "TRUE", "FALSE", "NULL"})
_AS_WRITTEN = frozenset({"source", "lines"})
"""Keys of texts that may look like numbers, whose notation counts."""


def to_yaml(data: dict[str, Any]) -> str:
    """The data in block style, without comments."""
    return Writer().text(data)


def to_styled_yaml(data: dict[str, Any], seed: int) -> str:
    """The data in a style of its own: flow or block, quotes, comments, notations."""
    return StyledWriter(random.Random(seed)).text(data)


class Writer:
    """Writes in the plain style."""

    def text(self, data: dict[str, Any]) -> str:
        return "\n".join(self._block(data, 0, "")) + "\n"

    # -- what a style may change -------------------------------------------------------------

    def _flows(self, value: Any, depth: int) -> bool:
        return not value

    def _remark(self, indent: int) -> list[str]:
        return []

    def _trailer(self) -> str:
        return ""

    def _step(self) -> int:
        return 2

    def _word(self, text: str) -> str:
        plain = _PLAIN.fullmatch(text) and text not in _WORDS
        return text if plain else _quoted(text)

    def _integer(self, value: int) -> str:
        return str(value)

    # -- structure ---------------------------------------------------------------------------

    def _block(self, value: Any, indent: int, key: str) -> list[str]:
        """The lines of a mapping or list that is not empty."""
        lines: list[str] = []
        items = value.items() if isinstance(value, dict) else ((None, item) for item in value)
        for name, item in items:
            lines += self._remark(indent)
            head = "-" if name is None else f"{self._scalar(name, '')}:"
            lines += self._item(" " * indent + head, item, indent, key if name is None else name)
        return lines

    def _item(self, head: str, item: Any, indent: int, key: Any) -> list[str]:
        if not isinstance(item, dict | list) or self._flows(item, indent):
            return [f"{head} {self._flow(item, key)}{self._trailer()}"]
        return [f"{head}{self._trailer()}", *self._block(item, indent + self._step(), key)]

    def _flow(self, value: Any, key: Any) -> str:
        if isinstance(value, dict):
            pairs = (f"{self._scalar(k, '')}: {self._flow(v, k)}" for k, v in value.items())
            return "{" + ", ".join(pairs) + "}"
        if isinstance(value, list):
            return "[" + ", ".join(self._flow(item, key) for item in value) + "]"
        return self._scalar(value, key)

    def _scalar(self, value: Any, key: Any) -> str:
        if value is None:
            return "null"
        if isinstance(value, bool):
            return "true" if value else "false"
        if isinstance(value, int):
            return str(value) if key in _AS_WRITTEN else self._integer(value)
        if isinstance(value, float):
            return _float(value)
        return self._word(value)


def _quoted(text: str) -> str:
    """The text between double quotes; JSON has no escape for a character beyond FFFF."""
    pieces = (json.dumps(c) if ord(c) < 0x10000 else f'"\\U{ord(c):08X}"' for c in text)
    return '"' + "".join(piece[1:-1] for piece in pieces) + '"'


def _float(value: float) -> str:
    if value != value:
        return ".nan"
    if value in (float("inf"), float("-inf")):
        return ".inf" if value > 0 else "-.inf"
    return repr(value)


class StyledWriter(Writer):
    """Writes in any style."""

    def __init__(self, choose: random.Random) -> None:
        self._choose = choose

    def _flows(self, value: Any, depth: int) -> bool:
        return not value or self._choose.random() < 0.1 + depth / 20

    def _remark(self, indent: int) -> list[str]:
        remarks = [[], [], [], [""], ['# a remark: {with} [what] "marks" there are']]
        return [" " * indent + line if line else line for line in self._choose.choice(remarks)]

    def _trailer(self) -> str:
        return self._choose.choice(["", "", "", "  # why", " # x: y"])

    def _step(self) -> int:
        return self._choose.choice([1, 2, 2, 4])

    def _word(self, text: str) -> str:
        plain = _PLAIN.fullmatch(text) and text not in _WORDS
        ways = [_quoted(text)]
        if plain:
            ways += [text, text]
        if text.isprintable():
            ways.append("'" + text.replace("'", "''") + "'")
        return self._choose.choice(ways)

    def _integer(self, value: int) -> str:
        ways = [str(value)]
        if value >= 0:
            ways += [f"0x{value:X}", f"0x{value:04x}", f"0o{value:o}", f"0{value}"]
        return self._choose.choice(ways)
