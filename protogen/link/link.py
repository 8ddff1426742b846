"""A link: what comes in of a port as typed streams, and requests that wait for their replies."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from types import TracebackType
from typing import Any, Generic, Self, TypeVar

import msgspec

from protogen.errors import UserError
from protogen.link.counts import LinkCounts, name_of
from protogen.link.errors import LinkClosedError, LinkError, NoReplyError
from protogen.link.intake import Intake
from protogen.link.line import LineDecoders
from protogen.link.ports.port import Port, PortLostError
from protogen.link.requests import Requests
from protogen.link.streams import DEFAULT_LIMIT, Heard, Overflow, Queue, Stream
from protogen.runtime.codec import Encoder
from protogen.runtime.codec import Protocol as Codec
from protogen.runtime.events import Event, MessageEvent
from protogen.runtime.payload.message import Message
from protogen.runtime.payload.number import GivenValue

SentT = TypeVar("SentT", bound=Message)
ReceivedT = TypeVar("ReceivedT", bound=Message)
MessageT = TypeVar("MessageT", bound=Message)

_CLASS = "a message is made by its class in the generated module"
_AT_ONCE = 64
"""Events that are given at once; then those who take them have their turn."""


class _Subscription(msgspec.Struct, frozen=True, eq=False):
    """A queue, and the messages that go there; without any, all events do."""

    queue: Queue[Any]
    kinds: frozenset[type[Message]] | None

    async def give(
        self, events: Sequence[Event[Any, Any]], messages: Sequence[Message], when: int
    ) -> None:
        """Give events, and the messages that are among them."""
        if self.kinds is None:
            await self.queue.put([Heard(when, event) for event in events])
        else:
            kinds = self.kinds
            await self.queue.put([message for message in messages if type(message) in kinds])


class Link(Generic[SentT, ReceivedT]):
    """An open port as one endpoint of a protocol. All of its methods are for one event loop.

    It reads all the time, so that `last`, `counts` and requests are up to date, whether or not
    somebody takes what comes in.
    """

    def __init__(
        self,
        codec: Codec[Any, Any],
        port: Port,
        endpoint: str | None,
        decoders: LineDecoders,
        encode: Callable[..., bytes] | None = None,
    ) -> None:
        """`endpoint` is this end; None only listens. `encode` is that of the generated module."""
        self.port = port
        self.endpoint = endpoint
        self.counts = LinkCounts()
        """What was seen and sent since the link was opened."""
        self._codec = codec
        self._line = decoders
        peers = decoders.senders
        self._source = peers[0] if len(peers) == 1 else ""
        self._last: dict[type[Message], Message] = {}
        self._subscriptions: list[_Subscription] = []
        self._writing = asyncio.Lock()
        self._written: asyncio.Task[None] | None = None
        """What writes the last frame that was begun."""
        self._has_gap = False
        """True if bytes are missing in front of those that come next."""
        self._error: Exception | None = None
        self._has_ended = False
        self._encoder: Encoder | None = None
        self._requests: Requests | None = None
        if endpoint in codec.endpoints:
            forms = codec.forms(endpoint)
            self._encoder = Encoder(forms, encode)
            self._requests = Requests(
                codec.exchanges, forms, self._encoder, self._write, self.counts
            )
        self._intake = Intake(port)
        self._reader = asyncio.create_task(self._read())

    # --- what comes in ----------------------------------------------------------------------------

    def messages(
        self, *kinds: type[MessageT], limit: int = DEFAULT_LIMIT, overflow: Overflow = "drop"
    ) -> Stream[MessageT]:
        """The messages of these kinds that come in from now on.

        At most `limit` of them wait; see `Overflow` for what becomes of more. Raises LinkError
        where the other end sends no such message.
        """
        for kind in kinds:
            self._check_kind(kind)
        if not kinds:
            raise LinkError("which messages?", "name their classes, or take `events()`")
        return self._stream(frozenset[type[Message]](kinds), limit, overflow)

    def events(self, *, limit: int = DEFAULT_LIMIT, overflow: Overflow = "drop") -> Stream[Heard]:
        """All events that come in from now on, with their times: unknown and invalid ones, too."""
        return self._stream(None, limit, overflow)

    def last(self, kind: type[MessageT]) -> MessageT | None:
        """The last message of a kind; None where none has come yet.

        Raises LinkError where the other end sends no such message.
        """
        found = self._last.get(kind)
        if found is None:
            self._check_kind(kind)
        return found if isinstance(found, kind) else None

    def _check_kind(self, kind: type[Message]) -> None:
        if kind not in self.kinds:
            names = ", ".join(item.NAME for item in self.kinds)
            shown = getattr(kind, "NAME", repr(kind))
            raise LinkError(f"the other end sends no {shown}; it sends {names}", _CLASS)

    @property
    def kinds(self) -> tuple[type[Message], ...]:
        """The messages that can come in."""
        forms = (form for name in self._line.senders for form in self._codec.forms(name))
        return tuple(dict.fromkeys(kind for form in forms for kind in form.messages))

    def _stream(
        self, kinds: frozenset[type[Message]] | None, limit: int, overflow: Overflow
    ) -> Stream[Any]:
        queue = Queue[Any](limit, overflow)
        if self._has_ended:
            queue.end(self._error)
        else:
            self._subscriptions.append(_Subscription(queue, kinds))
        return Stream(queue)

    # --- what goes out ----------------------------------------------------------------------------

    async def send(self, message: SentT, *, strict: bool = True, **parts: GivenValue) -> None:
        """Send a message, and wait for nothing but room on the line.

        `parts` are counters and other parts of the frame; counters count by themselves. Raises
        EncodeError, PortError.
        """
        encoder = self._encoder_for(message)
        await self._write(encoder.encode_next(message, strict, **parts), message)

    async def request(
        self,
        message: SentT,
        *,
        timeout: float | None = None,
        retries: int | None = None,
        **parts: GivenValue,
    ) -> ReceivedT:
        """Send a message and return what answers it, as the schema's `exchanges` say.

        Where nothing answers within `timeout` seconds, the same bytes are sent again, `retries`
        times; without them, the exchange says both. A request waits for another one that nothing
        would tell its reply from. Raises RefusedError, NoReplyError, EncodeError, PortError.
        """
        self._encoder_for(message)
        assert self._requests is not None
        if timeout is not None and not timeout > 0:
            raise LinkError(f"{timeout!r} is no timeout", "give seconds, more than 0")
        if retries is not None and retries < 0:
            raise LinkError(f"{retries!r} is no number of retries", "0 sends it once")
        self._check_open()
        try:
            reply: Any = await self._requests.ask(message, timeout, retries, parts)
        except NoReplyError as error:
            raise self.told(error) from None
        return reply  # type: ignore[no-any-return]

    @property
    def unfinished(self) -> int:
        """Bytes that came and of which nothing is certain yet."""
        return self._line.pending

    def told(self, error: NoReplyError) -> NoReplyError:
        """The error, which does not say that nothing came where bytes did."""
        if error.came or not self.unfinished:
            return error
        came = {f"invalid: no frame in {self.unfinished} bytes": 1}
        return NoReplyError(error.request, error.attempts, error.timeout, came)

    def _encoder_for(self, message: Message) -> Encoder:
        if not isinstance(message, Message):
            raise LinkError(f"{message!r} is no message", _CLASS)
        if self._encoder is None:
            who = f"{self.endpoint} sends nothing" if self.endpoint else "it only listens"
            names = " or ".join(self._codec.endpoints)
            raise LinkError(
                f"this link can't send {type(message).NAME}: {who}", f"open it as {names}"
            )
        return self._encoder

    async def _write(
        self, frame: bytes, message: Message, sending: AbstractContextManager[None] | None = None
    ) -> None:
        """Write a frame; the port takes it while `sending` is entered.

        Cancelled, it writes either all of the frame or nothing: half of one would spoil the next.
        """
        await self._writing.acquire()
        whole = self._write_whole(frame, message, sending or nullcontext())
        self._written = written = asyncio.create_task(whole)
        written.add_done_callback(self._end_write)
        await asyncio.wait({written})
        if written.cancelled():
            raise self._closed()
        written.result()

    async def _write_whole(
        self, frame: bytes, message: Message, sending: AbstractContextManager[None]
    ) -> None:
        self._check_open()
        # What this end sends may tell what the answers are. Nobody here wants its events.
        self._line.feed(self.endpoint or "", frame)
        with sending:
            await self.port.write(frame)
        self.counts.sent[type(message).NAME] += 1

    def _end_write(self, written: asyncio.Task[None]) -> None:
        self._writing.release()
        if not written.cancelled():
            written.exception()  # It is told to who waits, if anybody still does.

    def _check_open(self) -> None:
        if self._has_ended:
            raise self._closed()

    def _closed(self) -> Exception:
        name, error = self.port.name, self._error
        if isinstance(error, UserError):
            return type(error)(str(error), error.hint)
        return LinkClosedError(f"the link to {name} is closed" + (f": {error!r}" if error else ""))

    # --- reading ----------------------------------------------------------------------------------

    def note_loss(self, problem: str) -> None:
        """Take the news that the port was lost: no request will be answered."""
        self.counts.losses += 1
        self._has_gap = True
        if self._requests is not None:
            self._requests.fail(lambda: PortLostError(problem))

    async def _read(self) -> None:
        try:
            await self._read_all()
        except asyncio.CancelledError:
            raise
        except Exception as error:
            self._end(error)
        else:
            self._end(None)

    async def _read_all(self) -> None:
        while True:
            arrival = await self._intake.next(self._line.silence if self._line.pending else None)
            if arrival is None:
                await self._give(self._line.idle(self._source), time.time_ns())
                continue
            if self._has_gap:
                self._has_gap = False
                await self._give(self._line.flush(), arrival.when)
            if not arrival.data:
                await self._give(self._line.flush(), arrival.when)
                return
            self.counts.bytes_received += len(arrival.data)
            await self._give(self._line.feed(self._source, arrival.data), arrival.when)

    async def _give(self, events: Sequence[Event[Any, Any]], when: int) -> None:
        # Where somebody holds the line back, what is known of it goes no further than the stream.
        is_held = any(item.queue.waits for item in self._subscriptions)
        step = 1 if is_held else _AT_ONCE
        for start in range(0, len(events), step):
            if start and start % _AT_ONCE == 0:
                await asyncio.sleep(0)
            await self._give_at_once(events[start : start + step], when)

    async def _give_at_once(self, events: Sequence[Event[Any, Any]], when: int) -> None:
        self.counts.received.update(map(name_of, events))
        messages = [event.message for event in events if isinstance(event, MessageEvent)]
        for message in messages:
            self._last[type(message)] = message
        if self._requests is not None:
            self._requests.hear_all(events)
        for subscription in tuple(self._subscriptions):
            if subscription.queue.is_closed:
                self._subscriptions.remove(subscription)
            else:
                await subscription.give(events, messages, when)

    def _end(self, error: Exception | None) -> None:
        self._has_ended = True
        self._error = error
        if self._requests is not None:
            self._requests.fail(self._closed)
        for subscription in self._subscriptions:
            subscription.queue.end(error)
        self._subscriptions.clear()

    async def close(self) -> None:
        """Give the port back. Streams end, and requests fail with LinkClosedError."""
        owned = (self._reader, self._written)
        tasks = [task for task in owned if task is not None]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        await self._intake.close()
        if not self._has_ended:
            self._end(None)
        await self.port.close()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self.close()
