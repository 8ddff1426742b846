"""`protogen monitor`: what is on a line, live."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Annotated

import typer

from protogen.cli.exits import CLEAN, UsageError
from protogen.cli.line.options import PORTS, Baud, Dtr, Rts, Seconds, line_settings, named_ports
from protogen.cli.options import SchemaFile

if TYPE_CHECKING:
    from collections.abc import Iterable

    from protogen.monitor.app import MonitorApp
    from protogen.monitor.session import Session

EXAMPLE = "Example: protogen monitor rover.yaml board=/dev/ttyUSB0"


def monitor(  # noqa: PLR0913 - each option is one argument
    schema: SchemaFile,
    ports: Annotated[list[str], typer.Argument(metavar="[NAME=]PORT...", help=PORTS)],
    plain: Annotated[
        bool,
        typer.Option("--plain", help="Print lines, as where there is no screen or no keyboard."),
    ] = False,
    filter: Annotated[
        str,
        typer.Option(metavar="TEXT", help="Which events to show, such as `state.battery_v < 11`."),
    ] = "",
    seconds: Seconds = None,
    baud: Baud = None,
    dtr: Dtr = None,
    rts: Rts = None,
) -> int:
    """Watch a line: how often each message comes, its last values, what is no frame.

    With `board=/dev/ttyUSB0`, what comes from there is of `board`; without a name, it may be of
    anybody. In the full screen, keys at the bottom say what can be done: pause, filter, search,
    plot a field, send a message, save the log. A port that is lost is waited for.
    """
    from protogen.cli.wire.codec import open_codec
    from protogen.link.ports.port import PortError
    from protogen.monitor.filters import parse_filter
    from protogen.monitor.session import Session

    codec = open_codec(schema)
    ends = named_ports(codec.protocol, ports)
    kept = parse_filter(filter, codec.module)
    session = Session(codec, ends, line_settings(codec.protocol.link, baud, dtr, rts))
    app = None if plain or not has_screen(ends.values()) else _app(session)
    session.start()
    try:
        if app is None:
            from protogen.monitor.plain import watch

            with suppress(KeyboardInterrupt):
                watch(session, kept, seconds)
        else:
            app.filter_by(kept)
            if seconds is not None:
                app.end_after(seconds)
            app.run()
    finally:
        session.stop()
    if session.error is not None:
        raise PortError(str(session.error), session.error.hint)
    return CLEAN


def has_screen(addresses: Iterable[str]) -> bool:
    """True if the terminal takes a full screen, and its keys are not the line."""
    is_terminal = sys.stdout.isatty() and sys.stdin.isatty()
    return is_terminal and os.environ.get("TERM") != "dumb" and "-" not in addresses


def _app(session: Session) -> MonitorApp:
    try:
        from protogen.monitor import app
    except ModuleNotFoundError as error:
        if error.name != "textual":
            raise
        problem = "the full screen needs the package textual, which is not installed"
        hint = "pip install 'protogen-serial[monitor]', or give --plain"
        raise UsageError(problem, hint) from None
    return app.MonitorApp(session)
