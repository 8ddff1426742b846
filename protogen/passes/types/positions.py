"""Positions of the fields of a message or struct."""

from __future__ import annotations

from collections.abc import Iterable

from protogen.copying import replace
from protogen.model.sizes import SizeSet
from protogen.model.types import Field


def placed(fields: Iterable[Field]) -> tuple[Field, ...]:
    """The fields with their positions, behind each other."""
    found: list[Field] = []
    behind = SizeSet.exactly(0)
    for field in fields:
        found.append(replace(field, position=behind.fixed))
        behind += field.type.sizes
    return tuple(found)
