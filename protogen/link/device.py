"""A simulated device for tests of programs: a port, and an endpoint behind it."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Mapping
from types import TracebackType
from typing import Any, Literal, Self

from protogen.api import load
from protogen.link.answers import Answer, AnswerRates
from protogen.link.damage import Damage, DamageRates
from protogen.link.loop_thread import LoopThread
from protogen.link.ports.opening import open_port
from protogen.link.ports.port import Port, PortError
from protogen.link.simulated_values import (
    ValueFunction,
    computed_values,
    example_values,
)
from protogen.link.simulation import Counts, Simulation, rates_of
from protogen.live.codec import kept_module
from protogen.model.protocol import Protocol

_PATIENCE = 60
"""Seconds in which the device has to begin and to end."""


class SimulatedDevice:
    """A device that speaks for one endpoint, in a thread of its own.

    >>> with SimulatedDevice("rover.yaml", "board", rates={"state": 50}) as board:  # doctest: +SKIP
    ...     board.on("drive", lambda event: [])
    ...     my_program(board.port)
    """

    def __init__(  # noqa: PLR0913 - an argument for each setting
        self,
        schema: str | os.PathLike[str] | Protocol,
        endpoint: str,
        *,
        rates: Mapping[str, float] | None = None,
        values: ValueFunction | None = None,
        address: str = "pty:",
        seed: int = 0,
        damage: DamageRates | None = None,
        answers: Literal["exchanges"] | None = "exchanges",
        answer_rates: AnswerRates | None = None,
    ) -> None:
        """`rates` are messages with how often each is sent, in Hz, in place of the schema's `rate`.

        Values are those of examples, or random ones in their ranges; a function of the message's
        name and the seconds since the start gives others. The device is at a pseudo-terminal, or
        listens: `listen://127.0.0.1:0`. Requests are answered as the schema's exchanges say, but
        for the shares that `answer_rates` has refused or not answered; with `answers=None` none
        is. Raises SchemaError.
        """
        protocol = schema if isinstance(schema, Protocol) else load(schema)
        usual = example_values(protocol, endpoint, seed)
        self._address = address
        self._simulation = Simulation(
            protocol,
            kept_module(protocol),
            endpoint,
            rates_of(protocol, endpoint, rates or {}),
            usual if values is None else computed_values(usual, values),
            Damage(damage, seed) if damage is not None else None,
        )
        if answers is not None:
            self._simulation.answer_requests(answer_rates or AnswerRates(), seed)
        self.port = ""
        """The port that a program opens."""
        self.messages: dict[str, Any] = kept_module(protocol).MESSAGES
        """Classes of the messages, by name, for answers."""
        self._loop: LoopThread | None = None
        self._work: asyncio.Task[None] | None = None
        self._opened: Port | None = None

    @property
    def counts(self) -> Counts:
        """What was sent and received so far."""
        return self._simulation.counts

    def on(self, message: str, answer: Answer) -> None:
        """Answer each such message: `answer` takes the event and returns messages to send.

        With a message may come its parts: `[(Ack(), {"counter": event.parts.counter})]`. This
        takes the place of what the schema's exchanges answer. Raises KeyError if there is no such
        message.
        """
        self._simulation.on(message, answer)

    def send(self, message: Any, **parts: Any) -> None:
        """Send a message now. Raises EncodeError, PortError before the device has begun.

        Raises what ended the device, where something has.
        """
        if self._loop is None or self._opened is None or self._work is None:
            raise PortError("the device has not begun", "use it in a `with`, or call `start`")
        if self._work.done():
            self._work.result()
        self._loop.do(self._simulation.send(self._opened, message, **parts), _PATIENCE)

    def start(self) -> Self:
        """Open the port, and begin, also once more after `stop`. Raises PortError."""
        if self._loop is not None:
            raise PortError("the device has begun already", "`stop` it first")
        loop = LoopThread("simulated device")
        try:
            self._opened = loop.do(open_port(self._address), _PATIENCE)
        except BaseException:
            loop.close()
            raise
        self._loop = loop
        self._work = loop.begin(self._serve(self._opened))
        self.port = self._opened.name
        return self

    def stop(self) -> None:
        """Take the device away, as if it were unplugged.

        Raises what ended it before, such as an error in a function that answers.
        """
        loop, work = self._loop, self._work
        self._loop = self._work = self._opened = None
        if loop is None or work is None:
            return
        try:
            loop.end(work, _PATIENCE)
        finally:
            loop.close()

    async def _serve(self, port: Port) -> None:
        async with port:
            await self._simulation.run(port)

    def __enter__(self) -> Self:
        return self.start()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.stop()
