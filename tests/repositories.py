"""Support for tests of versions: schemas that differ, git, and commands in its repositories."""

from __future__ import annotations

import os
import subprocess
import tempfile
from contextlib import chdir
from pathlib import Path

from cli_support import PATIENCE, run
from typer.testing import Result

OLD = """\
protocol: demo
endpoints: {board: Sensor board}
byte_order: little
frame:
  start:   {literal: 0xAA}
  kind:    {type: uint8, id: true}
  payload: {}
  crc:     {type: uint16, algorithm: CRC-16/KERMIT, covers: [kind, payload]}
transparency:
  covers: kind..crc
  escape: {byte: 0xAB, of: [0xAA, 0xAB], transform: {xor: 0x20}}
messages:
  reading: {id: 1, from: board, fields: {value: {type: uint16, unit: mm}}}
  ping: {id: 3, from: board, fields: {number: uint8}}
"""
GONE = OLD[: OLD.index("  ping:")]
SECOND = OLD.replace("protocol: demo", "protocol: second")
TEMPORARY = Path(tempfile.gettempdir()).resolve()


def protogen(folder: Path, *arguments: str) -> Result:
    # What the tests run in may be a git repository; only a scratch one counts.
    with chdir(folder):
        return run(*arguments, NO_COLOR="1", GIT_CEILING_DIRECTORIES=str(TEMPORARY))


def answer(folder: Path, *arguments: str, code: int) -> str:
    done = protogen(folder, *arguments)
    output = done.stdout
    assert done.exit_code == code, f"{output}\n{done.stderr}"
    return output


def complaint(folder: Path, *arguments: str, code: int = 2) -> str:
    done = protogen(folder, *arguments)
    assert done.exit_code == code, done.stdout
    assert "Traceback" not in done.stderr
    return done.stderr


def git(folder: Path, *arguments: str, fails: bool = False) -> str:
    names = {"GIT_AUTHOR_NAME": "T", "GIT_AUTHOR_EMAIL": "t@example.org"}
    names |= {"GIT_COMMITTER_NAME": "T", "GIT_COMMITTER_EMAIL": "t@example.org"}
    nowhere = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull}
    done = subprocess.run(
        ["git", *arguments],
        cwd=folder,
        env={**os.environ, **names, **nowhere},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert (done.returncode != 0) == fails, done.stdout + done.stderr
    return done.stdout
