"""Compilers beside those of test_c_lint.py take what is generated, and say nothing.

What SDCC says for STM8 and 8051 is asked by test_c_machines.py, which runs what it makes.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from compiled import DOCUMENTS, ROOT, name_of
from tooling import require_tool

GENERATED = ROOT / "generated" / "c"
STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wsign-conversion", "-Werror")
FREESTANDING = {
    "gnu99": ("gcc", "-std=gnu99", "-O2", *STRICT),
    "freestanding": ("gcc", "-std=c99", "-ffreestanding", "-O2", *STRICT),
    "tcc": ("tcc", "-std=c99", "-Wall", "-Werror"),
    "riscv32": (
        *("riscv64-unknown-elf-gcc", "-march=rv32imac", "-mabi=ilp32"),
        *("-std=c99", "-ffreestanding", "-Os", *STRICT),
    ),
}
_OPTIMISES = "110"
"""SDCC's remark that it left out a jump of its own; it says so of any code."""


def said(command: list[str], folder: Path) -> str:
    """Output of a compiler, which has to succeed."""
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.mark.parametrize("name", FREESTANDING)
@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_no_compiler_warns(path: Path, name: str, tmp_path: Path) -> None:
    compiler, *flags = FREESTANDING[name]
    source = GENERATED / f"{path.stem}.c"
    assert said([require_tool(compiler), *flags, "-c", "-o", "unit.o", str(source)], tmp_path) == ""


def test_sdcc_warns_of_nothing_for_a_z80(tmp_path: Path) -> None:
    flags = ["-mz80", "--max-allocs-per-node", "200", "--std-c99", "--disable-warning", _OPTIMISES]
    command = [require_tool("sdcc"), *flags, "-c", str(GENERATED / "uherobot.c"), "-o", "unit.rel"]
    assert said(command, tmp_path) == ""
