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


def console() -> Console:
    """Return a console for standard output."""
    return _console(stderr=False)


def error_console() -> Console:
    """Return a console for standard error."""
    return _console(stderr=True)


def _console(*, stderr: bool) -> Console:
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

    cells = [[_text(cell) for cell in row] for row in rows]
    titles = [Text(head, style="bold") for head in heads]
    widths = [max(cell.cell_len for cell in column) for column in zip(titles, *cells, strict=True)]
    for row in (titles, *cells):
        line = Text("  ").join(_padded(row, widths))
        line.rstrip()
        console.print(line)


def echo_json(data: object) -> None:
    """Print data as JSON, for programs and for people who look."""
    import json

    import typer

    typer.echo(json.dumps(data, indent=2, ensure_ascii=False))


def _text(cell: Cell) -> Text:
    from rich.text import Text

    return Text(cell) if isinstance(cell, str) else cell


def _padded(row: Sequence[Text], widths: Sequence[int]) -> list[Text]:
    padded = []
    for cell, width in zip(row, widths, strict=True):
        whole = cell.copy()
        whole.pad_right(width - cell.cell_len)
        padded.append(whole)
    return padded
