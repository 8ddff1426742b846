"""Compilers, and how programs are built with them."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass

from c_costs.protocols import FOLDER, ROOT


def run(command: Sequence[str], data: bytes | None = None) -> str:
    """Run a program and return what it prints; end with what it says if it fails."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, input=data, capture_output=True, env=environment, check=False)
    if done.returncode != 0:
        said = (done.stdout + done.stderr).decode()
        raise SystemExit(f"{' '.join(command)} failed:\n{said[:3000]}")
    return done.stdout.decode()


@dataclass(frozen=True)
class Toolchain:
    """A compiler with its flags, and the tools that go with it."""

    title: str
    prefix: str
    flags: tuple[str, ...]
    compiler_name: str = "gcc"

    @property
    def compiler(self) -> str:
        return self.prefix + self.compiler_name

    @property
    def has_lto(self) -> bool:
        return "-flto" in self.flags

    def version(self) -> str:
        return run([self.compiler, "--version"]).splitlines()[0]


_SMALL = ("-std=gnu99", "-w", "-Os", "-ffunction-sections", "-fdata-sections")
_LINK = ("-Wl,--gc-sections",)
_APART = ("-fno-inline-functions-called-once", "-fno-inline-small-functions", "-fno-ipa-sra")
_ATMEGA = ("-mmcu=atmega328p", *_SMALL, *_LINK)
_CORTEX = (
    *("-mcpu=cortex-m0", "-mthumb", *_SMALL, *_LINK, "-nostartfiles", "-specs=nano.specs"),
    f"-Wl,-T,{FOLDER / 'harness' / 'cortex_m0.ld'}",
)
ORDINARY = "ordinary"
LTO = "lto"
BUILDS = (ORDINARY, LTO)
"""Each source compiled by itself, and all of them together when they are linked."""
AVR = {
    ORDINARY: Toolchain("ATmega328P", "avr-", _ATMEGA),
    LTO: Toolchain("ATmega328P", "avr-", (*_ATMEGA, "-flto")),
}
AVR_APART = Toolchain("ATmega328P", "avr-", (*_ATMEGA, *_APART))
ARM = {
    ORDINARY: Toolchain("Cortex-M0", "arm-none-eabi-", _CORTEX),
    LTO: Toolchain("Cortex-M0", "arm-none-eabi-", (*_CORTEX, "-flto")),
}
HOST = Toolchain("host", "", ("-std=gnu99", "-w", "-O2"), "cc")
