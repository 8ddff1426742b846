"""Costs of generated Python, beside code by hand and the field's peers, with equal messages.

    python benchmarks/bench_python.py             # writes python.md, python.png and into README.md
    python benchmarks/bench_python.py --rounds 3  # fewer rounds

Needs `pip install -e '.[bench]'`. The first run installs kaitai-struct-compiler by npm into
`.cache/bench`. A contender that is not there has empty cells.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks")]

from peers import MAKERS, made, timing  # noqa: E402
from peers.cases import FEW, Case, cases  # noqa: E402
from peers.contender import Contender, check  # noqa: E402

from protogen.version import VERSION  # noqa: E402

OUT = ROOT / "benchmarks" / "python.md"
README = ROOT / "benchmarks" / "README.md"
MARKS = ("<!-- bench_python: from here -->", "<!-- bench_python: to here -->")
SECONDS = 1_000_000_000

OURS, REFERENCE = "protogen", "protogen, `construct`"
SLOTTED, TUPLES, NUMPY = "hand, slotted", "hand, tuples", "hand, NumPy"
CONSTRUCT, COMPILED = "construct", "construct, compiled"
KAITAI, MAVLINK, SBP, SCAPY = "Kaitai Struct", "pymavlink", "libsbp", "scapy"
PURE, NATIVE = "protogen, Python columns", "protogen, native columns"

OBJECTS = (OURS, SLOTTED, CONSTRUCT, COMPILED, KAITAI, MAVLINK, SBP, SCAPY, REFERENCE)
"""Those that make an object of each message."""
BULK = (TUPLES, PURE, NUMPY, NATIVE)
"""Those that make tuples or columns of a whole stream."""
FRAMED = (KAITAI, MAVLINK, SBP)
"""The peers with frames or with code that is generated for them."""
SHORT = ("rn1 gyro", "rflex read-motor", "matty status")

Times = dict[str, list[float]]
"""Nanoseconds for a message by each contender, in each of the rounds."""


# --- measuring ------------------------------------------------------------------------------------


@dataclass
class Results:
    """Measurements of each case."""

    stream: dict[str, Times] = field(default_factory=dict)
    decode: dict[str, Times] = field(default_factory=dict)
    encode: dict[str, Times] = field(default_factory=dict)
    live: dict[str, Times] = field(default_factory=dict)
    """A stream in which each frame is fed by itself, as a serial port gives it."""
    pieces: dict[str, Times] = field(default_factory=dict)
    """A stream in pieces of `PIECE` bytes."""
    rates: dict[tuple[str, str], float] = field(default_factory=dict)
    """Bytes on the wire for a message, by case and contender."""
    missing: dict[str, str] = field(default_factory=dict)
    """Contenders that are not there, and why."""


PIECE = 64


def measure(rounds: int, size: int | None = None) -> Results:
    results = Results()
    for case in cases(size) if size else cases():
        found = contenders(case, results)
        measure_case(case, found, rounds, results)
        print(f"{case.title}: {len(found)} contenders", file=sys.stderr)
    return results


def contenders(case: Case, results: Results) -> list[Contender]:
    """Those that are there and read and write what the reference does, else ValueError."""
    found = []
    for maker in MAKERS:
        try:
            contender = made(maker, case)
        except ImportError as error:
            results.missing[maker] = str(error)
            continue
        if contender is not None:
            check(contender, case)
            found.append(contender)
    return found


def measure_case(case: Case, found: Sequence[Contender], rounds: int, results: Results) -> None:
    many, few = len(case.rows), min(FEW, len(case.rows))
    streams = {item.name: (item.stream, item.data, item.loops) for item in found if item.stream}
    runs = {name: _given(take, data) for name, (take, data, _) in streams.items()}
    times = timing.measure(runs, rounds)
    results.stream[case.title] = {
        name: [value / many / streams[name][2] for value in values]
        for name, values in times.items()
    }
    for name, (_, data, loops) in streams.items():
        results.rates[case.title, name] = len(data) / many / loops
    single = {
        "decode": {item.name: item.decode for item in found if item.decode},
        "encode": {item.name: item.encode for item in found if item.encode},
        "live": {item.name: _fed(item, case.frames[:few]) for item in found if item.feeder},
        "pieces": {item.name: _fed(item, pieces(case, few)) for item in found if item.feeder},
    }
    for what, calls in single.items():
        getattr(results, what)[case.title] = per_message(calls, rounds, few)


def per_message(calls: Mapping[str, Callable[[], object]], rounds: int, count: int) -> Times:
    times = timing.measure(calls, rounds)
    return {name: [value / count for value in values] for name, values in times.items()}


def pieces(case: Case, count: int) -> list[bytes]:
    data = b"".join(case.frames[:count])
    return [data[at : at + PIECE] for at in range(0, len(data), PIECE)]


def _given(take: Callable[[bytes], object], data: bytes) -> Callable[[], object]:
    return lambda: take(data)


def _fed(item: Contender, parts: Sequence[bytes]) -> Callable[[], object]:
    assert item.feeder is not None
    make = item.feeder

    def run() -> None:
        feed = make()
        for part in parts:
            feed(part)

    return run


# --- targets --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Target:
    """A figure that is to be reached; `value` is how near it is, 1 and less: reached."""

    what: str
    aim: str
    measured: str
    value: float | None


def targets(results: Results) -> list[Target]:
    found = []
    for case, times in results.stream.items():
        found.append(_most(f"stream of {case}, by hand with slots", times, SLOTTED, 1.0))
    for case in SHORT:
        times = results.stream[case]
        peers = [name for name in FRAMED if name in times]
        if peers:
            fastest = min(peers, key=lambda name: median(times[name]))
            found.append(_least(f"stream of {case}, {fastest}", times, OURS, fastest, 3))
        found.append(_least(f"stream of {case}, construct", times, OURS, CONSTRUCT, 6))
    for case, times in results.encode.items():
        found.append(_most(f"encoding {case}, by hand with slots", times, SLOTTED, 1.2))
    found += [_native(case, results) for case in results.stream]
    return found


def _most(what: str, times: Times, other: str, most: float) -> Target:
    value = timing.ratio(times[OURS], times[other])
    return Target(what, f"at most {most:g} x its time", f"{value:.2f} x", value / most)


def _least(what: str, times: Times, own: str, other: str, least: float) -> Target:
    value = timing.ratio(times[other], times[own])
    return Target(what, f"at least {least:g} x faster", f"{value:.1f} x", least / value)


def _native(case: str, results: Results) -> Target:
    what, aim = f"native columns of {case}", "at least 1,000 MB/s"
    if NATIVE not in results.stream[case]:
        return Target(what, aim, "not measured", None)
    rate = megabytes(results, case, NATIVE)
    return Target(what, aim, f"{rate:,.0f} MB/s", 1000 / rate)


def megabytes(results: Results, case: str, name: str) -> float:
    """Megabytes of wire a second."""
    return results.rates[case, name] / median(results.stream[case][name]) * 1000


def targets_table(results: Results) -> str:
    lines = ["| | aim | measured | |", "| --- | --- | ---: | --- |"]
    for item in targets(results):
        verdict = "" if item.value is None else "reached" if item.value <= 1 else "**missed**"
        lines.append(f"| {item.what} | {item.aim} | {item.measured} | {verdict} |")
    return "\n".join(lines)


# --- the page -------------------------------------------------------------------------------------

NOTHING = "-"
NOT_MEASURED = "not measured"


def table(found: Mapping[str, Times], names: Iterable[str], base: str = OURS) -> str:
    """Nanoseconds, and how many times those of `base`."""
    names = list(names)
    lines = [
        f"| ns per message (x {base}) | {' | '.join(names)} |",
        f"| --- |{' ---: |' * len(names)}",
    ]
    for case, times in found.items():
        cells = [_cell(times, name, base) for name in names]
        lines.append(f"| {case} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _cell(times: Times, name: str, base: str) -> str:
    if name not in times:
        return NOTHING
    shown = f"{median(times[name]):,.0f}"
    if name == base or base not in times:
        return shown
    factor = timing.ratio(times[name], times[base])
    return f"{shown} ({factor:,.{2 if factor < 2 else 1 if factor < 10 else 0}f} x)"


def bulk_table(results: Results) -> str:
    names = [OURS, *BULK]
    lines = [
        f"| ns per message (MB/s of wire) | {' | '.join(names)} |",
        f"| --- |{' ---: |' * len(names)}",
    ]
    for case, times in results.stream.items():
        cells = []
        for name in names:
            if name not in times:
                cells.append(NOT_MEASURED)
                continue
            rate = megabytes(results, case, name)
            cells.append(f"{median(times[name]):,.0f} ({rate:,.{1 if rate < 10 else 0}f})")
        lines.append(f"| {case} | {' | '.join(cells)} |")
    return "\n".join(lines)


PAGE = """\
# What generated Python takes

