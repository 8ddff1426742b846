"""A recording as a port: its bytes come at their own pace, faster, or at once."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator

from protogen.link.ports.port import Arrival, Port, PortError


class RecordedPort(Port):
    """Gives the bytes of a recording when they are due; nothing can be sent."""

    def __init__(self, name: str, pieces: Iterator[Arrival], speed: float) -> None:
        """`pieces` are what has been recorded.

        With a `speed` of 2 they come in half the time; with 0, each as soon as it is asked for.
        """
        super().__init__(name)
        self._pieces = pieces
        self._speed = speed
        self._begin: tuple[int, float] | None = None
        self._due: Arrival | None = None

    async def read(self) -> Arrival:
        """Wait until the next bytes are due; none mean the end. Times are as recorded."""
        if self._due is None:
            self._due = next(self._pieces, Arrival(b"", 0))
        due = self._due
        if due.data and self._speed:
            await self._wait_until(due.when)
        self._due = None  # One who gives up waiting finds it here again.
        return due

    async def _wait_until(self, when: int) -> None:
        now = asyncio.get_running_loop().time()
        if self._begin is None:
            self._begin = when, now
        first, begin = self._begin
        due = begin + (when - first) / 1e9 / self._speed
        await asyncio.sleep(max(0.0, due - now))

    async def write(self, data: bytes) -> None:
        """Raise PortError: nothing can be sent there."""
        raise PortError(f"nothing can be sent to the recording {self.name}", "give a device's port")

    async def close(self) -> None:
        """Leave the recording."""
        self._pieces = iter(())
