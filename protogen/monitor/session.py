"""What the monitor knows of a line: read and decoded in a thread, which waits for no drawing."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from threading import Lock, Thread
from typing import TYPE_CHECKING, Any

import msgspec

from protogen.errors import UserError
from protogen.link.ports.settings import LineSettings
from protogen.link.reader import LineReader
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
        self._reader = LineReader(codec, ends, settings, self)
        self._loop = asyncio.new_event_loop()
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
        asyncio.run_coroutine_threadsafe(self._reader.send(data), self._loop).result(_PATIENCE)

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
        try:
            await self._reader.open()
            self._ready.set_result(None)
            await self._reader.run()
        finally:
            await self._reader.close()

    # --- what the reader tells --------------------------------------------------------------------

    def take_bytes(self, source: str, data: bytes, when: int) -> None:
        """Count bytes that came."""
        with self.lock:
            self.statistics.take_bytes(source, len(data), when)

    def take_events(self, source: str, events: Sequence[Any], when: int) -> None:
        """Count events, and keep them for the log."""
        with self.lock:
            for event in events:
                self.statistics.take(event, when)
                self._add(Logged(self.number, when, event))

    def take_note(self, text: str) -> None:
        """Keep news for the log."""
        with self.lock:
            self._add(Logged(self.number, time.time_ns(), None, text))

    def _add(self, item: Logged) -> None:
        self.log.append(item)
        self.number += 1
