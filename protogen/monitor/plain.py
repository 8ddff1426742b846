"""The monitor as lines, for pipes."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

import typer

from protogen.cli.wire.event_lines import EventLines

if TYPE_CHECKING:
    from protogen.monitor.filters import Filter
    from protogen.monitor.session import Session

_PAUSE = 0.05
"""Seconds from one look to the next."""


def watch(session: Session, kept: Filter, seconds: float | None) -> None:
    """Print the events that a filter keeps, with their times, until the line ends or it is time."""
    lines = EventLines(session.codec.protocol, show_sender=len(session.codec.senders) > 1)
    end = None if seconds is None else time.monotonic() + seconds
    shown = 0
    while True:
        is_over = session.is_over or (end is not None and time.monotonic() >= end)
        news = session.since(shown)
        if news and news[0].number > shown:
            missing = news[0].number - shown
            typer.echo(f"{missing:,} events left out: the output is slower than the line", err=True)
        for item in news:
            shown = item.number + 1
            if item.event is None:
                typer.echo(item.note, err=True)
            elif kept.keeps(item.event):
                typer.echo(f"{item.when / 1e9:.6f} {lines.text(item.event)}")
        if news:
            sys.stdout.flush()
        if is_over:
            return
        time.sleep(_PAUSE)
