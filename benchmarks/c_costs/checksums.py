"""Cycles and flash of checksums of generated C, and their speed on this machine."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from types import SimpleNamespace
from typing import Any

from c_costs.cycles import Machine
from c_costs.events import said, spans
from c_costs.memory import size_of
from c_costs.protocols import FOLDER
from c_costs.toolchains import HOST, ORDINARY, Toolchain, run
from protogen.model.checksums import checksum_of, find_algorithm
from protogen.targets.c.emit import c_environment
from protogen.targets.c.frame.algorithms import Checksums, algorithm_of

NAMES = (
    "sum-8",
    "CRC-8/SMBUS",
    "CRC-8/MAXIM-DOW",
    "CRC-16/KERMIT",
    "CRC-16/XMODEM",
    "CRC-16/MODBUS",
    "CRC-32/ISO-HDLC",
    "fletcher-16",
)
SHORT, LONG = 32, 96
"""Bytes that are summed up; the difference leaves out what a call costs."""
ROUNDS = 400
DATA = bytes((index * 7 + 1) & 0xFF for index in range(LONG))
SMALL = "-DT_SMALL_CRC=1"
HARNESS = FOLDER / "harness"


@dataclass(frozen=True)
class Sum:
    """What a checksum costs on a small machine."""

    cycles: float
    """For each byte."""
    flash: int


class Source:
    """The generated functions of a checksum, in a folder of their own."""

    def __init__(self, name: str, folder: Path) -> None:
        spec = find_algorithm(name)
        assert spec is not None
        self.name = name
        self.is_crc = spec.kind == "crc"
        sums = [checksum_of(spec).compute(DATA[:size]) for size in (SHORT, LONG)]
        self._due = [byte for value in sums for byte in value.to_bytes(4, "little")]
        algorithm = algorithm_of(spec, "sum")
        given = {"module": SimpleNamespace(name="t", upper="T")}
        template: Any = c_environment().get_template("frame/checksums.c.j2").make_module(given)
        texts = [f"#define SUM_INIT {algorithm.init}"]
        texts += [template.choice(Checksums((algorithm,)))] if self.is_crc else []
        texts += [template.functions(Checksums((algorithm,)), False)]
        self._folder = Path(tempfile.mkdtemp(dir=folder))
        (self._folder / "sums.h").write_text("\n".join(texts), encoding="utf-8")

    def on(self, machine: Machine, *flags: str) -> Sum:
        """Cycles and flash in an ordinary build."""
        toolchain = machine.builds[ORDINARY]
        program = self._built(toolchain, "-DT_FAST_FEED=0", *flags)
        told = machine.events(program)
        if said(told) != self._due:
            raise SystemExit(f"{self.name} on {toolchain.title}: {said(told)}, not {self._due}")
        cycles = (spans(told, 3)[0] - spans(told, 1)[0]) / (LONG - SHORT)
        empty = self._built(toolchain, "-DT_FAST_FEED=0", "-DNOTHING", *flags)
        return Sum(cycles, size_of(toolchain, program).flash - size_of(toolchain, empty).flash)

    def here(self, rounds: int, *flags: str) -> float:
        """MB/s of the median round on this machine."""
        program = self._built(HOST, "-DHOSTED", f"-DROUNDS={ROUNDS}", *flags)
        return 1000 * median(float(run([str(program)]).split()[0]) for _ in range(rounds))

    def _built(self, toolchain: Toolchain, *flags: str) -> Path:
        program = Path(tempfile.mkdtemp(dir=self._folder)) / "program"
        folders = (f"-I{HARNESS}", f"-I{self._folder}")
        source = str(HARNESS / "checksum.c")
        run([toolchain.compiler, *toolchain.flags, *flags, *folders, source, "-o", str(program)])
        return program
