"""A protocol with requests, and a small device of it, at a pseudo-terminal or another port."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Callable, Iterable
from random import Random
from types import ModuleType
from typing import Any

from protogen.link.ports.port import Port, PortLostError
from protogen.link.ports.pseudo_terminal import make_pseudo_terminal

SCHEMA = """\
protocol: rig
endpoints: {host: Host, board: Board, viewer: Somebody who only looks}
link: {baud: 1000000, idle_timeout: 20 ms}
frame:
  sync: {literal: 0x55}
  length: {type: uint8, counts: counter..payload}
  counter: {type: uint8, counter: true}
  kind: {type: uint8, id: true}
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/KERMIT, covers: length..payload}
transparency: {covers: length..crc, escape: {byte: 0x56, of: [0x55, 0x56], transform: invert}}
byte_order: little
messages:
  set: {id: 1, from: host, fields: {value: uint16}}
  reset: {id: 2, from: host}
  ask: {id: 3, from: host, fields: {which: uint8}}
  ping: {id: 4, from: host, fields: {n: uint8}}
  note: {id: 5, from: host, fields: {text: {type: ascii, size: {fill: true, max: 40}}}}
  done: {id: 17, from: board, fields: {value: uint16}}
  failed: {id: 18, from: board, fields: {code: uint8}}
  value: {id: 19, from: board, fields: {which: uint8, value: sint16}}
  pong: {id: 20, from: board, fields: {n: uint8}}
  state: {id: 21, from: board, fields: {n: uint32}}
exchanges:
  command:
    request: [set, reset]
    reply: done
    refusal: failed
    match: counter
    timeout: 200 ms
    retries: 9
  query: {request: ask, reply: value, match: which, timeout: 2 s}
  order: {request: ping, reply: pong, timeout: 200 ms, retries: 2}
"""

Answers = Iterable[tuple[float, bytes]]
"""Frames, each with the seconds after which it is sent."""
Behaviour = Callable[[Any], Answers]
"""What a device does where it has read a message."""


class Board:
    """A device. It damages what goes in and out, and counts what came before that."""

    def __init__(
        self,
        module: ModuleType,
        behaviour: Behaviour,
        port: Port | None = None,
        *,
        lost: float = 0.0,
        seed: int = 1,
    ) -> None:
        """Of each byte, either way, `lost` is the chance that it is lost."""
        self.port = port or make_pseudo_terminal()
        self.arrived = Counter[str]()
        """Messages as they were sent to it."""
        self._whole = module.Decoder(sender="host")
        self._damaged = module.Decoder(sender="host")
        self._behaviour = behaviour
        self._lost = lost
        self._dice = Random(seed)
        self._answers: set[asyncio.Task[None]] = set()
        self._reader = asyncio.create_task(self._read())

    def _through(self, data: bytes) -> bytes:
        return bytes(byte for byte in data if self._dice.random() >= self._lost)

    async def _read(self) -> None:
        while True:
            data = (await self.port.read()).data
            self.arrived.update(event.message.NAME for event in self._whole.feed(data))
            for event in self._damaged.feed(self._through(data)):
                if event.kind == "message":
                    for delay, frame in self._behaviour(event):
                        self.later(delay, frame)

    def later(self, delay: float, frame: bytes) -> None:
        """Send something, damaged as the line does."""
        task = asyncio.create_task(self._send(delay, self._through(frame)))
        self._answers.add(task)
        task.add_done_callback(self._answers.discard)

    async def _send(self, delay: float, data: bytes) -> None:
        await asyncio.sleep(delay)
        await self.port.write(data)

    async def close(self) -> None:
        tasks = [self._reader, *self._answers]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        await self.port.close()

    async def __aenter__(self) -> Board:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()


def obedient(module: ModuleType) -> Behaviour:
    """Answers at once, as the schema says."""

    def behave(event: Any) -> Answers:
        counter = event.parts.counter
        match event.message:
            case module.Set(value=value):
                yield 0, module.encode(module.Done(value=value), counter=counter)
            case module.Reset():
                yield 0, module.encode(module.Failed(code=7), counter=counter)
            case module.Ask(which=which):
                yield 0, module.encode(module.Value(which=which, value=-which), counter=0)
            case module.Ping(n=n):
                yield 0, module.encode(module.Pong(n=n), counter=0)

    return behave


def silent(event: Any) -> Answers:
    """Answers nothing."""
    return ()


async def flooded(module: ModuleType, port: Port, number: int) -> None:
    """Send so many states, numbered from 0."""
    for first in range(0, number, 100):
        numbers = range(first, min(first + 100, number))
        frames = (module.encode(module.State(n=n), counter=0) for n in numbers)
        try:
            await port.write(b"".join(frames))
        except PortLostError:
            return
