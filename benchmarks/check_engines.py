"""Compares the fast engine of generated Python with the reference on a large seeded corpus.

Run: python benchmarks/check_engines.py --megabytes 100

Every sender of every schema, dialect and framing has its share: clean, noisy and adversarial
streams, at once and in portions. Ends with an AssertionError at the first difference.
"""

from __future__ import annotations

import argparse
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from random import Random
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))
sys.path.insert(0, str(ROOT / "benchmarks"))

from check_columns import shares, stream  # noqa: E402


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
    return 0


def compare(path: Path, sender: str, seed: str) -> tuple[int, int]:
    """Bytes and events of a stream that both engines read alike."""
    dice = Random(f"{path.stem} {sender} {seed}")
    data = stream(path, sender, dice)
    due = events_of(path, sender, "construct", [data])
    portions = [data[low : low + 997] for low in range(0, len(data), 997)]
    for pieces in ([data], portions):
        found = events_of(path, sender, "fast", pieces)
        assert len(found) == len(due), (path, sender, seed)
        for one, other in zip(found, due, strict=True):
            assert same(one, other), (path, sender, seed, one, other)
    return len(data), len(due)


def events_of(path: Path, sender: str, engine: str, pieces: list[bytes]) -> list[Any]:
    from compiled import module_at

    decoder = module_at(path).Decoder(sender, engine)
    events = [event for piece in pieces for event in decoder.feed(piece)]
    return [*events, *decoder.flush()]


def same(one: Any, other: Any) -> bool:
    """Whether two events are; their texts tell where a value is not a number."""
    return type(one) is type(other) and (one == other or repr(one) == repr(other))


if __name__ == "__main__":
    sys.exit(main())
