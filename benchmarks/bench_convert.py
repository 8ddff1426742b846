"""Speed of `protogen convert`: bytes of the line for each second of one core, by format.

    python benchmarks/bench_convert.py [--megabytes N] [--rounds N] [--folder DIR]

Needs `cc`, NumPy, pyarrow and mcap. Writes benchmarks/convert.md.
"""

from __future__ import annotations

import argparse
import platform
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from shutil import rmtree
from statistics import median
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
sys.path.insert(0, str(ROOT / "benchmarks"))

from bench_columns import CASES, Case, frames, write_page  # noqa: E402

import protogen  # noqa: E402
from protogen.convert.formats import OutputFormat  # noqa: E402
from protogen.convert.runs.conversion import Job, convert, plan  # noqa: E402

OUT = Path(__file__).with_name("convert.md")
FORMATS = (
    OutputFormat.PARQUET,
    OutputFormat.ARROW,
    OutputFormat.JSONL,
    OutputFormat.CSV,
    OutputFormat.MCAP,
    OutputFormat.MCAP_ROS2,
)
MEMORY = "/dev/shm"
"""A folder in memory, so that what the disk does meanwhile is not in the figures."""
LEAST = {OutputFormat.PARQUET: 100, OutputFormat.JSONL: 20, OutputFormat.MCAP_ROS2: 50}
"""MB/s that the project wants."""
DIFFERENT = 20_000
"""Frames that are repeated: so many that Snappy, which looks back 64 KB, does not see it."""


@dataclass(frozen=True)
class Found:
    """One conversion."""

    processor: float
    """Seconds of the processor, of the program and of the system for it."""
    written: int
    """Bytes of the files."""


def converted(case: Case, capture: Path, format: OutputFormat, folder: Path) -> Found:
    """Convert a capture from the beginning into a new folder, as the command does."""
    protocol = protogen.load(ROOT / case.schema)
    runtime = protogen.module_of(protocol).PROTOCOL
    sender = protocol.sender(case.sender)
    job = Job(protocol, runtime, sender, format, folder, force=True)
    before = time.process_time()
    (result,) = convert(job, plan(job, [str(capture)]), print, lambda count: None)
    taken = time.process_time() - before
    assert list(result.done.tally.messages) == [case.message], result.done.tally
    written = sum((folder / file).stat().st_size for file in result.done.files)
    rmtree(folder)  # To write over it would count what it takes to forget it.
    return Found(taken, written)


def measure(case: Case, size: int, rounds: int, folder: Path) -> str:
    """A row of the table."""
    protocol = protogen.load(ROOT / case.schema)
    some = b"".join(frames(protocol, case, DIFFERENT // (6 if case.message == "lidar" else 1)))
    capture = folder / "capture.bin"
    capture.write_bytes(some * max(1, size // len(some)))
    total = capture.stat().st_size
    converted(case, capture, OutputFormat.PARQUET, folder / "out")  # What is imported, is.
    each: dict[OutputFormat, list[Found]] = {format: [] for format in FORMATS}
    for _ in range(rounds):
        for format, found in each.items():
            found.append(converted(case, capture, format, folder / "out"))
    cells = [case.name]
    for found in each.values():
        rate = total / median(item.processor for item in found) / 1e6
        best = total / min(item.processor for item in found) / 1e6
        cells.append(f"{rate:,.0f} ({best:,.0f}; {found[0].written / total:.1f} x)")
    return "| " + " | ".join(cells) + " |"


_HEAD = """# What conversions cost

<!-- Written by benchmarks/bench_convert.py, do not edit. -->

Made by `python benchmarks/bench_convert.py --megabytes {megabytes} --rounds {rounds}` with Python
{python}, files in {folder}.

`protogen convert` of clean captures of frames of random values, each {megabytes} MB: MB of the line
for each second of the processor (the program's and the system's for it), medians of {rounds} rounds
in which every format has its turn; in brackets the best of the rounds, and how many times the
capture's size the files have. What else the machine does costs time of the processor, too, because
caches, and on a virtual machine the processor itself, are shared: the more medians and best ones
differ, the busier it was. The targets are {targets}.

| | {formats} |
| --- | {rulers} |
"""


def add_folder(parser: argparse.ArgumentParser) -> None:
    """Let the folder be chosen in which files are written."""
    parser.add_argument(
        "--folder",
        default=MEMORY if Path(MEMORY).is_dir() else None,
        help="where captures and results are for the time being; memory, where there is such",
    )


def kind_of(folder: str | None) -> str:
    """Description of such a folder, in words."""
    return "memory" if folder == MEMORY else "a disk's folder"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--megabytes", type=int, default=64)
    parser.add_argument("--rounds", type=int, default=5)
    add_folder(parser)
    options = parser.parse_args()
    with TemporaryDirectory(dir=options.folder) as folder:
        head = _HEAD.format(
            megabytes=options.megabytes,
            rounds=options.rounds,
            python=platform.python_version(),
            folder=kind_of(options.folder),
            targets=", ".join(f"{least} MB/s for {format}" for format, least in LEAST.items()),
            formats=" | ".join(FORMATS),
            rulers=" | ".join("---:" for _ in FORMATS),
        )
        size = options.megabytes << 20
        rows = (measure(case, size, options.rounds, Path(folder)) for case in CASES)
        write_page(OUT, head, rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
