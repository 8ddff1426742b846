"""Time of `protogen generate`, beside two other generators with equivalent definitions.

    python benchmarks/bench_generate.py            # writes benchmarks/generate.md
    python benchmarks/bench_generate.py --runs 3   # fewer runs

pymavlink and the npm package kaitai-struct-compiler are installed into `.cache/bench` by the first
run. A tool that can't be installed has empty cells.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import NamedTuple

from protogen.version import VERSION

ROOT = Path(__file__).resolve().parent.parent
RESULT = ROOT / "benchmarks" / "generate.md"
CACHE = ROOT / ".cache" / "bench"

SIZES = (10, 100, 1000)
"""Numbers of messages of the synthetic definitions."""

LARGEST = 10_000
"""Messages of the largest one, which only protogen is given, for all targets and for C."""

PROJECT = 100
"""Schemas of a project that is generated again without a change."""

# --- one definition in three languages ------------------------------------------------------------


class Numeric(NamedTuple):
    """A field of every synthetic message, in the words of each language."""

    name: str
    protogen: str
    mavlink: str
    kaitai: str
    unit: str
    doc: str


FIELDS = (
    Numeric("time", "uint32", "uint32_t", "u4", "ms", "Time since the start"),
    Numeric("latitude", "sint32", "int32_t", "s4", "deg", "Latitude in ten-millionths of a degree"),
    Numeric("speed", "sint16", "int16_t", "s2", "mm/s", "Speed over ground"),
    Numeric("voltage", "uint16", "uint16_t", "u2", "mV", "Voltage of the battery"),
    Numeric("heading", "float32", "float", "f4", "rad", "Heading, north is 0"),
)
"""Beside these, each message has a mode with four names, and four bytes of ranges."""

MODES = ("idle", "remote", "autonomous", "failed")


def protogen_yaml(messages: int) -> str:
    """Return a schema with so many messages."""
    head = """\
protocol: synthetic
title: Synthetic protocol
endpoints: {board: Board}
byte_order: little
frame:
  sync: {literal: 0xFD, unprotected: resync}
  number: {type: uint16, id: true}
  length: {type: uint16, counts: payload}
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/MCRF4XX, covers: number..payload}
decisions:
  resync: {question: Can FD occur inside?, document: Silent., choice: Yes., because: CRC.}
messages:
"""
    return head + "".join(map(_protogen_message, range(messages)))


def _protogen_message(number: int) -> str:
    values = ", ".join(f"{name}: {value}" for value, name in enumerate(MODES))
    lines = [
        f"  message{number}:",
        f"    id: {number}",
        "    from: board",
        f"    summary: Readings of sensor {number}",
        "    fields:",
        *(
            f"      {item.name}: {{type: {item.protogen}, unit: {item.unit}, doc: '{item.doc}'}}"
            for item in FIELDS
        ),
        f"      mode: {{type: uint8, values: {{{values}}}, doc: Mode of the sensor}}",
        "      ranges: {type: uint8, count: 4, doc: Distances}",
    ]
    return "\n".join(lines) + "\n"


def mavlink_xml(messages: int) -> str:
    """Return a MAVLink dialect with so many messages."""
    enums = "".join(map(_mavlink_enum, range(messages)))
    body = "".join(map(_mavlink_message, range(messages)))
    head = '<?xml version="1.0"?>\n<mavlink>\n<version>3</version>\n<dialect>0</dialect>\n'
    return f"{head}<enums>\n{enums}</enums>\n<messages>\n{body}</messages>\n</mavlink>\n"


def _mavlink_enum(number: int) -> str:
    entries = "".join(
        f'<entry value="{value}" name="MODE{number}_{name.upper()}"/>\n'
        for value, name in enumerate(MODES)
    )
    return f'<enum name="MODE{number}">\n{entries}</enum>\n'


def _mavlink_message(number: int) -> str:
    fields = "".join(
        f'<field type="{item.mavlink}" name="{item.name}" units="{item.unit}">{item.doc}</field>\n'
        for item in FIELDS
    )
    rest = (
        f'<field type="uint8_t" name="mode" enum="MODE{number}">Mode of the sensor</field>\n'
        '<field type="uint8_t[4]" name="ranges">Distances</field>\n'
    )
    about = f"<description>Readings of sensor {number}</description>\n"
    return f'<message id="{number}" name="MESSAGE{number}">\n{about}{fields}{rest}</message>\n'


def kaitai_ksy(messages: int) -> str:
    """Return a Kaitai Struct definition with so many messages."""
    cases = "".join(f"        {number}: message{number}\n" for number in range(messages))
    types = "".join(map(_kaitai_type, range(messages)))
    enums = "".join(map(_kaitai_enum, range(messages)))
    head = """\
