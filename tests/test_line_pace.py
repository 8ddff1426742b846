"""The line at 1 Mbaud: nothing is lost, waits for an output, or is lost with a killed process."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from random import Random

import pytest
from cli_support import PATIENCE, ROOT, run
from test_cli_line import line_of

from generated.python import matty
from protogen.recording import records

sys.path.append(str(ROOT / "benchmarks"))

from peers.pacing import Way, carry, device

pytest.importorskip("serialx")
pytestmark = pytest.mark.skipif(os.name != "posix", reason="pseudo-terminals are of POSIX")

MATTY = str(ROOT / "schemas/matty.yaml")
ENDS = ("esp", "pc")


def stream(sender: str, size: int) -> bytes:
    """Frames of random values, some of them damaged, with noise between them."""
    dice = Random(sender)
    found = bytearray()
    number = 0
    while len(found) < size:
        speed, steer = dice.randrange(-500, 500), dice.randrange(-250, 250)
        message = matty.Go(speed=speed, steer=steer) if sender == "pc" else matty.Ack()
        frame = bytearray(matty.encode(message, counter=number & 0xFF))
        if dice.random() < 0.01:
            frame[dice.randrange(len(frame))] ^= 1 << dice.randrange(8)
        if dice.random() < 0.01:
            found += dice.randbytes(dice.randrange(1, 40))
        found += frame
        number += 1
    return bytes(found[:size])


@contextmanager
def tapped(*options: str) -> Iterator[tuple[subprocess.Popen[str], tuple[int, int]]]:
    """A tap that is ready, and our ends of the ports between which it stands."""
    with ExitStack() as stack:
        (one, first), (two, second) = (stack.enter_context(device()) for _ in ENDS)
        args = ("tap", MATTY, f"esp={first}", f"pc={second}", *options)
        process = subprocess.Popen(
            [sys.executable, "-m", "protogen", *args],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=ROOT,
        )
        try:
            assert process.stderr is not None
            assert process.stderr.readline().startswith("passing on /dev/")
            yield process, (one, two)
        finally:
            process.kill()
            process.communicate()


def stopped(process: subprocess.Popen[str]) -> str:
    process.send_signal(signal.SIGINT)
    out, error = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, error
    return out


def recorded(file: Path, complain: Callable[[str], object] = pytest.fail) -> dict[str, bytes]:
    """What each source sent, in a recording that is whole, unless `complain` stands it."""
    found = {name: bytearray() for name in ENDS}
    for record in records([file.read_bytes()], complain):
        found[record.source] += record.data
    return {name: bytes(data) for name, data in found.items()}


def converted(capture: Path, sender: str, folder: Path) -> dict[str, list[dict[str, str]]]:
    """The tables of what a sender sent, without times, which only a recording has."""
    done = run("convert", MATTY, str(capture), "--sender", sender, "--to", "csv", "-o", str(folder))
    assert done.exit_code == 0, done.output
    tables = {}
    for file in folder.rglob("*.csv"):
        with file.open(newline="") as text:
            rows = list(csv.DictReader(text))
        table = file.relative_to(folder)
        tables[str(table).replace(capture.stem, "CAPTURE")] = [
            {k: v for k, v in row.items() if k != "t_ns"} for row in rows
        ]
    return tables


class TestTap:
    def test_both_ways_at_1_megabaud(self, tmp_path: Path) -> None:
        """For one second; `benchmarks/bench_line.py` does so for a minute."""
        file = tmp_path / "run.pgrec"
        sent = {name: stream(name, 100_000) for name in ENDS}
        with tapped("-o", str(file), "--quiet") as (process, (board, program)):
            ways = Way(board, program, sent["esp"]), Way(program, board, sent["pc"])
            carry(ways)
            stopped(process)
        assert [bytes(way.got) for way in ways] == [sent["esp"], sent["pc"]]
        assert recorded(file) == sent
        for name in ENDS:
            raw = tmp_path / f"{name}.bin"
            raw.write_bytes(sent[name])
            tables = converted(file, name, tmp_path / f"{name} recorded")
            assert tables == converted(raw, name, tmp_path / f"{name} raw")
            assert sum(map(len, tables.values())) > 1000

    def test_bytes_do_not_wait_for_who_reads_the_output(self, tmp_path: Path) -> None:
        file = tmp_path / "run.pgrec"
        sent = stream("pc", 100_000) * 25
        with tapped("-o", str(file)) as (process, (board, program)):
            few, much = (Way(program, board, part) for part in (sent[:100], sent[100:]))
            carry([few], rate=0)
            assert line_of(process.stdout).split()[1:3] == ["pc", "go"]
            carry([much], rate=0)
            out = stopped(process)
        assert bytes(few.got + much.got) == sent
        assert recorded(file)["pc"] == sent
        assert "were not shown" in out  # Bytes, lines, or both of them.


FORKS = """
import json, os, sys

import serialx
import protogen.link.ports.opening, protogen.link.tapping, protogen.cli.wire.codec
from protogen.cli import app

for line in sys.stdin:
    process = os.fork()
    if not process:
        app(json.loads(line))
    print(process, flush=True)
    os.waitpid(process, 0)
"""
"""Runs commands as processes that need not import anything any more."""


@pytest.fixture(scope="module")
def forks() -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        [sys.executable, "-c", FORKS],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )
    yield process
    process.kill()
    process.communicate()


def forked(forks: subprocess.Popen[str], *args: str) -> int:
    """Run a command; its process, which has told that it is ready."""
    assert forks.stdin is not None
    assert forks.stdout is not None
    assert forks.stderr is not None
    forks.stdin.write(json.dumps(args) + "\n")
    forks.stdin.flush()
    process = int(forks.stdout.readline())
    assert "Ctrl-C ends it" in forks.stderr.readline()
    return process


def kill(process: int) -> None:
    """End a process as nothing else does, and wait until it has ended."""
    os.kill(process, signal.SIGKILL)
    end = time.monotonic() + PATIENCE
    while Path(f"/proc/{process}").exists() and time.monotonic() < end:
        time.sleep(0.001)


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="processes are looked up in /proc")
def test_a_recording_has_what_came_out_of_a_tap_that_was_killed(
    forks: subprocess.Popen[str], tmp_path: Path
) -> None:
    """At 50 moments, from the first bytes on."""
    dice = Random(1)
    sent = {name: stream(name, 100_000) for name in ENDS}
    sizes = set()
    for number in range(50):
        file = tmp_path / f"{number}.pgrec"
        with device() as (board, first), device() as (program, second):
            ends = f"esp={first}", f"pc={second}"
            process = forked(forks, "tap", MATTY, *ends, "-o", str(file), "--quiet")
            ways = Way(board, program, sent["esp"]), Way(program, board, sent["pc"])
            carry(ways, rate=0, most=dice.randrange(1, 50_000))
            time.sleep(dice.uniform(0, 0.001))
            kill(process)
            for way in ways:
                way.read()
        # The system itself may break off a write; that record had not been passed on.
        torn = list[str]()
        found = recorded(file, torn.append)
        assert all(text.startswith("ends inside") for text in torn)
        for name, way in zip(ENDS, ways, strict=True):
            assert sent[name].startswith(found[name])
            assert found[name].startswith(way.got)
        sizes.add(file.stat().st_size)
        if number % 25 == 0:
            tables = converted(file, "pc", tmp_path / str(number))
            raw = tmp_path / f"{number}.bin"
            raw.write_bytes(found["pc"])
            assert tables == converted(raw, "pc", tmp_path / f"{number} raw")
    assert len(sizes) > 20
