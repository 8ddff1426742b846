"""Simulated devices: what they send is what the schema says, and they answer."""

from __future__ import annotations

import math
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from cli_support import ROOT, run
from test_cli_line import line_of, opened, read, started

from generated.python import matty
from protogen.link.damage import DamageRates
from protogen.link.device import SimulatedDevice
from protogen.recording import Recorder

pytest.importorskip("serialx")
pytestmark = pytest.mark.skipif(os.name != "posix", reason="pseudo-terminals are of POSIX")

MATTY = str(ROOT / "schemas/matty.yaml")
STOP = bytes.fromhex("55 02 01 53 AA")  # with counter 1
ACK = bytes.fromhex("55 02 01 41 BC")  # with counter 1


def events_of(port: int, seconds: float) -> list[Any]:
    """What comes within so many seconds."""
    decoder, found, end = matty.Decoder("esp"), [], time.monotonic() + seconds
    os.set_blocking(port, False)
    while time.monotonic() < end:
        try:
            found += decoder.feed(os.read(port, 4096))
        except BlockingIOError:
            time.sleep(0.002)
    return found


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
        with device(MATTY, "esp", rates={"status": 100}) as (it, port):
            found = events_of(port, 1.0)
        messages = [event.message for event in found if event.kind == "message"]
        assert {type(message) for message in messages} == {matty.Status}
        assert 80 <= len(messages) <= 101
        assert it.counts.sent["status"] >= len(messages)

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

    def test_sends_when_it_is_told(self) -> None:
        with device(MATTY, "esp") as (it, port):
            it.send(it.messages["ack"](), counter=1)
            assert read(port, 5) == ACK

    def test_values_are_a_function_of_the_time(self) -> None:
        def values(message: str, seconds: float) -> dict[str, int]:
            assert message == "status"
            return {"voltage": round(7000 + 100 * math.sin(seconds))}

        with device(MATTY, "esp", rates={"status": 100}, values=values) as (_, port):
            found = [event.message for event in events_of(port, 0.5)]
        assert len({message.voltage for message in found}) > 3
        assert all(7000 <= message.voltage <= 7100 for message in found)

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
            with socket.create_connection((host, int(number)), timeout=20) as client:
                decoder = matty.Decoder("pc")
                found: list[Any] = []
                while len(found) < 5:
                    found += decoder.feed(client.recv(100))
        assert all(event.kind == "message" for event in found)


class TestCommand:
    def test_is_soon_there_and_prints_its_port(self) -> None:
        run("check", MATTY)  # What is compiled is kept.
        options = ("--endpoint", "esp", "--rate", "status=100", "--values", "random", "--seed", "3")
        with simulating(*options) as (it, port):
            found = events_of(port, 0.5)
            it.send_signal(signal.SIGINT)
            _, error = it.communicate(timeout=20)
        assert it.returncode == 0
        assert re.search(r"sent \d+ status", error)
        voltages = {event.message.voltage for event in found}
        assert len(voltages) > 10

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
        assert counters == list(range(counters[0], counters[0] + 30))

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
            (("--endpoint", "esp", "--rate", "status=0"), "does not say how often status is sent"),
            (("--endpoint", "esp", "--pty", "--listen", ":1"), "exclude each other"),
            (("--endpoint", "esp", "--values", "no.pgrec"), "no.pgrec: No such file"),
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
