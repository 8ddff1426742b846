"""Support for tests of the command line: a schema with everything, and ways to run commands."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from typer import testing
from typer.main import get_command
from typer.testing import CliRunner, Result

from protogen.cli import app
from protogen.compiler import compile_file
from protogen.model.protocol import Protocol

ROOT = Path(__file__).resolve().parent.parent

PATIENCE = 300.0
"""Seconds after which a process is said to hang: on a busy machine, one second takes a minute."""

SINK = """\
protocol: sink
title: One of everything
link: {baud: 9600}
endpoints: {pc: Computer, board: The board}
byte_order: big
frame:
  sync: {literal: {hex: 1B 02}}
  kind: {type: char, id: true}
  number: {type: uint8, default: 0xFF}
  length: {type: uint8, counts: payload}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: kind..payload}
  end: {literal: {hex: 1B 03}}
transparency:
  covers: kind..check
  substitute: {0x1B: [0x1B, 0x00], 0x7C: [0x7C, 0x1B, 0x01]}
messages:
  numbers:
    id: N
    from: [pc, board]
    fields:
      mode: {type: uint8, values: {idle: 0, run: 7}, default: 0}
      strict_mode: {type: uint8, values: {low: 1, high: 2}, closed: true, default: 1}
      angle:
        {type: sint16, scale: 1/16, unit: deg, range: [-2880, 2880], special: {missing: 0x7FFF}}
      flags: {type: uint8, flags: {ready: 0, hot: 1, wet: 7}, default: 0}
      control: {type: uint8, bits: {speed: 0..5, gear: {bits: 6..7, values: {first: 1, rear: 3}}}}
      letter: {type: char, default: A}
      on_line: {type: bool, default: false}
      ratio: {type: float32, scale: 1/2, unit: V, default: 0.0}
      odd: {type: uint24, byte_order: little, const: 0x010203}
  lists:
    id: L
    from: pc
    fields:
      points: {count: 2, fields: {x: sint8, y: {type: uint8, unit: mm}}}
      size: {type: uint8, range: [0, 3]}
      levels: {type: uint16, count: size}
      name: {type: ascii, size: 4}
      rest: {type: bytes, size: {fill: true, max: 8}}
  choice:
    id: C
    from: board
    fields:
      what: {type: uint8, values: {nothing: 0, speed: 1, word: 2}}
      value:
        switch: what
        cases:
          nothing: {fields: {}}
          speed: {type: uint16}
          word: {fields: {text: {type: ascii, size: 3}, more: uint8}}
  empty: {id: E, from: pc}
"""


@cache
def compiled(text: str) -> Protocol:
    """Compile the text of a schema."""
    with TemporaryDirectory() as folder:
        path = Path(folder, "sink.yaml")
        path.write_text(text)
        compilation = compile_file(path)
    assert compilation.protocol is not None, compilation.problems
    return compilation.protocol


# To make the commands of all functions takes longer than most of them run.
testing._get_command = cache(get_command)


def run(*arguments: str, input: str | bytes | None = None, **environment: str) -> Result:
    """Run a command inside of this process."""
    return CliRunner().invoke(app, list(arguments), input=input, env=environment)


def start(
    *arguments: str, input: bytes = b"", cwd: Path = ROOT, **environment: str
) -> subprocess.CompletedProcess[bytes]:
    """Run a command as a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "protogen", *arguments],
        input=input,
        capture_output=True,
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        timeout=PATIENCE,
        check=False,
    )
