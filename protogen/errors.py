"""Errors that a user can fix."""

from __future__ import annotations


class UserError(Exception):
    """A call or a file that is wrong: the text is for the user, `hint` says what to do about it."""

    def __init__(self, message: str, hint: str | None = None) -> None:
        super().__init__(message, hint)
        self.hint = hint

    def __str__(self) -> str:
        return str(self.args[0])
