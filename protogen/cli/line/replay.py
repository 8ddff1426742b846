"""`protogen replay`: what was recorded, sent to a port."""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from protogen.cli.exits import CLEAN, UsageError
from protogen.cli.line.options import PORTS, Baud, Dtr, Rts
from protogen.cli.line.running import run_until_stopped, tell, tell_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from protogen.cli.wire.codec import Codec
    from protogen.link.ports.port import Port
    from protogen.link.ports.settings import LineSettings

EXAMPLE = "Example: protogen replay run.pgrec /dev/ttyUSB0 --source host --speed 2"


class _Sent:
    """How much was sent."""

    def __init__(self) -> None:
        self.bytes = 0


def replay(  # noqa: PLR0913 - each option is one argument
    recording: Annotated[Path, typer.Argument(metavar="FILE", help="The recording.")],
    port: Annotated[str, typer.Argument(metavar="PORT", help=PORTS)],
    source: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Whose bytes to send, where there are several senders."),
    ] = None,
    speed: Annotated[
        float, typer.Option(min=0, help="2 sends in half the time; 0 as fast as the port takes it.")
    ] = 1.0,
    schema: Annotated[
        Path | None,
        typer.Option(metavar="SCHEMA", help="Take settings of the line from there; for --step."),
    ] = None,
    step: Annotated[
        bool, typer.Option("--step", help="Send one frame for each line on standard input.")
    ] = False,
    baud: Baud = None,
    dtr: Dtr = None,
    rts: Rts = None,
) -> int:
    """Send the bytes of a recording to a port, at the pace at which they came.

    With --step, standard input tells when: each Enter sends the next frame, with what stands in
    front of it, and shows it.
    """
    from protogen.cli.wire.codec import open_codec
    from protogen.link.ports.settings import settings_of
    from protogen.model.protocol import Link

    if step and schema is None:
        raise UsageError("--step has to know what a frame is", "give --schema SCHEMA")
    codec = None if schema is None else open_codec(schema)
    link = Link() if codec is None else codec.protocol.link
    settings = settings_of(link, baud, dtr=dtr, rts=rts)
    chosen = _source(recording, source)
    sent = _Sent()
    if step and codec is not None:
        frames = _frames(recording, chosen, codec)
        run_until_stopped(lambda: _send_steps(frames, port, settings, sent))
    else:
        run_until_stopped(lambda: _send(recording, chosen, port, settings, speed, sent))
    typer.echo(f"{sent.bytes:,} bytes sent", err=True)
    return CLEAN


def _source(recording: Path, source: str | None) -> str | None:
    """The source whose bytes are sent. Raises UsageError where it is not said which."""
    from protogen.link.ports.recording import sources_of

    known = sources_of(str(recording))
    if source is not None and source not in known:
        raise UsageError(f"{recording} has nothing of `{source}`", _names(known))
    if source is None and len(known) > 1:
        raise UsageError(f"{recording} has bytes of several senders", f"give {_names(known)}")
    return source


def _names(known: list[str]) -> str:
    return " or ".join(f"--source {name}" for name in known if name) or "leave out --source"


async def _send(
    recording: Path,
    source: str | None,
    address: str,
    settings: LineSettings,
    speed: float,
    sent: _Sent,
) -> None:
    from protogen.link.ports.opening import open_port
    from protogen.link.ports.recording import open_recording

    recorded = open_recording(str(recording), speed, source)
    async with await open_port(address, settings) as port:
        await _begin(address, port)
        while data := (await recorded.read()).data:
            await _write(port, data, sent)
        await _end(port)


async def _write(port: Port, data: bytes, sent: _Sent) -> None:
    await port.write(data)
    sent.bytes += len(data)


def _frames(recording: Path, source: str | None, codec: Codec) -> Iterator[tuple[str, bytes]]:
    """Each frame with its readable line, and the bytes of it and of what is no frame in front."""
    from protogen.cli.wire.event_lines import EventLines
    from protogen.link.line import LineDecoders
    from protogen.link.ports.recording import pieces_of

    lines = EventLines(codec.protocol, show_sender=False)
    decoders = LineDecoders(codec.runtime)
    name = source if source in codec.senders else ""
    front = b""

    def found(events: list[Any]) -> Iterator[tuple[str, bytes]]:
        nonlocal front
        for event in events:
            front += event.raw
            if event.kind != "invalid":
                yield lines.text(event), front
                front = b""

    for data, _ in pieces_of(str(recording), source):
        yield from found(decoders.feed(name, data))
    yield from found(decoders.flush())
    if front:
        yield f"{len(front)} bytes that are no frame", front


async def _send_steps(
    frames: Iterator[tuple[str, bytes]], address: str, settings: LineSettings, sent: _Sent
) -> None:
    from protogen.link.ports.opening import open_port

    async with await open_port(address, settings) as port:
        await _begin(address, port)
        for text, data in frames:
            tell(f"next: {text}")
            if not await asyncio.to_thread(sys.stdin.readline):
                break
            await _write(port, data, sent)
        await _end(port)


async def _begin(address: str, port: Port) -> None:
    """Wait for who opens a port that was made: nothing is sent to nobody."""
    tell_name(address, port)
    if port.name != address:
        tell("waiting until it is opened")
    await port.joined()


async def _end(port: Port) -> None:
    """Leave what was sent for as long as it is being read."""
    if not await port.taken():
        tell("the other end has not read all of it")
