"""Complaints about lines and records of a capture that can't be used."""

from __future__ import annotations

import typer

_MOST = 20
"""So many are made one by one."""


class Complaints:
    """Prints what can't be used, up to a number of lines."""

    def __init__(self) -> None:
        self.count = 0

    def add(self, problem: str) -> None:
        """Complain of a line, whose bytes are lost."""
        self.count += 1
        if self.count <= _MOST:
            typer.echo(f"warning: {problem}", err=True)

    def report(self) -> None:
        """Say how many lines were left out without a word."""
        if self.count > _MOST:
            typer.echo(f"warning: {self.count - _MOST} more lines can't be used", err=True)
