"""What a simulated device does: sends messages at their rates, and answers."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable, Iterator, Mapping
from types import ModuleType
from typing import Any

import msgspec

from protogen.link.answers import Answers
from protogen.link.damage import Damage
from protogen.link.line import LineDecoders
from protogen.link.ports.port import Port
from protogen.link.simulated_values import ValuesError, ValueSource
from protogen.model.messages import given_parts
from protogen.model.parts import CounterPart
from protogen.model.protocol import Protocol
from protogen.runtime.attributes import arguments
from protogen.runtime.errors import EncodeError

Answer = Callable[[Any], Iterable[Any]]
"""Messages that answer an event: each a message, or a pair of one and its parts."""


class Counts(msgspec.Struct):
    """What a device has sent, and what it has got."""

    sent: dict[str, int] = msgspec.field(default_factory=dict)
    received: dict[str, int] = msgspec.field(default_factory=dict)
    """Messages by name; `unknown` and `invalid` for what was none."""
    lost: int = 0
    """Frames for which the line had no room, because nobody read."""


class Simulation:
    """One endpoint of a protocol, on a port."""

    def __init__(
        self,
        protocol: Protocol,
        module: ModuleType,
        endpoint: str,
        rates: Mapping[str, float],
        values: ValueSource,
        damage: Damage | None = None,
    ) -> None:
        """`rates` are messages with how often each is sent, in Hz."""
        self.endpoint = endpoint
        self.counts = Counts()
        self._protocol = protocol
        self._module = module
        self._rates = rates
        self._values = values
        self._damage = damage
        self._encoder = module.Encoder(endpoint)
        self._answers: dict[str, list[Answer]] = {}
        self._replies = Answers(module.PROTOCOL, endpoint, self.made)
        self._began = 0.0

    def on(self, message: str, answer: Answer) -> None:
        """Answer each such message of another endpoint, in place of what the exchanges say.

        Raises KeyError if there is none.
        """
        self._protocol.message(message)
        self._answers.setdefault(message, []).append(answer)

    async def run(self, port: Port) -> None:
        """Send and answer until it is cancelled, or the port has no more bytes."""
        self._began = asyncio.get_running_loop().time()
        tasks = [asyncio.create_task(self._repeat(port, name)) for name in self._rates]
        listening = asyncio.create_task(self._listen(port))
        try:
            done, _ = await asyncio.wait([listening, *tasks], return_when=asyncio.FIRST_COMPLETED)
            for task in done:
                task.result()
        finally:
            for task in (listening, *tasks):
                task.cancel()
            await asyncio.gather(listening, *tasks, return_exceptions=True)

    async def send(self, port: Port, message: Any, **parts: Any) -> None:
        """Send a message now. Raises EncodeError."""
        frame = self._encoder.encode(message, **parts)
        if self._damage is not None:
            await asyncio.sleep(self._damage.pause())
            frame = self._damage.of(frame)
        name = message.NAME
        self.counts.sent[name] = self.counts.sent.get(name, 0) + 1
        if not await port.offer(frame):
            self.counts.lost += 1

    def made(self, name: str) -> tuple[Any, dict[str, Any]]:
        """A message with values for now, and its parts. Raises ValuesError."""
        seconds = asyncio.get_running_loop().time() - self._began
        fields, parts = self._values(name, seconds)
        given = {part: parts[part] for part in self._chosen(name) if part in parts}
        try:
            return self._module.MESSAGES[name].from_dict(fields), arguments(given)
        except EncodeError as error:
            raise ValuesError(f"`{name}` can't have these values: {error}") from None

    def _chosen(self, name: str) -> Iterator[str]:
        """The parts that a caller gives; counters count by themselves."""
        message = self._protocol.message(name)
        held = {field.part for field in message.held}
        for sender in self._protocol.senders_of(message):
            if sender.endpoint == self.endpoint:
                for part in given_parts(sender.frame, message):
                    if not isinstance(part, CounterPart) and part.name not in held:
                        yield part.name

    async def _repeat(self, port: Port, name: str) -> None:
        """Send a message at its rate: the times are those of the start, so that none is late."""
        loop = asyncio.get_running_loop()
        number = 0
        while True:
            number += 1
            await asyncio.sleep(max(0.0, self._began + number / self._rates[name] - loop.time()))
            message, parts = self.made(name)
            try:
                await self.send(port, message, **parts)
            except EncodeError as error:
                raise ValuesError(f"`{name}` can't be sent: {error}") from None

    async def _listen(self, port: Port) -> None:
        others = [name for name in self._protocol.sending if name != self.endpoint]
        decoders = LineDecoders(self._module, others)
        source = others[0] if len(others) == 1 else ""
        while (arrival := await port.read()).data:
            for event in decoders.feed(source, arrival.data):
                await self._take(port, event)

    async def _take(self, port: Port, event: Any) -> None:
        kind = event.message.NAME if event.kind == "message" else event.kind
        self.counts.received[kind] = self.counts.received.get(kind, 0) + 1
        if event.kind != "message":
            return
        if kind not in self._answers:
            reply = self._replies.to(event)
            if reply is not None:
                await self.send(port, reply[0], **reply[1])
        for answer in self._answers.get(kind, ()):
            for item in answer(event):
                message, parts = item if isinstance(item, tuple) else (item, {})
                await self.send(port, message, **parts)
