"""What comes in from a port: a portion at a time, or that nothing came."""

from __future__ import annotations

import asyncio

from protogen.link.ports.port import Arrival, Port

_MANY = 64
"""Bytes of a portion behind which more are gathered: at 1 Mbaud they come in 0.6 ms, and at 115200
baud in 6, so that only a fast line that is busy is affected."""
_GATHERED_FOR = 0.005
"""Seconds. Each portion costs, however few bytes it has, and each millisecond brings one."""


class Intake:
    """Reads one port, for one task."""

    def __init__(self, port: Port) -> None:
        self._port = port
        self._reading: asyncio.Task[Arrival] | None = None
        self._is_busy = False

    async def next(self, silence: float | None) -> Arrival | None:
        """What comes next; None where nothing did for so many seconds.

        Bytes without data are the end. Raises PortLostError.
        """
        if self._is_busy and (silence is None or silence > 2 * _GATHERED_FOR):
            await self._port.gather(_GATHERED_FOR)
        arrival = await self._next(silence)
        self._is_busy = arrival is not None and len(arrival.data) >= _MANY
        return arrival

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
