"""`protogen serve`: what is on a line, for Foxglove and PlotJuggler."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from protogen.cli.exits import CLEAN, UsageError
from protogen.cli.line.options import PORTS, Baud, Dtr, Rts, Seconds, line_settings, named_ports
from protogen.cli.line.running import run_until_stopped, tell
from protogen.cli.options import SchemaFile

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from protogen.cli.wire.codec import Codec
    from protogen.link.ports.settings import LineSettings
    from protogen.model.protocol import Protocol
    from protogen.serving.line_server import LineServer
    from protogen.serving.plotjuggler import DatagramSender

EXAMPLE = "Example: protogen serve rover.yaml board=/dev/ttyUSB0"

_PORT = 8765
"""The port at which Foxglove looks for a server."""
_LARGEST = 65535


def serve(  # noqa: PLR0913 - each option is one argument
    schema: SchemaFile,
    ports: Annotated[list[str], typer.Argument(metavar="[NAME=]PORT...", help=PORTS)],
    host: Annotated[
        str, typer.Option(metavar="ADDRESS", help="Where to serve; 0.0.0.0 for other machines.")
    ] = "127.0.0.1",
    port: Annotated[
        int | None,
        typer.Option(min=0, max=_LARGEST, help=f"Port of the server. Default: {_PORT}; 0: any."),
    ] = None,
    endpoint: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Send what clients publish, as this endpoint."),
    ] = None,
    plotjuggler: Annotated[
        str | None,
        typer.Option(
            metavar="HOST:PORT",
            help="Send JSON by UDP to PlotJuggler, and serve Foxglove only with --port.",
        ),
    ] = None,
    speed: Annotated[
        float, typer.Option(min=0.001, help="How fast a recording is; 2 is in half the time.")
    ] = 1.0,
    seconds: Seconds = None,
    baud: Baud = None,
    dtr: Dtr = None,
    rts: Rts = None,
) -> int:
    """Serve a line to Foxglove: a channel for each message, with its schema and units.

    With --endpoint, a client that publishes JSON on /ENDPOINT/MESSAGE sends that message to the
    port; any page in a browser here could do so. A recording begins when the first client has
    subscribed. Ends with Ctrl-C.
    """
    from protogen.cli.wire.codec import open_codec

    codec = open_codec(schema)
    ends = named_ports(codec.protocol, ports)
    line = _Line(codec, ends, line_settings(codec.protocol.link, baud, dtr, rts), speed)
    outputs = _Outputs(
        None
        if plotjuggler is not None and port is None
        else (host, _PORT if port is None else port),
        _speakers(codec.protocol, endpoint),
        None if plotjuggler is None else _address(plotjuggler),
    )
    if outputs.foxglove is not None:
        _require_foxglove()
    run_until_stopped(lambda: _serve(line, outputs), seconds)
    return CLEAN


class _Line:
    """What is read."""

    def __init__(
        self, codec: Codec, ends: dict[str, str], settings: LineSettings, speed: float
    ) -> None:
        self.codec = codec
        self.ends = ends
        self.settings = settings
        self.speed = speed

    def server(self) -> LineServer:
        """A server of the line, which reads nothing yet."""
        from protogen.serving.line_server import LineServer

        return LineServer(self.codec, self.ends, self.settings, tell, self.speed)

    @property
    def is_replay(self) -> bool:
        """True if it is recordings, which can wait."""
        from protogen.link.ports.address import PortKind, parse_address

        return all(parse_address(it).kind is PortKind.RECORDING for it in self.ends.values())


class _Outputs:
    """Who is served."""

    def __init__(
        self,
        foxglove: tuple[str, int] | None,
        speakers: Sequence[str],
        plotjuggler: tuple[str, int] | None,
    ) -> None:
        self.foxglove = foxglove
        self.speakers = speakers
        self.plotjuggler = plotjuggler


async def _serve(line: _Line, outputs: _Outputs) -> None:
    server = line.server()
    datagrams = None
    try:
        await server.open()
        if outputs.plotjuggler is not None:
            datagrams = _add_plotjuggler(server, outputs.plotjuggler)
        if outputs.foxglove is not None:
            tell(server.add_foxglove(outputs.foxglove, outputs.speakers).address)
        try:
            await server.run(waits=line.is_replay and datagrams is None)
        finally:
            _report(server, datagrams)
    finally:
        await server.close()


def _add_plotjuggler(server: LineServer, address: tuple[str, int]) -> DatagramSender:
    from protogen.serving.plotjuggler import DatagramSender

    sender = DatagramSender(*address)
    server.add(sender)
    tell(f"JSON by UDP to {address[0]}:{address[1]}")
    return sender


def _report(server: LineServer, datagrams: DatagramSender | None) -> None:
    tell(f"served {server.rows:,}, sent {server.sent:,}")
    if datagrams is not None and datagrams.lost:
        tell(f"{datagrams.lost:,} were too large for a datagram, or there was no room")


def _require_foxglove() -> None:
    """Raise UsageError where the SDK is not installed."""
    from importlib.util import find_spec

    if find_spec("foxglove") is None:
        problem = "serving Foxglove needs the package foxglove-sdk, which is not installed"
        hint = "pip install 'protogen-serial[foxglove]', or give --plotjuggler 127.0.0.1:9870"
        raise UsageError(problem, hint)


def _speakers(protocol: Protocol, endpoint: str | None) -> Sequence[str]:
    """The endpoint as which is sent, if one is named: a board is not to move by accident.

    Raises UsageError for a name that sends nothing.
    """
    from protogen.problems import hint_for

    if endpoint is None:
        return []
    if endpoint not in protocol.sending:
        hint = hint_for(endpoint, protocol.sending) or _list(protocol.sending)
        raise UsageError(f"`{endpoint}` is no endpoint of {protocol.name} that sends", hint)
    return [endpoint]


def _list(names: Iterable[str]) -> str:
    return f"these send: {', '.join(names)}"


def _address(text: str) -> tuple[str, int]:
    """Host and port of `HOST:PORT`. Raises UsageError."""
    host, _, number = text.rpartition(":")
    if not number.isdecimal() or not 0 < int(number) <= _LARGEST:
        raise UsageError(f"`{text}` is no address", "write it as 127.0.0.1:9870")
    return host.strip("[]") or "127.0.0.1", int(number)
