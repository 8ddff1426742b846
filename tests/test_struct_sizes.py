"""The sizes of C structs that reference pages state, held against compilers."""

from __future__ import annotations

import ctypes
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from c_library import write_sources
from c_structs import structure_of
from compiled import ROOT, SCHEMAS, name_of, protocol_of
from hypothesis import HealthCheck, given, settings
from markdown_pages import page
from models import UINT8, message, protocol
from schema_fuzzing import Schema, schemas
from schema_fuzzing.text import to_yaml
from tooling import require_tool

from protogen.capture.layout import struct_sizes
from protogen.compiler import compile_file
from protogen.model.protocol import Protocol
from protogen.targets.c.emit import unit_of
from protogen.targets.c.options import COptions

SAMPLERS = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))
STATED = re.compile(
    r'^### <a id="message-(?P<name>\w+)"></a>'
    r"(?:(?!^###).)* · C struct (?P<natural>\d+) bytes?(?: \((?P<small>\d+) on AVR\))?(?: · |$)",
    re.MULTILINE | re.DOTALL,
)
MACHINES = {
    "x86-64": ("cc",),
    "x86-64 by clang": ("clang",),
    "cortex-m0": ("arm-none-eabi-gcc", "-mcpu=cortex-m0", "-mthumb"),
    "atmega328p": ("avr-gcc", "-mmcu=atmega328p"),
}
ASSERT = "typedef char check_{name}[sizeof({struct}) == {size}u ? 1 : -1];"


@pytest.mark.parametrize("path", [*SCHEMAS, *SAMPLERS], ids=name_of)
@pytest.mark.parametrize("machine", MACHINES)
def test_a_page_states_what_a_compiler_takes(machine: str, path: Path, tmp_path: Path) -> None:
    made = protocol_of(path)
    found = dict(stated(made, small=machine == "atmega328p"))
    kept = [item.name for item in made.messages if item.plan.holds_values]
    assert list(found) == kept
    write_sources(made, tmp_path, payloads_only=True)
    checks = [
        ASSERT.format(name=item.name, struct=item.struct, size=found[item.name])
        for item in unit_of(made, COptions()).module.messages
        if item.struct
    ]
    (tmp_path / "sizes.c").write_text("\n".join([f'#include "{made.name}.h"', *checks, ""]))
    compiler, *flags = MACHINES[machine]
    command = [require_tool(compiler), *flags, "-std=c99", "-c", "sizes.c", "-o", "sizes.o"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def stated(made: Protocol, *, small: bool) -> Iterator[tuple[str, int]]:
    """Name and size of each message, in the schema's order."""
    text = page(made, f"{made.name}.md")
    sizes = {
        item["name"]: int((item["small"] if small else None) or item["natural"])
        for item in STATED.finditer(text)
    }
    return ((item.name, sizes[item.name]) for item in made.messages if item.name in sizes)


def test_there_is_something_to_compare() -> None:
    sizes = [
        (dict(stated(protocol_of(path), small=False)), dict(stated(protocol_of(path), small=True)))
        for path in SAMPLERS
    ]
    assert any(natural != small for natural, small in sizes)


def test_one_size_is_stated_once() -> None:
    text = page(protocol(message("alone", 1, ("f", UINT8)), message("empty", 2)))
    assert " · payload 1 byte · C struct 1 byte\n" in text
    assert " · payload 0 bytes\n" in text  # There is none.


@settings(max_examples=60, suppress_health_check=list(HealthCheck))
@given(schema=schemas())
def test_random_structs(schema: Schema, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("drawn") / "drawn.yaml"
    path.write_text(to_yaml(schema.data), encoding="utf-8", newline="")
    made = compile_file(path).protocol
    assert made is not None
    for item in made.messages:
        sizes = struct_sizes(item)
        assert (sizes or [0])[0] == ctypes.sizeof(structure_of(item.fields))