<!-- Written by benchmarks/bench_python.py, do not edit. -->

Made by `python benchmarks/bench_python.py --rounds {rounds}`.

{versions}

CPU time of this process, medians of {rounds} rounds. In each round every contender has its turn,
every second round in the reverse order, so that whatever else the machine does befalls them alike;
factors are medians of the rounds' factors. Before anything is timed, the values that each contender
reads and the frames that it writes are compared with those of the reference; those of the code by
hand in noise as well, by the tests. The garbage collector stays on, but what there was before a
measurement is kept out of its sight (`gc.freeze`), as if each contender had a process of its own:
else a full collection goes through the modules of all contenders, takes some 100 ms, and whoever
makes objects when it is due pays for the others. Each turn begins with a run that is not counted:
the processor's caches hold what the contender before has left.

The messages have random values over all of their ranges; sonars are the 17 of an ATRV-Jr. A stream
has about {kilobytes} kB of one message, and is given as a whole.

![Time per message in whole streams, by contender](python.png)

## Whole streams, objects

Bytes to a list of results with framing, checksum, validation and typed values.

{stream}

What each does, and does not:

* **protogen** is the generated `Decoder` with its default engine: events with offset, raw bytes,
  parts and typed messages (enums, flags), anything that is no frame as an event with its reason,
  every message of the protocol known, and exact resynchronisation. With `construct` it is the
  reference: the same events byte by byte.
