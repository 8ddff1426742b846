"""A port that others connect to by TCP, one at a time."""

from __future__ import annotations

import asyncio
import time

from protogen.link.ports.address import Address
from protogen.link.ports.port import MOST_READ, PATIENCE, Arrival, Port, PortError, emptied

_MOST_WAITING = 1 << 12
"""So many bytes wait for one who does not read; what comes then is lost."""


class ListeningPort(Port):
    """Waits for one to connect; when that one leaves, for the next. The line outlives them."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self._server: asyncio.Server | None = None
        self._joined = asyncio.Event()
        self._is_stuck = False
        """True while nobody takes what is passed on."""
        self._streams: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None

    async def listen(self, host: str, number: int) -> None:
        """Begin to listen; of port 0 the system chooses one. Raises PortError."""
        try:
            self._server = await asyncio.start_server(self._join, host, number)
        except OSError as error:
            problem = f"{self.name}: can't listen: {error.strerror or error}"
            raise PortError(problem, "choose another port number; 0 takes a free one") from None
        address = self._server.sockets[0].getsockname()
        shown = f"[{address[0]}]" if ":" in address[0] else address[0]
        self.name = f"socket://{shown}:{address[1]}"

    async def _join(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Take one who connects, unless somebody is there who has not left."""
        if self._streams is not None and not self._streams[0].at_eof():
            writer.close()
            return
        self._streams = reader, writer
        self._joined.set()

    async def read(self) -> Arrival:
        """Wait for bytes of whoever is connected."""
        while True:
            await self._joined.wait()
            assert self._streams is not None
            reader, writer = self._streams
            try:
                data = await reader.read(MOST_READ)
            except OSError:
                data = b""
            if data:
                return Arrival(data, time.time_ns())
            self._leave(writer)

    async def write(self, data: bytes) -> None:
        """Send bytes to whoever is connected; without one, they are lost as on any line."""
        if self._streams is None:
            return
        _, writer = self._streams
        try:
            writer.write(data)
            await writer.drain()
        except OSError:
            self._leave(writer)

    async def pass_on(self, data: bytes) -> int:
        """Send bytes to whoever is connected, and wait for one who reads; else they are lost."""
        if self._streams is None or self._is_stuck:
            self._is_stuck = not await self.offer(data)
            return 0 if self._is_stuck else len(data)
        try:
            async with asyncio.timeout(PATIENCE):
                await self.write(data)
        except TimeoutError:
            self._is_stuck = True  # These bytes wait for it still.
        return len(data)

    async def offer(self, data: bytes) -> bool:
        """Send bytes to whoever is connected and reads; to others they are lost."""
        if self._streams is None:
            return False
        writer = self._streams[1]
        if writer.transport.get_write_buffer_size() > _MOST_WAITING:
            return False
        writer.write(data)
        return True

    async def joined(self) -> None:
        """Wait until somebody has connected."""
        await self._joined.wait()

    async def taken(self) -> bool:
        """Wait until the system has taken all for who is connected; False if it takes no more."""
        if self._streams is None:
            return False
        transport = self._streams[1].transport
        return await emptied(transport.get_write_buffer_size)

    def _leave(self, writer: asyncio.StreamWriter) -> None:
        """Let one go, so that the next can come."""
        if self._streams is not None and self._streams[1] is writer:
            self._streams = None
            self._joined.clear()
        writer.close()

    async def close(self) -> None:
        """Listen no more, and let go who is there."""
        if self._server is None:
            return
        self._server.close()
        if self._streams is not None:
            self._leave(self._streams[1])
        self._server = None


async def listen(address: Address) -> ListeningPort:
    """Listen at an address. Raises PortError."""
    port = ListeningPort(address.text)
    await port.listen(address.host, address.number)
    return port
