"""What a live line costs at 1 Mbaud: processor, latency, and what a tap adds to it.

    python benchmarks/bench_link.py [--seconds N] [--tap SECONDS] [--rounds N]

Needs pseudo-terminals and the extras `serial` and `bench`. Writes benchmarks/link.md. The tap's
recording is compared with what was sent, byte by byte, and so is what `convert` makes of it.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import signal
import subprocess
import sys
import tty
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from itertools import accumulate
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks")]

from peers.line_programs import PROGRAMS  # noqa: E402
from peers.line_streams import frames_of  # noqa: E402
from peers.pacing import MEGABAUD, Way, carry, delays, device  # noqa: E402

from protogen.recording import records  # noqa: E402
from protogen.version import VERSION  # noqa: E402

OUT = Path(__file__).with_name("link.md")
MATTY = ROOT / "schemas" / "matty.yaml"
ENDS = ("esp", "pc")


class Found(NamedTuple):
    """What a program was measured to take."""

    messages: int
    busy: float
    """Share of a core while bytes come."""
    idle: float
    """Share of a core while none do."""
    delays: list[float]
    """Milliseconds from a frame's last byte to its message."""


# --- programs that take messages ------------------------------------------------------------------


def measure(name: str, seconds: float) -> Found:
    """Have a program take messages at 1 Mbaud for so many seconds."""
    frames = frames_of(name.split(",", maxsplit=1)[0], int(seconds * MEGABAUD))
    ends = [*accumulate(map(len, frames))]
    program = Path(__file__).parent / "peers" / "line_programs.py"
    with device() as (own, port):
        command = [sys.executable, str(program), name, port, str(len(frames))]
        environment = {**os.environ, "MAVLINK20": "1"}
        with subprocess.Popen(command, stdout=subprocess.PIPE, env=environment) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == b"ready\n"
            way = Way(own, None, b"".join(frames))
            carry([way])
            found: dict[str, Any] = json.loads(process.stdout.readline())
    came = [*zip(ends, found["times"], strict=True)]
    return Found(len(frames), found["busy"], found["idle"], delays(way.written, came))


def programs(seconds: float, rounds: int) -> Iterator[str]:
    """Rows of the table: medians of rounds in which each program has its turn."""
    each: dict[str, list[Found]] = {name: [] for name in PROGRAMS}
    for _ in range(rounds):
        for name, found in each.items():
            found.append(measure(name, seconds))
            print(f"{name}: {found[-1].busy:.1%}", file=sys.stderr, flush=True)
    for name, runs in each.items():
        line, program = name.split(", ", 1)
        rate = runs[0].messages / seconds
        late = median(shares(run.delays)[1] for run in runs)
        cells = [
            f"{median(run.busy for run in runs):.1%} ({min(run.busy for run in runs):.1%})",
            f"{median(run.idle for run in runs):.2%}",
            f"{median(shares(run.delays)[0] for run in runs):.2f}",
            f"{late:.2f}",
        ]
        yield f"| {line} | {program} | {rate:,.0f} | {' | '.join(cells)} |"


def shares(found: Sequence[float]) -> tuple[float, float, float]:
    """Median, 99th percentile and greatest."""
    ordered = sorted(found)
    return median(ordered), ordered[int(0.99 * (len(ordered) - 1))], ordered[-1]


# --- the tap --------------------------------------------------------------------------------------


