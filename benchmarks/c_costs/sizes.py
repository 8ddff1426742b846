"""Flash of a few linked programs on an ATmega328P, recorded so that no change makes them larger."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from c_costs.memory import memory
from c_costs.protocols import FOLDER, PROTOCOLS
from c_costs.toolchains import AVR, ORDINARY
from c_costs.workshop import Workshop

RECORD = FOLDER / "sizes.toml"
RECORDED = ("matty", "rover", "probe", "tether", "dagny")
"""Protocols whose programs are cheap to build, one for each framing and checksum."""
HEADER = """\
# Bytes of flash on an ATmega328P that protogen takes in an ordinary build (no -flto), in programs
# with `--events messages`. tests/test_c_size.py compares them; they are written by
# {command}
"""
COMMAND = "python benchmarks/bench_c.py --sizes"


@dataclass(frozen=True)
class Sizes:
    """Flash by protocol, and the version of the compiler that it goes for."""

    compiler: str
    flash: Mapping[str, int]


def measured(folder: Path) -> Sizes:
    """What the programs take now."""
    workshop = Workshop(folder)
    toolchain = AVR[ORDINARY]
    flash = {
        protocol.name: memory(workshop, toolchain, workshop.subject("messages", protocol)).flash
        for protocol in PROTOCOLS
        if protocol.name in RECORDED
    }
    return Sizes(toolchain.version(), flash)


def recorded() -> Sizes:
    record = tomllib.loads(RECORD.read_text(encoding="utf-8"))
    return Sizes(record["compiler"], record["flash"])


def record(sizes: Sizes) -> None:
    lines = [f'compiler = "{sizes.compiler}"', "", "[flash]"]
    lines += [f"{name} = {flash}" for name, flash in sizes.flash.items()]
    text = HEADER.format(command=COMMAND) + "\n".join(lines) + "\n"
    RECORD.write_text(text, encoding="utf-8")
