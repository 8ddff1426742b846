"""`protogen tap`: in the middle of a line, passing on and showing what both ends send."""

from __future__ import annotations

import sys
from contextlib import AsyncExitStack, ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from protogen.cli.exits import CLEAN, UsageError
from protogen.cli.line.options import (
    Baud,
    Delay,
    Drop,
    Dtr,
    Flip,
    PortText,
    Rts,
    Seed,
    damage_rates,
    line_settings,
    named_port,
)
from protogen.cli.line.recorders import Force, RecordingFormat, check_output, open_recorder
from protogen.cli.line.running import run_until_stopped, tell, tell_name
from protogen.cli.line.shown_events import ShownEvents
from protogen.cli.options import Quiet, SchemaFile

if TYPE_CHECKING:
    from collections.abc import Callable

    from protogen.link.damage import DamageRates
    from protogen.link.ports.port import Arrival
    from protogen.link.ports.settings import LineSettings
    from protogen.link.tapping import End, Passed, Take
    from protogen.model.protocol import Protocol

EXAMPLE = "Example: protogen tap rover.yaml board=/dev/ttyUSB0 host=pty: -o run.pgrec"

_LETTERS = ("a", "b")
"""Names of ports of which no endpoint is named."""
_SWITCH_INTERVAL = 0.0002
"""Seconds after which the thread that shows what passes lets the line go on, if there is need."""


def tap(  # noqa: PLR0913 - each option is one argument
    schema: SchemaFile,
    port_a: PortText,
    port_b: PortText,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="Record both directions, too."),
    ] = None,
    format: RecordingFormat = "pgrec",
    force: Force = False,
    drop: Drop = 0.0,
    flip: Flip = 0.0,
    delay: Delay = 0.0,
    seed: Seed = 0,
    quiet: Quiet = False,
    baud: Baud = None,
    dtr: Dtr = None,
    rts: Rts = None,
) -> int:
    """Pass bytes on between two ports, at once and as they are, and show what they say.

    `board=/dev/ttyUSB0` says that what comes from there was sent by `board`. With `host=pty:`, a
    program opens the pseudo-terminal that is made, in the place of the device. Recordings and what
    is shown are what was passed on: with damage that was done on purpose, the damaged bytes.
    """
    from protogen.cli.wire.codec import open_codec

    codec = open_codec(schema)
    ends = _ends(codec.protocol, port_a, port_b)
    settings = line_settings(codec.protocol.link, baud, dtr, rts)
    rates = damage_rates(drop, flip, delay)
    passed: dict[str, Passed] = {}
    if output is not None:
        check_output(output, force=force)
    with ExitStack() as stack:
        shown = (
            None if quiet else ShownEvents(codec, [name for name in ends if name not in _LETTERS])
        )
        if shown is not None:
            sys.setswitchinterval(_SWITCH_INTERVAL)

        def begin() -> Take:
            """Begin the recording, once the ports are open: if one is not, an old file stays."""
            recorder = None
            if output is not None:
                recorder = open_recorder(output, format, None, None, force=force)
                stack.callback(recorder.close)

            def take(source: str, arrival: Arrival) -> None:
                if recorder is not None:
                    recorder.write(arrival.data, arrival.when, source)
                if shown is not None:
                    shown.take(source, arrival.data)

            return take

        run_until_stopped(lambda: _tap(ends, settings, rates, seed, begin, passed))
        if shown is not None:
            shown.end()
    for name, way in passed.items():
        held = f"held {way.mean_held * 1e3:.2f} ms on average, {way.most_held * 1e3:.2f} at most"
        lost = f"; {way.lost:,} were lost, as nobody took them" if way.lost else ""
        typer.echo(f"{name}: {way.bytes:,} bytes passed on, {held}{lost}", err=True)
    return CLEAN


def _ends(protocol: Protocol, *texts: str) -> dict[str, str]:
    """Endpoint or, where none is named, letter of each port, with the port.

    Raises UsageError where one endpoint is named twice.
    """
    named = [named_port(text, protocol) for text in texts]
    ends = {name or letter: port for (name, port), letter in zip(named, _LETTERS, strict=True)}
    if len(ends) < len(texts):
        raise UsageError(f"both ports are said to lead to {named[0][0]}", "name the other end")
    return ends


async def _tap(
    ends: dict[str, str],
    settings: LineSettings,
    rates: DamageRates,
    seed: int,
    begin: Callable[[], Take],
    passed: dict[str, Passed],
) -> None:
    from protogen.link.damage import Damage
    from protogen.link.ports.opening import open_lasting_port
    from protogen.link.tapping import End, tap

    async with AsyncExitStack() as stack:
        opened: list[End] = []
        for name, address in ends.items():
            port = await stack.enter_async_context(await open_lasting_port(address, settings, tell))
            tell_name(address, port, name)
            damage = None if rates.is_none else Damage(rates, f"{seed} {name}")
            opened.append(End(name, port, damage))
            passed[name] = opened[-1].passed
        take = begin()
        tell(f"passing on {opened[0].port.name} and {opened[1].port.name}; Ctrl-C ends it")
        await tap(opened[0], opened[1], take)
