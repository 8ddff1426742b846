"""The values of a column as Python has them, and as JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import Any

Values = Any
"""A column, in any of the types that batches have."""

_BETWEEN = "\ud800"
"""Half a character, which no text has."""
_SEAM = f", {json.dumps(_BETWEEN)}, "


def as_list(values: Any) -> list[Any]:
    """The values as a list, whatever a batch holds them in; None where one is missing."""
    tolist = getattr(values, "tolist", None)
    return list(values) if tolist is None else tolist()


def json_of_each(values: Sequence[Any], default: Callable[[Any], Any]) -> list[str]:
    """JSON of each value, as `json.dumps` makes it. One call for all, because calls are slow."""
    if not values:
        return []
    parted: list[Any] = [_BETWEEN] * (2 * len(values) - 1)
    parted[::2] = values
    texts = json.dumps(parted, default=default)[1:-1].split(_SEAM)
    if len(texts) == len(values):
        return texts
    return [json.dumps(value, default=default) for value in values]


def present_json(value: Any) -> str:
    """Strict JSON of a value, without members that are missing; bytes are hexadecimal digits."""
    return json.dumps(_present(value), default=lambda it: bytes(it).hex())


def _present(value: Any) -> Any:
    """The value without members that are missing; JSON has no infinities and not-a-number."""
    match value:
        case float() if value - value != 0:
            return None
        case list():
            return [_present(item) for item in value]
        case dict():
            members = {name: _present(item) for name, item in value.items()}
            return {name: item for name, item in members.items() if item is not None}
        case _:
            return value
