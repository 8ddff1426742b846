"""`protogen size`: what the real compilers make of generated C, taken apart.

Sums are compared with the compilers' own `size` and `nm`.
"""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
from cli_support import ROOT, compiled, run
from tooling import require_tool

from protogen.footprint.build import Build, build
from protogen.footprint.elf import Elf, Reference, Section, Symbol, read_elf
from protogen.footprint.graph import Graph
from protogen.footprint.machines import MACHINES
from protogen.targets.c.emit import texts
from protogen.targets.c.options import COptions

RN1 = str(ROOT / "schemas" / "rn1.yaml")
MATTY = str(ROOT / "schemas" / "matty.yaml")
FORMS = str(ROOT / "tests" / "framings" / "forms.yaml")
TOOLS = {"atmega328p": "avr-", "cortex-m0": "arm-none-eabi-", "host": ""}
machines = pytest.mark.parametrize("mcu", sorted(MACHINES))


def measured(*arguments: str) -> dict:
    done = run("size", *arguments, "--format", "json")
    assert done.exit_code == 0, done.output
    return json.loads(done.stdout)


def compile_by_hand(folder: Path, mcu: str, options: COptions) -> Path:
    machine = MACHINES[mcu]
    header, source = texts(compiled(Path(RN1).read_text()), options)
    (folder / "rn1.h").write_text(header)
    (folder / "rn1.c").write_text(source)
    flags = [*machine.flags, "-Os", "-std=c99", "-ffunction-sections", "-fdata-sections"]
    if mcu == "host":
        flags += ["-fno-asynchronous-unwind-tables", "-fno-stack-protector", "-fcf-protection=none"]
    made = folder / "rn1.o"
    command = [require_tool(machine.compiler), *flags, "-c", "rn1.c", "-o", str(made)]
    subprocess.run(command, cwd=folder, check=True)
    return made


@machines
def test_totals_are_what_the_tools_say(mcu: str, tmp_path: Path) -> None:
    made = compile_by_hand(tmp_path, mcu, COptions())
    tool = require_tool(f"{TOOLS[mcu]}size")
    said = subprocess.run([tool, str(made)], capture_output=True, text=True, check=True).stdout
    flash = int(said.splitlines()[1].split()[0])
    found = measured(RN1, "--mcu", mcu)
    assert found["flash"] == flash
    parts = [*found["messages"], *found["decoders"]]
    assert (
        sum(item["flash"] for item in parts) + found["shared_flash"] + found["handlers_flash"]
        == flash
    )
    assert found["static_ram"] == 0
    assert found["ram"] == sum(item["struct"] for item in found["decoders"])


@machines
def test_functions_hold_at_least_themselves(mcu: str, tmp_path: Path) -> None:
    made = compile_by_hand(tmp_path, mcu, COptions())
    command = [require_tool(f"{TOOLS[mcu]}nm"), "-S", "--defined-only", str(made)]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    rows = [line.split() for line in said.splitlines()]
    sizes = {row[3]: int(row[1], 16) for row in rows if len(row) == 4}
    found = measured(RN1, "--mcu", mcu)
    functions = [
        item for cost in (*found["messages"], *found["decoders"]) for item in cost["functions"]
    ]
    assert len(functions) == 4 * len(found["messages"]) + 4 * len(found["decoders"])
    for function in functions:
        assert function["flash"] >= sizes[function["name"]]


@machines
def test_less_is_smaller(mcu: str) -> None:
    require_tool(MACHINES[mcu].compiler)
    everything = measured(RN1, "--mcu", mcu)
    brain = measured(RN1, "--mcu", mcu, "--sender", "brain")
    gyro = measured(RN1, "--mcu", mcu, "--only", "gyro")
    least = measured(RN1, "--mcu", mcu, "--only", "gyro", "--events", "messages")
    flash = [item["flash"] for item in (everything, brain, gyro, least)]
    assert flash == sorted(flash, reverse=True)
    assert [item["name"] for item in brain["decoders"]] == ["brain"]
    assert [item["name"] for item in gyro["messages"]] == ["gyro"]
    assert gyro["ram"] < brain["ram"]


