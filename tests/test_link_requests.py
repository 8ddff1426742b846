"""Thousands of requests over a line that loses bytes and holds them back.

What the link says of them is compared with what was on the wire. Each request has a target of its
own, which its answer repeats and by which the link does not go: it goes by the counter, or the
order. The protocol, and the firmware in C, are those of `docs/howto/test-firmware.md`.
"""

from __future__ import annotations

import asyncio
import re
import select
import subprocess
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from cli_support import PATIENCE, run
from doc_pages import Page, named_schemas
from link_wire import WireEnd, run_in_virtual_time, wire
from tooling import require_tool

import protogen
from protogen.link import Link, LinkClosedError, NoReplyError, RefusedError, connect
from protogen.link.answers import AnswerRates
from protogen.link.damage import Damage, DamageRates
from protogen.link.ports.opening import open_port
from protogen.link.ports.port import Arrival, Port
from protogen.link.simulated_values import example_values
from protogen.link.simulation import Simulation
from protogen.link.tapping import End, tap
from protogen.live.codec import kept_module
from protogen.model.protocol import Protocol

PAGE = Page("docs/howto/test-firmware.md")
SCHEMA = named_schemas()["axis.yaml"]
BY_COUNTER = "match: counter,"
BY_ORDER = ""
REPEATED = "match: {counter: counter, target: target},"
"""What the simulator goes by, so that its answers have the target, too."""

TIMEOUT, RETRIES = 0.2, 2
"""Those of the schema."""
LATEST = 2 * TIMEOUT
"""So long the link expects an answer."""
LOST = 0.01
"""Share of the bytes that the tap leaves out."""


def schema_in(folder: Path, *changes: tuple[str, str]) -> Path:
    """The schema of the page, with changes."""
    text = SCHEMA
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    folder.mkdir(exist_ok=True)
    path = folder / "axis.yaml"
    path.write_text(text)
    return path


def protocol_in(folder: Path, match: str) -> Protocol:
    return protogen.load(schema_in(folder, (BY_COUNTER, match)))


class Line:
    """A wire, and a tap behind it that loses bytes and holds them back."""

    def __init__(self, far: Port, held: float) -> None:
        """`far` leads to the board; either way, bytes wait for at most `held` seconds."""
        self.here, middle = wire()
        self.passed = {"host": bytearray(), "board": bytearray()}
        """What the tap let through, by who sent it."""
        rates = DamageRates(drop=LOST, delay=held)
        self._ends = End("host", middle, Damage(rates, 1)), End("board", far, Damage(rates, 2))

    def _take(self, source: str, arrival: Arrival) -> None:
        self.passed[source] += arrival.data

    def messages(self, module: Any, source: str) -> int:
        """How many messages the tap let through."""
        events = module.Decoder(source).feed(bytes(self.passed[source]))
        return sum(event.kind == "message" for event in events)

    async def __aenter__(self) -> Line:
        self._tapping = asyncio.create_task(tap(*self._ends, self._take))
        return self

    async def __aexit__(self, *_: object) -> None:
        assert not self._tapping.done()
        self._tapping.cancel()


@dataclass
class Outcomes:
    """What became of requests, by their targets."""

    replies: set[int] = field(default_factory=set)
    refusals: set[int] = field(default_factory=set)
    unanswered: dict[int, int] = field(default_factory=dict)
    """With how often each was sent, as the error says."""
    settled: dict[int, float] = field(default_factory=dict)
    """When each was settled, by the link's clock."""


async def ask(
    link: Link[Any, Any], module: Any, targets: range, at_once: int, timeout: float
) -> Outcomes:
    """Make a request for each target. None may get an answer with another's."""
    found = Outcomes()
    room = asyncio.Semaphore(at_once)

    async def one(target: int) -> None:
        async with room:
            try:
                reply = await link.request(module.Move(target=target), timeout=timeout)
                assert reply == module.Moving(target=target)
                found.replies.add(target)
            except RefusedError as error:
                assert error.refusal == module.Refused(target=target)
                found.refusals.add(target)
            except NoReplyError as error:
                found.unanswered[target] = error.attempts
            found.settled[target] = asyncio.get_running_loop().time()

    async with asyncio.TaskGroup() as group:
        for target in targets:
            group.create_task(one(target))
    return found


