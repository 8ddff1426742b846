"""Native columns against the hand-written decoder with SSE2, and two cores against one.

    python benchmarks/bench_columns.py [--megabytes N] [--rounds N]

Needs `cc` and NumPy. Writes benchmarks/columns.md.
"""

from __future__ import annotations

import argparse
import ctypes
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from random import Random
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

import protogen  # noqa: E402
from protogen.capture import batches, columns  # noqa: E402
from protogen.capture.native import address_of  # noqa: E402
from protogen.model.protocol import Protocol  # noqa: E402
from protogen.model.types import Array, Fixed, Integer, Struct, Type  # noqa: E402

OUT = Path(__file__).with_name("columns.md")
EXPERTS = Path(__file__).parent / "c" / "expert"
READINGS = 17
CHUNK = 1 << 20


@dataclass(frozen=True)
class Case:
    """A stream of one message, and how the expert takes it."""

    name: str
    schema: str
    sender: str
    message: str
    expert: str
    struct: str
    call: str


CASES = (
    Case("rn1 gyro", "schemas/rn1.yaml", "brain", "gyro", "rn1", "expert_rn1_gyro",
         "sse2_rn1_next(data, size, row, &other, &which)"),
    Case("rn1 lidar", "schemas/rn1.yaml", "brain", "lidar", "rn1", "expert_rn1_lidar",
         "sse2_rn1_next(data, size, &other, row, &which)"),
    Case("rflex read_motor", "benchmarks/c/atrv.yaml", "flex", "read_motor", "atrv",
         "expert_atrv_motor", "sse2_atrv_next(data, size, row, &other, &which)"),
    Case("rflex sonar_data", "benchmarks/c/atrv.yaml", "flex", "sonar_data", "atrv",
         "expert_atrv_sonar", "sse2_atrv_next(data, size, &other, row, &which)"),
    Case("matty status", "schemas/matty.yaml", "esp", "status", "matty", "expert_matty_status",
         "sse2_matty_next(data, size, row, &is_complete)"),
)  # fmt: skip
_OTHERS = {
    "expert_rn1_gyro": "struct expert_rn1_lidar other;",
    "expert_rn1_lidar": "struct expert_rn1_gyro other;",
    "expert_atrv_motor": "struct expert_atrv_sonar other;",
    "expert_atrv_sonar": "struct expert_atrv_motor other;",
    "expert_matty_status": "bool is_complete;",
}
_EXPERT = """
#include "sse2_{expert}.c"
#include <stdlib.h>

/* Messages of a stream, a chunk at a time, into rows that are used again. */
size_t take_all(const uint8_t *data, size_t size, size_t chunk) {{
    struct {struct} *const rows = malloc((chunk / 8u + 1u) * sizeof *rows);
    size_t count = 0;
    const uint8_t *const end = data + size;
    while (data != end) {{
        const uint8_t *const stop = (size_t)(end - data) < chunk ? end : data + chunk;
        size_t found = 0;
        for (;;) {{
            struct {struct} *const row = &rows[found];
            {other}
            uint8_t which = 0;
            const size_t size = (size_t)(end - data);
            const size_t taken = {call};
            (void)which;
            if (taken == 0) {{
                return count + found;
            }}
            data += taken;
            found++;
            if (data >= stop) {{
                break;
            }}
        }}
        count += found;
    }}
    free(rows);
    return count;
}}
"""


def expert(case: Case, folder: Path) -> Callable[[memoryview], int]:
    """The expert, as a function that counts the messages of a stream."""
    source, library = folder / f"{case.struct}.c", folder / f"{case.struct}.so"
    source.write_text(
        _EXPERT.format(
            expert=case.expert, struct=case.struct, call=case.call, other=_OTHERS[case.struct]
        )
    )
    command = ["cc", "-O2", "-w", "-fPIC", "-shared", f"-I{EXPERTS}", "-o", library, source]
    subprocess.run(command, check=True)
    function = ctypes.CDLL(str(library)).take_all
    function.restype = ctypes.c_size_t
    function.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_size_t)
    return lambda data: int(function(address_of(data), len(data), CHUNK))


# --- streams --------------------------------------------------------------------------------------


def frames(protocol: Protocol, case: Case, count: int) -> list[bytes]:
    """Frames of random values."""
    module, dice = protogen.module_of(protocol), Random(case.name)
    found = []
    for number in range(count):
        fields = protocol.message(case.message).fields
        values = {f.name: _value(f.type, dice) for f in fields if f.const is None}
        message = module.MESSAGES[case.message].from_dict(values)
        parts = {"counter": number & 0xFF} if case.expert == "matty" else {}
        found.append(module.encode(message, case.sender, strict=False, **parts))
    return found


def _value(type_: Type, dice: Random) -> Any:
    match type_:
        case Integer():
            return dice.randint(type_.least, type_.greatest)
        case Array(element=element, extent=extent):
            count = extent.count if isinstance(extent, Fixed) else READINGS
            return [_value(element, dice) for _ in range(count)]
        case Struct(fields=fields):
            return {field.name: _value(field.type, dice) for field in fields}
        case _:
            raise AssertionError(type_)


