"""Runs Frama-C, whichever analysis is asked for."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Sequence

from tooling import require_tool

_ROOM = "s=4M,o=400"
"""Words that are taken before garbage is collected, and a share of it that may stay: a fifth of the
time would go into that."""


def run_frama_c(arguments: Sequence[str], **variables: str) -> tuple[int, str]:
    """Run it with some environment variables; returns its status, and all that it says."""
    command = [require_tool("frama-c"), *arguments]
    environment = {**os.environ, "OCAMLRUNPARAM": _ROOM, **variables}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    return done.returncode, done.stdout + done.stderr
