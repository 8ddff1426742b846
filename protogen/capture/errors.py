"""Errors about captures, as exceptions whose text a user can read."""

from __future__ import annotations

from protogen.errors import UserError


class CaptureError(UserError, ValueError):
    """A capture can't be read so: the text says why, and what would help."""


class MissingPackageError(CaptureError, ImportError):
    """A package is not installed that reading captures needs."""


class SlowCaptureWarning(UserWarning):
    """A capture is read in Python, because there is no native engine. Warned of once."""


class NoSilenceWarning(UserWarning):
    """Only a silence ends frames, and a capture without times has one: its end. Warned of once."""
