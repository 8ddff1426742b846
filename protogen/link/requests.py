"""Requests: what was sent, what answers it, and what came instead.

An answer may come up to two timeouts after its request was sent. A request that is settled while a
repetition of it may still be answered, or that is given up, is *expected late* until then: a
request that its late answer could be taken for waits for that long.
"""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Awaitable, Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from typing import Any

from protogen.link.counts import LinkCounts, name_of
from protogen.link.errors import LinkError, NoReplyError, RefusedError
from protogen.runtime.attributes import attribute
from protogen.runtime.codec import Encoder
from protogen.runtime.decoder import Decoder
from protogen.runtime.events import Event, MessageEvent
from protogen.runtime.framing.sender import SenderSpec
from protogen.runtime.line import Exchange
from protogen.runtime.payload.message import Message
from protogen.runtime.payload.number import GivenValue

DEFAULT_TIMEOUT = 1.0
"""Seconds until a request is lost where neither the schema nor the caller says it."""

Write = Callable[[bytes, Message, AbstractContextManager[None]], Awaitable[None]]
"""Sends the frame of a message; it is in the context while the port takes the frame."""
Pairs = Mapping[str, Any]
"""Values that an answer has to have, by the names of its fields or parts."""


def value_of(message: Message, event: MessageEvent[Any, Any] | None, name: str) -> Any:
    """The value of a message's field, or of a part of its frame, which `event` has.

    Raises LinkError where nobody could read the frame.
    """
    spelled = attribute(name)
    if spelled in type(message).__fields__:
        return getattr(message, spelled)
    if event is None:
        raise LinkError(f"this end can't read its own {type(message).NAME}, to match a reply")
    return getattr(event.parts, spelled)


class Pending:
    """A request that waits for its answer, or whose answer may come late."""

    def __init__(
        self, wanted: Mapping[type[Message], Pairs], exchange: Exchange, timeout: float
    ) -> None:
        self._wanted = wanted
        self._exchange = exchange
        self.timeout = timeout
        self.settled = asyncio.Event()
        self.reply: Message | None = None
        self.error: Exception | None = None
        self.is_over = False
        """True once nobody waits for the answer."""
        self.gone = asyncio.Event()
        """Set once no answer is expected any more."""
        self.is_being_sent = False
        """True while the port takes its frame, which may be longer than somebody waits for it."""
        self.times_sent = 0
        self.unanswered = 0
        """Frames of it that may yet be answered."""
        self.last_sent = 0.0
        """When it was last sent, by the event loop's clock."""
        self.came = Counter[str]()

    def accepts(self, event: MessageEvent[Any, Any]) -> bool:
        """True if a message answers it."""
        pairs = self._wanted.get(type(event.message))
        return pairs is not None and all(
            value_of(event.message, event, name) == value for name, value in pairs.items()
        )

    def rivals(self, other: Pending) -> bool:
        """True if there may be an answer that nothing tells of which of the two it is."""
        return any(
            all(
                pairs[name] == other._wanted[kind][name]
                for name in pairs.keys() & other._wanted[kind].keys()
            )
            for kind, pairs in self._wanted.items()
            if kind in other._wanted
        )

    def settle(self, request: Message, message: Message) -> None:
        """Take the answer."""
        if type(message) in self._exchange.refusals:
            self.error = RefusedError(request, message)
        else:
            self.reply = message
        self.settled.set()

    def note(self, event: Event[Any, Any]) -> None:
        """Take what came and is no answer."""
        name = name_of(event)
        if isinstance(event, MessageEvent) and type(event.message) in self._wanted:
            name = f"{name} of another request"
        self.came[name] += 1