# --- timing ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Times:
    """Seconds that a run took: of the processor, and on the clock."""

    processor: float
    clock: float


def timed(run: Callable[[], object]) -> Times:
    clock, processor = time.perf_counter(), time.process_time()
    run()
    return Times(time.process_time() - processor, time.perf_counter() - clock)


def measure(case: Case, size: int, rounds: int, folder: Path) -> str:
    protocol = protogen.load(ROOT / case.schema)
    some = frames(protocol, case, 2000 if case.message != "lidar" else 300)
    repeats = max(1, size // len(b"".join(some)))
    data, count = b"".join(some) * repeats, len(some) * repeats
    take = expert(case, folder)
    view, middle = memoryview(data), len(data) // repeats * (repeats // 2)

    def by_expert(*parts: memoryview) -> int:
        with ThreadPoolExecutor(len(parts)) as pool:
            return sum(pool.map(take, parts))

    halves = view[:middle], view[middle:]
    assert by_expert(view) == by_expert(*halves) == count

    def read(workers: int) -> int:
        each = batches(data, protocol, case.sender, workers=workers)
        return sum(tables.events for tables in each)

    def whole(workers: int) -> int:
        return len(columns(data, protocol, case.sender, workers=workers).messages[case.message])

    assert read(1) == read(2) == whole(1) == whole(2) == count
    runs: dict[str, Callable[[], object]] = {
        "expert": lambda: by_expert(view),
        "expert by two": lambda: by_expert(*halves),
        "one": lambda: read(1),
        "two": lambda: read(2),
        "whole": lambda: whole(1),
        "whole by two": lambda: whole(2),
    }
    found: dict[str, list[Times]] = {name: [] for name in runs}
    for _ in range(rounds):
        for name, run in runs.items():
            found[name].append(timed(run))

    def ns(name: str) -> float:
        return median(item.processor for item in found[name]) / count * 1e9

    def ratio(one: str, two: str, kind: str) -> float:
        pairs = zip(found[one], found[two], strict=True)
        return median(getattr(a, kind) / getattr(b, kind) for a, b in pairs)

    per = len(data) / count
    cells = [
        case.name,
        f"{per:.1f}",
        f"{ns('expert'):.1f}",
        f"{ns('one'):.1f} ({per / ns('one') * 1000:,.0f})",
        f"{ratio('one', 'expert', 'processor'):.2f}",
        f"{ns('whole'):.1f} ({per / ns('whole') * 1000:,.0f})",
        f"{ratio('expert', 'expert by two', 'clock'):.2f}",
        f"{ratio('one', 'two', 'clock'):.2f} ({2 * ratio('one', 'two', 'processor'):.2f})",
        f"{ratio('whole', 'whole by two', 'clock'):.2f} "
        f"({2 * ratio('whole', 'whole by two', 'processor'):.2f})",
    ]
    return "| " + " | ".join(cells) + " |"


_HEAD = """# What native columns cost

<!-- Written by benchmarks/bench_columns.py, do not edit. -->

Made by `python benchmarks/bench_columns.py --megabytes {megabytes} --rounds {rounds}`.

Clean streams of frames of random values. Medians of {rounds} rounds, in each of which every program
has its turn; the time of the processor, in ns per message (and MB/s of wire bytes). The expert is C
by hand with SSE2 ([c/expert](c/expert/sse2_rn1.h)): it writes the fields of the one message that
there is into rows that are used again, and neither offsets, numbers of events nor parts of frames.
By batches is `batches`, whose memory is used again, too; whole is `columns`, whose tables stay: it
also takes what the system needs to give and take back memory for all of them, which differs much
between runs. rflex's sonar_data has room for 17 readings, as the expert's.

Two cores: how many times as fast they are on the clock, which other processes of the machine
disturb, and in brackets how many times the processor's time allows where both cores are free. The
expert's is what this machine has to give: two threads that take half of the stream each, and share
nothing but its memory. Parts begin with some milliseconds for threads and for memory that nobody
has used yet, which is why captures are large here: 128 MB of lidar frames last 12 ms. Of the rows,
those of gyro and lidar, whose frames have one size, are numbered right when they are written; those
of the others are numbered anew where two parts meet, which is in the figures. One core writes the
rows of whole tables where they stay; with two, they are copied there.

| | bytes | expert | by batches | ratio to expert | whole | two cores: expert | batches | whole |
| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--megabytes", type=int, default=512)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    head = _HEAD.format(megabytes=options.megabytes, rounds=options.rounds)
    with TemporaryDirectory() as folder:
        size = options.megabytes << 20
        rows = (measure(case, size, options.rounds, Path(folder)) for case in CASES)
        write_page(OUT, head, rows)
    return 0


def write_page(path: Path, head: str, rows: Iterable[str]) -> None:
    """Write a page that ends with a table, and print the table's rows as they come."""
    lines = []
    for row in rows:
        print(row, flush=True)
        lines.append(f"{row}\n")
    path.write_text(head + "".join(lines), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