meta: {id: synthetic, endian: le}
seq:
  - {id: sync, contents: [0xFD]}
  - {id: number, type: u2}
  - {id: len_payload, type: u2}
  - id: payload
    size: len_payload
    type:
      switch-on: number
      cases:
"""
    return f"{head}{cases}  - {{id: crc, type: u2}}\ntypes:\n{types}enums:\n{enums}"


def _kaitai_type(number: int) -> str:
    lines = [
        f"  message{number}:",
        f"    doc: Readings of sensor {number}",
        "    seq:",
        *(
            f"      - {{id: {field.name}, type: {field.kaitai}, doc: '{field.doc}'}}"
            for field in FIELDS
        ),
        f"      - {{id: mode, type: u1, enum: mode{number}, doc: Mode of the sensor}}",
        "      - {id: ranges, type: u1, repeat: expr, repeat-expr: 4, doc: Distances}",
    ]
    return "\n".join(lines) + "\n"


def _kaitai_enum(number: int) -> str:
    values = ", ".join(f"{value}: {name}" for value, name in enumerate(MODES))
    return f"  mode{number}: {{{values}}}\n"


# --- the tools ------------------------------------------------------------------------------------

Command = Callable[[Path, Path], list[str]]
"""The command line that makes files of a definition in a folder."""


@dataclass(frozen=True, slots=True)
class Tool:
    """A generator; ``command`` is None where it could not be installed."""

    title: str
    makes: str
    suffix: str
    definition: Callable[[int], str]
    command: Command | None
    sizes: tuple[int, ...] = SIZES


def _protogen(definition: Path, folder: Path, *options: str) -> list[str]:
    command = [sys.executable, "-m", "protogen", "generate", str(definition)]
    return [*command, "-o", str(folder), "--quiet", *options]


def _tools() -> list[Tool]:
    more = (*SIZES, LARGEST)
    return [
        Tool("protogen", "Python, C and Markdown", ".yaml", protogen_yaml, _protogen, more),
        Tool("protogen", "C", ".yaml", protogen_yaml, _only("c"), more),
        Tool("protogen", "Python", ".yaml", protogen_yaml, _only("python")),
        Tool("mavgen", "Python", ".xml", mavlink_xml, _mavgen()),
        Tool("Kaitai Struct", "Python", ".ksy", kaitai_ksy, kaitai()),
    ]


def _only(target: str) -> Command:
    return lambda definition, folder: _protogen(definition, folder, "--target", target)


def _mavgen() -> Command | None:
    python = CACHE / "venv" / "bin" / "python"
    if not python.exists():
        _succeeds([sys.executable, "-m", "venv", str(CACHE / "venv")])
    if not _succeeds([str(python), "-c", "import pymavlink"]):
        _succeeds([str(python), "-m", "pip", "install", "--quiet", "pymavlink"])
    if not _succeeds([str(python), "-c", "import pymavlink"]):
        return None
    module = [str(python), "-m", "pymavlink.tools.mavgen", "--lang=Python", "--wire-protocol=2.0"]
    return lambda definition, folder: [*module, "-o", str(folder / "made.py"), str(definition)]


def kaitai() -> Command | None:
    packages = ["kaitai-struct-compiler", "js-yaml"]
    folders = [CACHE / "node_modules" / name for name in packages]
    if not all(folder.exists() for folder in folders):
        options = ["--no-audit", "--no-fund", "--no-package-lock", "--prefix", str(CACHE)]
        _succeeds(["npm", "install", *options, *packages])
    if not all(folder.exists() for folder in folders):
        return None
    script = CACHE / "kaitai.js"
    script.write_text(_KAITAI_SCRIPT, encoding="utf-8")
    return lambda definition, folder: ["node", str(script), str(definition), str(folder)]


_KAITAI_SCRIPT = """\
// The npm package is a library: this is the least command around it.
const fs = require('fs'), path = require('path'), yaml = require('js-yaml');
const compiler = require('kaitai-struct-compiler');
const [definition, folder] = process.argv.slice(2);
const parsed = yaml.load(fs.readFileSync(definition, 'utf8'));
compiler.compile('python', parsed, null, false).then(files => {
  for (const [name, text] of Object.entries(files)) fs.writeFileSync(path.join(folder, name), text);
}).catch(error => { console.error(String(error)); process.exit(1); });
"""


def _succeeds(command: Sequence[str]) -> bool:
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        return False


# --- measuring ------------------------------------------------------------------------------------


class Timing(NamedTuple):
    """Medians of several runs, in seconds."""

    wall: float
    cpu: float
    """User and system time of the process."""


def _measure(
    command: Callable[[Path], list[str]], runs: int, cwd: Path = ROOT, *, warm: bool = True
) -> Timing:
    """Run a command, each time with a new folder for what it writes.

    With `warm`, a first run, which fills caches, does not count.
    """
    if warm:
        _run(command, cwd)
    timings = [_run(command, cwd) for _ in range(runs)]
    return Timing(*(median(column) for column in zip(*timings, strict=True)))


def _runs_of(size: int, runs: int) -> int:
    """Return how often a definition with so many messages is taken: large ones vary less."""
    return max(1, min(runs, 3 * SIZES[-1] // size))


def _run(command: Callable[[Path], list[str]], cwd: Path) -> Timing:
    with tempfile.TemporaryDirectory() as folder:
        argv = command(Path(folder))
        with tempfile.TemporaryFile() as output:
            start = time.perf_counter()
            process = subprocess.Popen(
                argv, cwd=cwd, env=_environment(), stdout=output, stderr=subprocess.STDOUT
            )
            _, status, usage = os.wait4(process.pid, 0)
            wall = time.perf_counter() - start
            process.returncode = os.waitstatus_to_exitcode(status)
            if process.returncode:
                output.seek(0)
                raise SystemExit(f"{argv[0]} failed:\n{output.read().decode()}")
    return Timing(wall, usage.ru_utime + usage.ru_stime)


def _measure_no_op(runs: int) -> Timing:
    """Run `protogen generate` in a project of which nothing has changed since the last run."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "protogen.toml").write_text('schemas = ["*.yaml"]\n', encoding="utf-8")
        for number in range(PROJECT):
            text = protogen_yaml(SIZES[0]).replace("synthetic", f"synthetic{number}")
            (folder / f"synthetic{number}.yaml").write_text(text, encoding="utf-8")
        argv = [sys.executable, "-m", "protogen", "generate"]
        return _measure(lambda _: argv, runs, folder)