class Requests:
    """The requests of an endpoint."""

    def __init__(
        self,
        exchanges: tuple[Exchange, ...],
        forms: tuple[SenderSpec[Any, Any], ...],
        encoder: Encoder,
        write: Write,
        counts: LinkCounts,
    ) -> None:
        self._exchanges = {kind: item for item in exchanges for kind in item.requests}
        self._turns = {item.name: asyncio.Lock() for item in exchanges}
        """Requests of an exchange are sent in the order in which they were made."""
        self._forms = forms
        self._encoder = encoder
        self._write = write
        self._counts = counts
        self._pending: dict[Pending, Message] = {}

    def hear_all(self, events: Sequence[Event[Any, Any]]) -> None:
        """Take what came in, which costs nothing where no answer is expected."""
        if self._pending:
            for event in events:
                self.hear(event)

    def hear(self, event: Event[Any, Any]) -> None:
        """Take what came in: an answer, or something else, which those that wait take note of."""
        for pending, request in self._pending.items():
            if isinstance(event, MessageEvent) and pending.accepts(event):
                self._answered(pending, request, event.message)
                return
        for pending in self._pending:
            if not pending.is_over:
                pending.note(event)

    def _answered(self, pending: Pending, request: Message, message: Message) -> None:
        pending.unanswered -= 1
        if not pending.is_over and not pending.settled.is_set():
            pending.settle(request, message)
            return
        self._counts.late += 1
        if pending.is_over and not pending.unanswered:
            self._retire(pending)

    def fail(self, error: Callable[[], Exception]) -> None:
        """Let all requests fail, each with an error of its own; nothing comes late any more."""
        for pending in tuple(self._pending):
            if pending.is_over:
                self._forget(pending)
            elif not pending.settled.is_set():
                pending.error = error()
                pending.unanswered = 0
                pending.settled.set()

    async def ask(
        self,
        message: Message,
        timeout: float | None,
        retries: int | None,
        parts: Mapping[str, GivenValue],
    ) -> Message:
        """Send a request, again where nothing answers, and return its reply.

        Raises RefusedError, NoReplyError, EncodeError, PortError, and LinkError where the schema
        does not say what answers it.
        """
        exchange = self._exchange_of(message)
        if timeout is None:
            timeout = DEFAULT_TIMEOUT if exchange.timeout is None else exchange.timeout
        attempts = 1 + (exchange.retries if retries is None else retries)
        frame, pending = await self._begun(exchange, message, timeout, parts)
        try:
            reply = await self._sent(frame, message, pending, attempts)
        finally:
            pending.is_over = True
            self._retire(pending)
        self._counts.replies += 1
        return reply

    def _exchange_of(self, message: Message) -> Exchange:
        found = self._exchanges.get(type(message))
        if found is None:
            name = type(message).NAME
            raise LinkError(
                f"the schema does not say what answers {name}",
                f"add `exchanges: {{ask: {{request: {name}, reply: ...}}}}`; `send` waits for none",
            )
        return found

    async def _begun(
        self,
        exchange: Exchange,
        message: Message,
        timeout: float,
        parts: Mapping[str, GivenValue],
    ) -> tuple[bytes, Pending]:
        """The frame of a request, once no other one could be taken for it."""
        async with self._turns[exchange.name]:
            while True:
                frame = self._encoder.preview(message, True, **parts)
                pending = Pending(self._wanted(exchange, message, frame), exchange, timeout)
                rival = next((item for item in self._pending if item.rivals(pending)), None)
                if rival is None:
                    break
                await rival.gone.wait()
            self._pending[pending] = message
            return self._encoder.encode_next(message, True, **parts), pending

    def _wanted(
        self, exchange: Exchange, message: Message, frame: bytes
    ) -> Mapping[type[Message], Pairs]:
        """What an answer of each kind has to have."""
        pairs: dict[str, Any] = {}
        if exchange.match:
            decoder = Decoder(self._forms)
            events = [*decoder.feed(frame), *decoder.flush()]
            own = next((event for event in events if isinstance(event, MessageEvent)), None)
            pairs = {answer: value_of(message, own, asked) for asked, answer in exchange.match}
        refusals = pairs if exchange.is_refusal_matched else {}
        return {
            **dict.fromkeys(exchange.refusals, refusals),
            **dict.fromkeys(exchange.replies, pairs),
        }

    async def _sent(
        self, frame: bytes, message: Message, pending: Pending, attempts: int
    ) -> Message:
        for _ in range(attempts):
            try:
                async with asyncio.timeout(pending.timeout):
                    await self._write(frame, message, self._sending(pending))
                    await pending.settled.wait()
            except TimeoutError:
                if not pending.settled.is_set():
                    continue
            return self._outcome(pending)
        self._counts.unanswered += 1
        raise NoReplyError(message, pending.times_sent, pending.timeout, pending.came)

    @contextmanager
    def _sending(self, pending: Pending) -> Iterator[None]:
        pending.is_being_sent = True
        try:
            yield
            self._counts.retries += pending.times_sent > 0
            pending.times_sent += 1
            pending.unanswered += 1
            pending.last_sent = asyncio.get_running_loop().time()
        finally:
            pending.is_being_sent = False
            if pending.is_over:
                self._retire(pending)

    def _outcome(self, pending: Pending) -> Message:
        if pending.error is not None:
            self._counts.refusals += isinstance(pending.error, RefusedError)
            raise pending.error
        assert pending.reply is not None
        return pending.reply

    def _retire(self, pending: Pending) -> None:
        """Forget a request that is over, as soon as no answer to it is expected any more."""
        if pending.is_being_sent:
            return  # It is retired once its frame is out.
        if pending.unanswered > 0:
            end = pending.last_sent + 2 * pending.timeout
            asyncio.get_running_loop().call_at(end, self._forget, pending)
        else:
            self._forget(pending)

    def _forget(self, pending: Pending) -> None:
        self._pending.pop(pending, None)
        pending.gone.set()