* **hand, slotted** is what an expert writes with `struct` for these two messages of a protocol
  ([slotted_rn1.py](peers/slotted_rn1.py), [slotted_rflex.py](peers/slotted_rflex.py),
  [slotted_matty.py](peers/slotted_matty.py)): slotted messages and events with offset, raw bytes
  and counter; enums and flags by tables; `bytes.find`, `replace`, `zlib.adler32` as a sum,
  exclusive or by a folded integer. It reports bytes that are no frame, without a reason, and
  finds the same messages in noise.
* **construct** parses the payloads, to containers of plain integers. The frames around them are
  cut by hand ([framing.py](peers/framing.py)), without events, and the first bad byte is an error.
  7-bit pairs go through adapters with the tables of the code by hand.
* **Kaitai Struct** parses the payloads with code of its compiler, with enums, without flags; the
  same frames by hand. Its numbers of 7-bit pairs are instances, which are asked for; those of the
  lidar are converted by hand, because instances would need an object for each. It encodes nothing:
  the function of the npm package compiles for reading only.
* **pymavlink** has its own frames, with sequence and CRC ({crc}), and resynchronises; dialects in
  [c/mavlink](c/mavlink/rn1.xml). Plain integers. A turn of the lidar goes out in four messages,
  and the readings of the sonars are two arrays, not records.
* **libsbp** has its own frames with CRC-16 and its own reader, without metadata; classes as its
  generator makes them. Plain integers. A turn of the lidar does not fit.
* **scapy** dissects the payloads into packets, with names for enums and flags; the same frames by
  hand.

## Whole streams, tuples and columns

{bulk}

* **hand, tuples** ([tuned.py](peers/tuned.py)) cuts whole buffers with `split` and `re`, reads all
  of them with one `iter_unpack`, and checks sums over all frames at once; tuples of plain integers
  without offsets. What is not plainly in order goes to the decoder with slots.
