"""`protogen record`: the bytes of a line into a file, with the times at which they came."""

from __future__ import annotations

import asyncio
import time
from typing import TYPE_CHECKING

import msgspec
import typer

from protogen.cli.exits import CLEAN
from protogen.cli.line.options import Baud, Dtr, PortText, Rts, Seconds, line_settings, named_port
from protogen.cli.line.recorders import (
    AnyRecorder,
    Force,
    MostMegabytes,
    MostMinutes,
    Output,
    RecordingFormat,
    check_output,
    open_recorder,
)
from protogen.cli.line.running import run_until_stopped, tell, tell_name
from protogen.cli.options import SchemaFile

if TYPE_CHECKING:
    from collections.abc import Callable

    from protogen.link.ports.port import Port
    from protogen.link.ports.settings import LineSettings

EXAMPLE = "Example: protogen record rover.yaml board=/dev/ttyUSB0 -o run.pgrec"


class _Taken(msgspec.Struct):
    """What was recorded, and where."""

    bytes: int = 0
    recorder: AnyRecorder | None = None


def record(  # noqa: PLR0913 - each option is one argument
    schema: SchemaFile,
    port: PortText,
    output: Output,
    format: RecordingFormat = "pgrec",
    seconds: Seconds = None,
    max_size: MostMegabytes = None,
    max_time: MostMinutes = None,
    force: Force = False,
    baud: Baud = None,
    dtr: Dtr = None,
    rts: Rts = None,
) -> int:
    """Record what comes from a port, until Ctrl-C.

    With `board=/dev/ttyUSB0`, the recording says that `board` sent it. What was written stays,
    however the command ends. A port that is lost is waited for; the recording notes it.
    """
    from protogen.cli.schemas import open_protocol

    protocol = open_protocol(schema)
    source, address = named_port(port, protocol)
    settings = line_settings(protocol.link, baud, dtr, rts)
    check_output(output, force=force or max_size is not None or max_time is not None)
    taken = _Taken()
    began = time.monotonic()

    def begin() -> AnyRecorder:
        taken.recorder = open_recorder(output, format, max_size, max_time, force=force)
        return taken.recorder

    try:
        run_until_stopped(lambda: _record(address, settings, source, begin, taken), seconds)
    finally:
        if taken.recorder is not None:
            taken.recorder.close()
    if taken.recorder is not None:
        passed = time.monotonic() - began
        typer.echo(f"{taken.bytes:,} bytes in {passed:.1f} s: {taken.recorder.where}")
    return CLEAN


async def _record(
    address: str,
    settings: LineSettings,
    source: str,
    begin: Callable[[], AnyRecorder],
    taken: _Taken,
) -> None:
    from protogen.link.ports.opening import open_lasting_port

    def noted(text: str) -> None:
        if taken.recorder is not None:
            taken.recorder.note(text)
        tell(text)

    async with await open_lasting_port(address, settings, noted) as port:
        recorder = begin()  # Where there is no port, no file is made, nor one written over.
        tell_name(address, port)
        tell(f"recording {port.name}; Ctrl-C ends it")
        syncing = asyncio.create_task(_synced(recorder))
        try:
            await _take(port, source, recorder, taken)
        finally:
            syncing.cancel()


async def _take(port: Port, source: str, recorder: AnyRecorder, taken: _Taken) -> None:
    while (arrival := await port.read()).data:
        recorder.write(arrival.data, arrival.when, source)
        taken.bytes += len(arrival.data)


async def _synced(recorder: AnyRecorder) -> None:
    """Have the disk take what was written, each second, for those who fear for the power."""
    while True:
        await asyncio.sleep(1)
        await asyncio.to_thread(recorder.sync)
