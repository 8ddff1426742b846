"""What every port offers, and the errors of all of them."""

from __future__ import annotations

import abc
from types import TracebackType
from typing import Self

import msgspec

from protogen.errors import UserError

MOST_READ = 1 << 16
"""The most bytes that a port reads at once."""


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

    @abc.abstractmethod
    async def write(self, data: bytes) -> None:
        """Send bytes; waits while the port takes no more. Raises PortLostError or PortError."""

    async def offer(self, data: bytes) -> bool:
        """Send bytes as a device does, which waits for nobody; True if they are on their way.

        Where nobody takes them, they are lost. Raises PortLostError or PortError.
        """
        await self.write(data)
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
