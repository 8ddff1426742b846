"""Simulated devices: what they send is what the schema says, and they answer."""

from __future__ import annotations

import asyncio
import math
import os
import re
import select
import signal
import socket
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event
from typing import Any

import pytest
from cli_support import PATIENCE, ROOT, run
from link_wire import run_in_virtual_time, wire
from test_cli_line import line_of, opened, read, started

import protogen
from generated.python import matty
from protogen.link import NoReplyError, PortError, RefusedError, connect
from protogen.link.answers import AnswerRates
from protogen.link.damage import DamageRates
from protogen.link.device import SimulatedDevice
from protogen.link.simulated_values import ValuesError, example_values
from protogen.link.simulation import Simulation, rates_of
from protogen.live.codec import kept_module
from protogen.model.protocol import Protocol
from protogen.recording import Recorder

pytest.importorskip("serialx")
pytestmark = pytest.mark.skipif(os.name != "posix", reason="pseudo-terminals are of POSIX")

MATTY = str(ROOT / "schemas/matty.yaml")
STOP = bytes.fromhex("55 02 01 53 AA")  # with counter 1
ACK = bytes.fromhex("55 02 01 41 BC")  # with counter 1


def messages_until(port: int, enough: Callable[[list[Any]], bool]) -> list[Any]:
    """What comes until there is enough of it, all of which has to be messages."""
    decoder = matty.Decoder("esp")
    found: list[Any] = []
    while not enough(found):
        assert select.select([port], [], [], PATIENCE)[0], "nothing comes any more"
        events = decoder.feed(os.read(port, 4096))
        assert all(event.kind == "message" for event in events)
        found += [event.message for event in events]
    return found


def until(holds: Callable[[], bool]) -> None:
    """Wait for what another thread does soon."""
    end = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < end, "it did not come"
        time.sleep(0.005)


@contextmanager
def device(*args: Any, **settings: Any) -> Iterator[tuple[SimulatedDevice, int]]:
    """A device, and its port, opened."""
    with SimulatedDevice(*args, **settings) as found, opened(found.port) as port:
        yield found, port


@contextmanager
def simulating(*options: str) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """The command, and its port, opened."""
    with started("simulate", MATTY, *options) as it, opened(line_of(it.stdout).strip()) as port:
        yield it, port


