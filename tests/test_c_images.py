"""Which messages of generated C are copied as a whole: those that lie in memory as on the wire."""

import subprocess
from pathlib import Path

import pytest
from c_library import write_sources
from compiled import protocol_of
from tooling import require_tool

from protogen.targets.c.payload.images import is_image

SCHEMA = """\
protocol: sample
byte_order: little
endpoints: {{host: Host, board: Board}}
frame:
  opening: {{literal: 0x7E}}
  id:      {{type: uint8, id: true}}
  payload: {{}}
  closing: {{literal: 0x7E}}
transparency: hdlc
messages:
  reading:
    from: board
    id: 1
    fields: {{{fields}}}
"""


@pytest.mark.parametrize(
    ("fields", "is_one"),
    [
        ("a: {type: uint32}, b: {type: sint16}", True),
        ("a: {type: uint32}, b: {type: uint16}, c: {type: uint8}", True),
        ("a: {type: uint16, count: 3}", True),
        ("a: {type: float32}, b: {type: uint8}", True),
        # At the odd place 1, which most machines leave free.
        ("a: {type: uint8}, b: {type: uint32}", False),
        ("a: {type: uint32, byte_order: big}, b: {type: uint16}", False),
        ("a: {type: uint24}, b: {type: uint24}", False),
        ("a: {type: bool}, b: {type: uint8}, c: {type: uint32, const: 7}", False),
        # So few are taken one by one.
        ("a: {type: uint16}, b: {type: uint16}", False),
    ],
)
def test_what_has_padding_or_other_bytes_in_memory_is_no_image(
    fields: str, is_one: bool, tmp_path: Path
) -> None:
    path = tmp_path / "sample.yaml"
    path.write_text(SCHEMA.format(fields=fields), encoding="utf-8")
    (message,) = protocol_of(path).messages
    assert is_image(message.plan) is is_one


def test_a_struct_that_is_laid_out_in_another_way_does_not_compile(tmp_path: Path) -> None:
    path = tmp_path / "sample.yaml"
    path.write_text(SCHEMA.format(fields="a: uint32, b: {type: float32}"), encoding="utf-8")
    write_sources(protocol_of(path), tmp_path)
    header = tmp_path / "sample.h"
    command = [require_tool("cc"), "-std=c99", "-DSAMPLE_AS_IN_MEMORY=1", "-fsyntax-only"]
    for before, after, fault in (
        ("", "", ""),
        ("uint32_t a;", "uint32_t a; uint8_t more;", "sample_reading_layout"),
    ):
        text = header.read_text(encoding="utf-8")
        header.write_text(text.replace(before, after) if before else text, encoding="utf-8")
        call = [*command, "sample.c"]
        done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode != 0, fault in done.stderr) == (bool(fault), True)
        header.write_text(text, encoding="utf-8")
    call = [*command, "-Dfloat=double", "sample.c"]
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "sample_float32_size" in done.stderr


def test_a_machine_whose_sizes_are_too_small_for_a_frame_does_not_compile(tmp_path: Path) -> None:
    path = tmp_path / "sample.yaml"
    fields = "a: {type: bytes, size: 40000}"
    path.write_text(SCHEMA.format(fields=fields), encoding="utf-8")
    write_sources(protocol_of(path), tmp_path)
    for command, fault in ((["cc"], ""), (["avr-gcc", "-mmcu=atmega328p"], "size_t can't hold")):
        call = [require_tool(command[0]), *command[1:], "-std=c99", "-fsyntax-only", "sample.c"]
        done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode != 0, fault in done.stderr) == (bool(fault), True)
