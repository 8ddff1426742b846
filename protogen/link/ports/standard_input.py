"""Standard input as a port that can only be read."""

from __future__ import annotations

import asyncio
import sys
import time
from io import BufferedReader
from threading import Semaphore, Thread
from typing import cast

from protogen.link.ports.port import MOST_READ, Arrival, Port, PortError

_WAITING = 16
"""So many pieces may wait to be taken; then whoever writes has to wait."""


class StandardInput(Port):
    """Bytes of a pipe, a file or a terminal, as they come.

    A thread of its own reads, as files and terminals can't be waited for otherwise. It ends with
    the program, even while it waits.
    """

    def __init__(self) -> None:
        """Begin to read. Needs a running event loop."""
        super().__init__("-")
        self._loop = asyncio.get_running_loop()
        self._arrived: asyncio.Queue[Arrival] = asyncio.Queue()
        self._room = Semaphore(_WAITING)
        self._has_ended = False
        Thread(target=self._take, name="standard input", daemon=True).start()

    def _take(self) -> None:
        stream = cast(BufferedReader, sys.stdin.buffer)
        data = b"."
        while data:
            self._room.acquire()
            data = stream.read1(MOST_READ)
            arrival = Arrival(data, time.time_ns())
            try:
                self._loop.call_soon_threadsafe(self._arrived.put_nowait, arrival)
            except RuntimeError:  # The event loop has ended.
                return

    async def read(self) -> Arrival:
        """Wait for bytes; none mean the end."""
        if self._has_ended:
            return Arrival(b"", time.time_ns())
        arrival = await self._arrived.get()
        self._room.release()
        self._has_ended = not arrival.data
        return arrival

    async def write(self, data: bytes) -> None:
        """Raise PortError: nothing can be sent there."""
        raise PortError("nothing can be sent to standard input", "give the port of the device")

    async def close(self) -> None:
        """Leave it open: it is the program's."""
