"""Compares all engines that give events with the reference on a large seeded corpus.

Run: python benchmarks/check_engines.py --megabytes 100 --processes 2

The engines: construct, which is the reference, fast Python, and generated C where there is a
compiler, byte by byte (push) and by buffers (feed). Every sender of every schema, dialect and
framing has its share: clean, noisy and adversarial streams, at once and in portions. Ends with an
AssertionError at the first difference; else writes benchmarks/equality.md, from 100 MB on.
`check_columns.py` does the same for native columns.
"""

from __future__ import annotations

import argparse
import platform
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

from protogen.runtime.values import as_dict

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))
sys.path.insert(0, str(ROOT / "benchmarks"))

from check_columns import record, shares, stream  # noqa: E402

SIZES = (16, 997, 1 << 16)
"""Bytes of the portions that C takes."""
_SSE2 = platform.machine() in ("x86_64", "AMD64")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--megabytes", type=float, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=1)
    options = parser.parse_args()
    jobs = list(shares(int(options.megabytes * 1e6), options.seed))
    started, done, events, by_c = time.monotonic(), 0, 0, 0
    with ProcessPoolExecutor(options.processes) as pool:
        for size, count, in_c in pool.map(compare, *zip(*jobs, strict=True)):
            done, events, by_c = done + size, events + count, by_c + in_c
            rate = done / (time.monotonic() - started) / 1e6
            text = f"{done / 1e6:.1f} MB, {events} events alike, {by_c} of them in C"
            print(f"\r{text}, {rate:.2f} MB/s", end="")
    print()
    engines = "construct, fast Python" + (", C push and feed" if by_c == events else "")
    record(__file__, engines, options, done, events)
    return 0


def compare(path: Path, sender: str, seed: str) -> tuple[int, int, int]:
    """Bytes of a stream that all engines read alike, its events, and how many C was asked for."""
    dice = Random(f"{path.stem} {sender} {seed}")
    data = stream(path, sender, dice)
    due = events_of(path, sender, "construct", [data])
    for pieces in ([data], portions(data, 997)):
        found = events_of(path, sender, "fast", pieces)
        assert len(found) == len(due), (path, sender, seed)
        for one, other in zip(found, due, strict=True):
            # As text: the process that asked does not have the module of these events.
            assert same(one, other), f"{path} {sender} {seed}: {one} is {other}"
    in_c = compare_c(path, sender, data, due, dice.choice(["SSE2", "FAST_FEED"]))
    return len(data), len(due), in_c


def portions(data: bytes, size: int) -> list[bytes]:
    return [data[low : low + size] for low in range(0, len(data), size)]


def events_of(path: Path, sender: str, engine: str, pieces: list[bytes]) -> list[Any]:
    from compiled import module_at

    decoder = module_at(path).Decoder(sender, engine)
    events = [event for piece in pieces for event in decoder.feed(piece)]
    return [*events, *decoder.flush()]


def same(one: Any, other: Any) -> bool:
    """True if two events are; their texts tell where a value is not a number."""
    return type(one) is type(other) and (one == other or repr(one) == repr(other))


# --- C --------------------------------------------------------------------------------------------


def compare_c(path: Path, sender: str, data: bytes, due: Sequence[Any], way: str) -> int:
    """Number of events C gives like these; none where there is no compiler.

    What C answers is compared byte by byte where both ways take the same portions; then one answer
    is enough to be compared with the reference.
    """
    library = library_of(path, way if _SSE2 else "FAST_FEED")
    if library is None:
        return 0
    for size in SIZES:
        pushed, fed = (answers(library, sender, data, kind, size) for kind in ("push", "feed"))
        assert pushed == fed, (path, sender, way, size)
    events = [event for step in library.do(steps(library, sender, data, "feed", 1 << 16))
              for event in step]  # fmt: skip
    return compare_events(path, sender, events, due)


@cache
def library_of(path: Path, way: str) -> Any:
    """The C of a schema, compiled once in a process; None where there is no compiler."""
    from compiled import protocol_of

    from protogen.fuzzing.c_library import CLibrary, find_compiler
    from protogen.targets.c.fuzz_driver.driver import driver_of

    compiler = find_compiler()
    if compiler is None:
        return None
    protocol = protocol_of(path)
    flags = ("-std=c99", "-O1", "-fPIC", "-shared", f"-D{protocol.name.upper()}_{way}=1")
    return CLibrary(driver_of(protocol), compiler, flags)


def steps(library: Any, sender: str, data: bytes, kind: str, size: int) -> Any:
    """The call that takes a new decoder through the data in portions."""
    return library.calls.events(
        sender, [*((kind, piece) for piece in portions(data, size)), ("flush",)]
    )


def answers(library: Any, sender: str, data: bytes, kind: str, size: int) -> bytes:
    """All bytes that C answers."""
    from protogen.fuzzing.c_calls import Call

    call = steps(library, sender, data, kind, size)
    found: bytes = library.do(Call(call.request, lambda given: given._stream.read()))
    return found


def compare_events(path: Path, sender: str, found: Sequence[Any], due: Sequence[Any]) -> int:
    """Number of C's events that are as they should be, which are all that C has to have."""
    alike = 0
    for event, one in zip(due, found, strict=False):
        if not same_in_c(event, one):
            break
        alike += 1
    if alike == len(found) == len(due):
        return alike
    # C refuses counts that no struct has room for, and may find others inside.
    from c_engine import _event, comparable
    from compiled import protocol_of

    least = comparable(protocol_of(path), [[_event(event) for event in due]])
    one, other = found[alike : alike + 1], due[alike : alike + 1]
    place = f"{path} {sender}: {one} is {other}"
    assert least is not None, place
    assert alike >= least, place
    return alike


def same_in_c(event: Any, found: Any) -> bool:
    """True if an event of C is that of Python."""
    from protogen.fuzzing.trips import same as same_values

    if (found.kind, found.offset, found.size) != (event.kind, event.offset, event.size):
        return False
    if event.kind == "invalid":
        return bool(found.reason == event.reason)
    if (found.parts, found.payload) != (as_dict(event.parts), event.payload):
        return False
    if event.kind == "unknown":
        return not found.message
    # C has no constants in its structs; of a constant 0.0, what came in may have been -0.0.
    constant = {name for name, rule in event.message.RULES if getattr(rule, "const", None) == 0}
    values, due = (
        {name: value for name, value in item.items() if name not in constant}
        for item in (found.values, event.message.to_dict())
    )
    return bool(found.message == event.message.NAME and same_values(values, due))


if __name__ == "__main__":
    sys.exit(main())
