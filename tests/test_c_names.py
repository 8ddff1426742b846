"""The table of names that generated C has, held against what is printed."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from c_library import FLAGS, write_sources
from compiled import ROOT, SCHEMAS, protocol_of
from tooling import require_tool

from protogen.compiler import compile_file
from protogen.model.protocol import Protocol
from protogen.targets.c.emit import emit
from protogen.targets.c.options import COptions
from protogen.targets.c.protocol_names import names_of
from protogen.targets.c.spelling import Names
from protogen.targets.naming import message

PATHS = sorted({*SCHEMAS, *ROOT.glob("tests/c_schemas/*.yaml")})
NO_CODE = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\])*"', re.DOTALL)
DEFINED = r"^(?:(?:static|\w+_INLINE) .*\b{0}\(|typedef char {0}\[)"
"""A function, or what is asserted when it is compiled."""
AT_FILE_SCOPE = re.compile(r"^(?:#define |(?!extern |enum \{)[a-z]).*$", re.MULTILINE)


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_every_name_of_generated_c_is_in_the_table(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    protocol = protocol_of(path)
    names = names_of(protocol)
    tables = (names.others, names.tags, names.members)
    table = {name for scope in tables for name in scope.things}
    made: list[Names] = []

    def noted(chosen: Protocol) -> Names:
        made.append(names_of(chosen))
        return made[-1]

    monkeypatch.setattr("protogen.targets.c.emit.names_of", noted)
    prefixed = re.compile(rf"\b(?:{protocol.name}|{protocol.name.upper()})_\w+")
    chosen = [COptions(events="all", stubs=True), COptions(events="messages", style="single")]
    chosen += [COptions(senders=(sender.name,)) for sender in protocol.senders]
    for options in chosen:
        files = [file for file in emit([protocol], options) if file.path.suffix in (".c", ".h")]
        helpers = {*made[-1].others.things} - table
        for text in (NO_CODE.sub("", file.text) for file in files):
            assert set(prefixed.findall(text)) <= table | helpers
            for line in AT_FILE_SCOPE.findall(text):
                assert prefixed.search(line), line
        # Helpers are the only ones that are named later; each is the source's own.
        printed = "\n".join(file.text for file in files)
        for name in helpers.intersection(prefixed.findall(printed)):
            assert re.search(DEFINED.format(name), printed, re.MULTILINE)


def test_no_name_stands_for_two_things() -> None:
    names = Names("robot")
    first, second = message("status"), message("status_x")
    assert names.claim(first, "status", "x", "encode") == "robot_status_x_encode"
    assert names.claim(first, "status", "x", "encode") == "robot_status_x_encode"
    assert names.claim_tag(second, "status_x_encode") == "robot_status_x_encode"
    assert not [*names.others.escaped, *names.tags.escaped]  # A tag is no function.
    for _ in range(2):
        assert names.claim(second, "status_x", "encode") == "robot_status_x_encode_"
    assert names.others.escaped == {second: ["robot_status_x_encode_"]}
    assert names.claim_macro(first, "ok") == "ROBOT_OK"
    assert names.claim_helper("status_x_encode") == "robot_status_x_encode_2"


def test_messages_may_be_called_like_functions_of_the_source(tmp_path: Path) -> None:
    text = "protocol: demo\nendpoints: {host: Host}\ntransparency: slip\n"
    text += "frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}\nmessages:\n"
    for number, name in enumerate(("write", "copy", "on_it", "frame_it", "host_take", "linux")):
        kind = "{type: bytes, size: 4}"
        text += f"  {name}: {{id: {number}, from: host, fields: {{x: {kind}}}}}\n"
    path = tmp_path / "demo.yaml"
    path.write_text(text, encoding="utf-8")
    write_sources(protocol_of(path), tmp_path)
    assert "\nstruct demo_write {\n" in (tmp_path / "demo.h").read_text(encoding="utf-8")
    (tmp_path / "main.cpp").write_text('#include "demo.h"\n', encoding="utf-8")
    flags = ["-Wall", "-Wextra", "-Werror", "-fsyntax-only"]
    for command in (["cc", "-std=gnu99", "demo.c"], ["c++", "-std=c++11", "main.cpp"]):
        subprocess.run([require_tool(command[0]), *flags, *command[1:]], cwd=tmp_path, check=True)


FRAMINGS = {
    "flags": """
frame:
  opening: {literal: 0x7E}
  id: {type: uint8, id: true}
PARTS
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/MODBUS, covers: id..payload}
  closing: {literal: 0x7E}
transparency: hdlc
""",
    "zeros": """
frame:
  id: {type: uint8, id: true}
PARTS
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/MODBUS, covers: id..payload}
  closing: {literal: 0}
transparency: {encoding: cobs}
""",
    "digits": """
frame:
  opening: {literal: 2}
  id: {type: uint8, id: true}
PARTS
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/MODBUS, covers: id..payload}
  closing: {literal: 3}
transparency: {covers: id..crc, encoding: base16-upper}
""",
    "a length over the wire": """
frame:
  opening: {literal: {hex: FF FD}, unprotected: accepted}
  number: {type: uint8, range: [0, 252], default: 7}
  long: {type: uint16, counts: id..last, over: wire}
  id: {type: uint8, id: true}
PARTS
  payload: {}
  last: {type: uint8, default: 0}
  crc: {type: uint16, algorithm: sum-16, covers: id..last, over: wire}
transparency: {covers: id..last, substitute: {FF FD: FF FD FD}}
""",
    "a length": """
frame:
  opening: {literal: 0x7E, unprotected: accepted}
  id: {type: uint8, id: true}
