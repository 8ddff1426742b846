"""Shapes of types: all that two versions must share to be the same but for names and texts."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from difflib import SequenceMatcher
from typing import Any

from protogen.copying import field_names, is_record
from protogen.model.expressions import Expression
from protogen.model.meanings import Enum, Flags
from protogen.model.transparency import Encoding, Escape, Insertion, Substitution
from protogen.model.types import Struct

_WORDS = frozenset({"about", "renamed_from", "stated", "sizes", "holds_values", "needs"})
"""Texts, and facts that follow from the rest."""
_NAMED = (Enum, Flags, Struct)
"""Types whose names are derived from the fields that they stand in, or chosen for code."""


def shape(item: Any) -> Hashable:
    """Content of a type without texts for people and without the names of types."""
    if isinstance(item, tuple):
        return tuple(shape(each) for each in item)
    if isinstance(item, Expression):
        return str(item)
    kind = type(item)
    if not is_record(kind):
        found: Hashable = item
        return found
    left_out = _WORDS | {"name"} if kind in _NAMED else _WORDS
    names = [name for name in field_names(kind) if name not in left_out]
    return kind.__name__, *(shape(getattr(item, name)) for name in names)


def encoding_shape(encoding: Encoding) -> Hashable:
    """Content of a stuffing; the order in which its bytes are listed does not count."""
    if isinstance(encoding, Substitution):
        return "substitution", frozenset(encoding.table)
    if isinstance(encoding, Escape):
        return "escape", encoding.byte, frozenset(encoding.of), encoding.xor
    if isinstance(encoding, Insertion):
        return "insertion", encoding.sequence, encoding.byte
    return type(encoding).__name__


def are_crossed(pairs: Sequence[tuple[str, str]]) -> bool:
    """True if some name is more like another one's new name than like its own.

    `left, right` that became `right_speed, left_speed` are.
    """
    return any(
        _likeness(one, theirs) > _likeness(one, own)
        for one, own in pairs
        for _, theirs in pairs
        if theirs != own
    )


def are_alike(pairs: Sequence[tuple[str, str]]) -> bool:
    """True if each name is more like its own new name than like any other's."""
    return all(
        _likeness(one, own) > _likeness(one, theirs)
        for one, own in pairs
        for _, theirs in pairs
        if theirs != own
    )


def _likeness(one: str, other: str) -> float:
    """Likeness of two names, from 0 to 1: words that both have, else letters in order."""
    words = [set(name.split("_")) for name in (one, other)]
    shared = len(words[0] & words[1]) / len(words[0] | words[1])
    return max(shared, SequenceMatcher(None, one, other, autojunk=False).ratio())
