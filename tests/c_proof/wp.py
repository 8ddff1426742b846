"""Runs Frama-C's WP with Z3, and reads what it says."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tooling import require_tool

_WHY3 = """[main]
magic = 14
memlimit = 2000
running_provers_max = 1
timelimit = 20

[partial_prover]
name = "Z3"
path = "{z3}"
version = "{version}"
"""
"""What `why3 config detect` writes, but in a folder of its own."""
_OPTIONS = (
    "-no-autoload-plugins",
    "-load-module=wp,rtegen",
    "-wp",
    "-wp-cache=none",
    "-wp-par=1",
    "-wp-timeout=20",
    "-wp-prover=z3",
)
_GOALS = re.compile(r"Proved goals: +(\d+) / (\d+)")
_GOAL = re.compile(r"Goal (\S+) : (?!Valid)")
_RISK = re.compile(r"Warning: [^\n]*(?:[Cc]ast|Missing|skipped|ignored)[^\n]*")


@dataclass(frozen=True)
class Proof:
    """What WP says of the functions that it was given."""

    goals: int
    failed: tuple[str, ...]
    """Goals that are not proved, by name."""
    doubts: tuple[str, ...]
    """Warnings by which a proof might say less than it seems to."""
    log: str


def prove_contracts(
    source: Path, functions: Sequence[str], folder: Path, *, safe: Sequence[str] = ()
) -> Proof:
    """Prove the contracts of some functions of a file.

    Those that are `safe` must not access memory out of bounds or overflow either.
    """
    frama_c, z3 = require_tool("frama-c"), require_tool("z3")
    require_tool("why3")
    version = re.findall(r"\d+\.[\d.]+", subprocess.check_output([z3, "--version"], text=True))[0]
    config = folder / "why3.conf"
    config.write_text(_WHY3.format(z3=z3, version=version), encoding="utf-8")
    command = [frama_c, *_OPTIONS, f"-wp-fct={','.join(functions)}"]
    if safe:
        command = [frama_c, "-no-autoload-plugins", "-load-module=wp,rtegen", "-rte"]
        command += [f"-rte-select={','.join(safe)}", f"-cpp-extra-args=-I{folder}", str(source)]
        command += ["-then", *_OPTIONS[2:], f"-wp-fct={','.join(functions)}"]
    else:
        command += [f"-cpp-extra-args=-I{folder}", str(source)]
    room = {**os.environ, "WHY3CONFIG": str(config)}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=room)
    log = done.stdout + done.stderr
    assert done.returncode == 0, log[-4000:]
    [counts] = _GOALS.findall(log)
    failed = tuple(_GOAL.findall(log))
    assert int(counts[1]) - int(counts[0]) == len(failed), log[-4000:]
    return Proof(int(counts[1]), failed, tuple(_RISK.findall(log)), log)