class TestDevice:
    def test_sends_at_its_rate_with_values_of_examples(self) -> None:
        began = time.monotonic()
        with device(MATTY, "esp", rates={"status": 100}) as (it, port):
            found = messages_until(port, lambda found: len(found) >= 30)
        assert time.monotonic() - began >= 0.3
        assert {type(message) for message in found} == {matty.Status}
        assert it.counts.sent["status"] >= len(found)

    def test_no_message_is_late(self) -> None:
        """In virtual time: each is sent when its rate says, counted from the start."""

        async def sent() -> None:
            here, there = wire()
            protocol = protogen.load(MATTY)
            values = example_values(protocol, "esp", 0)
            simulation = Simulation(
                protocol, kept_module(protocol), "esp", {"status": 100, "ack": 30}, values
            )
            running = asyncio.create_task(simulation.run(there))
            await asyncio.sleep(1.005)
            running.cancel()
            events = [matty.Decoder("esp").feed(data)[0] for _, data in there.written]
            for name, rate in (("status", 100), ("ack", 30)):
                times = [
                    when
                    for (when, _), event in zip(there.written, events, strict=True)
                    if name == event.message.NAME
                ]
                assert times == pytest.approx([(n + 1) / rate for n in range(rate)])
            assert simulation.counts.sent == {"status": 100, "ack": 30}
            assert here.written == []

        run_in_virtual_time(sent())

    def test_counts_frames_by_itself(self) -> None:
        with (
            SimulatedDevice(MATTY, "pc", rates={"stop": 200}) as device,
            opened(device.port) as port,
        ):
            assert read(port, 10) == bytes.fromhex("55 02 00 53 AB  55 02 01 53 AA")

    def test_answers(self) -> None:
        with device(MATTY, "esp") as (it, port):
            ack = it.messages["ack"]
            it.on("stop", lambda event: [(ack(), {"counter": event.parts.counter})])
            os.write(port, b"noise" + STOP)
            assert read(port, 5) == ACK
            assert it.counts.received == {"invalid": 1, "stop": 1}

    def test_answers_as_the_exchanges_say(self) -> None:
        with device(MATTY, "esp") as (it, port):
            os.write(port, STOP)
            assert read(port, 5) == ACK
            assert it.counts.sent == {"ack": 1}

    def test_an_answer_of_its_own_replaces_that_of_the_exchange(self) -> None:
        with device(MATTY, "esp") as (it, port):
            it.on("stop", lambda event: [(it.messages["nack"](), {"counter": 7})])
            os.write(port, STOP)
            assert read(port, 5)[3] == ord("N")
            time.sleep(0.05)
            assert it.counts.sent == {"nack": 1}

    def test_answers_nothing_where_it_should_not(self) -> None:
        with device(MATTY, "esp", answers=None) as (it, port):
            os.write(port, STOP)
            until(lambda: bool(it.counts.received))
            time.sleep(0.05)
            assert (it.counts.received, it.counts.sent) == ({"stop": 1}, {})

    def test_refuses_and_ignores_the_shares_that_it_is_told(self) -> None:
        """In virtual time, in which no answer is late."""
        protocol = protogen.load(MATTY)
        simulation = Simulation(
            protocol, kept_module(protocol), "esp", {}, example_values(protocol, "esp", 5)
        )
        simulation.answer_requests(AnswerRates(refuse=0.3, ignore=0.2), seed=5)
        outcomes = Counter[str]()

        async def asked() -> None:
            here, there = wire()
            running = asyncio.create_task(simulation.run(there))
            async with connect(matty, here, "pc") as link:
                for _ in range(400):
                    try:
                        await link.request(matty.Stop(), timeout=0.03, retries=0)
                    except (NoReplyError, RefusedError) as error:
                        outcomes[type(error).__name__] += 1
            running.cancel()

        run_in_virtual_time(asked())
        assert 100 <= outcomes["RefusedError"] <= 140
        assert 60 <= outcomes["NoReplyError"] <= 100
        assert simulation.counts.sent["nack"] == outcomes["RefusedError"]

    def test_refuses_all_where_it_is_told(self) -> None:
        rates = AnswerRates(refuse=1)
        with (
            SimulatedDevice(MATTY, "esp", answer_rates=rates) as it,
            matty.connect(it.port, "pc") as link,
            pytest.raises(RefusedError),
        ):
            link.request(matty.Stop(), timeout=PATIENCE)

    def test_sends_when_it_is_told(self) -> None:
        with device(MATTY, "esp") as (it, port):
            it.send(it.messages["ack"](), counter=1)
            assert read(port, 5) == ACK

    def test_values_are_a_function_of_the_time(self) -> None:
        def values(message: str, seconds: float) -> dict[str, int]:
            assert message == "status"
            return {"voltage": round(7000 + 100 * math.sin(seconds))}

        with device(MATTY, "esp", rates={"status": 100}, values=values) as (_, port):
            found = messages_until(port, lambda found: len({it.voltage for it in found}) > 3)
        assert all(6900 <= message.voltage <= 7100 for message in found)

    def test_the_same_seed_sends_the_same(self) -> None:
        def sent(seed: int) -> bytes:
            rates, damage = {"stop": 500}, DamageRates(flip=0.02, drop=0.02)
            with device(MATTY, "pc", rates=rates, seed=seed, damage=damage) as (_, port):
                return read(port, 500)

        first = sent(1)
        assert first == sent(1)
        assert first != sent(2)
        events = matty.Decoder("pc").feed(first)
        assert {event.kind for event in events} > {"message"}

    def test_is_unplugged_when_it_ends(self) -> None:
        with SimulatedDevice(MATTY, "esp") as it:
            port = os.open(it.port, os.O_RDWR | os.O_NOCTTY)
        with pytest.raises(OSError, match="Input/output error"):
            os.write(port, b"x")
        os.close(port)

    def test_is_at_a_socket(self) -> None:
        address = "listen://127.0.0.1:0"
        with SimulatedDevice(MATTY, "pc", rates={"stop": 100}, address=address) as it:
            host, number = it.port.removeprefix("socket://").split(":")
            with socket.create_connection((host, int(number)), timeout=PATIENCE) as client:
                decoder = matty.Decoder("pc")
                found: list[Any] = []
                while len(found) < 5:
                    found += decoder.feed(client.recv(100))
        assert all(event.kind == "message" for event in found)


