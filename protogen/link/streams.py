"""Streams of what comes in: queues of bounded length between the reader and whoever takes it."""

from __future__ import annotations

import asyncio
import weakref
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from threading import Lock
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
    """Items that wait to be taken. One event loop puts them in; any thread may take them."""

    def __init__(self, limit: int, overflow: Overflow) -> None:
        if limit < 1:
            raise LinkError(f"a stream holds at least 1 item, not {limit}")
        if overflow not in get_args(Overflow):
            words = " or ".join(map(repr, get_args(Overflow)))
            raise LinkError(f"{overflow!r} is no `overflow`", f"give {words}")
        self._limit = limit
        self.waits = overflow == "wait"
        """True if the reader waits for room."""
        self._items = deque[ItemT]()
        self._changed = asyncio.Event()
        """Set where there is something to take, or will never be."""
        self._room = asyncio.Event()
        self._taking = Lock()
        self._error: Exception | None = None
        self.tell: Callable[[], None] = _nobody
        """Called where there is something to take, or will never be."""
        self.is_closed = False
        """True once nobody takes items any more."""
        self.has_ended = False
        """True once no more come in."""
        self.dropped = 0

    async def put(self, items: Sequence[ItemT]) -> None:
        """Add items; of a full queue the oldest are dropped, or there is a wait for room."""
        if self.waits:
            await self._put_each(items)
        elif items and not self.is_closed:
            with self._taking:
                self._items.extend(items)
                excess = len(self._items) - self._limit
                for _ in range(excess):
                    self._items.popleft()
            self.dropped += max(0, excess)
            self._tell()

    async def _put_each(self, items: Sequence[ItemT]) -> None:
        for item in items:
            while len(self._items) >= self._limit and not self.is_closed:
                self._room.clear()
                await self._room.wait()
            if self.is_closed:
                return
            self._items.append(item)
            self._tell()

    async def take(self) -> list[ItemT]:
        """All that wait, at least one; none mean the end. Raises what ended the link."""
        await self._wait()
        items = self._all()
        self._room.set()
        return items

    def take_now(self) -> list[ItemT]:
        """All that wait by now, in any thread. Raises what ended the link where none will come.

        Whoever takes them in another thread has to call `make_room` in that of the event loop.
        """
        has_ended = self.has_ended
        items = self._all()
        if has_ended and not items and self._error is not None:
            raise self._error
        return items

    def make_room(self) -> None:
        """Let a reader go on that waits for room."""
        self._room.set()

    def _all(self) -> list[ItemT]:
        with self._taking:
            items = list(self._items)
            self._items.clear()
        return items

    async def take_one(self) -> list[ItemT]:
        """The same of the first alone."""
        if not self._items:
            await self._wait()
        return self.first_now()

    def first_now(self) -> list[ItemT]:
        """The first of those that wait by now, in the event loop's thread."""
        with self._taking:
            items = [self._items.popleft()] if self._items else []
        if self.waits:
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
        self._error = error
        self.has_ended = True
        self._tell()

    def close(self) -> None:
        """Stop to take items."""
        self.is_closed = True
        self._items.clear()
        self._room.set()
        self.end()

    def _tell(self) -> None:
        self._changed.set()
        self.tell()


def _nobody() -> None:
    """Tell nobody."""


class Stream(Generic[ItemT]):
    """What comes in from now on: `async for item in stream`.

    It holds a bounded number of items. It ends with the link; where the port is lost for good, it
    raises PortLostError behind the last item. `close`, or the end of `async with`, or to forget it,
    ends it sooner.
    """

    def __init__(self, queue: Queue[ItemT]) -> None:
        self.queue = queue
        """The items that wait."""
        loop = asyncio.get_running_loop()
        weakref.finalize(self, _close_later, loop, queue).atexit = False

    @property
    def dropped(self) -> int:
        """Items that were dropped because nobody took them in time."""
        return self.queue.dropped

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> ItemT:
        items = self.queue.first_now() or await self.queue.take_one()
        if not items:
            raise StopAsyncIteration
        return items[0]

    async def get(self, timeout: float | None = None) -> ItemT:
        """The next item. Raises TimeoutError, and LinkError where the stream has ended."""
        async with asyncio.timeout(timeout):
            items = await self.queue.take_one()
        if not items:
            raise LinkError("the stream has ended")
        return items[0]

    async def take(self) -> list[ItemT]:
        """All that wait, at least one; none mean the end."""
        return await self.queue.take()

    def close(self) -> None:
        """Take no more."""
        self.queue.close()

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
