"""Reads the ports of a line and decodes what comes, for whoever listens."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from protogen.errors import UserError
from protogen.link.intake import Intake
from protogen.link.line import LineDecoders
from protogen.link.ports.opening import open_lasting_port
from protogen.link.ports.port import Port, PortError
from protogen.link.ports.settings import LineSettings

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec


class Listener(Protocol):
    """Takes what comes from a line. A source is an endpoint, or "" where that is not known."""

    def take_bytes(self, source: str, data: bytes, when: int) -> None:
        """Take bytes that came, before the events that they complete."""

    def take_events(self, source: str, events: Sequence[Any], when: int) -> None:
        """Take events that are certain now."""

    def take_note(self, text: str) -> None:
        """Take news, such as that a port was lost."""


class LineReader:
    """The ports of a line and their decoders. All of its methods are for one event loop."""

    def __init__(
        self,
        codec: Codec,
        ends: Mapping[str, str],
        settings: LineSettings,
        listener: Listener,
        speed: float = 1.0,
    ) -> None:
        """`ends` are ports by the endpoint that is there; "" is one of which that is not known.

        `speed` is that of recordings.
        """
        self._codec = codec
        self._ends = dict(ends)
        self._settings = settings
        self._listener = listener
        self._speed = speed
        self._decoders = LineDecoders(codec.runtime)
        self._ports: dict[str, Port] = {}

    async def open(self) -> None:
        """Open the ports. Raises PortError."""
        self._decoders.prepare()
        for source, address in self._ends.items():
            self._ports[source] = await open_lasting_port(
                address, self._settings, self._listener.take_note, self._speed
            )

    async def run(self) -> None:
        """Read until every input has ended."""
        reading = [
            asyncio.create_task(self._read(source, port)) for source, port in self._ports.items()
        ]
        try:
            await asyncio.gather(*reading)
            for source, events in self._decoders.flush_each():
                self._listener.take_events(source, events, time.time_ns())
        finally:
            for task in reading:
                task.cancel()
            await asyncio.gather(*reading, return_exceptions=True)

    async def close(self) -> None:
        """Give the ports back."""
        for port in self._ports.values():
            await port.close()

    async def send(self, data: bytes, sender: str = "") -> None:
        """Send a frame to the first port at which its sender is not.

        With a `sender`, listeners take it as what that endpoint sent. Raises PortError.
        """
        port = next((port for end, port in self._ports.items() if not end or end != sender), None)
        if port is None:
            raise PortError(f"there is no port to send to, as {sender}", "name the other end's")
        await port.write(data)
        if sender and sender not in self._ports:  # Else it is read there.
            self._decode(sender, data, time.time_ns())

    async def _read(self, source: str, port: Port) -> None:
        intake = Intake(port)
        try:
            await self._take(source, intake)
        finally:
            await intake.close()

    async def _take(self, source: str, intake: Intake) -> None:
        silence = self._silence(source)
        seen = {source}
        while True:
            arrival = await intake.next(silence)
            if arrival is None:
                for name in seen:
                    self._listener.take_events(name, self._decoders.idle(name), time.time_ns())
                silence = None  # It has ended what it could.
                continue
            if not arrival.data:
                return
            silence = self._silence(source)
            sender = arrival.source if arrival.source in self._codec.senders else source
            seen.add(sender)
            self._decode(sender, arrival.data, arrival.when)

    def _decode(self, source: str, data: bytes, when: int) -> None:
        self._listener.take_bytes(source, data, when)
        try:
            events = self._decoders.feed(source, data)
        except ValueError as error:
            name = self._codec.senders[0]
            raise UserError(f"{error}", f"say who is there: {name}=PORT") from None
        self._listener.take_events(source, events, when)

    def _silence(self, source: str) -> float | None:
        known = self._codec.protocol.frame_silences
        found = known.get(source, min(known.values(), default=None))
        idle = found if found is not None else self._codec.protocol.link.idle_timeout
        return None if idle is None else float(idle) / (self._speed or 1)
