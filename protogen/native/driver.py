"""A C source that fills rows, and what is expected of the library that it becomes."""

from __future__ import annotations

import msgspec

from protogen.capture.schema import CaptureSchema


class Driver(msgspec.Struct, frozen=True):
    """The source for what one endpoint sends."""

    text: str
    schema: CaptureSchema
    layout: tuple[int, ...]
    """Sizes and offsets of rows that the library's `protogen_layout` has to have."""
    spells: bool
    """True if the library has `protogen_spell`."""
