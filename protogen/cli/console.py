"""Console of a command: colour where a terminal takes it, plain text everywhere else.

Lines are never wrapped, so that a line of output is one line in a pipe as well.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.text import Text

    Cell = str | Text


def console(*, stderr: bool = False) -> Console:
    """Return a console for standard output, or for standard error."""
    from rich.console import Console

    return Console(
        file=sys.stderr if stderr else sys.stdout,
        # rich itself leaves bold and dim letters with NO_COLOR.
        color_system=None if os.environ.get("NO_COLOR") else "auto",
        highlight=False,
        soft_wrap=True,
        emoji=False,
        markup=False,
    )


def print_table(console: Console, heads: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    """Print ``rows`` in columns as wide as their longest cell."""
    from rich.text import Text

    table = [[Text(head, style="bold") for head in heads]]
    table += (
        [Text(cell) if isinstance(cell, str) else cell.copy() for cell in row] for row in rows
    )
    widths = [max(cell.cell_len for cell in column) for column in zip(*table, strict=True)]
    for texts in table:
        for text, width in zip(texts, widths, strict=True):
            text.pad_right(width - text.cell_len)
        line = Text("  ").join(texts)
        line.rstrip()
        console.print(line)


def echo_json(data: object) -> None:
    """Print data as JSON, for programs and for people who look."""
    import json

    import typer

    typer.echo(json.dumps(data, indent=2, ensure_ascii=False))
