"""Which events are shown: `state`, `state.battery_v < 11`, `drive or invalid`."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable
from functools import reduce
from types import ModuleType
from typing import Any

import msgspec

from protogen.errors import UserError
from protogen.problems import hint_for

_TERM = re.compile(
    r"\s*(?P<path>[A-Za-z_][\w.]*)\s*(?:(?P<operator><=|>=|==|!=|=|<|>)\s*(?P<value>[^\s]+))?\s*"
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


class FilterError(UserError):
    """A filter that can't be understood."""


class _Term(msgspec.Struct, frozen=True):
    """A kind of event, and maybe what a field of it has to be."""

    kind: str
    path: tuple[str, ...]
    operator: str
    value: float | str

    def keeps(self, event: Any) -> bool:
        kind = event.message.NAME if event.kind == "message" else event.kind
        if self.kind not in (kind, event.sender):
            return False
        if not self.path:
            return True
        found = value_at(event.message, self.path)
        if found is None:
            return False
        if isinstance(self.value, str):
            found = str(getattr(found, "name", found)).lower()
        return _OPERATORS[self.operator](found, self.value)


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


def value_at(message: Any, path: Iterable[str]) -> Any:
    """A field or physical value of a message; None where it is not there."""
    return reduce(lambda value, name: getattr(value, name, None), path, message)


def field_path(text: str, module: ModuleType) -> tuple[str, tuple[str, ...]]:
    """Split `state.battery_v` into the message and the path to its field. Raises FilterError."""
    message, *path = text.split(".")
    known = {*module.MESSAGES, *_KINDS, *module.PROTOCOL.endpoints}
    if message not in known:
        raise FilterError(f"there is no message `{message}`", hint_for(message, known))
    if path and message not in module.MESSAGES:
        raise FilterError(f"`{message}` has no fields", "name a message")
    if path and not hasattr(module.MESSAGES[message], path[0]):
        names = [name for name in dir(module.MESSAGES[message]) if name.islower()]
        problem = f"`{message}` has no field `{path[0]}`"
        raise FilterError(problem, hint_for(path[0], [n for n in names if not n.startswith("_")]))
    return message, tuple(path)


def _term(text: str, module: ModuleType) -> _Term:
    found = _TERM.fullmatch(text)
    if found is None:
        raise FilterError(f"`{text}` is no condition", "write MESSAGE, or MESSAGE.FIELD < NUMBER")
    message, path = field_path(found["path"], module)
    if bool(path) != bool(found["operator"]):
        problem = f"`{text}` does not say what " + ("the field is to be" if path else "is compared")
        raise FilterError(problem, "write MESSAGE, or MESSAGE.FIELD < NUMBER")
    return _Term(message, path, found["operator"] or "", _value(found["value"] or ""))


def _value(text: str) -> float | str:
    try:
        return float(int(text, 0)) if re.fullmatch(r"0[xX][0-9A-Fa-f]+", text) else float(text)
    except ValueError:
        return text.lower()
