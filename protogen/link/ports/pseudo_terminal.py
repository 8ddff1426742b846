"""Pseudo-terminals: a serial port that this program makes, for another one to open."""

from __future__ import annotations

import asyncio
import os
import select
import time
from array import array
from importlib import import_module

from protogen.link.ports.port import (
    MOST_READ,
    PATIENCE,
    Arrival,
    Port,
    PortError,
    PortLostError,
    emptied,
)

_LOOK = 0.02
"""Seconds from one look to the next, where nothing tells."""
_SET_UP = 0.5
"""Seconds in which a program sets up a port that it has opened; it throws away what is there."""


class PseudoTerminal(Port):
    """The end of a pseudo-terminal that this program has; `name` is the device of the other end."""

    def __init__(self, name: str, own: int, other: int) -> None:
        """`other` stays open, so that programs can open and close their end as they like."""
        super().__init__(name)
        self._own: int | None = own
        self._other = other
        self._is_stuck = False
        """True while nobody takes what is passed on."""
        os.set_blocking(own, False)

    async def read(self) -> Arrival:
        """Wait for bytes. Raises PortLostError once it is closed."""
        while True:
            try:
                return Arrival(os.read(self._open(), MOST_READ), time.time_ns())
            except BlockingIOError:
                await self._ready(is_reading=True)
            except OSError as error:
                raise PortLostError(f"{self.name} is gone: {error.strerror}") from None

    async def write(self, data: bytes) -> None:
        """Send bytes; waits while nobody reads. Raises PortLostError once it is closed."""
        left = memoryview(data)
        while left:
            left = await self._some_left(left)

    async def pass_on(self, data: bytes) -> int:
        """Send bytes, and wait for one who reads them; without one, they are lost."""
        left = memoryview(data)
        try:
            while left:
                async with asyncio.timeout(0 if self._is_stuck else PATIENCE):
                    left = await self._some_left(left)
                self._is_stuck = False
        except TimeoutError:
            self._is_stuck = True
        return len(data) - len(left)

    async def _some_left(self, data: memoryview) -> memoryview:
        """Send what there is room for, as soon as there is room; the rest."""
        while True:
            try:
                return data[os.write(self._open(), data) :]
            except BlockingIOError:
                await self._ready(is_reading=False)
            except OSError as error:
                raise PortLostError(f"{self.name} is gone: {error.strerror}") from None

    async def offer(self, data: bytes) -> bool:
        """Send bytes as far as there is room; a line without a listener loses the others."""
        try:
            return os.write(self._open(), data) == len(data)
        except BlockingIOError:
            return False

    async def joined(self) -> None:
        """Wait until a program has opened the device, and is ready to read it."""
        termios = import_module("termios")
        os.close(self._other)  # The system tells it only where nobody else has it open.
        try:
            while _is_alone(self._open()):
                await asyncio.sleep(_LOOK)
        finally:
            self._other = os.open(self.name, os.O_RDWR | os.O_NOCTTY)
            if termios.tcgetattr(self._other)[3] & termios.ICANON:  # Its settings were lost.
                import_module("tty").setraw(self._other)
        await asyncio.sleep(_SET_UP)

    async def taken(self) -> bool:
        """Wait until the program has read all; False if it has stopped to read."""
        return await emptied(lambda: _waiting(self._other))

    async def close(self) -> None:
        """Take the device away."""
        if self._own is None:
            return
        loop = asyncio.get_running_loop()
        loop.remove_reader(self._own)
        loop.remove_writer(self._own)
        os.close(self._own)
        os.close(self._other)
        self._own = None

    def _open(self) -> int:
        if self._own is None:
            raise PortLostError(f"{self.name} is closed")
        return self._own

    async def _ready(self, *, is_reading: bool) -> None:
        """Wait until there is something to read, or room to write."""
        loop, own = asyncio.get_running_loop(), self._open()
        add, remove = (
            (loop.add_reader, loop.remove_reader)
            if is_reading
            else (loop.add_writer, loop.remove_writer)
        )
        ready = loop.create_future()
        add(own, _settle, ready)
        try:
            await ready
        finally:
            if self._own is not None:
                remove(own)


def _is_alone(own: int) -> bool:
    """True if nobody has the device open."""
    poll = select.poll()
    poll.register(own, 0)
    return any(event & select.POLLHUP for _, event in poll.poll(0))


def _waiting(other: int) -> int:
    """Bytes that the device holds for its reader."""
    size = array("i", [0])
    import_module("fcntl").ioctl(other, import_module("termios").FIONREAD, size)
    return size[0]


def _settle(ready: asyncio.Future[None]) -> None:
    if not ready.done():
        ready.set_result(None)


def make_pseudo_terminal() -> PseudoTerminal:
    """Make a pseudo-terminal that passes all bytes on as they are.

    Raises PortError where the system has none.
    """
    try:
        tty = import_module("tty")
        own, other = os.openpty()
    except (ImportError, AttributeError):
        problem = "this system has no pseudo-terminals"
        raise PortError(problem, "listen on TCP instead: listen://127.0.0.1:9000") from None
    except OSError as error:
        raise PortError(f"can't make a pseudo-terminal: {error.strerror}") from None
    tty.setraw(other)
    return PseudoTerminal(os.ttyname(other), own, other)
