"""What a simulated device does: sends messages at their rates, and answers."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Mapping, Sequence
from types import ModuleType
from typing import Any

import msgspec

from protogen.link.answers import Answer, AnswerRates, ExchangeAnswers
from protogen.link.connection import MIN_SILENCE
from protogen.link.damage import Damage
from protogen.link.line import LineDecoders
from protogen.link.ports.port import Arrival, Port
from protogen.link.simulated_values import ValuesError, ValueSource
from protogen.model.messages import given_parts
from protogen.model.parts import CounterPart
from protogen.model.protocol import Protocol
from protogen.problems import hint_for
from protogen.runtime.attributes import arguments
from protogen.runtime.errors import DecodeError, EncodeError

FASTEST = 100_000.0
"""Messages a second; no clock is finer."""


class Counts(msgspec.Struct):
    """What a device has sent, and what it has got."""

    sent: dict[str, int] = msgspec.field(default_factory=dict)
    received: dict[str, int] = msgspec.field(default_factory=dict)
    """Messages by name; `unknown` and `invalid` for what was none."""
    lost: int = 0
    """Frames for which the line had no room, because nobody read."""


def rates_of(protocol: Protocol, endpoint: str, stated: Mapping[str, float]) -> dict[str, float]:
    """How often an endpoint sends each message, in Hz: as stated, else as the schema says.

    Raises ValuesError for a message that it does not send, and for what is no rate.
    """
    names = [message.name for message in protocol.messages if endpoint in message.senders]
    for name, rate in stated.items():
        if name not in names:
            hint = hint_for(name, names) or f"it sends {', '.join(names)}"
            raise ValuesError(f"{endpoint} sends no `{name}`", hint)
        if not isinstance(rate, int | float) or not 0 <= rate <= FASTEST:
            problem = f"{rate!r} does not say how often `{name}` is sent"
            raise ValuesError(problem, "give a number of Hz; 0 sends it not at all")
    said = {
        message.name: float(message.rate)
        for message in protocol.messages
        if message.rate is not None and endpoint in message.senders
    }
    return {name: rate for name, rate in {**said, **stated}.items() if rate > 0}


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
        self._by_exchanges: dict[str, Answer] = {}
        self._began = 0.0

    def on(self, message: str, answer: Answer) -> None:
        """Answer each such message of another endpoint. Raises KeyError if there is none.

        It is then not answered as the schema's exchanges say.
        """
        self._protocol.message(message)
        self._answers.setdefault(message, []).append(answer)

    def answer_requests(self, rates: AnswerRates, seed: int) -> None:
        """Answer requests as the schema's exchanges say, where `on` says nothing of them."""
        answers = ExchangeAnswers(self._protocol, self.endpoint, self._fitting, rates, seed)
        self._by_exchanges = dict.fromkeys(answers.requests, answers)

    @property
    def is_idle(self) -> bool:
        """True if nothing is sent at a rate, and nothing is answered."""
        return not (self._rates or self._answers or self._by_exchanges)

    async def run(self, port: Port) -> None:
        """Send and answer until it is cancelled, or the port has no more bytes."""
        self._began = asyncio.get_running_loop().time()
        tasks = [asyncio.create_task(self._repeat(port, name)) for name in self._rates]
        tasks.append(asyncio.create_task(self._listen(port)))
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            try:
                await asyncio.gather(*tasks, return_exceptions=True)
            finally:
                _raise_first(tasks)

    async def send(self, port: Port, message: Any, **parts: Any) -> None:
        """Send a message now, of this module or of one generated elsewhere. Raises EncodeError."""
        message = self._own(message)
        frame = self._encoder.encode(message, **parts)
        if self._damage is not None:
            await asyncio.sleep(self._damage.pause())
            frame = self._damage.of(frame)
        name = message.NAME
        self.counts.sent[name] = self.counts.sent.get(name, 0) + 1
        if not await port.offer(frame):
            self.counts.lost += 1

    def _own(self, message: Any) -> Any:
        """A message as one of this module's class: users have generated a module, too."""
        own = self._module.MESSAGES.get(getattr(message, "NAME", None))
        if own is None or isinstance(message, (own, type)):
            return message
        return own.from_dict(message.to_dict())

    def made(self, name: str) -> tuple[Any, dict[str, Any]]:
        """A message with values for now, and its parts. Raises ValuesError."""
        try:
            return self._with(name, {})
        except EncodeError as error:
            raise ValuesError(f"`{name}` can't have these values: {error}") from None

    def _with(self, name: str, stated: Mapping[str, Any]) -> tuple[Any, dict[str, Any]]:
        """A message, of which these fields and parts have these values. Raises EncodeError."""
        seconds = asyncio.get_running_loop().time() - self._began
        fields, parts = self._values(name, seconds)
        own = {field.name for field in self._protocol.message(name).fields}
        fields = fields | {key: value for key, value in stated.items() if key in own}
        parts = {key: value for key, value in parts.items() if key in self._chosen(name)} | {
            key: stated[key] for key in self._given(name) if key in stated
        }
        return self._module.MESSAGES[name].from_dict(fields), arguments(parts)

    def _fitting(self, name: str, stated: Mapping[str, Any]) -> tuple[Any, dict[str, Any]]:
        """The same, as an answer. Raises EncodeError also where its frame has other values."""
        message, parts = self._with(name, stated)
        frame = self._encoder.preview(message, True, **parts)
        settled = {field.name for field in self._protocol.message(name).fields}
        if not stated.keys() <= settled.union(self._given(name)):  # Its identity, for example.
            try:
                line = self._module.PROTOCOL.read(frame, self.endpoint).as_json()
            except DecodeError as error:
                raise EncodeError(name, str(error)) from None
            shown = {**line["parts"], **line["fields"]}
            if any(shown[key] != value for key, value in stated.items()):
                raise EncodeError(name, "has another identity")
        return message, parts

    def _chosen(self, name: str) -> tuple[str, ...]:
        """The parts that a caller gives; counters count by themselves."""
        return tuple(part for part, is_counter in self._callers(name) if not is_counter)

    def _given(self, name: str) -> tuple[str, ...]:
        """The parts that a caller may give, counters among them."""
        return tuple(part for part, _ in self._callers(name))

    def _callers(self, name: str) -> Iterator[tuple[str, bool]]:
        """Yield the parts that a caller may give; True for those that are counters."""
        message = self._protocol.message(name)
        held = {field.part for field in message.held}
        for sender in self._protocol.senders_of(message):
            if sender.endpoint == self.endpoint:
                for part in given_parts(sender.frame, message):
                    if part.name not in held:
                        yield part.name, isinstance(part, CounterPart)

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
        silence = self._module.PROTOCOL.line.silence
        idle = None if silence is None else max(silence, MIN_SILENCE)
        decoders = LineDecoders(self._module, others, idle)
        source = others[0] if len(others) == 1 else ""
        reading: asyncio.Task[Arrival] | None = None
        try:
            while True:
                reading = reading or asyncio.create_task(port.read())
                patience = decoders.silence if decoders.pending else None
                done, _ = await asyncio.wait({reading}, timeout=patience)
                arrival, reading = (reading.result(), None) if done else (None, reading)
                if arrival is not None and not arrival.data:
                    return
                events = decoders.feed(source, arrival.data) if arrival else decoders.idle(source)
                for event in events:
                    await self._take(port, event)
        finally:
            if reading is not None:
                reading.cancel()

    async def _take(self, port: Port, event: Any) -> None:
        kind = event.message.NAME if event.kind == "message" else event.kind
        self.counts.received[kind] = self.counts.received.get(kind, 0) + 1
        if event.kind != "message":
            return
        by_exchange = [self._by_exchanges[kind]] if kind in self._by_exchanges else []
        for answer in self._answers.get(kind) or by_exchange:
            for item in answer(event):
                message, parts = item if isinstance(item, tuple) else (item, {})
                await self.send(port, message, **parts)


def _raise_first(tasks: Sequence[asyncio.Task[None]]) -> None:
    """Raise what one of them ended with, also where all are cancelled a moment later."""
    for task in tasks:
        if task.done() and not task.cancelled():
            task.result()
