"""Time that a program waits for `import` of a generated module, and for its first frame.

    python benchmarks/bench_start.py             # writes benchmarks/start.md
    python benchmarks/bench_start.py --runs 5    # fewer runs

Each run is a process of its own. What is shown is how much longer it takes than one that does
nothing; processes of all kinds take turns, so that a busy moment meets all of them.
"""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import NamedTuple

from protogen.version import VERSION

ROOT = Path(__file__).resolve().parent.parent
RESULT = ROOT / "benchmarks" / "start.md"

FIRST_FRAMES = {
    "rn1": ("brain", "m.Gyro(status=1, int_x=-5, int_y=0, int_z=812)"),
    "rflex": ("linux", "m.RequestSystemStatus(), number=7"),
    "matty": ("pc", "m.Go(speed=500, steer=-250), counter=1"),
    "dagny": ("host", "m.Motor(s=5)"),
    "uherobot": ("daemon", "m.MotorTest(motor_1=-1, motor_2=300)"),
}
"""For each protocol an endpoint, and a message that it sends."""

NOTHING = "pass"
OTHERS = ("typing", "dataclasses", "construct")
"""Modules to compare with: the first is needed by all generated modules, the others by none."""


class Taken(NamedTuple):
    """Times of a process, in seconds."""

    cpu: float
    wall: float


def programs() -> dict[str, str]:
    """The programs by what the tables call them."""
    found = {NOTHING: NOTHING}
    found |= {f"`import {name}`": f"import {name}" for name in OTHERS}
    for name, (sender, given) in FIRST_FRAMES.items():
        load = f"import generated.python.{name} as m"
        found[f"`import generated.python.{name}`"] = load
        found[f"{name}: import, encode, decode, feed"] = (
            f"{load}; frame = m.encode({given}); m.decode(frame, '{sender}'); "
            f"assert m.Decoder('{sender}').feed(frame)"
        )
    return found


def run(program: str, environment: Mapping[str, str]) -> Taken:
    """Run a program in a new process."""
    start = time.perf_counter()
    # -P: the modules are those of the environment, not what lies in the present folder.
    process = os.posix_spawn(sys.executable, [sys.executable, "-P", "-c", program], environment)
    _, status, usage = os.wait4(process, 0)
    if status:
        raise SystemExit(f"this program failed: {program}")
    return Taken(usage.ru_utime + usage.ru_stime, time.perf_counter() - start)


def measure(runs: int, environment: Mapping[str, str]) -> dict[str, list[Taken]]:
    """The runs of each program, behind one that does not count."""
    found: dict[str, list[Taken]] = {name: [] for name in programs()}
    for count in range(runs + 1):
        for name, program in programs().items():
            taken = run(program, environment)
            if count:
                found[name].append(taken)
    return found


def table(found: Mapping[str, Sequence[Taken]]) -> list[str]:
    """Milliseconds above those of the program that does nothing."""
    lines = [
        "| program | CPU, best | CPU, median | wall, best | wall, median |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    for name, runs in found.items():
        if name == NOTHING:
            continue
        cells = [
            (of([item[index] for item in runs]) - of([item[index] for item in found[NOTHING]]))
            * 1e3
            for index in range(len(Taken._fields))
            for of in (min, median)
        ]
        lines.append(f"| {name} | {' | '.join(f'{cell:.1f}' for cell in cells)} |")
    return lines


TEXT = """\
# How long a program waits for an import

<!-- Written by benchmarks/bench_start.py, do not edit. -->

Made by `python benchmarks/bench_start.py --runs {runs}`: milliseconds more than a process that
does nothing (`pass`: {best:.1f} ms of CPU at best), best and median of {runs} processes. CPU is the
process's user and system time. Wall time also holds what other processes on the machine took.

The aim: `import generated.python.rn1` in under 30 ms. It needs neither NumPy nor construct, and
neither do the first frames, as long as they are in order.

protogen {version} on Python {python}. {cpus} CPUs.

## With bytecode

As everywhere but at the first import: Python keeps the bytecode of what it has compiled.
"""

WITHOUT = """
## Without bytecode

Where Python can't write beside the modules, or shall not (`PYTHONDONTWRITEBYTECODE`), each process
compiles the generated module and its runtime anew; only installed packages have bytecode here.
"""


def page(runs: int, cached: Mapping[str, list[Taken]], compiled: Mapping[str, list[Taken]]) -> str:
    """The whole page."""
    best = min(item.cpu for item in cached[NOTHING]) * 1e3
    head = TEXT.format(
        runs=runs,
        best=best,
        version=VERSION,
        python=platform.python_version(),
        cpus=os.cpu_count(),
    )
    return "\n".join([head, *table(cached), WITHOUT, *table(compiled), ""])


COPIED = ("generated/python", "protogen/runtime", "protogen/__init__.py", "protogen/version.py")
"""Files of the project that an import of a generated module reads."""


def copy_to(folder: Path) -> dict[str, str]:
    """Put what is imported into a folder, without bytecode; the environment that finds it there."""
    for name in COPIED:
        source, target = ROOT / name, folder / name
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target)
    plain = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "COVERAGE"))}
    return {**plain, "PYTHONPATH": str(folder)}


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=25)
    runs = parser.parse_args().runs
    with tempfile.TemporaryDirectory() as folder:
        plain = copy_to(Path(folder))
        compiled = measure(runs, {**plain, "PYTHONDONTWRITEBYTECODE": "1"})
        cached = measure(runs, plain)
    RESULT.write_text(page(runs, cached, compiled))
    print(RESULT.read_text())


if __name__ == "__main__":
    main()
