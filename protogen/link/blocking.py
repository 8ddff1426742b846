"""The same link for programs without async: its event loop runs in a thread of its own."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Coroutine
from threading import Event
from types import TracebackType
from typing import Any, Generic, Self, TypeVar

from protogen.link.counts import LinkCounts
from protogen.link.errors import LinkError
from protogen.link.link import Link, MessageT, ReceivedT, SentT
from protogen.link.loop_thread import LoopThread
from protogen.link.streams import DEFAULT_LIMIT, Heard, Overflow, Stream
from protogen.runtime.payload.number import GivenValue

ItemT = TypeVar("ItemT")
ResultT = TypeVar("ResultT")


class BlockingStream(Generic[ItemT]):
    """What comes in from now on: `for item in stream`. See `Stream`."""

    def __init__(self, loop: LoopThread, stream: Stream[ItemT]) -> None:
        self._loop = loop
        self._stream = stream
        self._queue = stream.queue
        self._taken = deque[ItemT]()
        """Taken together: to ask another thread for each item would take long."""
        self._arrived = Event()
        self._queue.tell = self._arrived.set

    @property
    def dropped(self) -> int:
        """Items that were dropped because nobody took them in time."""
        return self._stream.dropped

    def __iter__(self) -> Self:
        return self

    def __next__(self) -> ItemT:
        if not self._taken:
            self._taken.extend(self._waited_for())
        if not self._taken:
            raise StopIteration
        return self._taken.popleft()

    def _waited_for(self) -> list[ItemT]:
        """All that wait, at least one; none mean the end."""
        while True:
            self._arrived.clear()
            has_ended = self._queue.has_ended
            items = self._queue.take_now()
            if items and self._queue.waits:
                self._loop.call(self._queue.make_room)
            if items or has_ended:
                return items
            self._arrived.wait()

    def get(self, timeout: float | None = None) -> ItemT:
        """The next item. Raises TimeoutError, and LinkError where the stream has ended."""
        if self._taken:
            return self._taken.popleft()
        return self._loop.do(self._stream.get(timeout))

    def close(self) -> None:
        """Take no more."""
        self._taken.clear()
        self._loop.do(_called(self._stream.close))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


class BlockingLink(Generic[SentT, ReceivedT]):
    """An open port as one endpoint of a protocol. Its methods may be called from any thread."""

    def __init__(self, opened: Callable[[], Coroutine[Any, Any, Link[SentT, ReceivedT]]]) -> None:
        """`opened` opens the link, in the event loop that it will have. Raises PortError."""
        self._loop = LoopThread("link")
        try:
            self._link = self._loop.do(opened())
        except BaseException:
            self._loop.close()
            raise

    @property
    def counts(self) -> LinkCounts:
        """What was seen and sent since the link was opened."""
        return self._link.counts

    def messages(
        self, *kinds: type[MessageT], limit: int = DEFAULT_LIMIT, overflow: Overflow = "drop"
    ) -> BlockingStream[MessageT]:
        """The messages of these kinds that come in from now on. See `Link.messages`."""
        made = _called(lambda: self._link.messages(*kinds, limit=limit, overflow=overflow))
        return BlockingStream(self._loop, self._loop.do(made))

    def events(
        self, *, limit: int = DEFAULT_LIMIT, overflow: Overflow = "drop"
    ) -> BlockingStream[Heard]:
        """All events that come in from now on, with their times."""
        made = _called(lambda: self._link.events(limit=limit, overflow=overflow))
        return BlockingStream(self._loop, self._loop.do(made))

    def last(self, kind: type[MessageT]) -> MessageT | None:
        """The last message of a kind; None where none has come yet."""
        return self._link.last(kind)

    def send(self, message: SentT, *, strict: bool = True, **parts: GivenValue) -> None:
        """Send a message. See `Link.send`."""
        self._loop.do(self._link.send(message, strict=strict, **parts))

    def request(
        self,
        message: SentT,
        *,
        timeout: float | None = None,
        retries: int | None = None,
        **parts: GivenValue,
    ) -> ReceivedT:
        """Send a message and return what answers it. See `Link.request`."""
        work = self._link.request(message, timeout=timeout, retries=retries, **parts)
        return self._loop.do(work)

    def close(self) -> None:
        """Give the port back, and end the thread."""
        try:
            self._loop.do(self._link.close())
        except LinkError:
            return  # It was closed already.
        finally:
            self._loop.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


async def _called(work: Callable[[], ResultT]) -> ResultT:
    """Call something in the event loop."""
    return work()
