"""Costs of checksums and of framings in generated C, each by itself, on small machines and here.

    python benchmarks/bench_c_parts.py              # writes benchmarks/c_parts.md
    python benchmarks/bench_c_parts.py --rounds 3   # fewer rounds of the speeds on this machine

Needs avr-gcc, arm-none-eabi-gcc, cc, libsimavr-dev and `pip install '.[bench]'`.
"""

from __future__ import annotations

import argparse
import platform
import sys
import tempfile
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks")]

from bench_c import TOOLS, missing_tools  # noqa: E402
from c_costs.checksums import NAMES, SMALL, Source, Sum  # noqa: E402
from c_costs.cycles import CORTEX_M0, Machine, atmega328p, build_counter, cycles  # noqa: E402
from c_costs.framings import FRAMINGS, framed  # noqa: E402
from c_costs.memory import memory  # noqa: E402
from c_costs.tables import NOTHING, TITLES, header, row  # noqa: E402
from c_costs.toolchains import ARM, AVR, BUILDS, HOST, ORDINARY  # noqa: E402
from c_costs.workshop import Workshop  # noqa: E402

from protogen.version import VERSION  # noqa: E402

OUT = ROOT / "benchmarks" / "c_parts.md"
PAGE = """\
# What checksums and framings cost in generated C

<!-- Written by benchmarks/bench_c_parts.py, do not edit. -->

Made by `python benchmarks/bench_c_parts.py --rounds {rounds}`.

{versions}

Cycles are counted in simavr and, for the Cortex-M0, in Unicorn with the cycles of Arm's manual (DDI
0432C, 3.3). Small machines are built with `-Os`, this machine with `-O2`. Results are compared with
those of Python first.

## Checksums

For each byte in a run, and the flash of all that a checksum takes, with its table. `NAME_SMALL_CRC`
goes bit by bit.

{checksums}

On this machine, in MB/s, of runs of 64 kB: `NAME_FAST_FEED`, which is the default here, takes
several bytes at once. Medians of {rounds} rounds.

{speeds}

## Framings

The same message of eight bytes and a CRC-16/KERMIT in each framing, with `--events messages`:
cycles for each byte of a frame, to push it and decode the message, and to encode it; flash and RAM
of a program that does both. Medians of 8 frames of random values.

{framings}
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9, help="rounds of the speeds")
    parser.add_argument("--output", type=Path, default=OUT, help="the page")
    arguments = parser.parse_args()
    missing = missing_tools(TOOLS)
    if missing:
        sys.exit(f"not there: {', '.join(missing)}")
    with tempfile.TemporaryDirectory(prefix="protogen-bench-") as folder:
        workshop = Workshop(Path(folder))
        machines = (atmega328p(build_counter(workshop)), CORTEX_M0)
        sources = [Source(name, workshop.folder) for name in NAMES]
        text = PAGE.format(
            rounds=arguments.rounds,
            versions=versions(),
            checksums="\n".join(checksum_lines(sources, machines)),
            speeds="\n".join(speed_lines(sources, arguments.rounds)),
            framings="\n".join(framing_lines(workshop.folder, machines)),
        )
    arguments.output.write_text(text, encoding="utf-8")


def versions() -> str:
    compilers = ", ".join(item.version() for item in (AVR[ORDINARY], ARM[ORDINARY], HOST))
    tools = f"unicorn {version('unicorn')} on Python {platform.python_version()}"
    return f"protogen {VERSION}, {tools}; {compilers}."


def titles(machines: Sequence[Machine]) -> list[str]:
    return [machine.builds[ORDINARY].title for machine in machines]


def checksum_lines(sources: Sequence[Source], machines: Sequence[Machine]) -> Iterator[str]:
    ways = [f"{title}{way}" for title in titles(machines) for way in ("", ", `NAME_SMALL_CRC`")]
    yield from header("cycles a byte / bytes of flash", *ways)
    for source in sources:
        cells = []
        for machine in machines:
            cells.append(costs(source.on(machine)))
            cells.append(costs(source.on(machine, SMALL)) if source.is_crc else NOTHING)
        yield row([source.name, *cells])


def costs(found: Sum) -> str:
    return f"{found.cycles:.0f} / {found.flash}"


def speed_lines(sources: Sequence[Source], rounds: int) -> Iterator[str]:
    yield from header("MB/s", "default", "`NAME_FAST_FEED` as 0")
    for source in sources:
        speeds = [source.here(rounds, f"-DT_FAST_FEED={fast}") for fast in (1, 0)]
        yield row([source.name, *(f"{speed:,.0f}" for speed in speeds)])


def framing_lines(folder: Path, machines: Sequence[Machine]) -> Iterator[str]:
    heads = [
        f"{title}, {what}" for title in titles(machines) for what in ("decode / encode", "memory")
    ]
    yield from header("cycles a byte; flash / RAM", "build", *heads, texts=2)
    for title in FRAMINGS:
        workshop, subject = framed(folder, title)
        for build in BUILDS:
            cells = []
            for machine in machines:
                found = cycles(workshop, machine, build, subject)[0]
                taken = memory(workshop, machine.builds[build], subject)
                cells.append(f"{found.decode / found.bytes:.0f} / {found.encode / found.bytes:.0f}")
                cells.append(f"{taken.flash} / {taken.ram}")
            yield row([title, TITLES[build], *cells])


if __name__ == "__main__":
    main()
