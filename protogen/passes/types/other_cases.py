"""The case of a switch for all values that no other case has: `else`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from protogen.model.types import Case
from protogen.passes.context import Context, Loc
from protogen.passes.types.expressions import Selector

ELSE = "else"
"""The key of the case, and its name."""

_MEANT = frozenset({"default", "other", "others", "otherwise", "rest", "unknown", "any", "_", "*"})
"""What the case is called elsewhere."""


def is_else(key: object) -> bool:
    """True if the key of a case is that of all other values."""
    return key == ELSE


def hint_at_else(key: object) -> str | None:
    """A hint where somebody may have meant the case for all other values."""
    is_meant = isinstance(key, str) and key.lower() in _MEANT
    return "`else` is the case of all other values" if is_meant else None


def check_else(
    context: Context,
    cases: Sequence[Case],
    selector: Selector,
    written: Mapping[object, Any],
    loc: Loc,
) -> None:
    """Report a case for all other values that can't be told from another, or is never chosen.

    `written` are all cases, also those that the selector can't have, and `loc` is their place.
    """
    if not any(map(is_else, written)):
        return
    chosen, loc = selector.expression.text, (*loc, ELSE)
    if selector.type.enum and ELSE in (entry.name for entry in selector.type.enum.values):
        text = f"`{chosen}` has a value that is called `else`, as the case of all other values is"
        hint = "give that value another name"
        context.error_at_key("PG270", loc, text, hint)
        return
    values = {case.value for case in cases if case.value is not None}
    if len(written) == 1:
        text = "`else` is the only case, so nothing is chosen"
        hint = "give the field the type of this case, without a switch"
        context.error_at_key("PG271", loc, text, hint)
    elif not _is_left(selector, values):
        text = f"every value of `{chosen}` has a case, so `else` is never chosen"
        context.error_at_key("PG272", loc, text, "leave `else` out")


def _is_left(selector: Selector, values: set[int]) -> bool:
    """True if an encoder allows a value that has no case of its own."""
    least, greatest = selector.allowed
    if selector.type.is_closed:
        return any(selector.allows(value) for value in selector.named - values)
    taken = sum(least <= value <= greatest for value in values)
    return greatest - least + 1 > taken or bool(selector.special - values)
