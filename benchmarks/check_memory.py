"""Memory that `protogen convert` needs at most for a capture of 10 GB.

    python benchmarks/check_memory.py [--gigabytes N] [--others N] [--folder DIR]

Linux only: it reads /proc. The capture is piped to standard input and never stands on the disk; the
results do, one at a time, in a folder that is removed. Writes benchmarks/memory.md. Not part of
`make bench`, because it takes minutes.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
sys.path.insert(0, str(ROOT / "benchmarks"))

from bench_columns import CASES, frames  # noqa: E402

import protogen  # noqa: E402

OUT = Path(__file__).with_name("memory.md")
SCHEMA = "benchmarks/c/atrv.yaml"
PIECE = 32 << 20
"""About so many bytes of different frames, which are repeated."""


@dataclass(frozen=True)
class Found:
    """Costs of a conversion."""

    bytes: int
    written: int
    seconds: float
    processor: float
    peak: int
    """Most bytes of memory at a time."""


def capture() -> bytes:
    """Frames of two messages, some of them damaged, and noise."""
    protocol, dice = protogen.load(ROOT / SCHEMA), Random(1)
    cases = [case for case in CASES if case.schema == SCHEMA]
    whole = [frame for case in cases for frame in frames(protocol, case, 2000)]
    found = bytearray()
    while len(found) < PIECE:
        frame = bytearray(dice.choice(whole))
        if dice.random() < 0.01:
            frame[dice.randrange(len(frame))] ^= 1 << dice.randrange(8)
        found += frame
        if dice.random() < 0.01:
            found += dice.randbytes(dice.randrange(1, 40))
    return bytes(found)


def measure(piece: bytes, size: int, format: str, folder: Path) -> Found:
    """Convert about `size` bytes in a process of its own."""
    command = [sys.executable, "-m", "protogen", "convert", SCHEMA, "-", "--sender", "flex"]
    command += ["--input", "raw", "--to", format, "--output", str(folder), "--force", "--quiet"]
    started, given = time.monotonic(), 0
    peak, processor = 0, 0.0
    with subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE) as process:
        assert process.stdin is not None
        while given < size:
            process.stdin.write(piece)
            given += len(piece)
            peak, processor = status(process.pid)
        process.stdin.close()
        while process.poll() is None:
            try:
                peak, processor = status(process.pid)
            except (OSError, ValueError, IndexError):
                break  # It is about to end.
            time.sleep(0.05)
    assert process.returncode == 0
    written = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    return Found(given, written, time.monotonic() - started, processor, peak)


def status(process: int) -> tuple[int, float]:
    """The most memory that a process had so far, and the seconds of the processor it took."""
    text = Path(f"/proc/{process}/status").read_text()
    ticks = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return int(text.split("VmHWM:")[1].split()[0]) << 10, (int(ticks[11]) + int(ticks[12])) / 100


_HEAD = """# The memory of conversions

<!-- Written by benchmarks/check_memory.py, do not edit. -->

Made by `python benchmarks/check_memory.py --gigabytes {gigabytes:g} --others {others:g}`.

`protogen convert` of a capture that comes through a pipe: read-motor and sonar frames of an
ATRV-Jr's rFLEX, 1 % of them damaged, and noise. Memory is the most that the process had at a time
(VmHWM); the target is 300 MB for a capture of 10 GB. Other processes of the machine disturb the
seconds on the clock.

| | GB of the line | GB written | most memory, MB | MB/s on the clock | MB/s of the processor |
| --- | ---: | ---: | ---: | ---: | ---: |
"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--gigabytes", type=float, default=10, help="converted to Parquet")
    parser.add_argument("--others", type=float, default=2, help="converted to the other formats")
    parser.add_argument("--folder", help="where the results are for the time being")
    options = parser.parse_args()
    piece = capture()
    text = _HEAD.format(gigabytes=options.gigabytes, others=options.others)
    for format in ("parquet", "arrow", "jsonl"):
        size = options.gigabytes if format == "parquet" else options.others
        with TemporaryDirectory(dir=options.folder) as folder:
            it = measure(piece, int(size * 1e9), format, Path(folder))
        rate, processor = it.bytes / it.seconds / 1e6, it.bytes / it.processor / 1e6
        sizes = f"{it.bytes / 1e9:.1f} | {it.written / 1e9:.1f}"
        line = f"| {format} | {sizes} | {it.peak / 1e6:.0f} | {rate:.0f} | {processor:.0f} |"
        print(line, flush=True)
        text += line + "\n"
    OUT.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
