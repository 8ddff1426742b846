"""Generated C as those read it who review or call it."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from tooling import require_tool

from protogen.api import load
from protogen.model.protocol import Protocol
from protogen.targets.c.emit import emit, texts
from protogen.targets.c.options import COptions, Events
from protogen.targets.c.wrapping import wrapped

SCHEMA = """
protocol: boiler
endpoints: {burner: Burner}
frame:
  kind:    {type: uint8, id: true}
  payload: {}
  crc:     {type: uint16, algorithm: CRC-16/KERMIT, covers: kind..payload}
  end:     {literal: 0}
byte_order: little
transparency: {covers: kind..crc, encoding: cobs}
types:
  mode: {type: uint8, values: {off: 0, heat: 1}}
messages:
  status:
    id: 1
    from: burner
    fields:
      mode:   mode
      alarms: {type: uint16, flags: {hot: 0, dry: 15}}
      pump:   {type: uint8, bits: {speed: {bits: 0..1, values: {slow: 0, fast: 1}}, valve: 2}}
      flow:   {type: uint16, when: alarms.dry == 0, unit: l/h}
      name:   {type: ascii, size: 6}
      modes:  {type: mode, count: 3}
      text:   {type: ascii, size: {fill: true, max: 20}}
  dump:
    id: 2
    from: burner
    fields:
      name:  {type: ascii, size: 6}
      key:   {type: bytes, size: 4}
      cells: {type: uint16, count: 20}
  trace:
    id: 3
    from: burner
    fields:
      n:     {type: uint8, range: [1, 9]}
      hot:   {type: uint16, count: n}
      cold:  {type: uint16, count: n}
"""


@pytest.fixture(scope="module")
def protocol(tmp_path_factory: pytest.TempPathFactory) -> Protocol:
    path = tmp_path_factory.mktemp("comments") / "boiler.yaml"
    path.write_text(SCHEMA, encoding="utf-8")
    return load(path)


@pytest.fixture(scope="module")
def header(protocol: Protocol) -> str:
    return texts(protocol, COptions())[0]


@pytest.mark.parametrize(
    ("comment", "member"),
    [
        # Where the names of its values are.
        ("Mode, BOILER_MODE_...", "uint8_t mode;"),
        ("Modes, BOILER_MODE_..., 3 elements.", "uint8_t modes[3];"),
        ("Alarms, BOILER_STATUS_ALARMS_...", "uint16_t alarms;"),
        # What a sender does not look at, and a receiver sets to zero.
        ("Flow, l/h, 0..65535, sent only if alarms.dry == 0.", "uint16_t flow;"),
        # Whether it can be printed by %s.
        ("Name, NUL behind a shorter text only.", "char name[6];"),
        ("Text, no NUL behind it.", "char text[20];"),
    ],
)
def test_the_comment_of_a_member(comment: str, member: str, header: str) -> None:
    assert f"    /** {comment} */\n    {member}\n" in header


def test_the_comment_of_bits_with_named_values(header: str) -> None:
    assert "/** Speed, BOILER_STATUS_PUMP_SPEED_...; bits 0 to 1 of pump. */" in header
    assert "/** Valve; bit 2 of pump. */" in header


@pytest.mark.parametrize("call", ['name_set(payload, "ab")', "key_set(payload, (uint8_t[]){1, 2})"])
def test_gcc_warns_of_an_array_that_is_too_short(call: str, header: str, tmp_path: Path) -> None:
    (tmp_path / "boiler.h").write_text(header, encoding="utf-8")
    program = '#include "boiler.h"\nint main(void) {\n    uint8_t payload[60] = {0};\n'
    program += f"    return boiler_dump_{call};\n}}\n"
    (tmp_path / "main.c").write_text(program, encoding="utf-8")
    command = [require_tool("gcc"), "-std=c99", "-Wall", "-c", "main.c", "-o", "main.o"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "-Wstringop-over" in done.stderr


def test_decoders_of_messages_alone_declare_nothing_of_other_events(protocol: Protocol) -> None:
    files = emit([protocol], COptions(events="messages", hpp=True))
    for header in (file.text for file in files if file.path.suffix in (".h", ".hpp")):
        assert not re.search("event_kind|reason|BOILER_(UNKNOWN|INVALID|CHECKSUM)", header)


@pytest.mark.parametrize("events", ["all", "messages"])
def test_no_line_of_a_comment_is_too_long(events: Events, tmp_path: Path) -> None:
    name = "a_protocol_of_some_length"
    path = tmp_path / f"{name}.yaml"
    path.write_text(SCHEMA.replace("protocol: boiler", f"protocol: {name}"), encoding="utf-8")
    lines = [
        line
        for file in emit([load(path)], COptions(events=events, hpp=True))
        if file.path.suffix in (".h", ".c", ".hpp")
        for line in file.text.splitlines()
        if line.lstrip().startswith(("*", "/*"))
    ]
    assert lines
    assert [line for line in lines if len(line) > 100 and "     [](const " not in line] == []


def test_paragraphs_of_comments_are_folded_by_themselves() -> None:
    words = " ".join(["words"] * 20)
    text = f"/* {words[:95]} */\n    /* {words}. */\n    /** {words}. */\n"
    text += f"    /*\n     * {words}\n     * on.\n     *\n     * End. */"
    folded = " ".join(["words"] * 15)
    rest = " ".join(["words"] * 5)
    assert wrapped(text).splitlines() == [
        f"/* {words[:89]}",
        "   words */",
        f"    /* {folded}",
        f"       {rest}. */",
        "    /**",
        f"     * {folded}",
        f"     * {rest}.",
        "     */",
        "    /*",
        f"     * {folded}",
        f"     * {rest} on.",
        "     *",
        "     * End. */",
    ]


def test_a_number_that_counts_two_arrays_is_looked_at_once(protocol: Protocol) -> None:
    source = texts(protocol, COptions())[1]
    for function, number in (("validate", "message->n"), ("check", "n")):
        found = re.search(rf"boiler_trace_{function}\(.*?\n}}", source, re.DOTALL)
        assert found is not None
        assert len(re.findall(rf"if \({number}\w* < 1U \|\| ", found[0])) == 1