def _environment() -> dict[str, str]:
    """Return an environment in which Python keeps its bytecode, as it does for its users."""
    kept = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    return {**kept, "PYTHONPYCACHEPREFIX": str(CACHE / "bytecode"), "PYTHONPATH": str(ROOT)}


def _measure_tool(tool: Tool, size: int, runs: int) -> Timing | None:
    command = tool.command
    if command is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        definition = Path(folder, f"synthetic{tool.suffix}")
        definition.write_text(tool.definition(size), encoding="utf-8")
        few = _runs_of(size, runs)
        return _measure(lambda output: command(definition, output), few, warm=size < LARGEST)


def _own_commands() -> dict[str, Callable[[Path], list[str]]]:
    python = [sys.executable, "-m", "protogen"]
    return {
        "protogen --help": lambda folder: [*python, "--help"],
        "protogen check schemas": lambda folder: [*python, "check", "schemas"],
        "protogen generate schemas": lambda folder: [
            *(*python, "generate", "schemas"),
            *("--output", str(folder)),
        ],
    }


# --- the page -------------------------------------------------------------------------------------


def _page(own: Iterable[str], tools: Iterable[str], versions: str, runs: int) -> str:
    return _PAGE.format(own="\n".join(own), tools="\n".join(tools), versions=versions, runs=runs)


