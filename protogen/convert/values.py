"""The values of a column as Python has them."""

from __future__ import annotations

from typing import Any


def as_list(values: Any) -> list[Any]:
    """The values as a list, whatever a batch holds them in; None where one is missing."""
    tolist = getattr(values, "tolist", None)
    return list(values) if tolist is None else tolist()
