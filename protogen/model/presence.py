"""Presence: what says whether a field is there that is not always there."""

from __future__ import annotations

import msgspec

from protogen.model.expressions import Expression


class Conditional(msgspec.Struct, frozen=True):
    """Presence that earlier fields say."""

    condition: Expression


class Trailing(msgspec.Struct, frozen=True):
    """Presence that only the end of the payload says: all fields behind are such fields."""

    behind: str
    """The trailing field in front, without which this one is not there either; empty: none."""


Presence = Conditional | Trailing
