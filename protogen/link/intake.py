"""What comes in from a port: a portion at a time, or that nothing came."""

from __future__ import annotations

import asyncio

from protogen.link.ports.port import Arrival, Port

_MANY = 64
"""Bytes of a portion behind which more are gathered: at 1 Mbaud they come in 0.6 ms, and at 115200
baud in 6, so that only a fast line that is busy is affected."""
_GATHERED = 1024
"""Bytes to wait for, at most: systems hold 4096 for a program that does not read. Behind a portion
that is much longer, more may be there already."""
_GATHERED_FOR = 0.005
"""Seconds, at most. Each portion costs, however short it is, and each millisecond brings one."""


class Intake:
    """Reads one port, for one task."""

    def __init__(self, port: Port) -> None:
        self._port = port
        self._reading: asyncio.Task[Arrival] | None = None
        self._came = 0.0
        """When the last portion came, in seconds of the event loop."""
        self._pause = 0.0
        """Seconds for which bytes gather now."""

    async def next(self, silence: float | None) -> Arrival | None:
        """What comes next; None where nothing did for so many seconds.

        Bytes without data are the end. Raises PortLostError.
        """
        if self._pause and (silence is None or silence > 2 * _GATHERED_FOR):
            await self._port.gather(self._pause)
        arrival = await self._next(silence)
        self._pause = 0.0 if arrival is None else self._pause_behind(len(arrival.data))
        return arrival

    def _pause_behind(self, size: int) -> float:
        """How long bytes gather behind a portion of so many.

        Not at all on a slow line, nor where the reader is the slower one.
        """
        now = asyncio.get_running_loop().time()
        lasted, self._came = now - self._came, now
        if not _MANY <= size <= 4 * _GATHERED:
            return 0.0
        return min(_GATHERED_FOR, lasted * _GATHERED / size)

    async def _next(self, silence: float | None) -> Arrival | None:
        if self._reading is None and silence is None:
            return await self._port.read()
        if self._reading is None:  # A read goes on over silences: it may be opening the port again.
            self._reading = asyncio.create_task(self._port.read())
        done, _ = await asyncio.wait({self._reading}, timeout=silence)
        if not done:
            return None
        reading, self._reading = self._reading, None
        return reading.result()

    async def close(self) -> None:
        """Read no more."""
        if self._reading is not None:
            self._reading.cancel()
            await asyncio.gather(self._reading, return_exceptions=True)
