"""Costs of generated C, beside an expert's C by hand, MAVLink C and nanopb, with equal messages.

    python benchmarks/bench_c.py                # writes benchmarks/c.md and benchmarks/c/sizes.toml
    python benchmarks/bench_c.py --rounds 5     # fewer rounds of the timings on this machine
    python benchmarks/bench_c.py --small rover  # prints flash, RAM and cycles of some protocols
    python benchmarks/bench_c.py --sizes        # writes benchmarks/c/sizes.toml alone

Needs avr-gcc, arm-none-eabi-gcc, cc, libsimavr-dev and `pip install '.[bench]'`. The first run
fetches nanopb's C sources by npm into `.cache/bench`; without them its cells stay empty.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "tests"), str(ROOT / "benchmarks")]

from c_costs import sizes  # noqa: E402
from c_costs.measure import measure, measure_small  # noqa: E402
from c_costs.page import page  # noqa: E402
from c_costs.protocols import PROTOCOLS  # noqa: E402
from c_costs.tables import bytes_table, cycles_table, memory_table  # noqa: E402
from c_costs.workshop import Workshop  # noqa: E402

OUT = ROOT / "benchmarks" / "c.md"


def main() -> None:
    arguments = parse()
    missing = missing_tools(["avr-gcc"] if arguments.sizes else TOOLS)
    if missing:
        sys.exit(f"not there: {', '.join(missing)}")
    with tempfile.TemporaryDirectory(prefix="protogen-bench-") as folder:
        if arguments.small:
            print(small(Workshop(Path(folder)), arguments.small))
            return
        sizes.record(sizes.measured(Path(folder, "sizes")))
        if not arguments.sizes:
            results = measure(Workshop(Path(folder)), arguments.rounds, arguments.seeds)
            text = page(results, arguments.rounds, arguments.seeds)
            arguments.output.write_text(text, encoding="utf-8")


def parse() -> argparse.Namespace:
    names = [protocol.name for protocol in PROTOCOLS]
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9, help="rounds of the timings")
    parser.add_argument("--seeds", type=int, default=100, help="noisy streams of each protocol")
    parser.add_argument("--output", type=Path, default=OUT, help="the page")
    parser.add_argument("--small", nargs="+", choices=names, help="no page, but small machines")
    parser.add_argument("--sizes", action="store_true", help="no page, but the recorded sizes")
    return parser.parse_args()


def small(workshop: Workshop, names: Sequence[str]) -> str:
    """Tables of some protocols, of protogen and the expert."""
    protocols = [protocol for protocol in PROTOCOLS if protocol.name in names]
    results = measure_small(workshop, protocols)
    tables = (
        f"ATmega328P\n{memory_table(results.avr)}",
        f"Cortex-M0\n{memory_table(results.arm)}",
        f"Cycles, ATmega328P\n{cycles_table(results.avr_cycles)}",
        f"Cycles, Cortex-M0\n{cycles_table(results.arm_cycles)}",
        bytes_table(results, protocols),
    )
    return "\n\n".join(tables)


def missing_tools(tools: Sequence[str]) -> list[str]:
    return [name for name in tools if not _CHECKS.get(name, lambda name=name: shutil.which(name))()]


_CHECKS: dict[str, Callable[[], object]] = {
    "pymavlink": lambda: find_spec("pymavlink"),
    "pyelftools": lambda: find_spec("elftools"),
    "unicorn": lambda: find_spec("unicorn"),
    "libsimavr-dev": lambda: Path("/usr/include/simavr/sim_avr.h").exists(),
}
TOOLS = ("avr-gcc", "arm-none-eabi-gcc", "cc", *_CHECKS)


if __name__ == "__main__":
    main()
