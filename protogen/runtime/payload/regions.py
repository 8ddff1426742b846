"""Sizes of regions, for records that are made without the fields that say them."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from protogen.runtime.attributes import attribute
from protogen.runtime.payload.rules import Scope
from protogen.runtime.values import OMITTED


def region_size(record: Any, name: str) -> int:
    """The bytes that a field's value takes in its region; 0 of what is no value of it."""
    with suppress(Exception):  # An encoder says what is wrong.
        return len(_region(record, name))
    return 0


def _region(record: Any, name: str) -> bytes:
    """The bytes, as the fields in front say them, of which the one with the size is not known."""
    from protogen.runtime.constructs import region_bytes  # It takes long to import.

    scope = Scope()
    for own, rule in record.RULES:
        value = getattr(record, attribute(own), OMITTED)
        if value is not OMITTED:
            scope[own] = rule.chosen(scope).to_wire(value, scope, strict=False)
        if own == name:
            break
    return region_bytes(record.FORMAT, name, scope)
