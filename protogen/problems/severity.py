"""How grave a problem is."""

from __future__ import annotations

from enum import StrEnum


class Severity(StrEnum):
    """How grave a problem is; the value is the word that is printed."""

    ERROR = "error"
    """Nothing can be generated."""
    WARNING = "warning"
    """The schema compiles, but is likely to say something else than is meant."""
    NOTE = "note"
    """Worth knowing, nothing to mend."""