class Sent:
    """The requests on the wire, found without the link."""

    def __init__(self, end: WireEnd, module: Any) -> None:
        self.number = Counter[int]()
        """How often each request was sent, by its target."""
        self.first: dict[int, float] = {}
        frames: dict[int, bytes] = {}
        for when, frame in end.written:
            assert frame.index(0) == len(frame) - 1  # In COBS, a zero ends each frame.
            target = module.PROTOCOL.read(frame, "host").message.target
            self.number[target] += 1
            self.first.setdefault(target, when)
            assert frames.setdefault(target, frame) == frame  # Repeated, it is the same.


def check(link: Link[Any, Any], sent: Sent, found: Outcomes, timeout: float, slack: float) -> None:
    """Compare what the link says with what was sent.

    `slack` are seconds by which the event loop may call late.
    """
    counts = link.counts
    outcomes = [found.replies, found.refusals, found.unanswered]
    assert [counts.replies, counts.refusals, counts.unanswered] == [len(it) for it in outcomes]
    assert sum(len(it) for it in outcomes) == len(found.settled) == len(sent.number)
    assert counts.sent == {"move": sent.number.total()}
    assert counts.retries == sent.number.total() - len(sent.number)
    for target, times in sent.number.items():
        took = found.settled[target] - sent.first[target]
        assert (times - 1) * timeout - slack <= took <= times * timeout + slack
        assert times <= 1 + RETRIES
        assert found.unanswered.get(target, times) == times


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
    repeating = protocol_in(tmp_path / "board", REPEATED)
    values = example_values(repeating, "board", 1)
    simulation = Simulation(repeating, kept_module(repeating), "board", {}, values)
    simulation.answer_requests(AnswerRates(refuse=0.1, ignore=0.02), seed=1)
    host: Any = kept_module(protocol_in(tmp_path / "host", match))

    async def asked() -> None:
        far, there = wire()
        async with Line(far, held) as line, connect(host, line.here, "host") as link:
            device = asyncio.create_task(simulation.run(there))
            found = await ask(link, host, range(number), at_once, TIMEOUT)
            await asyncio.sleep(LATEST)
            device.cancel()
            check(link, Sent(line.here, host), found, TIMEOUT, 1e-6)
            assert len(found.settled) == number
            assert set(found.unanswered.values()) == {1 + RETRIES}
            assert min(len(found.refusals), len(found.unanswered), link.counts.late) > 10
            # What comes is of a request that waits, or too late for it, and nothing else.
            counts = link.counts
            came = line.messages(host, "board")
            assert came == counts.replies + counts.refusals + counts.late
            assert simulation.counts.received["move"] == line.messages(host, "host")

    run_in_virtual_time(asked())


class SlowEnd(WireEnd):
    """Takes one byte in ten milliseconds."""

    async def write(self, data: bytes) -> None:
        for byte in data:
            await super().write(bytes([byte]))
            await asyncio.sleep(0.01)


def test_a_lazy_line_gets_whole_frames(tmp_path: Path) -> None:
    """A frame of 12 bytes takes 120 ms, and nobody waits so long for its answer."""
    host: Any = kept_module(protocol_in(tmp_path, BY_COUNTER))

    async def asked() -> None:
        here, there = SlowEnd("here"), WireEnd("there")
        here.other, there.other = there, here
        async with connect(host, here, "host") as link:
            found = await ask(link, host, range(5), 5, 0.1)
            await asyncio.sleep(1)
            counts = link.counts
            *frames, rest = b"".join(data for _, data in here.written).split(b"\0")
            sent = [host.PROTOCOL.read(frame + b"\0", "host").message.target for frame in frames]
            # They begin at 0, 120 and 240 ms. From 300 ms on, nobody waits.
            assert (len(sent), rest) == (3, b"")
            assert counts.sent == {"move": 3}
            assert counts.retries == 3 - len(set(sent))
            # The third one had begun, and was not sent yet.
            assert sum(found.unanswered.values()) == 2
            with pytest.raises(NoReplyError, match="move was not sent: the port did not take it"):
                await link.request(host.Move(target=9), timeout=0.1, retries=0)
            # Closed, it cuts the frame that it writes, and begins no other.
            ends = [asyncio.create_task(link.send(host.Move(target=9))) for _ in range(2)]
            await asyncio.sleep(0.05)
        for end in ends:
            with pytest.raises(LinkClosedError):
                await end

    run_in_virtual_time(asked())


