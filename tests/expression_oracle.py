"""Expressions worked out by Python itself, from their text: an independent judge of every engine.

The text of an expression is Python but for runs of bits, `key[4..6]`.
"""

from __future__ import annotations

import keyword
import re
from collections.abc import Mapping
from typing import Any

from protogen.model.expressions import Expression, Quotient

_OPERATORS = ("and", "or", "not", "in")
_WORD = re.compile(r"[a-z_][a-z0-9_]*")
_RUN = re.compile(r"(?P<name>[a-z][a-z0-9_.]*)\[(?P<low>\d+)\.\.(?P<high>\d+)\]")


def worked_out(expression: Expression, scope: Mapping[str, Any]) -> int:
    """The value of an expression; of a condition, 0 or 1. Bytes that are no elements are -1."""
    if isinstance(expression, Quotient):
        whole, part = divmod(worked_out(expression.operand, scope), expression.size)
        return -1 if part else whole
    text = str(expression)
    if text in scope:
        return int(scope[text])
    python = _WORD.sub(_unreserved, _RUN.sub(_shifted, text))
    members: Any = _Members(scope)
    found = eval(python, {"__builtins__": {}}, members)
    return int(bool(found) if expression.is_condition else found)


def _unreserved(word: re.Match[str]) -> str:
    """A field's name that is no word of Python: no field's name ends so."""
    is_field = keyword.iskeyword(word[0]) and word[0] not in _OPERATORS
    return f"{word[0]}_" if is_field else word[0]


def _shifted(run: re.Match[str]) -> str:
    width = int(run["high"]) - int(run["low"]) + 1
    return f"(({run['name']} >> {run['low']}) & {2**width - 1})"


class _Members:
    """Values by name, whose members are attributes; no method has the name of one."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = values

    def __getitem__(self, name: str) -> Any:
        value = self._values[name if name in self._values else name.removesuffix("_")]
        return _Members(value) if isinstance(value, Mapping) else value

    def __getattr__(self, name: str) -> Any:
        return self[name]
