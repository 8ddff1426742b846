"""Speed of one and two workers of a Dask cluster that convert a capture to Parquet.

    python benchmarks/bench_fleet.py [--megabytes N] [--part-size MB] [--rounds N] [--folder DIR]

Needs `cc` and the extra `dask`. Writes benchmarks/fleet.md.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from shutil import rmtree
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
sys.path.insert(0, str(ROOT / "benchmarks"))

from bench_columns import CASES, Case, frames, write_page  # noqa: E402
from bench_convert import DIFFERENT, add_folder, kind_of  # noqa: E402

import protogen  # noqa: E402
from protogen.convert.formats import OutputFormat  # noqa: E402
from protogen.convert.runs.conversion import Fleet, Job, plan  # noqa: E402

OUT = Path(__file__).with_name("fleet.md")
NUMBERS = (1, 2)
"""Of workers."""
SHOWN = ("read_motor", "status")
"""Messages whose frames are neither the smallest nor the largest."""


@dataclass(frozen=True)
class Found:
    """One conversion: seconds on the clock, and of the processor in all workers."""

    clock: float
    processor: float


def converted(case: Case, capture: Path, client: Any, part_size: int, folder: Path) -> Found:
    """Have the workers of a cluster convert a capture into a new folder."""
    from protogen.convert.runs.fleet import convert_fleet

    protocol = protogen.load(ROOT / case.schema)
    runtime = protogen.module_of(protocol).PROTOCOL
    sender = protocol.sender(case.sender)
    job = Job(protocol, runtime, sender, OutputFormat.PARQUET, folder, force=True)
    fleet = Fleet(client.scheduler.address, None, part_size)
    named = plan(job, [str(capture)])
    before, start = _processor(client), time.monotonic()
    (result,) = convert_fleet(job, named, fleet, print, lambda count: None)
    found = Found(time.monotonic() - start, _processor(client) - before)
    assert list(result.done.tally.messages) == [case.message], result.done.tally
    rmtree(folder)
    return found


def _processor(client: Any) -> float:
    return float(sum(client.run(time.process_time).values()))


def measure(
    case: Case, clients: dict[int, Any], size: int, part_size: int, rounds: int, folder: Path
) -> str:
    """A row of the table."""
    protocol = protogen.load(ROOT / case.schema)
    some = b"".join(frames(protocol, case, DIFFERENT))
    capture = folder / "capture.bin"
    capture.write_bytes(some * max(1, size // len(some)))
    total = capture.stat().st_size
    each: dict[int, list[Found]] = {number: [] for number in NUMBERS}
    for turn in range(rounds + 1):
        for number, found in each.items():
            found.append(converted(case, capture, clients[number], part_size, folder / "out"))
            if not turn:
                found.clear()  # What is imported and compiled, is.
    one, two = (each[number] for number in NUMBERS)
    cells = [case.name]
    cells += [f"{total / median(it.clock for it in found) / 1e6:,.0f}" for found in (one, two)]
    pairs = list(zip(one, two, strict=True))
    on_clock = median(first.clock / second.clock for first, second in pairs)
    allowed = median(2 * first.processor / second.processor for first, second in pairs)
    cells.append(f"{on_clock:.2f} ({allowed:.2f})")
    cells.append(f"{total / median(it.processor for it in one) / 1e6:,.0f}")
    return "| " + " | ".join(cells) + " |"


_HEAD = """# What a fleet converts

<!-- Written by benchmarks/bench_fleet.py, do not edit. -->

Made by `python benchmarks/bench_fleet.py --megabytes {megabytes} --part-size {part_size}
--rounds {rounds}` with Python {python}, {cores} cores, files in {folder}.

`protogen convert --dask` of clean captures of frames of random values to Parquet, each
{megabytes} MB in parts of {part_size} MB, by one and by two workers of a local cluster that runs
already: MB of the line for each second on the clock, medians of {rounds} rounds in which both have
their turn. Two workers share the cores with the scheduler, with the command, and with whatever else
the machine does; so in brackets stands how many times as fast the workers' processor time lets them
be where each has a core of its own. The last column is one worker's MB for each second of its
processor, which is what [the page on conversions](convert.md) has of the command by itself.

| | 1 worker | 2 workers | ratio | 1 worker, processor |
| --- | ---: | ---: | ---: | ---: |
"""


def _rows(options: argparse.Namespace, folder: Path) -> Iterator[str]:
    import distributed

    from protogen.convert.runs.fleet import LOCAL_CLUSTER

    size, part_size = options.megabytes * 1_000_000, options.part_size * 1_000_000
    with ExitStack() as opened:
        clients = {}
        for number in NUMBERS:
            cluster = opened.enter_context(
                distributed.LocalCluster(n_workers=number, **LOCAL_CLUSTER)
            )
            clients[number] = opened.enter_context(
                distributed.Client(cluster, set_as_default=False)
            )
        for case in CASES:
            if case.message in SHOWN:
                yield measure(case, clients, size, part_size, options.rounds, folder)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--megabytes", type=int, default=256)
    parser.add_argument("--part-size", type=int, default=16, metavar="MB")
    parser.add_argument("--rounds", type=int, default=5)
    add_folder(parser)
    options = parser.parse_args()
    with TemporaryDirectory(dir=options.folder) as folder:
        head = _HEAD.format(
            megabytes=options.megabytes,
            part_size=options.part_size,
            rounds=options.rounds,
            python=platform.python_version(),
            cores=os.cpu_count(),
            folder=kind_of(options.folder),
        )
        write_page(OUT, head, _rows(options, Path(folder)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
