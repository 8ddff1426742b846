"""Errors of native libraries that can't be had."""

from __future__ import annotations

from protogen.errors import UserError


class NativeError(UserError):
    """Native code can't be had here: the text says why."""


class NoCompilerError(NativeError):
    """There is no compiler, and nobody asked for a certain one."""
