"""Which events are shown: `state`, `state.battery_v < 11`, `drive or invalid`."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable
from types import ModuleType
from typing import Any

import msgspec

from protogen.monitor.fields import (
    FieldPath,
    FilterError,
    check_path,
    check_text,
    path_of,
    value_at,
)
from protogen.problems import hint_for

_TERM = re.compile(
    r"\s*(?P<path>[A-Za-z_][\w.\[\]]*)\s*"
    r"(?:(?P<operator><=|>=|==|!=|=|<|>)\s*(?P<value>\"[^\"]*\"|'[^']*'|[^\s]+))?\s*"
)
_OPERATORS: dict[str, Callable[[Any, Any], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "=": operator.eq,
    "!=": operator.ne,
}
_KINDS = ("unknown", "invalid")


class _Term(msgspec.Struct, frozen=True):
    """A kind of event, and maybe what a field of it has to be."""

    kind: str
    path: FieldPath
    operator: str
    value: float | str

    def keeps(self, event: Any) -> bool:
        kind = event.message.NAME if event.kind == "message" else event.kind
        if self.kind not in (kind, event.sender):
            return False
        if not self.path:
            return True
        found = value_at(event.message, self.path)
        if isinstance(self.value, str):
            return found is not None and _OPERATORS[self.operator](_text(found), self.value)
        return isinstance(found, int | float) and _OPERATORS[self.operator](found, self.value)


class Filter(msgspec.Struct, frozen=True):
    """Events of which some group of conditions holds; without any, all events."""

    groups: tuple[tuple[_Term, ...], ...] = ()

    def keeps(self, event: Any) -> bool:
        """True if an event is shown."""
        return not self.groups or any(
            all(term.keeps(event) for term in group) for group in self.groups
        )


def parse_filter(text: str, module: ModuleType) -> Filter:
    """Read conditions joined by `and` and `or`; `and` binds first. Raises FilterError."""
    if not text.strip():
        return Filter()
    return Filter(
        tuple(
            tuple(_term(term, module) for term in re.split(r"\s+and\s+", group.strip()))
            for group in re.split(r"\s+or\s+", text.strip())
        )
    )


def field_path(text: str, module: ModuleType) -> tuple[str, FieldPath]:
    """Split `state.cells_v[2]` into the message and the path to its value. Raises FilterError."""
    message, *steps = text.split(".")
    known = {*module.MESSAGES, *_KINDS, *module.PROTOCOL.endpoints}
    if message not in known:
        raise FilterError(f"there is no message `{message}`", hint_for(message, known))
    if steps and message not in module.MESSAGES:
        raise FilterError(f"`{message}` has no fields", "name a message")
    path = path_of(text, steps)
    if path:
        check_path(text, module.MESSAGES[message], path)
    return message, path


def _term(text: str, module: ModuleType) -> _Term:
    found = _TERM.fullmatch(text)
    if found is None:
        hint = "write MESSAGE, or MESSAGE.FIELD < NUMBER, and quote a value with blanks"
        raise FilterError(f"`{text}` is no condition", hint)
    message, path = field_path(found["path"], module)
    if bool(path) != bool(found["operator"]):
        problem = f"`{text}` does not say what " + ("the field is to be" if path else "is compared")
        raise FilterError(problem, "write MESSAGE, or MESSAGE.FIELD < NUMBER")
    value = _value(found["value"] or "")
    if isinstance(value, str) and path:
        if found["operator"] not in ("=", "==", "!="):
            hint = "write it without its unit; names are compared by = and !="
            raise FilterError(f"`{found['value']}` is no number", hint)
        check_text(value, module.MESSAGES[message], path)
    return _Term(message, path, found["operator"] or "", value)


def _value(text: str) -> float | str:
    try:
        return float(int(text, 0)) if re.fullmatch(r"0[xX][0-9A-Fa-f]+", text) else float(text)
    except ValueError:
        return text.strip("\"'").lower()


def _text(found: Any) -> str:
    """A value as filters compare it: the name of a number, bytes in hex."""
    if isinstance(found, bytes):
        return found.hex()
    return str(getattr(found, "name", found)).lower()
