"""Flash and RAM of linked programs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from c_costs.protocols import FOLDER, Protocol
from c_costs.toolchains import AVR_APART, Toolchain, run
from c_costs.workshop import Subject, Workshop


@dataclass(frozen=True)
class Memory:
    """Memory that a linked program takes, less an empty one."""

    flash: int
    ram: int


def memory(workshop: Workshop, toolchain: Toolchain, subject: Subject) -> Memory:
    program = workshop.build(toolchain, "size", subject)
    empty = workshop.build(toolchain, "size", nothing(subject.protocol))
    whole, base = size_of(toolchain, program), size_of(toolchain, empty)
    return Memory(whole.flash - base.flash, whole.ram - base.ram)


def nothing(protocol: Protocol) -> Subject:
    return Subject("empty", protocol, FOLDER / "subjects" / "use_empty.h", (), ())


def size_of(toolchain: Toolchain, program: Path) -> Memory:
    said = run([f"{toolchain.prefix}size", str(program)])
    text, data, bss = map(int, said.splitlines()[1].split()[:3])
    return Memory(text + data, data + bss)


def spenders(workshop: Workshop, subject: Subject, most: int = 14) -> list[tuple[str, int]]:
    """The largest functions and constants, with nothing inlined."""
    program = workshop.build(AVR_APART, "size", subject)
    said = run([f"{AVR_APART.prefix}nm", "-S", "--size-sort", "--reverse-sort", str(program)])
    rows = [line.split() for line in said.splitlines()]
    return [(row[3], int(row[1], 16)) for row in rows if row[2] in "tTwWrR"][:most]
