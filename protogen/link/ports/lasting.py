"""A port that is opened again when it was lost."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from protogen.link.ports.port import Arrival, Port, PortError, PortLostError

_PAUSES = (0.1, 0.2, 0.5, 1.0)
"""Seconds between attempts; the last one again and again."""


class LastingPort(Port):
    """Opens its port again for as long as that takes, and says so by `tell`.

    What was written while the port was gone is lost: a device that comes back is not to be
    surprised by old commands.
    """

    def __init__(
        self, port: Port, reopen: Callable[[], Awaitable[Port]], tell: Callable[[str], None]
    ) -> None:
        """`reopen` opens the port anew, or raises PortError; `tell` takes news for the user."""
        super().__init__(port.name)
        self._port: Port | None = port
        self._reopen = reopen
        self._tell = tell

    @property
    def is_there(self) -> bool:
        """True while the port is open."""
        return self._port is not None

    async def read(self) -> Arrival:
        """Wait for bytes, and for the port, if it is gone."""
        while True:
            port = self._port or await self._opened_again()
            try:
                return await port.read()
            except PortLostError as error:
                await self._lose(port, error)

    async def gather(self, seconds: float) -> None:
        """Let bytes gather, where the port is there."""
        if self._port is not None:
            await self._port.gather(seconds)

    async def write(self, data: bytes) -> None:
        """Send bytes. Raises PortLostError while the port is gone."""
        if self._port is None:
            raise PortLostError(f"{self.name} is gone; nothing is sent until it is back")
        try:
            await self._port.write(data)
        except PortLostError as error:
            await self._lose(self._port, error)
            raise

    async def pass_on(self, data: bytes) -> int:
        """Send bytes; they are lost while the port is gone."""
        if self._port is None:
            return 0
        try:
            return await self._port.pass_on(data)
        except PortLostError as error:
            await self._lose(self._port, error)
            return 0

    async def close(self) -> None:
        """Give the port back."""
        if self._port is not None:
            await self._port.close()

    async def _lose(self, port: Port, error: PortLostError) -> None:
        if self._port is not port:
            return
        self._port = None
        await port.close()
        self._tell(f"{error}; waiting for it")

    async def _opened_again(self) -> Port:
        attempt = 0
        while True:
            await asyncio.sleep(_PAUSES[min(attempt, len(_PAUSES) - 1)])
            attempt += 1
            try:
                self._port = await self._reopen()
            except PortError:
                continue
            self._tell(f"{self.name} is back")
            return self._port
