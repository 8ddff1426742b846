"""Runs Frama-C, whichever analysis is asked for."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Sequence

from tooling import require_tool


def run_frama_c(arguments: Sequence[str], **variables: str) -> tuple[int, str]:
    """Run it with some environment variables; returns its status, and all that it says."""
    command = [require_tool("frama-c"), *arguments]
    room = {**os.environ, **variables}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=room)
    return done.returncode, done.stdout + done.stderr
