"""What an importer makes of definitions: schemas, and remarks on what they don't say."""

from __future__ import annotations

from enum import StrEnum

import msgspec

from protogen.errors import UserError
from protogen.problems.span import Span


class DefinitionError(UserError):
    """A mistake in definitions: the text begins with its place."""

    def __init__(self, span: Span, message: str, hint: str | None = None) -> None:
        super().__init__(f"{span}: {message}", hint)


class Kind(StrEnum):
    """What became of something that a schema can't say as its definition does."""

    LEFT_OUT = "left out"
    """It is not in the schema."""
    CHANGED = "changed"
    """It is there, and says less or something else than its definition."""


class Remark(msgspec.Struct, frozen=True):
    """Something that was not imported as it is defined, and why."""

    kind: Kind
    name: str
    """Name in the definitions: MSG_NAME, or MSG_NAME.field."""
    reason: str
    span: Span


class Schema(msgspec.Struct, frozen=True):
    """Schema made of definitions."""

    name: str
    """Name of its protocol, and of its file without the suffix."""
    text: str
    messages: int
    types: int


class Imported(msgspec.Struct, frozen=True):
    """Result of an import."""

    schemas: tuple[Schema, ...]
    files: int
    """Number of files that were read."""
    others: int
    """Number of files that hold something else."""
    remarks: tuple[Remark, ...]
