"""A tap in the middle of a line: passes bytes on between two ports, and shows them."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable

import msgspec

from protogen.link.damage import Damage
from protogen.link.ports.port import Arrival, Port

Take = Callable[[str, Arrival], None]
"""Takes what an end sent, as it is about to be passed on."""


class Passed(msgspec.Struct):
    """What was passed on in one direction, and how long the tap held it, in seconds."""

    bytes: int = 0
    lost: int = 0
    """Bytes that the other end did not take, or that came while it was gone."""
    pieces: int = 0
    held: float = 0.0
    most_held: float = 0.0

    @property
    def mean_held(self) -> float:
        """Seconds that a piece was held on average."""
        return self.held / self.pieces if self.pieces else 0.0


class End(msgspec.Struct):
    """One end of the line: its name, the port that leads to it, and what becomes of its bytes."""

    name: str
    port: Port
    damage: Damage | None = None
    passed: Passed = msgspec.field(default_factory=Passed)


async def tap(one: End, other: End, take: Take) -> None:
    """Pass bytes on both ways until one end has no more.

    `take` sees them first: what it records is there before anybody has got it. What the other end
    does not take is counted, and lost, as on any line. Raises PortLostError where a port is gone,
    with the ports left to the caller.
    """
    ways = [
        asyncio.create_task(_pass_on(one, other.port, take)),
        asyncio.create_task(_pass_on(other, one.port, take)),
    ]
    try:
        done, _ = await asyncio.wait(ways, return_when=asyncio.FIRST_COMPLETED)
        for way in done:
            way.result()
    finally:
        for way in ways:
            way.cancel()
        await asyncio.gather(*ways, return_exceptions=True)


async def _pass_on(source: End, target: Port, take: Take) -> None:
    while (arrival := await source.port.read()).data:
        came = time.perf_counter()
        data = arrival.data
        if source.damage is not None:
            await asyncio.sleep(source.damage.pause())
            data = source.damage.of(data)
        sent = 0
        if data:
            take(source.name, Arrival(data, arrival.when))
            sent = await target.pass_on(data)
        source.passed.lost += len(data) - sent
        _note(source.passed, sent, time.perf_counter() - came)


def _note(passed: Passed, size: int, held: float) -> None:
    passed.bytes += size
    passed.pieces += 1
    passed.held += held
    passed.most_held = max(passed.most_held, held)