* **hand, NumPy** ([bulk.py](peers/bulk.py)) finds, unstuffs, checks and reads all frames at once
  into a structured array, without offsets. Of rflex and matty it takes whole frames of one message
  only, anything else is an error.
* **protogen, Python columns** are `protogen.capture.columns` without a compiler, filled from the
  Python decoder's events. **Native** ones are by generated C. Both
  have offsets, sequence and sizes of all rows, every message, invalid bytes with their reasons.
  What either decodes with is made before anything is timed.
  Native columns are measured on {loops} streams behind one another, by batches, and on one core;
  [columns.md](columns.md) measures them beside C by hand, on larger captures and in another run.

## Live streams

A serial port gives a few bytes at a time. What it costs to feed each frame by itself:

{live}

And in pieces of {piece} bytes, wherever they end:

{pieces}

## Single frames

Decoding exactly one frame of each of {few} values:

{decode}

Encoding a frame of a message:

{encode}

## Targets

{targets}

{missing}
"""


def page(results: Results, rounds: int) -> str:
    any_case = next(iter(results.stream.values()))
    values = {
        "rounds": rounds,
        "versions": versions(),
        "kilobytes": round(cases()[0].size / 1000),
        "crc": "by fastcrc" if find_spec("fastcrc") else "in Python",
        "stream": table(results.stream, OBJECTS),
        "bulk": bulk_table(results),
        "loops": 256 if NATIVE in any_case else "many",
        "live": table(results.live, (OURS, SLOTTED, REFERENCE)),
        "pieces": table(results.pieces, (OURS, SLOTTED, REFERENCE)),
        "piece": PIECE,
        "few": FEW,
        "decode": table(results.decode, OBJECTS),
        "encode": table(results.encode, [name for name in OBJECTS if name != KAITAI]),
        "targets": targets_table(results),
        "missing": missing_text(results),
    }
    return PAGE.format(**values).rstrip() + "\n"


def missing_text(results: Results) -> str:
    if not results.missing:
        return ""
    lines = [f"* `{name}`: {why}" for name, why in results.missing.items()]
    return "\n".join(["Not measured here:", "", *lines])


PACKAGES = ("construct", "kaitaistruct", "pymavlink", "sbp", "scapy", "numpy")


def versions() -> str:
    found = [f"{name} {version(name)}" for name in PACKAGES if find_spec(name)]
    return (
        f"protogen {VERSION} on Python {platform.python_version()}, "
        f"{platform.system()} {platform.machine()}, {os.cpu_count()} CPUs; {', '.join(found)}."
    )


def summary(results: Results) -> str:
    """The part of `README.md` that this writes."""
    names = (OURS, SLOTTED, TUPLES, NUMPY, NATIVE, CONSTRUCT, COMPILED, KAITAI, MAVLINK, SBP, SCAPY)
    any_case = next(iter(results.stream.values()))
    shown = [name for name in names if name in any_case]
    lines = [
        "Whole streams in Python: framing, checksum, validation and typed results, in ns per",
        "message, and how many times protogen's that is. [python.md](python.md) says what each",
        "does and does not; live streams, single frames, encoding and the targets are there,",
        "too.",
        "",
        table(results.stream, shown),
        "",
        "![Time per message in whole streams, by contender](python.png)",
    ]
    return "\n".join(lines)


def into_readme(text: str, part: str) -> str:
    """The page with this part between the marks."""
    before, rest = text.split(MARKS[0], 1)
    after = rest.split(MARKS[1], 1)[1]
    return f"{before}{MARKS[0]}\n\n{part}\n\n{MARKS[1]}{after}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9, help="rounds of the timings")
    parser.add_argument("--output", type=Path, default=OUT, help="the page; the plot is beside it")
    arguments = parser.parse_args()
    results = measure(arguments.rounds)
    arguments.output.write_text(page(results, arguments.rounds), encoding="utf-8")
    if find_spec("matplotlib"):
        from peers.plot import plot

        plot(results.stream, (*OBJECTS, *BULK), arguments.output.with_suffix(".png"))
    else:
        print("no plot: pip install matplotlib", file=sys.stderr)
    if arguments.output == OUT:
        text = into_readme(README.read_text(encoding="utf-8"), summary(results))
        README.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
