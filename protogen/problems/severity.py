"""Severity of a problem."""

from __future__ import annotations

from enum import StrEnum


class Severity(StrEnum):
    """Severity of a problem; the value is the word that is printed."""

    ERROR = "error"
    """Nothing can be generated."""
    WARNING = "warning"
    """The schema compiles, but is likely to say something else than is meant."""
    NOTE = "note"
    """Worth knowing, nothing to fix."""
