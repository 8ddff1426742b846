"""Frames that nothing marks and nothing checks, from the schema to every output."""

from __future__ import annotations

from typing import Any

import pytest
from cli_support import run
from compiled import ROOT, module_at, protocol_of
from markdown_pages import page

from protogen.model.framing import Anywhere

SCHEMA = ROOT / "tests" / "c_schemas" / "by_position.yaml"


def test_the_analysis_says_what_goes_unnoticed() -> None:
    driver, robot, scanner = (
        protocol_of(SCHEMA).sender(name).framing for name in ("driver", "robot", "scanner")
    )
    assert driver.start == robot.start == scanner.start == Anywhere(checked=False)
    assert driver.finds_start.startswith("where the frame before ends")
    assert driver.finds_end == (
        "identity and fields give the size; no frame has an unknown identity"
    )
    assert robot.finds_end == "`length` gives the size"
    assert scanner.finds_end == "the message gives the size"
    assert not driver.self_synchronising
    assert "nothing marks the start" in driver.why_synchronising
    moved = "a wrong byte that makes another size of a frame: those behind it are cut elsewhere"
    assert moved in driver.undetected
    assert moved in robot.undetected
    assert moved not in scanner.undetected


@pytest.mark.parametrize("engine", ["fast", "construct"])
def test_a_decoder_that_begins_within_a_frame_reads_what_is_there(engine: str) -> None:
    module: Any = module_at(SCHEMA)
    wire = module.encode(module.Drive(velocity=-200, radius=500)) + module.encode(module.Start())
    decoder = module.Decoder("driver", engine=engine)
    found = [*decoder.feed(wire[1:]), *decoder.flush()]
    assert [(event.kind, event.raw.hex(" ")) for event in found] == [
        ("invalid", "ff 38 01 f4"),
        ("message", "80"),
    ]


def test_the_reference_names_the_decision() -> None:
    text = page(protocol_of(SCHEMA), "by_position.md")
    row = next(line for line in text.splitlines() if "`command`" in line and "Tells which" in line)
    assert "Nothing marks where a frame starts: [by_position](" in row
    fields = next(line for line in text.splitlines() if "The fields of the message." in line)
    assert fields


def test_the_command_line_reads_and_writes_it() -> None:
    assert run("encode", str(SCHEMA), "stop", "@command=174").output.split() == ["AE"]
    shown = run("decode", str(SCHEMA), "--sender", "driver", "--hex", "80 01 AE").output
    assert "start" in shown and "noise" in shown and "@command=174" in shown
