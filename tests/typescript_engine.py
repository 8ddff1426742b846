"""Generated TypeScript in a process of node, and what Python says to the same."""

from __future__ import annotations

import atexit
import json
import math
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from compiled import ROOT, protocol_of
from tooling import PATIENCE, require_tool, unavailable

from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConstantStep,
    FloatStep,
    IntegerStep,
    OptionalStep,
    RecordStep,
    RegionStep,
    RepeatStep,
    RestStep,
)
from protogen.model.payload_walks import said
from protogen.model.protocol import Protocol
from protogen.model.types import Octets
from protogen.targets.output import File
from protogen.targets.typescript.emit import codecs, emit
from protogen.targets.typescript.names import names_of

DRIVER = Path(__file__).with_name("typescript") / "driver.mjs"
TOOLS = ROOT / ".cache" / "typescript" / "node_modules"
"""Where npm puts what `tests/typescript/package.json` names."""
Steps = Sequence[bytes | None]
"""Bytes that come in, or None for a silence."""


def require_npm(name: str) -> Path:
    """Path of a program that npm installed; without it, skip the test or fail."""
    found = TOOLS / ".bin" / name
    if not found.exists():
        unavailable(f"{name} is not in .cache/typescript, where npm has to install it")
    return found


def run_tool(name: str, *arguments: str | Path, folder: Path) -> str:
    """What a program of npm prints, which has to find nothing wrong."""
    command = [require_npm(name), *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def programs() -> list[str | Path]:
    """The system's node, and that of npm: the oldest one that its makers maintain."""
    return [require_tool("node"), require_npm("node")]


def run_node(program: str | Path, *arguments: str | Path) -> str:
    """What a program in node prints."""
    command = [program, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=PATIENCE)
    assert done.returncode == 0, done.stderr
    return done.stdout


class Node:
    """A process of each node, which take requests one by one and have to give the same answers."""

    def __init__(self) -> None:
        self._processes = [
            subprocess.Popen(
                [program, DRIVER],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
                encoding="utf-8",
            )
            for program in programs()
        ]
        for process in self._processes:
            atexit.register(process.kill)

    def ask(self, module: Path, **request: Any) -> Any:
        """The answer to a request about a module."""
        text = json.dumps({"module": str(module), **request}) + "\n"
        for process in self._processes:
            assert process.stdin is not None
            process.stdin.write(text)
            process.stdin.flush()
        first, *others = map(_line, self._processes)
        assert others == [first] * len(others), "versions of node differ"
        answer = json.loads(first)
        assert "error" not in answer, answer["error"]
        return answer["answer"]


def _line(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    return process.stdout.readline()


@cache
def node() -> Node:
    """The processes of these tests."""
    return Node()


@cache
def modules() -> Path:
    """The folder of all modules that were printed here."""
    made = TemporaryDirectory(prefix="protogen-typescript-")
    atexit.register(made.cleanup)
    return Path(made.name)


def write_package(protocols: Sequence[Protocol], folder: Path) -> None:
    """Write a package."""
    _write(emit(protocols), folder)


def _write(files: Iterable[File], folder: Path) -> None:
    for file in files:
        path = folder / file.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(file.bytes)


def module_of(protocol: Protocol) -> Path:
    """The JavaScript of a protocol, printed now."""
    folder = modules() / protocol.spec_hash / protocol.name
    if not folder.exists():
        _write(codecs([protocol]), folder)
    return folder / "dist" / f"{names_of(protocol).file}.js"


@cache
def module_at(path: Path) -> Path:
    """The JavaScript of a schema."""
    return module_of(protocol_of(path))


def events(module: Path, sender: str | None, steps: Steps, **more: Any) -> list[list[Any]]:
    """The events of each step, as JSON lines have them."""
    given = [None if step is None else step.hex() for step in steps]
    found = node().ask(module, sender=sender, steps=given, **more)
    return [[json.loads(line) for line in lines] for lines in found]


def python_events(
    module: Any, sender: str | None, steps: Steps, told: Mapping[str, Any] | None = None
) -> list[list[Any]]:
    """What Python says to the same."""
    decoder = module.Decoder(sender=sender)
    if told:
        decoder.tell(**told)
    found = (decoder.flush() if step is None else decoder.feed(step) for step in steps)
    return [[json.loads(json.dumps(event.as_json())) for event in events] for events in found]


def first_difference(found: Iterable[Any], expected: Iterable[Any]) -> str:
    """The first step, and the first event in it, that differ; empty where none does."""
    for number, (one, other) in enumerate(zip(found, expected, strict=True)):
        for item, due in zip(one, other, strict=False):
            if not same(item, due):
                return f"step {number}: TypeScript has\n{item},\nPython\n{due}"
        if len(one) != len(other):
            return f"step {number}: TypeScript has {one}, Python {other}"
    return ""


def same(one: Any, other: Any) -> bool:
    """True if values of JSON are equal; zeros have signs, and truth values are no numbers."""
    if isinstance(one, dict) and isinstance(other, dict):
        return list(one) == list(other) and all(same(one[key], other[key]) for key in one)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, bool) or isinstance(other, bool):
        return one is other
    if isinstance(one, float) and isinstance(other, float):
        return one == other and math.copysign(1, one) == math.copysign(1, other)
    return one == other


# --- values in requests ---------------------------------------------------------------------------


def message_of(protocol: Protocol, name: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """A message for a request: values of a JSON line, with marks where JSON says too little."""
    record = protocol.message(name)
    return {"message": name, **_record(protocol, name, record.plan.steps, values, ())}


def _record(
    protocol: Protocol,
    name: str,
    steps: Iterable[AnyStep],
    values: Mapping[str, Any],
    around: tuple[Mapping[str, Any], ...],
) -> dict[str, Any]:
    members, records = names_of(protocol).records[name].fields, (*around, values)
    return {
        members[step.name]: _value(protocol, step, records, values[step.name])
        for step in steps
        if step.name in values
    }


def _value(
    protocol: Protocol, step: AnyStep | RestStep, records: tuple[Mapping[str, Any], ...], value: Any
) -> Any:
    if value is None or isinstance(value, bool):
        return value
    match step:
        case OptionalStep() | RegionStep():
            return _value(protocol, step.step, records, value)
        case ConstantStep():
            return _value(protocol, step.value, records, value)
        case RepeatStep():
            return [_value(protocol, step.element, records, item) for item in value]
        case RecordStep():
            return _record(protocol, step.type.name, step.steps, value, records)
        case ChooseStep():
            chosen = step.case(said(step.selector, records))
            assert chosen is not None
            return _value(protocol, chosen, records, value)
    return _plain(step, value)


def _plain(step: AnyStep | RestStep, value: Any) -> Any:
    """A single value."""
    match step:
        case IntegerStep() if step.type.bits > 53:
            return {"$big": str(value)}
        case FloatStep() if isinstance(value, str):
            return {"$float": {"nan": "NaN", "inf": "Infinity", "-inf": "-Infinity"}[value]}
        case RestStep():
            return {"$bytes": value}
        case BytesStep() if isinstance(step.type, Octets):
            return {"$bytes": value}
    return value
