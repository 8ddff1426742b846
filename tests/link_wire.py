"""A line in memory that keeps what was sent over it, and an event loop whose time costs nothing."""

from __future__ import annotations

import asyncio
import selectors
from collections.abc import Coroutine
from typing import Any

from protogen.link.ports.port import Arrival, Port, PortLostError


class WireEnd(Port):
    """One end of a line in memory. What is written here is read at the other end, in order."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.other: WireEnd
        self.written: list[tuple[float, bytes]] = []
        """All that was written here, each piece with the loop's time."""
        self._held = bytearray()
        self._changed = asyncio.Event()
        self._is_open = True

    async def read(self) -> Arrival:
        while not self._held:
            if not self._is_open:
                raise PortLostError(f"{self.name} is closed")
            self._changed.clear()
            await self._changed.wait()
        data = bytes(self._held)
        self._held.clear()
        return Arrival(data, 0)

    async def write(self, data: bytes) -> None:
        self.written.append((asyncio.get_running_loop().time(), data))
        self.other._held += data
        self.other._changed.set()

    async def close(self) -> None:
        self._is_open = False
        self._changed.set()


def wire() -> tuple[WireEnd, WireEnd]:
    """Both ends of a line."""
    one, other = WireEnd("one end"), WireEnd("the other end")
    one.other, other.other = other, one
    return one, other


class _Jumping(selectors.DefaultSelector):
    """Waits for nothing: its time goes on to when the next timer is due."""

    now = 0.0

    def select(self, timeout: float | None = None) -> Any:
        ready = super().select(0)
        if not ready:
            assert timeout is not None, "everybody waits for somebody else"
            self.now += max(timeout, 0.0)
        return ready


class _VirtualTimeLoop(asyncio.SelectorEventLoop):
    def __init__(self) -> None:
        self._jumping = _Jumping()
        super().__init__(self._jumping)

    def time(self) -> float:
        return self._jumping.now


def run_in_virtual_time(work: Coroutine[Any, Any, None]) -> None:
    """Run what waits for timers and for a wire alone, in no time, and the same on each machine."""
    with asyncio.Runner(loop_factory=_VirtualTimeLoop) as runner:
        runner.run(work)