PARTS
  long: {type: uint16, counts: payload}
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/MODBUS, covers: id..payload}
""",
    "trimmed": """
frame:
  opening: {literal: 0x7E, unprotected: accepted}
  id: {type: uint8, id: true}
PARTS
  long: {type: uint16, counts: payload}
  payload: {trailing_zeros: trimmed}
  crc: {type: uint16, algorithm: CRC-16/MODBUS, covers: id..payload}
""",
}
DEMO = """
protocol: demo
endpoints: {host: Host}
byte_order: big
max_frame: 700
"""
DECISIONS = "decisions: {accepted: {document: d, question: q, choice: c, because: b}}\n"
OF_ONE_SIZE = """
messages:
  calm: {id: 1, from: host}
  gust: {id: 2, from: host, fields: {speed: uint8}}
  wind: {id: 3, from: host, fields: {speed: uint16, gauge: {type: uint8, range: [1, 5]}}}
"""
OF_ANY_SIZE = (
    OF_ONE_SIZE
    + """
  rain:
    id: 4
    from: host
    fields:
      days: {type: uint8, range: [1, 40]}
      fallen: {type: uint16, count: days}
      least: {type: sint16, range: [1, 5], count: days}
  log:
    id: 5
    from: host
    fields: {day: {type: uint8, range: [1, 7]}, snow: {type: uint8, count: {fill: true, max: 90}}}
"""
)
VARIABLE = re.compile(
    r"\b(?:u?int\d+_t|size_t|ptrdiff_t|bool|char|demo_put|(?:struct|enum) \w+) "
    r"\*?(?:const )?([a-z][a-z0-9]*(?:_[a-z0-9]+)*)\b(?! ?\()"
)
DIRECTIVES = {"after", "before", "remove", "rename", "replace"}
"""Words of `extends` that are no names."""


@pytest.mark.parametrize("framing", FRAMINGS)
def test_parts_may_be_called_like_any_variable_of_the_source(framing: str, tmp_path: Path) -> None:
    text = FRAMINGS[framing]
    taken = {*re.findall(r"^  (\w+):", text, re.MULTILINE), *DIRECTIVES}
    words = {*VARIABLE.findall(named_parts(text, ["plain"], tmp_path))} - taken
    words = sorted(word for word in words if not word.startswith("demo"))
    assert len(words) > 40
    for chosen in (words[::2], words[1::2]):
        named_parts(text, [*chosen, "size_part", "wire_part"], tmp_path)
        command = [require_tool("cc"), *FLAGS, "-fsyntax-only", "demo.c"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")


def named_parts(framing: str, names: list[str], folder: Path) -> str:
    """Header and source of a frame with parts of these names, which are written."""
    parts = "\n".join(f"  {name}: {{type: uint8, default: 1}}" for name in names)
    messages = OF_ONE_SIZE if "trimmed" in framing else OF_ANY_SIZE
    decisions = DECISIONS if "accepted" in framing else ""
    path = folder / "demo.yaml"
    path.write_text(DEMO + decisions + framing.replace("PARTS", parts) + messages, encoding="utf-8")
    file = write_sources(protocol_of_text(path), folder)
    return "".join((folder / f"{file}.{kind}").read_text(encoding="utf-8") for kind in "hc")


NUMBERED = """
  m{index}:
    id: {index}
    from: host
    fields:
      {name}: {{type: uint8, range: [1, 40]}}
      of_elements: {{type: uint16, range: [1, 5], count: {name}{formula}}}
      of_others: {{type: sint16, range: [1, 5], count: 2}}
"""


@pytest.mark.parametrize("framing", ["zeros", "a length"])
@pytest.mark.parametrize("formula", ["", " * 2"], ids=["at the end", "first"])
def test_numbers_of_elements_may_be_called_like_any_variable_of_writers(
    framing: str, formula: str, tmp_path: Path
) -> None:
    """Those of C and of C++; a compiler for either warns of a name that hides another one."""
    text = numbered(framing, formula, ["plain", "plainer"], tmp_path)
    words = {*VARIABLE.findall(text)} - {*DIRECTIVES, "of_elements", "of_others"}
    words = sorted(word for word in words if not word.startswith("demo"))
    assert {"value_0", "is_begun", "payload", "at"} < {*words}
    numbered(framing, formula, words, tmp_path)
    (tmp_path / "main.cpp").write_text('#include "demo.hpp"\n', encoding="utf-8")
    for call in (["cc", *FLAGS, "demo.c"], ["c++", "-std=c++11", *FLAGS[1:], "main.cpp"]):
        command = [require_tool(call[0]), *call[1:], "-fsyntax-only"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")


def numbered(framing: str, formula: str, names: list[str], folder: Path) -> str:
    """Headers and source of a message for each of these names of a number, which are written."""
    messages = "".join(
        NUMBERED.format(index=index, name=name, formula=formula) for index, name in enumerate(names)
    )
    decisions = DECISIONS if "accepted" in FRAMINGS[framing] else ""
    frame = FRAMINGS[framing].replace("PARTS\n", "")
    path = folder / "demo.yaml"
    path.write_text(f"{DEMO}{decisions}{frame}\nmessages:{messages}", encoding="utf-8")
    found = ""
    for file in emit([protocol_of_text(path)], COptions(hpp=True)):
        if file.path.suffix in (".c", ".h", ".hpp"):
            (folder / file.path.name).write_bytes(file.bytes)
            found += file.bytes.decode("utf-8")
    return found


def protocol_of_text(path: Path) -> Protocol:
    """The protocol of a schema that may have been another one before."""
    protocol = compile_file(path).protocol
    assert protocol is not None
    return protocol