ASKED = """\
protocol: rig
endpoints: {host: Host, board: Board}
link: {idle_timeout: 20 ms}
byte_order: little
frame:
  kind: {type: uint8, id: true}
  payload: {}
  end: {literal: 0xC0}
transparency: slip
messages:
  ask: {id: 1, from: host, fields: {which: uint8, name: {type: bytes, size: 2}}}
  get: {id: 2, from: host, fields: {wanted: uint8}}
  value:
    id: 17
    from: board
    fields: {of: {type: uint8, range: [0, 9]}, label: {type: bytes, size: 2}, value: uint16}
  wide: {id: 18, from: board, fields: {label: {type: bytes, size: 2}, of: uint8}}
  red: {id: 33, from: board, fields: {level: uint8}}
  green: {id: 34, from: board, fields: {level: uint8}}
exchanges:
  query: {request: ask, reply: [value, wide], match: {which: of, name: label}}
  colour: {request: get, reply: [red, green], match: {wanted: kind}}
"""


def test_sends_at_the_rates_of_the_schema_unless_others_are_given(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(
        "protocol: rig\nendpoints: {board: Board}\nframe: {kind: {type: uint8, id: true}, "
        "payload: {}, end: {literal: 0xC0}}\ntransparency: slip\nmessages:\n"
        "  often: {id: 1, from: board, rate: 5 ms}\n"
        "  never: {id: 2, from: board, rate: 100 Hz}\n"
        "  other: {id: 3, from: board, rate: 0.01}\n"
    )
    protocol = protogen.load(path)
    assert rates_of(protocol, "board", {}) == {"often": 200, "never": 100, "other": 0.01}
    assert rates_of(protocol, "board", {"never": 0, "other": 9}) == {"often": 200, "other": 9}
    with SimulatedDevice(path, "board", rates={"never": 0, "other": 200}) as it:
        with opened(it.port) as port:
            assert set(read(port, 20)) == {1, 3, 0xC0}
        assert it.counts.sent.keys() == {"often", "other"}
    done = run("simulate", str(path), "--rate", "never=0", "--for", "0.2")
    assert re.search(r"sent \d+ often", done.stderr), done.stderr
    assert "never" not in done.stderr


class TestExchanges:
    """Which of several replies it is, by what the request has."""

    @pytest.fixture
    def rig(self, tmp_path: Path) -> Protocol:
        (tmp_path / "rig.yaml").write_text(ASKED)
        return protogen.load(tmp_path / "rig.yaml")

    def test_the_first_reply_that_can_have_the_values(self, rig: Protocol) -> None:
        module: Any = kept_module(rig)
        with SimulatedDevice(rig, "board") as it, module.connect(it.port, "host") as link:
            small = link.request(module.Ask(which=9, name=b"ab"))
            assert (small.NAME, small.of, small.label) == ("value", 9, b"ab")
            large = link.request(module.Ask(which=10, name=b"ab"))
            assert (large.NAME, large.of, large.label) == ("wide", 10, b"ab")

    def test_the_reply_whose_identity_was_asked_for(self, rig: Protocol) -> None:
        module: Any = kept_module(rig)
        with SimulatedDevice(rig, "board") as it, module.connect(it.port, "host") as link:
            for wanted, name in ((34, "green"), (33, "red")):
                reply = link.request(module.Get(wanted=wanted), timeout=PATIENCE)
                assert name == reply.NAME
            with pytest.raises(NoReplyError):
                link.request(module.Get(wanted=35), timeout=0.05)
        assert it.counts.sent == {"green": 1, "red": 1}

    @pytest.mark.parametrize("name", ["mhz19", "ping", "feetech"])
    def test_each_request_of_the_library_has_an_answer(self, name: str) -> None:
        one = {"id": 1} if name == "feetech" else {}  # Its requests may also be to all.
        protocol = protogen.load(f"library:{name}")
        module: Any = kept_module(protocol)
        for exchange in module.PROTOCOL.exchanges:
            (answering,) = {
                end for reply in exchange.replies for end in protocol.message(reply.NAME).senders
            }
            asking = next(end for end in protocol.sending if end != answering)
            values = example_values(protocol, asking, 3)
            with (
                SimulatedDevice(protocol, answering) as it,
                module.connect(it.port, asking) as link,
            ):
                for request in exchange.requests:
                    fields, parts = values(request.NAME, 0.0)
                    link.request(request.from_dict(fields), timeout=PATIENCE, **{**parts, **one})


class TestCommand:
    def test_is_soon_there_and_prints_its_port(self) -> None:
        run("check", MATTY)  # What is compiled is kept.
        options = ("--endpoint", "esp", "--rate", "status=100", "--values", "random", "--seed", "3")
        with simulating(*options) as (it, port):
            messages_until(port, lambda found: len({it.voltage for it in found}) > 10)
            it.send_signal(signal.SIGINT)
            _, error = it.communicate(timeout=PATIENCE)
        assert it.returncode == 0
        assert re.search(r"sent \d+ status", error)

    def test_values_of_a_recording(self, tmp_path: Path) -> None:
        with Recorder(tmp_path / "run.pgrec") as recorder:
            for number, speed in enumerate((7, -7)):
                frame = matty.encode(matty.Go(speed=speed, steer=speed), counter=9)
                recorder.write(frame, t_ns=number * 300_000_000, source="pc")
        options = ("--endpoint", "pc", "--rate", "go=50", "--values", str(tmp_path / "run.pgrec"))
        decoder, found = matty.Decoder("pc"), []
        with simulating(*options) as (_, port):
            while len(found) < 30:
                found += decoder.feed(os.read(port, 100))
        speeds = [event.message.speed for event in found]
        assert speeds == sorted(speeds, reverse=True)
        assert set(speeds) == {7, -7}
        counters = [event.parts.counter for event in found]
        assert counters == list(range(counters[0], counters[0] + len(counters)))

    def test_values_of_a_function(self, tmp_path: Path) -> None:
        (tmp_path / "wave.py").write_text("def wave(message, seconds):\n    return {'speed': 12}\n")
        values = ("--values", f"{tmp_path}/wave.py:wave")
        with simulating("--endpoint", "pc", "--rate", "go=50", *values) as (_, port):
            event = matty.Decoder("pc").feed(read(port, 9))[0]
        assert event.kind == "message"
        assert isinstance(event.message, matty.Go)
        assert event.message.speed == 12

    @pytest.mark.parametrize(
        ("options", "problem"),
        [
            ((), "it is not said which endpoint the device is"),
            (("--endpoint", "esb"), "`esb` is no endpoint of matty that sends"),
            (("--endpoint", "esp", "--rate", "statu=1"), "esp sends no `statu`"),
            (("--endpoint", "esp", "--rate", "status"), "does not say how often status is sent"),
            (
                ("--endpoint", "esp", "--rate", "status=-1"),
                "does not say how often `status` is sent",
            ),
            (("--endpoint", "pc", "--refuse", "0.1"), "no exchange of matty has a refusal of pc"),
            (("--endpoint", "esp", "--silent", "--ignore", "1"), "answers no request at all"),
            (("--endpoint", "esp", "--refuse", "1", "--ignore", "1"), "more than 1 together"),
            (("--endpoint", "esp", "--pty", "--listen", ":1"), "exclude each other"),
            (
                ("--endpoint", "esp", "--values", "no.pgrec"),
                "--values no.pgrec is none of: examples",
            ),
            (("--endpoint", "esp", "--values", "exampels"), "did you mean `examples`?"),
            (("--endpoint", "esp", "--values", "wave.py"), "write wave.py:NAME"),
            (("--endpoint", "esp", "--values", "no.py:wave"), "there is no file no.py"),
        ],
    )
    def test_mistakes_are_told(self, options: tuple[str, ...], problem: str) -> None:
        done = run("simulate", MATTY, *options)
        assert done.exit_code == 2
        assert problem in done.stderr

    @pytest.mark.parametrize(
        ("body", "problem"),
        [
            ("return {'speed': 1 << 20}", "`go` can't be sent: speed: 1048576"),
            ("return {'spede': 1}", "`go` can't have these values: spede"),
            ("return 1 / 0", "the function of values fails for `go`: ZeroDivisionError"),
        ],
    )
    def test_a_function_that_fails_ends_it(self, tmp_path: Path, body: str, problem: str) -> None:
        (tmp_path / "wave.py").write_text(f"def wave(message, seconds):\n    {body}\n")
        values = ("--values", f"{tmp_path}/wave.py:wave", "--for", "20")
        done = run("simulate", MATTY, "--endpoint", "pc", "--rate", "go=50", *values)
        assert done.exit_code == 2
        assert problem in done.stderr


PROGRAM = """
import os

def test_robot(simulated_device):
    device = simulated_device({schema!r}, "pc", rates={{"stop": 100}})
    port = os.open(device.port, os.O_RDWR | os.O_NOCTTY)
    assert os.read(port, 1)
    os.close(port)
"""


def test_a_fixture_of_pytest(tmp_path: Path) -> None:
    (tmp_path / "test_robot.py").write_text(PROGRAM.format(schema=MATTY))
    (tmp_path / "conftest.py").write_text('pytest_plugins = ["protogen.link.pytest_plugin"]\n')
    command = [sys.executable, "-m", "pytest", "-q"]
    done = subprocess.run(
        [*command, "test_robot.py"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert "1 passed" in done.stdout, done.stdout


class TestMistakesOfAProgram:
    """What a test's author gets wrong is told as it is, and not as what followed of it."""

    def test_an_error_in_an_answer_comes_out_where_the_device_ends(self) -> None:
        def answered(event: Any) -> list[Any]:
            raise ZeroDivisionError("of the test's author")

        it = SimulatedDevice(MATTY, "esp").start()
        it.on("stop", answered)
        with opened(it.port) as port:
            os.write(port, STOP)
            with pytest.raises(ZeroDivisionError, match="author"):
                while True:  # Until the thread of the device has come so far.
                    it.send(it.messages["ack"]())
                    time.sleep(0.005)
        with pytest.raises(ZeroDivisionError, match="author"):
            it.stop()

    @pytest.mark.parametrize("given", [None, [("battery", 1)], 5])
    def test_values_that_are_no_dict_are_a_mistake_of_the_function(self, given: Any) -> None:
        asked = Event()

        def values(name: str, when: float) -> Any:
            asked.set()
            return given

        it = SimulatedDevice(MATTY, "esp", rates={"status": 200}, values=values)
        it.start()
        assert asked.wait(PATIENCE)
        with pytest.raises(ValuesError, match=f"gives {type(given).__name__} for `status`"):
            it.stop()

    @pytest.mark.parametrize(
        ("rates", "problem"),
        [
            ({"statsu": 5}, "esp sends no `statsu`"),
            ({"go": 5}, "esp sends no `go`"),
            ({"status": -1}, "-1 does not say how often `status` is sent"),
            ({"status": "5 Hz"}, "'5 Hz' does not say how often `status` is sent"),
            ({"status": math.nan}, "nan does not say"),
        ],
    )
    def test_a_rate_of_nothing_is_told_at_once(self, rates: Any, problem: str) -> None:
        with pytest.raises(ValuesError, match=re.escape(problem)):
            SimulatedDevice(MATTY, "esp", rates=rates)

    def test_answers_may_be_messages_of_the_generated_module(self) -> None:
        with SimulatedDevice(MATTY, "esp") as it, matty.connect(it.port, "pc") as link:
            it.on("stop", lambda event: [(matty.Nack(), {"counter": event.parts.counter})])
            with pytest.raises(RefusedError):
                link.request(matty.Stop(), timeout=PATIENCE)

    def test_begins_once_more_after_its_end(self) -> None:
        it = SimulatedDevice(MATTY, "esp")
        for _ in range(2):
            with it, matty.connect(it.port, "pc") as link:
                assert link.request(matty.Stop(), timeout=PATIENCE) == matty.Ack()
        it.stop()
        with pytest.raises(PortError, match="has not begun"):
            it.send(it.messages["ack"]())
        with it, pytest.raises(PortError, match="has begun already"):
            it.start()
