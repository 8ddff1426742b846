"""A line, served: rows to whoever shows them, and what clients publish to the port."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Protocol

from protogen.errors import UserError
from protogen.link.ports.settings import LineSettings
from protogen.link.reader import LineReader
from protogen.serving.live_rows import LiveRow, LiveRows, Topic
from protogen.serving.publishing import Publisher

if TYPE_CHECKING:
    from protogen.cli.wire.codec import Codec
    from protogen.serving.foxglove_server import FoxgloveServer

_WAITING = 1000
"""Published messages that wait to be sent; more are refused."""
_SETTLED = 0.2
"""Seconds after a subscription in which a client has asked for the other topics as well."""


class Output(Protocol):
    """Takes the rows."""

    def send(self, row: LiveRow) -> None:
        """Take a row; waits for nobody."""

    def stop(self) -> None:
        """Take no more."""


class LineServer:
    """Reads a line, and serves it. All of its methods are for one event loop."""

    def __init__(
        self,
        codec: Codec,
        ends: Mapping[str, str],
        settings: LineSettings,
        tell: Callable[[str], None],
        speed: float = 1.0,
    ) -> None:
        """`ends` are ports by the endpoint that is there; `tell` takes news for the user."""
        self._codec = codec
        self._tell = tell
        self._rows = LiveRows(codec.protocol, self._take, self._note)
        self._reader = LineReader(codec, ends, settings, self._rows, speed)
        self._outputs: list[Output] = []
        self._foxglove: FoxgloveServer | None = None
        self._publisher: Publisher | None = None
        self._published: asyncio.Queue[tuple[str, bytes]] = asyncio.Queue(_WAITING)
        self._subscribed = asyncio.Event()
        self.rows = 0
        """Rows that were served."""
        self.sent = 0
        """Published messages that were sent to the port."""

    @property
    def topics(self) -> Sequence[Topic]:
        """What is served."""
        return self._rows.topics

    async def open(self) -> None:
        """Open the ports. Raises PortError."""
        await self._reader.open()

    def add(self, output: Output) -> None:
        """Serve to somebody."""
        self._outputs.append(output)

    def add_foxglove(self, address: tuple[str, int], endpoints: Sequence[str]) -> FoxgloveServer:
        """Serve to Foxglove, whose messages are sent as these endpoints. Raises UserError."""
        from protogen.serving.foxglove_server import FoxgloveServer

        loop = asyncio.get_running_loop()
        self._publisher = Publisher(self._codec, endpoints)
        self._foxglove = FoxgloveServer(
            self._codec.protocol.name,
            self.topics,
            address,
            lambda topic, data: _call(loop, lambda: self._queue(topic, data)),
            lambda: _call(loop, self._subscribed.set),
        )
        self.add(self._foxglove)
        return self._foxglove

    async def run(self, *, waits: bool = False) -> None:
        """Serve until every input has ended, or for ever if clients may still look at it.

        With `waits`, nothing is read before a client has subscribed.
        """
        sending = asyncio.create_task(self._send())
        reading = asyncio.create_task(self._read(waits=waits))
        try:
            await asyncio.wait({sending, reading}, return_when=asyncio.FIRST_COMPLETED)
            await (sending if sending.done() else reading)
            if self._foxglove is not None:
                self._tell("the input has ended; clients stay connected until Ctrl-C")
                await sending
        finally:
            for task in (sending, reading):
                task.cancel()
            await asyncio.gather(sending, reading, return_exceptions=True)

    async def _read(self, *, waits: bool) -> None:
        if waits:
            await self._subscribed.wait()
            await asyncio.sleep(_SETTLED)
        await self._reader.run()

    async def close(self) -> None:
        """Let clients go, and give the ports back."""
        for output in self._outputs:
            output.stop()
        await self._reader.close()

    def _take(self, row: LiveRow) -> None:
        self.rows += 1
        for output in self._outputs:
            output.send(row)

    def _note(self, text: str) -> None:
        self._tell(text)
        if self._foxglove is not None:
            self._foxglove.note(text)

    # --- what clients publish ---------------------------------------------------------------------

    def _queue(self, topic: str, data: bytes) -> None:
        try:
            self._published.put_nowait((topic, data))
        except asyncio.QueueFull:
            assert self._foxglove is not None
            self._foxglove.complain(topic, "the port does not take so many messages")

    async def _send(self) -> None:
        while True:
            topic, data = await self._published.get()
            assert self._foxglove is not None
            assert self._publisher is not None
            try:
                sender, frame = self._publisher.frame(topic, data)
                await self._reader.send(frame, sender)
            except UserError as error:
                hint = f" ({error.hint})" if error.hint else ""
                self._foxglove.complain(topic, f"{error}{hint}")
            else:
                self.sent += 1
                self._foxglove.settle(topic)


def _call(loop: asyncio.AbstractEventLoop, function: Callable[[], None]) -> None:
    """Call a function in the thread of the loop."""
    with suppress(RuntimeError):  # The loop has ended, as the command has.
        loop.call_soon_threadsafe(function)
