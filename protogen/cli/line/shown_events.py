"""Shows what is on a line as readable lines, while it comes."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import typer

from protogen.cli.exits import UsageError
from protogen.cli.wire.event_lines import EventLines
from protogen.link.line import LineDecoders

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec


class ShownEvents:
    """Prints the events of each source, and ends what a silence ends."""

    def __init__(self, codec: Codec, endpoints: Sequence[str]) -> None:
        """`endpoints` are the sources that are endpoints; any may have sent what others send."""
        self._codec = codec
        self._endpoints = endpoints
        self._lines = EventLines(codec.protocol, show_sender=len(codec.senders) > 1)
        self._line = LineDecoders(codec.runtime)
        self._alone: dict[str, LineDecoders] = {}
        self._timers: dict[str, asyncio.TimerHandle] = {}
        silence = codec.protocol.silence
        self._silence = None if silence is None else float(silence)

    def take(self, source: str, data: bytes) -> None:
        """Show what these bytes complete. Raises UsageError where no decoder takes any sender's."""
        try:
            self._show(self._decoders(source).feed(self._endpoint(source), data))
        except ValueError as error:
            hint = f"name them, such as {self._codec.senders[0]}=PORT"
            raise UsageError(f"{error}; which endpoint is at which port?", hint) from None
        if self._silence is not None:
            if source in self._timers:
                self._timers[source].cancel()
            loop = asyncio.get_running_loop()
            self._timers[source] = loop.call_later(self._silence, self._idle, source)

    def end(self) -> None:
        """Show what is left."""
        for line in (self._line, *self._alone.values()):
            self._show(line.flush())

    def _idle(self, source: str) -> None:
        self._show(self._decoders(source).idle(self._endpoint(source)))

    def _endpoint(self, source: str) -> str:
        return source if source in self._endpoints else ""

    def _decoders(self, source: str) -> LineDecoders:
        """Those of the line; two ports of unknown senders must not be mixed."""
        if source in self._endpoints:
            return self._line
        return self._alone.setdefault(source, LineDecoders(self._codec.runtime))

    def _show(self, events: Sequence[Any]) -> None:
        for event in events:
            typer.echo(self._lines.text(event))
        if events:
            sys.stdout.flush()
