"""Memory of programs on a line that are given an hour of 1 Mbaud.

    python benchmarks/check_line_memory.py [--megabytes N]

Linux only: it reads /proc. The bytes come as fast as they are taken. Writes
benchmarks/line_memory.md. Not part of `make bench`, because it takes minutes.
"""

from __future__ import annotations

import argparse
import asyncio
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks")]

from bench_link import ENDS, MATTY, streams  # noqa: E402
from peers.pacing import MEGABAUD, Way, carry, device  # noqa: E402

OUT = Path(__file__).with_name("line_memory.md")
HOUR = 3600 * MEGABAUD
_PIECE = 10
"""Seconds of the line that are kept, and sent again and again."""


class Program(NamedTuple):
    """A program on one port, or between two."""

    ports: int
    command: tuple[str, ...]
    """With the ports' names behind it."""


def programs(folder: Path) -> dict[str, Program]:
    """The programs by what the table calls them."""
    own = sys.executable, __file__, "--child"
    protogen = sys.executable, "-m", "protogen"
    recorded = "-o", str(folder / "run.pgrec"), "--force"
    return {
        "a program with a link": Program(1, (*own, "link")),
        "one that takes nothing of its stream": Program(1, (*own, "idle")),
        "what `monitor` knows": Program(1, (*own, "session")),
        "`record`": Program(1, (*protogen, "record", str(MATTY), *recorded)),
        "`record --max-size 20`": Program(
            1, (*protogen, "record", str(MATTY), "--max-size", "20", *recorded)
        ),
        "`tap`, which records and shows": Program(2, (*protogen, "tap", str(MATTY), *recorded)),
    }


def resident(process: int) -> int:
    """Bytes of memory that a process has now."""
    text = Path(f"/proc/{process}/status").read_text()
    return int(text.split("VmRSS:")[1].split()[0]) << 10


def measure(program: Program, size: int, sent: Mapping[str, bytes]) -> Iterator[int]:
    """Give a program its bytes; its memory behind a tenth of them, and behind all."""
    with ExitStack() as stack:
        devices = [stack.enter_context(device()) for _ in range(program.ports)]
        names = [f"{end}={name}" for end, (_, name) in zip(ENDS, devices, strict=False)]
        process = stack.enter_context(
            subprocess.Popen(
                [*program.command, *names],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                cwd=ROOT,
            )
        )
        assert process.stderr is not None
        assert b"Ctrl-C ends it" in process.stderr.readline()
        ports = [port for port, _ in devices]
        given = 0
        for goal in (size // 10, size):
            while given < goal:
                exits = ports[::-1] if len(ports) == 2 else [None]
                pairs = zip(ports, exits, ENDS, strict=False)
                carry([Way(one, other, sent[name]) for one, other, name in pairs], rate=0)
                given += len(sent["esp"])
            time.sleep(1)
            yield resident(process.pid)
        process.kill()


# --- programs in Python ---------------------------------------------------------------------------


async def _link(port: str, *, takes: bool) -> None:
    from generated.python import matty
    from protogen.link import connect

    async with connect(matty, port, "pc") as link:
        stream = link.messages(matty.Ack)
        _tell_ready()
        while takes:
            await stream.take()
        await asyncio.Event().wait()


def _session(port: str) -> None:
    from protogen.cli.wire.codec import open_codec
    from protogen.link.ports.settings import settings_of
    from protogen.monitor.session import Session

    codec = open_codec(MATTY)
    session = Session(codec, {"esp": port}, settings_of(codec.protocol.link))
    session.start()
    _tell_ready()
    while not session.is_over:
        time.sleep(1)


def _tell_ready() -> None:
    print("Ctrl-C ends it", file=sys.stderr, flush=True)


CHILDREN: dict[str, Callable[[str], None]] = {
    "link": lambda port: asyncio.run(_link(port, takes=True)),
    "idle": lambda port: asyncio.run(_link(port, takes=False)),
    "session": _session,
}

_HEAD = """# The memory of a line

<!-- Written by benchmarks/check_line_memory.py, do not edit. -->

Made by `python benchmarks/check_line_memory.py --megabytes {megabytes:g}`: MB of memory (VmRSS) of
programs that were given so many megabytes from each end of the line, as fast as they took them, and
MB/s of the clock. An hour of 1 Mbaud is 360 MB.

| | behind a tenth | behind all | MB/s |
| --- | ---: | ---: | ---: |
"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--megabytes", type=float, default=HOUR / 1e6)
    parser.add_argument("--child", nargs=2, metavar=("NAME", "PORT"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        name, port = options.child
        CHILDREN[name](port.partition("=")[2])
        return 0
    sent = streams(_PIECE)
    size = int(options.megabytes * 1e6)
    text = _HEAD.format(megabytes=options.megabytes)
    with TemporaryDirectory() as folder:
        for title, program in programs(Path(folder)).items():
            began = time.monotonic()
            tenth, whole = measure(program, size, sent)
            rate = size / (time.monotonic() - began) / 1e6
            line = f"| {title} | {tenth / 1e6:.0f} | {whole / 1e6:.0f} | {rate:.1f} |"
            print(line, flush=True)
            text += line + "\n"
            for file in Path(folder).iterdir():
                file.unlink()
    OUT.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
