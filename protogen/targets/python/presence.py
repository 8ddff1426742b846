"""Presence of fields, around their declarations and their rules."""

from __future__ import annotations

from protogen.model.presence import Conditional, Trailing
from protogen.model.types import Field
from protogen.targets.python.formulas import formula
from protogen.targets.python.literals import call, text


def where_present(field: Field, found: str, *, conditional: str, trailing: str) -> str:
    """What was found of a field, in the call of one of these where it is not always there."""
    match field.presence:
        case None:
            return found
        case Conditional(condition=condition):
            return call(conditional, formula(condition), found)
        case Trailing(behind=behind):
            return call(trailing, found, behind=text(behind) if behind else None)
