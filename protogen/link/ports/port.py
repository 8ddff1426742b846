"""What every port offers, and the errors of all of them."""

from __future__ import annotations

import abc
import asyncio
import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

import msgspec

from protogen.errors import UserError

MOST_READ = 1 << 16
"""The most bytes that a port reads at once."""


PATIENCE = 2.0
"""Seconds in which one who reads a port takes something."""


_LOOK = 0.02
"""Seconds from one look to the next, where nothing tells."""


class PortError(UserError):
    """A port can't be opened, or can't do what it was asked for."""


class PortLostError(PortError):
    """A port that was open is gone: unplugged, or the other end has closed it."""


class Arrival(msgspec.Struct, frozen=True):
    """Bytes that came together, and when: nanoseconds since 1970-01-01 UTC.

    Without bytes, the input has ended.
    """

    data: bytes
    when: int
    source: str = ""
    """Who sent them, as far as a recording says it."""


async def emptied(waiting: Callable[[], int]) -> bool:
    """Wait until no bytes wait to be read any more; False if nobody has taken any for so long."""
    left, since = 1, time.monotonic()
    while True:
        await asyncio.sleep(_LOOK)
        now = waiting()
        if not now and not left:  # At two looks: the system passes them on a moment later.
            return True
        if now < left:
            since = time.monotonic()
        elif time.monotonic() - since > PATIENCE:
            return False
        left = now


class Port(abc.ABC):
    """An open port. All of its methods are for one event loop."""

    def __init__(self, name: str) -> None:
        self.name = name
        """What the user calls it."""

    @abc.abstractmethod
    async def read(self) -> Arrival:
        """Wait for bytes, however few; no bytes mean that there will be no more.

        Raises PortLostError.
        """

    async def gather(self, seconds: float) -> None:
        """Let bytes gather for a while, for the next read to take them together.

        Only for a reader that has just taken all that was there.
        """
        await asyncio.sleep(seconds)

    @abc.abstractmethod
    async def write(self, data: bytes) -> None:
        """Send bytes; waits while the port takes no more. Raises PortLostError or PortError."""

    async def offer(self, data: bytes) -> bool:
        """Send bytes as a device does, which waits for nobody; True if they are on their way.

        Where nobody takes them, they are lost. Raises PortLostError or PortError.
        """
        await self.write(data)
        return True

    async def pass_on(self, data: bytes) -> int:
        """Send bytes that another end has sent, and return how many of them are on their way.

        Who reads slowly is waited for. What nobody has taken for `PATIENCE` seconds is lost, and so
        is what comes then, until something is taken again: the line does not stand still for it.
        """
        await self.write(data)
        return len(data)

    async def joined(self) -> None:
        """Wait until somebody is at the other end of a port that this program has made."""
        return

    async def taken(self) -> bool:
        """Wait until the other end has read what was written, as far as that can be known.

        False if it has stopped to read.
        """
        return True

    @abc.abstractmethod
    async def close(self) -> None:
        """Give the port back. Does nothing where it is closed already."""

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self.close()
