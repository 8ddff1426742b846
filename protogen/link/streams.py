"""Streams of what comes in: queues of bounded length between the reader and whoever takes it."""

from __future__ import annotations

import asyncio
import weakref
from collections import deque
from contextlib import suppress
from types import TracebackType
from typing import Any, Generic, Literal, NamedTuple, Self, TypeVar, get_args

from protogen.link.errors import LinkError
from protogen.runtime.events import Event

ItemT = TypeVar("ItemT")

Overflow = Literal["drop", "wait"]
"""What happens where a stream is full: its oldest item is dropped and counted, or the reader waits
for whoever takes the items, and so does, in the end, the device."""

DEFAULT_LIMIT = 1000
"""The most items that wait in a stream."""


class Heard(NamedTuple):
    """An event, and when its last byte came: nanoseconds since 1970-01-01 UTC."""

    when: int
    event: Event[Any, Any]


class Queue(Generic[ItemT]):
    """Items that wait to be taken."""

    def __init__(self, limit: int, overflow: Overflow) -> None:
        if limit < 1:
            raise LinkError(f"a stream holds at least 1 item, not {limit}")
        if overflow not in get_args(Overflow):
            words = " or ".join(map(repr, get_args(Overflow)))
            raise LinkError(f"{overflow!r} is no `overflow`", f"give {words}")
        self._limit = limit
        self._waits = overflow == "wait"
        self._items = deque[ItemT]()
        self._changed = asyncio.Event()
        """Set where there is something to take, or will never be."""
        self._room = asyncio.Event()
        self._error: Exception | None = None
        self.is_closed = False
        """True once nobody takes items any more."""
        self.has_ended = False
        """True once no more come in."""
        self.dropped = 0

    async def put(self, item: ItemT) -> None:
        """Add an item; of a full queue the oldest is dropped, or there is a wait for room."""
        while self._waits and len(self._items) >= self._limit and not self.is_closed:
            self._room.clear()
            await self._room.wait()
        if self.is_closed:
            return
        if len(self._items) >= self._limit:
            self._items.popleft()
            self.dropped += 1
        self._items.append(item)
        self._changed.set()

    async def take(self) -> list[ItemT]:
        """All that wait, at least one; none mean the end. Raises what ended the link."""
        await self._wait()
        items = list(self._items)
        self._items.clear()
        self._room.set()
        return items

    async def take_one(self) -> list[ItemT]:
        """The same of the first alone."""
        await self._wait()
        items = [self._items.popleft()] if self._items else []
        self._room.set()
        return items

    async def _wait(self) -> None:
        while not self._items and not self.has_ended:
            self._changed.clear()
            await self._changed.wait()
        if not self._items and self._error is not None:
            raise self._error

    def end(self, error: Exception | None = None) -> None:
        """Let no more come in; `error` is raised behind the last item."""
        self.has_ended = True
        self._error = error
        self._changed.set()

    def close(self) -> None:
        """Stop to take items."""
        self.is_closed = True
        self._items.clear()
        self._room.set()
        self.end()


class Stream(Generic[ItemT]):
    """What comes in from now on: `async for item in stream`.

    It holds a bounded number of items. It ends with the link; where the port is lost for good, it
    raises PortLostError behind the last item. `close`, or the end of `async with`, or to forget it,
    ends it sooner.
    """

    def __init__(self, queue: Queue[ItemT]) -> None:
        self._queue = queue
        loop = asyncio.get_running_loop()
        weakref.finalize(self, _close_later, loop, queue).atexit = False

    @property
    def dropped(self) -> int:
        """Items that were dropped because nobody took them in time."""
        return self._queue.dropped

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> ItemT:
        items = await self._queue.take_one()
        if not items:
            raise StopAsyncIteration
        return items[0]

    async def get(self, timeout: float | None = None) -> ItemT:
        """The next item. Raises TimeoutError, and LinkError where the stream has ended."""
        async with asyncio.timeout(timeout):
            items = await self._queue.take_one()
        if not items:
            raise LinkError("the stream has ended")
        return items[0]

    async def take(self) -> list[ItemT]:
        """All that wait, at least one; none mean the end."""
        return await self._queue.take()

    def close(self) -> None:
        """Take no more."""
        self._queue.close()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def _close_later(loop: asyncio.AbstractEventLoop, queue: Queue[Any]) -> None:
    """Close a queue whose stream was forgotten, in whatever thread that is found."""
    with suppress(RuntimeError):  # The event loop has ended.
        loop.call_soon_threadsafe(queue.close)
