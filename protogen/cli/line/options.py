"""Arguments and options that the commands of the line have in common."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from protogen.cli.exits import UsageError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from protogen.link.damage import DamageRates
    from protogen.link.ports.settings import LineSettings
    from protogen.model.protocol import Link, Protocol

PORTS = (
    "A device, socket://HOST:PORT, rfc2217://HOST:PORT, listen://HOST:PORT, pty:, a recording or -."
)
"""What a port may be."""

PortText = Annotated[str, typer.Argument(metavar="[NAME=]PORT", help=PORTS)]

Baud = Annotated[
    int | None,
    typer.Option(min=1, metavar="RATE", help="Bits per second. Default: the schema's, or 115200."),
]
Dtr = Annotated[
    bool | None, typer.Option("--dtr/--no-dtr", help="Set DTR. Default: leave it as it is.")
]
Rts = Annotated[
    bool | None, typer.Option("--rts/--no-rts", help="Set RTS. Default: leave it as it is.")
]

Drop = Annotated[
    float, typer.Option(min=0, max=1, help="Share of bytes to leave out, from 0 to 1.")
]
Flip = Annotated[float, typer.Option(min=0, max=1, help="Share of bytes to turn over a bit of.")]
Delay = Annotated[
    float, typer.Option(min=0, metavar="MS", help="The most milliseconds to hold bytes back.")
]
Seed = Annotated[int, typer.Option(help="The same seed does the same.")]

Seconds = Annotated[
    float | None,
    typer.Option("--for", min=0, metavar="SECONDS", help="End after so long."),
]

_MILLISECONDS = 1000


def damage_rates(drop: float, flip: float, delay: float) -> DamageRates:
    """The damage that was asked for; `delay` is in milliseconds."""
    from protogen.link.damage import DamageRates

    return DamageRates(drop=drop, flip=flip, delay=delay / _MILLISECONDS)


def named_port(text: str, protocol: Protocol) -> tuple[str, str]:
    """Split `NAME=PORT` into the endpoint that is there and the port; the name may be left out.

    Raises UsageError for a name that is no endpoint.
    """
    name, equals, port = text.partition("=")
    if not equals or "/" in name or "\\" in name or Path(text).exists():
        return "", text
    if name not in protocol.sending:
        from protogen.problems import hint_for

        known = ", ".join(protocol.sending)
        hint = hint_for(name, protocol.sending) or f"these send: {known}"
        raise UsageError(f"`{name}` is no endpoint of {protocol.name}", hint)
    return name, port


def named_ports(protocol: Protocol, ports: Sequence[str]) -> dict[str, str]:
    """Ports by the endpoint that is there. Raises UsageError where two have the same."""
    ends: dict[str, str] = {}
    for text in ports:
        name, port = named_port(text, protocol)
        if not name and len(protocol.sending) == 1:
            name = protocol.sending[0]
        if name in ends:
            hint = f"name them: {protocol.sending[0]}=PORT"
            raise UsageError("two ports need the names of who is there", hint)
        ends[name] = port
    return ends


def line_settings(link: Link, baud: int | None, dtr: bool | None, rts: bool | None) -> LineSettings:
    """The settings of a schema's link, with what the user gave in their place."""
    from protogen.link.ports.settings import settings_of

    return settings_of(link, baud, dtr=dtr, rts=rts)