# --- generated C on an emulated board -------------------------------------------------------------


def firmware(folder: Path) -> Path:
    """The page's firmware, compiled as the page says."""
    done = run(
        *("generate", f"{folder}/axis.yaml", "--target", "c", "--events", "messages"),
        *("--no-project", "--output", f"{folder}/generated"),
    )
    assert done.exit_code == 0, done.output
    (source,) = (block for block in PAGE.blocks if block.language == "c")
    (folder / source.file).write_text(source.text)
    (command,) = re.findall(r"^\$ (arm-none-eabi-gcc .*)", PAGE.commands, re.MULTILINE)
    require_tool("arm-none-eabi-gcc")
    made = subprocess.run(
        command.split(), cwd=folder, capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    assert made.returncode == 0, made.stderr
    return folder / "drive.elf"


@contextmanager
def emulated(program: Path) -> Iterator[str]:
    """A board that runs a program; gives the pseudo-terminal of its UART."""
    quiet = ("-display", "none", "-monitor", "none")
    board = subprocess.Popen(
        [
            require_tool("qemu-system-arm"),
            *("-M", "mps2-an385", *quiet, "-serial", "pty", "-kernel", program),
        ],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert board.stdout is not None
        assert select.select([board.stdout], [], [], PATIENCE)[0], "it said nothing"
        found = re.search(r"/dev/\S+", board.stdout.readline())
        assert found is not None
        yield found[0]
    finally:
        board.kill()
        board.communicate()


class Listened(Port):
    """A port, and what was read of it."""

    def __init__(self, port: Port) -> None:
        super().__init__(port.name)
        self._port = port
        self.came = bytearray()

    async def read(self) -> Arrival:
        arrival = await self._port.read()
        self.came += arrival.data
        return arrival

    async def write(self, data: bytes) -> None:
        await self._port.write(data)

    async def close(self) -> None:
        await self._port.close()


def test_against_c_on_an_emulated_board(tmp_path: Path) -> None:
    """Ten thousand requests, of which the firmware refuses a quarter.

    A counter of two bytes is never the same for two of them, so that a machine which stands still
    for long makes no answer too late.
    """
    pytest.importorskip("serialx")
    schema = schema_in(tmp_path, ("{type: uint8, counter: true}", "{type: uint16, counter: true}"))
    host: Any = kept_module(protogen.load(schema))
    targets = range(0, 400_000, 40)
    timeout = 0.4

    async def asked(address: str) -> None:
        async with Listened(await open_port(address)) as board:
            # QEMU takes a while to see that somebody has opened its pseudo-terminal.
            await board.write(host.encode(host.Move(target=-1), counter=0))
            while board.came != host.encode(host.Refused(target=-1), counter=0):
                await board.read()
            board.came.clear()
            async with Line(board, 0.03) as line, connect(host, line.here, "host") as link:
                found = await ask(link, host, targets, 50, timeout)
                check(link, Sent(line.here, host), found, timeout, 10)
                assert found.settled.keys() == set(targets)
                assert found.replies <= set(range(0, 300_001, 40))
                assert found.refusals <= set(range(300_040, 400_000, 40))
                # Of the damaged bytes, C has read what Python does, and has answered each once.
                while board.came.count(0) < line.messages(host, "host"):
                    await asyncio.sleep(0.05)
            assert board.came.count(0) == line.messages(host, "host")

    with emulated(firmware(tmp_path)) as port:
        asyncio.run(asyncio.wait_for(asked(port), PATIENCE))
