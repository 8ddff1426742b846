"""Compares native columns with those of the Python decoder's events on a seeded corpus.

Run: python benchmarks/check_columns.py --megabytes 100

Every sender of every schema, dialect and framing has its share: clean, noisy and adversarial
streams, decoded by one core, in pieces and in parts of many sizes. Ends with 1 at the first
difference; else writes benchmarks/equality.md, from 100 MB on.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from random import Random

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

PAGE = Path(__file__).with_name("equality.md")
LEAST = 100_000_000
"""Bytes of a run that the page tells of."""
PIECE = 1 << 18
"""Bytes of a stream."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--megabytes", type=float, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=1)
    options = parser.parse_args()
    jobs = list(shares(int(options.megabytes * 1e6), options.seed))
    started, done, events = time.monotonic(), 0, 0
    with ProcessPoolExecutor(options.processes) as pool:
        for size, count in pool.map(compare, *zip(*jobs, strict=True)):
            done, events = done + size, events + count
            rate = done / (time.monotonic() - started) / 1e6
            print(f"\r{done / 1e6:.1f} MB, {events} events alike, {rate:.2f} MB/s", end="")
    print()
    record(__file__, "native columns and Python's", options, done, events)
    return 0


_HEAD = """# Equality of the engines

<!-- Written by benchmarks/check_engines.py and check_columns.py, do not edit. -->

The last runs to their end. Each stream is clean, noisy or adversarial, of one of all senders of all
schemas, dialects and samples of framings, and is read at once and in portions. A run ends at the
first difference, and is not recorded then.

| engines | made by | MB of the line | events, all alike |
| --- | --- | ---: | ---: |
"""


def record(script: str, engines: str, options: argparse.Namespace, size: int, events: int) -> None:
    """Write on the page what a large run has seen. The other script's row stays."""
    if size < LEAST:
        return
    name = Path(script).name
    command = f"`python benchmarks/{name} --megabytes {options.megabytes:g} --seed {options.seed}`"
    rows = PAGE.read_text(encoding="utf-8").splitlines(True) if PAGE.exists() else []
    others = [row for row in rows if row.startswith("| ") and "`python " in row and name not in row]
    row = f"| {engines} | {command} | {size / 1e6:.1f} | {events:,} |\n"
    PAGE.write_text(_HEAD + "".join(sorted([*others, row])), encoding="utf-8")


def shares(size: int, seed: int) -> Iterator[tuple[Path, str, str]]:
    """Schema, sender and seed of each stream."""
    from compiled import SCHEMAS, protocol_of

    samplers = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))
    senders = [(p, s.name) for p in (*SCHEMAS, *samplers) for s in protocol_of(p).senders]
    for number in range(-(-size // PIECE)):
        path, sender = senders[number % len(senders)]
        yield path, sender, f"{seed} {number // len(senders)}"


def compare(path: Path, sender: str, seed: str) -> tuple[int, int]:
    """Bytes and events of a stream whose tables are the same. AssertionError where they differ."""
    from capture_support import assert_same_tables
    from compiled import protocol_of

    from protogen.capture import columns
    from protogen.capture.gather import Gathering, gathered
    from protogen.capture.native import NativeEngine, library_of
    from protogen.capture.parallel import Parts

    protocol = protocol_of(path)
    dice = Random(f"{path.stem} {sender} {seed}")
    data = stream(path, sender, dice)
    expected = columns(data, protocol, sender, engine="python")
    assert_same_tables(columns(data, protocol, sender, engine="native"), expected)
    library = library_of(protocol, protocol.sender(sender))
    in_place = Gathering(len(data))
    decoder = NativeEngine(library, memory=in_place)
    size = dice.choice([5000, 20_000, 50_000])
    for start in range(0, len(data), size):
        for found in decoder.feed(data[start : start + size]):
            in_place.add(found)
    for found in decoder.flush():
        in_place.add(found)
    assert_same_tables(in_place.tables, expected)
    engines = [NativeEngine(library) for _ in range(4)]
    parts = Parts(memoryview(data), engines, dice.choice([100, 1000, 10_000, 100_000]))
    assert_same_tables(gathered(parts.tables(2), len(data), 1), expected)
    return len(data), expected.events


def stream(path: Path, sender: str, dice: Random) -> bytes:
    """Frames, or frames among damage and noise, or bytes that mean something without any sense."""
    import handwritten_streams
    from compiled import module_at
    from corpus import marks_of, material_of, pieces

    material, marks = material_of(path, sender), marks_of(path, sender)
    spec = module_at(path).PROTOCOL.sender(sender)
    noisy = pieces(material, dice)
    found = bytearray()
    while len(found) < PIECE:
        kind = dice.random()
        for _ in range(200):
            if kind < 0.25:
                found += dice.choice(material.frames)
            elif kind < 0.75:
                found += next(noisy).data
            elif kind < 0.9:
                found += bytes(dice.choice(marks) for _ in range(8))
            else:
                found += handwritten_streams.random_stream(spec, dice, 1)
    return bytes(found[:PIECE])


if __name__ == "__main__":
    sys.exit(main())
