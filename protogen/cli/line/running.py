"""Runs a command on a line until it is done, or stopped by Ctrl-C."""

from __future__ import annotations

import asyncio
import signal
import sys
from collections.abc import Callable, Coroutine
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from protogen.link.ports.port import Port


def run_until_stopped(
    work: Callable[[], Coroutine[Any, Any, None]], seconds: float | None = None
) -> None:
    """Run until the work is done, for so many seconds, or until Ctrl-C or SIGTERM.

    These are the usual ends of what has no end of its own, and no errors: what the work has opened
    is closed, and the command goes on to its summary.
    """
    # Where there are no signal handlers, Ctrl-C comes as an exception, behind the clean-up.
    with suppress(KeyboardInterrupt):
        asyncio.run(_stopped(work, seconds))


async def _stopped(work: Callable[[], Coroutine[Any, Any, None]], seconds: float | None) -> None:
    running = asyncio.ensure_future(work())
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        with suppress(NotImplementedError):  # On Windows.
            loop.add_signal_handler(number, running.cancel)
    if seconds is not None:
        loop.call_later(seconds, running.cancel)
    with suppress(asyncio.CancelledError):
        await running


def tell_name(address: str, port: Port, end: str = "") -> None:
    """Say what a port that was made is called, for who wants to open its other end."""
    if port.name != address:
        tell(f"{end}={address} is {port.name}" if end else f"{address} is {port.name}")


def tell(text: str) -> None:
    """Say something about the line to who watches, on standard error."""
    typer.echo(text, err=True)
    sys.stderr.flush()
