"""A progress bar on standard error, where somebody can see it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Advance = Callable[[int], None]
"""Tell that so many more units are done."""


@contextmanager
def progress(
    title: str, total: int | None, *, shares_terminal: bool = False, in_bytes: bool = False
) -> Iterator[Advance]:
    """Show a bar while the block runs, and give the block the function that moves it.

    ``total`` is the number of units, None if that is not known. There is no bar if standard error
    is no terminal, nor with ``shares_terminal`` if the block prints to the same terminal.
    """
    if not sys.stderr.isatty() or (shares_terminal and sys.stdout.isatty()):
        yield lambda amount: None
        return
    with _bar(title, total, in_bytes=in_bytes) as advance:
        yield advance


@contextmanager
def _bar(title: str, total: int | None, *, in_bytes: bool) -> Iterator[Advance]:
    from rich import progress as rich_progress

    from protogen.cli.console import console

    amount = rich_progress.DownloadColumn() if in_bytes else rich_progress.MofNCompleteColumn()
    rate = (rich_progress.TransferSpeedColumn(),) if in_bytes else ()
    columns = (
        rich_progress.TextColumn("{task.description}"),
        rich_progress.BarColumn(),
        amount,
        *rate,
        rich_progress.TimeRemainingColumn(),
    )
    with rich_progress.Progress(*columns, console=console(stderr=True), transient=True) as shown:
        task = shown.add_task(title, total=total)
        yield lambda amount: shown.advance(task, amount)
