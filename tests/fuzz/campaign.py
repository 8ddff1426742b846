"""A long run of the fuzzers, which goes on where the last one stopped.

    .venv/bin/python tests/fuzz/campaign.py --inputs 90000000

gives that many inputs in all to the decoders of the documents, of their dialects, and of a schema
of each way in which frames begin, end and are stuffed. Rounds of short inputs and of some long ones
go over all of them, so that it may be stopped at any time. What was reached stays in `.cache/fuzz`,
and how many inputs there were in `tallies.jsonl` there. `--keep` puts the least of it that reaches
as much into `tests/fuzz/corpus`, where all runs begin. It ends with a table of what was done.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path
from shutil import rmtree
from time import monotonic

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from compiled import DIALECTS, DOCUMENTS, ROOT, covering, protocol_of

from fuzz.corpora import pack
from fuzz.harness import Fuzzer, build, executions, tell
from protogen.targets.c.options import EVENTS, Events

WORK = ROOT / ".cache" / "fuzz"
QUICK = "-fno-sanitize-coverage=trace-cmp"
"""Comparisons are not watched: thrice as many inputs in the same time reach the same branches."""
SHORT = 96
"""Bytes of an input: several of the smallest frames."""
SHORT_ROUND, LONG_ROUND = 225_000, 25_000
MORE = 4
"""Times as many for documents."""


@dataclass(frozen=True)
class Target:
    """The decoders of a schema, of one kind."""

    path: Path
    events: Events

    @property
    def name(self) -> str:
        """A name of its own."""
        return f"{self.path.stem}-{self.events}"

    @property
    def folder(self) -> Path:
        """Where its program and its corpus lie."""
        return WORK / self.name

    def fuzzer(self) -> Fuzzer:
        """The program, compiled anew, with its corpus of before."""
        rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        protocol = protocol_of(self.path)
        vectors = f"-D{protocol.name.upper()}_SSE2=1"
        return build(protocol, self.path, self.folder, QUICK, vectors, events=self.events)


@dataclass(frozen=True)
class Tally:
    """What one round has done."""

    target: str
    inputs: int
    seconds: float


def targets() -> list[Target]:
    """The decoders that a campaign goes over."""
    paths = [*DOCUMENTS, *DIALECTS]
    paths += sorted(covering() - {*paths})
    return [Target(path, events) for path in paths for events in EVENTS]


def rounds(inputs: int, log: Path) -> Iterator[Tally]:
    """Run until so many inputs were tried since the log was begun."""
    fuzzers: dict[Target, Fuzzer] = {}
    done = sum(tally.inputs for tally in read_tallies(log))
    for target in cycle(targets()):
        if done >= inputs:
            return
        if target not in fuzzers:
            fuzzers[target] = target.fuzzer()
        before, tried, fuzzer = monotonic(), 0, fuzzers[target]
        times = MORE if target.path in DOCUMENTS else 1
        for longest, share in ((fuzzer.longest, LONG_ROUND), (SHORT, SHORT_ROUND)):
            seed = 1 + (done + tried) % (1 << 31)
            limits = (f"-runs={share * times}", f"-max_len={longest}", f"-seed={seed}")
            tried += executions(fuzzer.run(*limits, "-reload=0", "-detect_leaks=0"))
        done += tried
        yield Tally(target.name, tried, monotonic() - before)


def read_tallies(log: Path) -> list[Tally]:
    """What earlier rounds have done."""
    lines = log.read_text(encoding="utf-8").splitlines() if log.exists() else []
    return [Tally(**json.loads(line)) for line in lines]


def keep() -> None:
    """Put the least inputs that reach all that was reached into the tests' corpus."""
    by_path: dict[Path, list[Target]] = {}
    for target in targets():
        if (target.folder / "fuzzer").exists():
            by_path.setdefault(target.path, []).append(target)
    for path, kinds in by_path.items():
        kept = WORK / f"{path.stem}-kept"
        rmtree(kept, ignore_errors=True)
        kept.mkdir(parents=True)
        corpora = [str(kind.folder / "corpus") for kind in kinds]
        for kind in kinds:
            merge = ["-merge=1", "-use_counters=0", "-max_len=4096", str(kept), *corpora]
            subprocess.run([str(kind.folder / "fuzzer"), *merge], check=True, capture_output=True)
        pack(kept, path)


def print_table(tallies: list[Tally]) -> None:
    """Inputs and seconds of each target, in all rounds."""
    tell("| decoders | inputs | seconds |")
    tell("| --- | ---: | ---: |")
    for name in dict.fromkeys(tally.target for tally in tallies):
        own = [tally for tally in tallies if tally.target == name]
        seconds = sum(tally.seconds for tally in own)
        tell(f"| {name} | {sum(tally.inputs for tally in own):,} | {seconds:.0f} |")
    tell(f"| all | {sum(tally.inputs for tally in tallies):,} | |")


def main() -> None:
    """Go on with the campaign."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--inputs", type=int, default=0, help="of this campaign, in all")
    parser.add_argument("--keep", action="store_true")
    given = parser.parse_args()
    log = WORK / "tallies.jsonl"
    WORK.mkdir(parents=True, exist_ok=True)
    os.environ.setdefault("ASAN_OPTIONS", "quarantine_size_mb=1:malloc_context_size=0")
    for tally in rounds(given.inputs, log) if given.inputs else ():
        with log.open("a", encoding="utf-8") as file:
            file.write(json.dumps(vars(tally)) + "\n")
    if given.keep:
        keep()
    print_table(read_tallies(log))


if __name__ == "__main__":
    main()