def test_struct_has_the_size_of_its_members_on_avr() -> None:
    require_tool("avr-gcc")
    found = measured(RN1, "--only", "gyro", "--only", "lidar")
    structs = {item["name"]: item["struct"] for item in found["messages"]}
    assert structs == {"gyro": 1 + 3 * 2, "lidar": 1 + 360 * 2}


def test_a_decoder_takes_as_much_stack_as_its_deepest_chain() -> None:
    require_tool("avr-gcc")
    found = measured(RN1)
    for decoder in found["decoders"]:
        stack = {item["role"]: item["stack"] for item in decoder["functions"]}
        assert stack["feed"] > stack["push"] > stack["init"] > 0
        assert decoder["stack"] == stack["feed"]


def test_the_decoder_of_all_forms_is_one_of_the_decoders() -> None:
    require_tool("avr-gcc")
    *alone, together = measured(FORMS)["decoders"]
    assert [item["name"] for item in alone] == ["station_brief", "station_wide", "station_counted"]
    # Bytes are kept once, those of the greatest frame; each form has some numbers of its own.
    assert together["name"] == "station"
    assert max(item["struct"] for item in alone) < together["struct"]
    assert together["struct"] < sum(item["struct"] for item in alone)


def test_the_table_has_a_row_for_everything() -> None:
    require_tool("avr-gcc")
    done = run("size", MATTY, "--only", "status", "--only", "ack")
    assert done.exit_code == 0
    rows = [line.split("  ")[0] for line in done.stdout.splitlines()]
    assert "matty on ATmega328P" in done.stdout
    for name in ("ack", "status", "esp", "shared by them", "total"):
        assert name in rows


def test_a_missing_compiler_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    done = run("size", RN1, "--mcu", "cortex-m0")
    assert done.exit_code == 2
    assert "arm-none-eabi-gcc, the compiler for Cortex-M0, is not installed" in done.stderr
    assert "apt install gcc-arm-none-eabi" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--only", "gyroo"], "has no message `gyroo`"),
        (["--sender", "brian"], "has no sender `brian`"),
        (["--only", "gyro", "--sender", "host"], "no message is left of `rn1`"),
        (["--mcu", "z80"], "atmega328p"),
    ],
)
def test_a_wrong_call(arguments: list[str], text: str) -> None:
    done = run("size", RN1, *arguments)
    assert done.exit_code == 2
    assert text in done.stderr


def test_a_missing_schema() -> None:
    done = run("size", "nowhere.yaml")
    assert done.exit_code == 2
    assert "there is no schema `nowhere.yaml`" in done.stderr


def test_what_is_no_object_file() -> None:
    with pytest.raises(ValueError, match="no ELF file"):
        read_elf(b"text")


def test_build_knows_structs_and_frames() -> None:
    machine = MACHINES["host"]
    require_tool(machine.compiler)
    made = build(compiled(Path(RN1).read_text()), COptions(), machine, ["struct rn1_gyro"])
    assert made.sizes == {"struct rn1_gyro": 8}
    assert made.frames["rn1_gyro_encode"] > 0


def test_depth_of_a_graph_by_hand() -> None:
    """A calls b and c; c calls d, which another file has; a constant refers to itself."""
    sections = tuple(
        Section(number, f".text.{name}", 10 * number, True, False, True)
        for number, name in enumerate("abc", start=1)
    )
    constant = Section(4, ".rodata.k", 7, False, False, True)
    a, b, c = (Symbol(item.name[-1], item.index, item.size, True) for item in sections)
    k, d = Symbol("k", 4, 7, False), Symbol("d", None, 0, False)
    references = tuple(
        Reference(section, 0, symbol)
        for section, symbol in ((1, b), (1, c), (3, d), (3, k), (4, k), (1, a))
    )
    elf = Elf((*sections, constant), (a, b, c, k, d), references)
    graph = Graph(Build(elf, {"a": 1, "b": 20, "c": 300}, {}, ""))
    assert graph.stack("a") == 301
    assert graph.stack("b") == 20
    assert graph.stack("d") == 0
    assert graph.reach("c") == {3, 4}
    assert graph.flash(graph.reach("a")) == 10 + 20 + 30 + 7
    assert graph.external == {"d"}