def streams(seconds: float) -> dict[str, bytes]:
    """What both ends of the line send."""
    from random import Random

    from generated.python import matty

    found = {}
    for sender in ENDS:
        dice = Random(sender)
        frames = bytearray()
        for number in range(256 * 20):
            speed, steer = dice.randrange(-500, 500), dice.randrange(-250, 250)
            message = matty.Go(speed=speed, steer=steer) if sender == "pc" else matty.Ack()
            frames += matty.encode(message, counter=number & 0xFF)
        size = int(seconds * MEGABAUD)
        found[sender] = bytes(frames * (size // len(frames) + 1))[:size]
    return found


def passed(one: int, other: int, sent: dict[str, bytes]) -> list[float]:
    """Latencies of both ways between two ports, behind which the bytes are the same."""
    ways = [Way(one, other, sent["esp"]), Way(other, one, sent["pc"])]
    carry(ways)
    assert all(way.got == way.data for way in ways), "bytes were lost"
    return [delay for way in ways for delay in way.latencies()]


def plain(seconds: float) -> list[float]:
    """Latencies of a pseudo-terminal with nobody in the middle."""
    own, other = os.openpty()
    tty.setraw(other)
    try:
        return passed(own, other, streams(seconds))
    finally:
        os.close(own)
        os.close(other)


class Tapped(NamedTuple):
    """What a tap did."""

    delays: list[float]
    busy: float
    said: str


def tapped(seconds: float, *options: str) -> Tapped:
    """Pass bytes through a tap that records, and compare what it recorded."""
    sent = streams(seconds)
    with TemporaryDirectory() as folder, device() as one, device() as two:
        file = Path(folder) / "run.pgrec"
        ends = f"esp={one[1]}", f"pc={two[1]}"
        command = [sys.executable, "-m", "protogen", "tap", str(MATTY), *ends, "-o", str(file)]
        with subprocess.Popen(
            [*command, *options],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            cwd=ROOT,
        ) as process:
            assert process.stderr is not None
            process.stderr.readline()
            before = processor(process.pid)
            found = passed(one[0], two[0], sent)
            busy = (processor(process.pid) - before) / seconds
            process.send_signal(signal.SIGINT)
            said = process.stderr.read().strip()
        compare(file, sent, Path(folder))
    return Tapped(found, busy, said)


def processor(process: int) -> float:
    """Seconds of the processor that a process took so far."""
    ticks = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(ticks[11]) + int(ticks[12])) / os.sysconf("SC_CLK_TCK")


def compare(file: Path, sent: dict[str, bytes], folder: Path) -> None:
    """Raise AssertionError unless a recording has what was sent, also for `convert`."""
    found = {name: bytearray() for name in sent}
    complaints: list[str] = []
    for record in records([file.read_bytes()], complaints.append):
        found[record.source] += record.data
    assert not complaints, complaints
    assert found == sent, "the recording has other bytes"
    for name, data in sent.items():
        raw = folder / f"{name}.bin"
        raw.write_bytes(data)
        assert tables(file, name, folder) == tables(raw, name, folder), "convert has other tables"


def tables(capture: Path, sender: str, folder: Path) -> dict[str, Any]:
    """The columns of all tables that `convert` makes, without times."""
    from pyarrow import parquet

    made = folder / f"{capture.stem} {sender}"
    command = [sys.executable, "-m", "protogen", "convert", str(MATTY), str(capture), "--quiet"]
    command += ["--sender", sender, "--to", "parquet", "-o", str(made)]
    subprocess.run(command, check=True, cwd=ROOT)
    found = {}
    for file in made.rglob("*.parquet"):
        table = parquet.read_table(file)
        name = str(file.relative_to(made)).replace(capture.stem, "CAPTURE")
        found[name] = [table[column] for column in table.column_names if column != "t_ns"]
    return found


def taps(seconds: float) -> Iterator[str]:
    """Rows of the table: latencies, of which those of a plain line are taken off."""
    without = shares(plain(min(seconds, 10)))
    yield f"| nobody in the middle | - | {' | '.join(f'{item:.2f}' for item in without)} | - |"
    for title, options in (("records", ["--quiet"]), ("records and shows", [])):
        found = tapped(seconds, *options)
        print(f"{title}: {found.busy:.1%}; {found.said}", file=sys.stderr, flush=True)
        own = shares(found.delays)
        cells = [f"{item:.2f}" for item in own]
        added = own[0] - without[0], own[1] - without[1]
        more = f"{added[0]:.2f} and {added[1]:.2f}"
        yield f"| {title} | {found.busy:.1%} | {' | '.join(cells)} | {more} |"


_TEXT = """# What a live line costs

<!-- Written by benchmarks/bench_link.py, do not edit. -->

Made by `python benchmarks/bench_link.py --seconds {seconds:g} --tap {tap:g} --rounds {rounds}` with
protogen {version}, Python {python}, serialx {serialx}, pyserial {pyserial}, pymavlink {pymavlink},
sbp {sbp}, on {cpus} CPUs.

A writer puts the bytes of 1 Mbaud (100,000 a second) into a pseudo-terminal each millisecond, as a
fast adapter does. Each program has a process of its own. *Busy* is its time of the processor, of a
core, from the first message to the last one, median and in brackets the best of the rounds; *idle*
is that of a silent line behind it. *Latency* is the time from the write of a frame's last byte
until the program has the message, in ms. The aim: at most 15 % of a core. On a fast line that is
busy, protogen leaves bytes to gather for up to 5 ms, as each portion costs; behind a portion of
less than 64 bytes it takes them at once.

## Programs that take messages

protogen's are `async for message in link.messages(...)`; without async,
`for message in link.messages(...)`. The loop by hand waits for a byte by pyserial, takes what has
come with it, and decodes with code that an expert wrote for this one protocol. pymavlink is used by
`recv_match`, libsbp by a callback of its `Handler`.

| line | program | messages/s | busy | idle | latency, median | latency, 99 % |
| --- | --- | ---: | ---: | ---: | ---: | ---: |
"""
_TAP = """
## `protogen tap`

1 Mbaud both ways for {tap:g} s. The recording had the bytes of both ends, none more and none less,
and `convert` made of it what it makes of what was sent. Latencies are those from write to read,
in ms; *added* is what is more of it than with nobody in the middle, median and 99 %.

| | busy | median | 99 % | greatest | added |
| --- | ---: | ---: | ---: | ---: | ---: |
"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=10, help="of each program's turn")
    parser.add_argument("--tap", type=float, default=60, help="seconds of each tap")
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    given = {"seconds": options.seconds, "tap": options.tap, "rounds": options.rounds}
    packages = {name: version(name) for name in ("serialx", "pyserial", "pymavlink", "sbp")}
    machine = {"version": VERSION, "python": platform.python_version(), "cpus": os.cpu_count()}
    text = _TEXT.format(**given, **packages, **machine)
    text += "".join(f"{row}\n" for row in programs(options.seconds, options.rounds))
    text += _TAP.format(tap=options.tap)
    text += "".join(f"{row}\n" for row in taps(options.tap))
    OUT.write_text(text, encoding="utf-8")
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
