"""What the monitor knows of a line: read and decoded in a thread, which waits for no drawing."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Mapping
from concurrent.futures import Future
from threading import Lock, Thread
from typing import TYPE_CHECKING, Any

import msgspec

from protogen.errors import UserError
from protogen.link.line import LineDecoders
from protogen.link.ports.opening import open_lasting_port
from protogen.link.ports.port import Port
from protogen.link.ports.settings import LineSettings
from protogen.link.statistics import LineStatistics

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec

_KEPT = 10_000
"""Events that are kept for the log."""
_PATIENCE = 10


class Logged(msgspec.Struct, frozen=True):
    """An event, or a note such as that the port was lost."""

    number: int
    when: int
    event: Any
    note: str = ""


class Session:
    """A line that is being watched. `lock` is held while its statistics and its log change."""

    def __init__(self, codec: Codec, ends: Mapping[str, str], settings: LineSettings) -> None:
        """`ends` are ports by the endpoint that is there; "" is one of which that is not known."""
        self.codec = codec
        self.ends = dict(ends)
        self.lock = Lock()
        self.statistics = LineStatistics(codec.protocol)
        self.log: deque[Logged] = deque(maxlen=_KEPT)
        self.number = 0
        """Events and notes so far."""
        self.is_over = False
        """True when the input has ended."""
        self.error: UserError | None = None
        """What ended the watching, if it was a mistake."""
        self._settings = settings
        self._decoders = LineDecoders(codec.runtime)
        self._loop = asyncio.new_event_loop()
        self._ports: dict[str, Port] = {}
        self._work: asyncio.Task[None] | None = None
        self._thread = Thread(target=self._run, name="line", daemon=True)
        self._ready: Future[None] = Future()

    def start(self) -> None:
        """Open the ports and begin. Raises PortError."""
        self._thread.start()
        self._ready.result()

    def stop(self) -> None:
        """Give the ports back."""
        if self._work is not None and not self._work.done():
            self._loop.call_soon_threadsafe(self._work.cancel)
        self._thread.join(_PATIENCE)

    def send(self, data: bytes) -> None:
        """Send a frame to the first port. Raises PortError."""
        port = next(iter(self._ports.values()))
        asyncio.run_coroutine_threadsafe(port.write(data), self._loop).result(_PATIENCE)

    def _run(self) -> None:
        try:
            self._loop.run_until_complete(self._watch())
        except asyncio.CancelledError:
            pass
        except UserError as error:
            self.error = error
            if not self._ready.done():
                self._ready.set_exception(error)
        finally:
            self.is_over = True
            self._loop.close()

    async def _watch(self) -> None:
        self._work = asyncio.current_task()
        for source, address in self.ends.items():
            self._ports[source] = await open_lasting_port(address, self._settings, self._note)
        self._ready.set_result(None)
        reading = [
            asyncio.create_task(self._read(source, port)) for source, port in self._ports.items()
        ]
        try:
            await asyncio.gather(*reading)
            self._take("", self._decoders.flush(), time.time_ns())
        finally:
            for task in reading:
                task.cancel()
            await asyncio.gather(*reading, return_exceptions=True)
            for port in self._ports.values():
                await port.close()

    async def _read(self, source: str, port: Port) -> None:
        silence = self._silence(source)
        while True:
            try:
                arrival = await asyncio.wait_for(port.read(), silence)
            except TimeoutError:
                self._take(source, self._decoders.idle(source), time.time_ns())
                silence = None  # It has ended what it could.
                continue
            if not arrival.data:
                return
            silence = self._silence(source)
            with self.lock:
                self.statistics.take_bytes(source, len(arrival.data), arrival.when)
            try:
                events = self._decoders.feed(source, arrival.data)
            except ValueError as error:
                name = self.codec.senders[0]
                raise UserError(f"{error}", f"say who is there: {name}=PORT") from None
            self._take(source, events, arrival.when)

    def _silence(self, source: str) -> float | None:
        from protogen.cli.wire.silences import ends_of_frames

        known = ends_of_frames(self.codec.protocol)
        found = known.get(source, min(known.values(), default=None))
        idle = found if found is not None else self.codec.protocol.link.idle_timeout
        return None if idle is None else float(idle)

    def _take(self, source: str, events: list[Any], when: int) -> None:
        with self.lock:
            for event in events:
                self.statistics.take(event, when)
                self._add(Logged(self.number, when, event))

    def _note(self, text: str) -> None:
        with self.lock:
            self._add(Logged(self.number, time.time_ns(), None, text))

    def _add(self, item: Logged) -> None:
        self.log.append(item)
        self.number += 1
