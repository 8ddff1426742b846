"""The table of names that generated C has, held against what is printed."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from c_library import write_sources
from compiled import ROOT, SCHEMAS, protocol_of
from tooling import require_tool

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
