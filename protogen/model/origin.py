"""Sources and docs of parts of the model."""

from __future__ import annotations

from dataclasses import dataclass, field

import msgspec

from protogen.problems.span import Span


class Source(msgspec.Struct, frozen=True, kw_only=True):
    """A place in a document. `lines` and `section` are texts as people write them."""

    document: str | None = None
    revision: str | None = None
    lines: str | None = None
    section: str | None = None
    url: str | None = None
    license: str | None = None
    note: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class About:
    """Doc of a thing, and where it is written down."""

    doc: str = ""
    source: Source | None = None
    span: Span | None = field(default=None, compare=False, repr=False)
    """Place in a schema. Two things that differ in nothing else are equal."""


NOTHING = About()
"""No text and no source."""