_PAGE = """\
# How long generation takes

<!-- Written by benchmarks/bench_generate.py, do not edit. -->

Made by `python benchmarks/bench_generate.py --runs {runs}`: medians of {runs} runs, but at most 3
with 1,000 messages and one with 10,000. Each run is a process of its own, so start-up is included.
One more run, which fills caches of bytecode, does not count. CPU is the process's user and system
time. Wall time also holds what other processes on the machine took.

The aims: `--help` in under 0.2 s, all schemas of the project in under 1 s, 1,000 messages for all
targets in under 2.5 s and 10,000 in under 20 s. A run that has nothing to do: under 0.5 s with 100
schemas.

{versions}

## This project's schemas

`generate` writes all files into an empty folder.

| command | CPU s | wall s |
| --- | ---: | ---: |
{own}

## Synthetic definitions

The script makes the same messages for each tool: five numbers with unit and text, an enum of four
names, and an array of four bytes. Mind what each of them makes: mavgen and Kaitai Struct print
Python only, and Kaitai Struct's Python, as made here, reads and does not write.

| tool | makes | messages | CPU s | wall s | CPU ms for one more message |
| --- | --- | ---: | ---: | ---: | ---: |
{tools}
"""


def _tool_rows(tool: Tool, timings: Sequence[Timing | None]) -> Iterable[str]:
    before: tuple[int, Timing] | None = None
    for size, timing in zip(tool.sizes, timings, strict=True):
        cells = f"| {tool.title} | {tool.makes} | {size:,} |"
        if timing is None:
            yield f"{cells} | | |"
            continue
        slope = ""
        if before is not None:
            slope = f"{(timing.cpu - before[1].cpu) / (size - before[0]) * 1000:.2f}"
        before = (size, timing)
        yield f"{cells} {timing.cpu:.2f} | {timing.wall:.2f} | {slope} |"


def _versions() -> str:
    python = str(CACHE / "venv" / "bin" / "python")
    pymavlink = _output([python, "-c", "import pymavlink; print(pymavlink.__version__)"])
    kaitai = _output(["node", "-p", "require('./node_modules/kaitai-struct-compiler').version"])
    return (
        f"protogen {VERSION} and mavgen of pymavlink {pymavlink} on Python "
        f"{platform.python_version()}.\nKaitai Struct {kaitai} of npm on Node.js "
        f"{_output(['node', '--version'])}. {os.cpu_count()} CPUs."
    )


def _output(command: Sequence[str]) -> str:
    try:
        done = subprocess.run(command, cwd=CACHE, capture_output=True, text=True, check=False)
    except OSError:
        return "not installed"
    return done.stdout.strip() if done.returncode == 0 else "not installed"


def main() -> None:
    parser = argparse.ArgumentParser(description="Measure generation, write benchmarks/generate.md")
    parser.add_argument("--runs", type=int, default=7, help="runs of each command (7)")
    runs: int = parser.parse_args().runs
    CACHE.mkdir(parents=True, exist_ok=True)
    tools = _tools()
    own = []
    for title, command in _own_commands().items():
        timing = _measure(command, runs)
        own.append(f"| `{title}` | {timing.cpu:.2f} | {timing.wall:.2f} |")
    timing = _measure_no_op(runs)
    title = f"`protogen generate`, {PROJECT} schemas of {SIZES[0]} messages, unchanged"
    own.append(f"| {title} | {timing.cpu:.2f} | {timing.wall:.2f} |")
    rows = [
        row
        for tool in tools
        for row in _tool_rows(tool, [_measure_tool(tool, size, runs) for size in tool.sizes])
    ]
    page = _page(own, rows, _versions(), runs)
    RESULT.write_text(page, encoding="utf-8")
    print(page)


if __name__ == "__main__":
    main()
