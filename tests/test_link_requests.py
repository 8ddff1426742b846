"""Thousands of requests over a line that loses bytes and holds them back.

What the link says of them is compared with what was on the wire. Each request has a token that
its answer repeats and that the link knows nothing of: it goes by the counter, or by the order.
"""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from link_wire import WireEnd, run_in_virtual_time, wire

import protogen
from protogen.link import Link, NoReplyError, RefusedError, connect
from protogen.link.answers import AnswerRates
from protogen.link.damage import Damage, DamageRates
from protogen.link.ports.port import Arrival
from protogen.link.simulated_values import example_values
from protogen.link.simulation import Simulation
from protogen.link.tapping import End, tap
from protogen.live.codec import kept_module

SCHEMA = """\
protocol: valve
endpoints: {{host: Host, board: Board}}
byte_order: little
frame:
  counter: {{type: uint8, counter: true}}
  kind: {{type: uint8, id: true}}
  payload: {{}}
  crc: {{type: uint32, algorithm: CRC-32/ISO-HDLC, covers: counter..payload}}
  end: {{literal: 0x00}}
transparency: {{covers: counter..crc, encoding: cobs}}
messages:
  set: {{id: 1, from: host, fields: {{token: uint32}}}}
  done: {{id: 17, from: board, fields: {{token: uint32}}}}
  refused: {{id: 18, from: board, fields: {{token: uint32}}}}
exchanges:
  command: {{request: set, reply: done, refusal: refused, {match}}}
"""
BY_COUNTER = "match: counter"
BY_ORDER = "retries: 0"
REPEATED = "match: {counter: counter, token: token}"
"""What the simulator goes by, so that its answers have the token, too."""

TIMEOUT, RETRIES = 0.1, 2
LOST = 0.01
LATEST = 2 * TIMEOUT
"""So long the link expects an answer."""


def module_of(match: str, folder: Path) -> tuple[Any, ModuleType]:
    """The protocol, where an exchange goes by this."""
    path = folder / "valve.yaml"
    path.write_text(SCHEMA.format(match=match))
    protocol = protogen.load(path)
    return protocol, kept_module(protocol)


class Line:
    """Two wires with a tap between them, which loses bytes and holds them back."""

    def __init__(self, held: float) -> None:
        """`held` are the most seconds for which bytes wait, either way."""
        self.here, middle = wire()
        other, self.there = wire()
        self.passed = {"host": bytearray(), "board": bytearray()}
        """What the tap let through, by who sent it."""
        rates = DamageRates(drop=LOST, delay=held)
        self._ends = End("host", middle, Damage(rates, 1)), End("board", other, Damage(rates, 2))

    def _take(self, source: str, arrival: Arrival) -> None:
        self.passed[source] += arrival.data

    async def __aenter__(self) -> Line:
        self._tapping = asyncio.create_task(tap(*self._ends, self._take))
        return self

    async def __aexit__(self, *_: object) -> None:
        assert not self._tapping.done()
        self._tapping.cancel()


def messages(decoder: Any, data: bytearray) -> int:
    """How many messages are in what came."""
    return sum(event.kind == "message" for event in decoder.feed(bytes(data)))


@dataclass
class Outcomes:
    """What became of requests, by their tokens."""

    replies: set[int] = field(default_factory=set)
    refusals: set[int] = field(default_factory=set)
    unanswered: set[int] = field(default_factory=set)
    settled: dict[int, float] = field(default_factory=dict)
    """When each was settled, by the link's clock."""


async def ask(link: Link[Any, Any], module: Any, number: int, at_once: int) -> Outcomes:
    """Make so many requests. None may get an answer with another's token."""
    found = Outcomes()
    room = asyncio.Semaphore(at_once)

    async def one(token: int) -> None:
        async with room:
            try:
                reply = await link.request(
                    module.Set(token=token), timeout=TIMEOUT, retries=RETRIES
                )
                assert reply == module.Done(token=token)
                found.replies.add(token)
            except RefusedError as error:
                assert error.refusal == module.Refused(token=token)
                found.refusals.add(token)
            except NoReplyError as error:
                assert error.attempts == 1 + RETRIES
                found.unanswered.add(token)
            found.settled[token] = asyncio.get_running_loop().time()

    async with asyncio.TaskGroup() as group:
        for token in range(number):
            group.create_task(one(token))
    return found


def frames_of(end: WireEnd) -> Iterator[tuple[float, bytes]]:
    """Each frame that was written at an end, with its time: in COBS, all up to a zero."""
    for when, data in end.written:
        assert data.count(0) == 1
        assert data.endswith(b"\0")
        yield when, data


class Sent:
    """The requests on the wire, which are found without the link."""

    def __init__(self, end: WireEnd, module: Any) -> None:
        self.number = Counter[int]()
        """How often each request was sent, by its token."""
        self.first: dict[int, float] = {}
        frames: dict[int, bytes] = {}
        for when, frame in frames_of(end):
            token = module.PROTOCOL.read(frame, "host").message.token
            self.number[token] += 1
            self.first.setdefault(token, when)
            assert frames.setdefault(token, frame) == frame  # Repeated, it is the same.


def check(link: Link[Any, Any], sent: Sent, found: Outcomes, number: int, slack: float) -> None:
    """Compare what the link says with what was sent."""
    counts = link.counts
    assert sent.number.keys() == set(range(number))
    assert counts.sent == {"set": sent.number.total()}
    assert counts.retries == sent.number.total() - number
    assert (counts.replies, counts.refusals, counts.unanswered) == (
        len(found.replies), len(found.refusals), len(found.unanswered)
    )  # fmt: skip
    assert counts.replies + counts.refusals + counts.unanswered == number
    for token, times in sent.number.items():
        took = found.settled[token] - sent.first[token]
        assert (times - 1) * TIMEOUT - 1e-6 <= took <= times * TIMEOUT + slack
        assert times <= 1 + RETRIES
        assert token not in found.unanswered or times == 1 + RETRIES


@pytest.mark.parametrize(
    ("match", "number", "at_once", "held"),
    [
        # Bytes wait for those in front of them, and then as long themselves: four times in all.
        (BY_COUNTER, 10_000, 40, LATEST / 4),
        # They never wait for others.
        (BY_ORDER, 1_000, 10, LATEST / 2),
    ],
    ids=["by_counter", "by_order"],
)
def test_against_the_simulator(
    match: str, number: int, at_once: int, held: float, tmp_path: Path
) -> None:
    """In virtual time, which is the same on each machine, whatever else it does."""
    protocol, board = module_of(REPEATED, tmp_path)
    _, host = module_of(match, tmp_path)
    simulation = Simulation(protocol, board, "board", {}, example_values(protocol, "board", 1))
    simulation.answer_requests(AnswerRates(refuse=0.1, ignore=0.02), seed=1)

    async def asked() -> None:
        async with Line(held) as line:
            device = asyncio.create_task(simulation.run(line.there))
            async with connect(host, line.here, "host") as link:
                found = await ask(link, host, number, at_once)
                await asyncio.sleep(LATEST)
                check(link, Sent(line.here, host), found, number, 1e-6)
                assert min(len(found.replies), len(found.refusals), len(found.unanswered)) > 10
                assert link.counts.late > 10
                # What comes is of a request that waits, or too late for it, and nothing else.
                came = messages(host.Decoder("board"), line.passed["board"])
                assert came == link.counts.replies + link.counts.refusals + link.counts.late
                got = messages(host.Decoder("host"), line.passed["host"])
                assert simulation.counts.received["set"] == got
            device.cancel()

    run_in_virtual_time(asked())
