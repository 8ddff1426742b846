"""Runs Frama-C's WP with Z3, and reads what it says."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tooling import require_tool

from c_proof.frama_c import run_frama_c

_WHY3 = """[main]
magic = 14
memlimit = 2000
running_provers_max = 4
timelimit = 20

[partial_prover]
name = "Z3"
path = "{z3}"
version = "{version}"
"""
"""What `why3 config detect` writes, but in a folder of its own."""
_READ = (
    "-no-autoload-plugins",
    "-load-module=wp,rtegen",
    "-machdep=gcc_x86_64",
    "-simplify-cfg",
    "-rte",
)
"""Without `switch`, WP follows where variables begin and end."""
_PROVE = ("-wp", "-wp-cache=none", "-wp-par=4", "-wp-prover=z3")
"""Four goals at once: WP looks now and then whether one is proved, and most take less than that."""
_GOALS = re.compile(r"Proved goals: +(\d+) / (\d+)")
_GOAL = re.compile(r"Goal (\S+) : (?!Valid)")


@dataclass(frozen=True)
class Proof:
    """What WP says of the functions that it was given."""

    goals: int
    failed: tuple[str, ...]
    """Goals that are not proved, by name."""
    log: str


def prove_contracts(
    source: Path,
    functions: Sequence[str],
    folder: Path,
    *,
    safe: Sequence[str],
    patience: int,
    named: str = "",
) -> Proof:
    """Prove the contracts of some functions of a file; and that safe ones do nothing undefined.

    `patience` is for each goal, in seconds. Only clauses that are `named` so are proved, if any.
    """
    z3 = require_tool("z3")
    require_tool("why3")
    said = subprocess.run([z3, "--version"], capture_output=True, text=True, check=True).stdout
    [version] = re.findall(r"\d+\.[\d.]+", said)
    config = folder / "why3.conf"
    config.write_text(_WHY3.format(z3=z3, version=version), encoding="utf-8")
    arguments = [*_READ, f"-cpp-extra-args=-I{folder}", f"-rte-select={','.join(safe)}"]
    arguments += [str(source), "-then", *_PROVE, f"-wp-timeout={patience}"]
    arguments += [f"-wp-fct={','.join(functions)}", *([f"-wp-prop={named}"] if named else [])]
    status, log = run_frama_c(arguments, WHY3CONFIG=str(config))
    assert status == 0, log[-4000:]
    [counts] = _GOALS.findall(log)
    failed = tuple(_GOAL.findall(log))
    assert int(counts[1]) - int(counts[0]) == len(failed), log[-4000:]
    return Proof(int(counts[1]), failed, log)
