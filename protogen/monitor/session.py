"""What the monitor knows of a line: read and decoded in a thread, which waits for no drawing."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Mapping, Sequence
from itertools import islice
from threading import Lock
from typing import TYPE_CHECKING, Any

import msgspec

from protogen.errors import UserError
from protogen.link.loop_thread import LoopThread
from protogen.link.ports.port import PortError
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
        self._loop = LoopThread("line")
        self._work: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Open the ports and begin. Raises PortError."""
        try:
            self._loop.do(self._reader.open())
        except BaseException:
            self._loop.do(self._reader.close())
            self._loop.close()
            raise
        self._work = self._loop.begin(self._watch())

    def stop(self) -> None:
        """Give the ports back."""
        if self._work is None:
            return
        work, self._work = self._work, None
        try:
            self._loop.end(work, _PATIENCE)
        finally:
            self._loop.close()

    def send(self, data: bytes) -> None:
        """Send a frame to the first port. Raises PortError."""
        if self.is_over:
            raise PortError("the input has ended; nothing can be sent any more")
        try:
            self._loop.do(self._reader.send(data), _PATIENCE)
        except TimeoutError:
            raise PortError("the port does not take it", "does anybody read at its end?") from None

    def since(self, number: int) -> list[Logged]:
        """What was logged from a number on, as far as it is kept."""
        with self.lock:
            count = max(0, min(self.number - number, len(self.log)))
            return [*islice(reversed(self.log), count)][::-1]

    async def _watch(self) -> None:
        try:
            await self._reader.run()
        except UserError as error:
            self.error = error
        finally:
            self.is_over = True
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
