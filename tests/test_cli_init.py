"""`protogen init`: each starter schema is complete and holds at once."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest
from cli_support import PATIENCE, ROOT, run
from tooling import require_tool

from protogen.compiler import compile_file
from protogen.layout.formatting import format_text
from protogen.schema.json_schema import json_schema_text
from protogen.starter.framings import Framing

FRAMINGS = [framing.value for framing in Framing]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("framing", FRAMINGS)
class TestEachFraming:
    def test_compiles_with_nothing_to_report(self, framing: str) -> None:
        assert run("init", "motor", "--framing", framing).exit_code == 0
        compilation = compile_file("motor.yaml", examples=True)
        assert compilation.problems == ()
        assert compilation.protocol is not None
        assert sum(len(message.examples) for message in compilation.protocol.messages) == 2

    def test_generates_everything_and_the_c_compiles(self, framing: str, folder: Path) -> None:
        run("init", "motor", "--framing", framing)
        made = run("generate", "motor.yaml", "--quiet")
        assert made.exit_code == 0, made.output
        for name in ("python/motor.py", "markdown/motor.md", "c/motor.h"):
            assert (folder / "generated" / name).is_file()
        strict = ["-std=c99", "-Wall", "-Wextra", "-Werror"]
        command = [require_tool("cc"), *strict, "-c", "generated/c/motor.c", "-o", "motor.o"]
        subprocess.run(command, cwd=folder, check=True)

    def test_is_in_the_canonical_layout(self, framing: str, folder: Path) -> None:
        run("init", "motor", "--framing", framing)
        text = (folder / "motor.yaml").read_text()
        assert format_text(text) == text

    def test_shows_an_enum_a_scale_a_unit_and_an_array(self, framing: str, folder: Path) -> None:
        run("init", "motor", "--framing", framing)
        text = (folder / "motor.yaml").read_text()
        assert all(f"{key}: " in text for key in ("values", "scale", "unit", "count", "special"))


class TestFiles:
    def test_names_the_json_schema_that_is_written_beside_it(self, folder: Path) -> None:
        (folder / "schemas").mkdir()
        done = run("init", "motor", "--output", "schemas/motor.yaml")
        assert done.output.splitlines() == [
            "wrote schemas/motor.yaml",
            "wrote schemas/protogen.schema.json",
            "next: protogen check schemas/motor.yaml",
        ]
        first = (folder / "schemas/motor.yaml").read_text().splitlines()[0]
        assert first == "# yaml-language-server: $schema=protogen.schema.json"
        assert (folder / "schemas/protogen.schema.json").read_text() == json_schema_text()

    def test_leaves_a_json_schema_alone(self, folder: Path) -> None:
        (folder / "protogen.schema.json").write_text("{}")
        assert "schema.json" not in run("init", "motor").output
        assert (folder / "protogen.schema.json").read_text() == "{}"

    def test_never_overwrites(self, folder: Path) -> None:
        (folder / "motor.yaml").write_text("mine")
        done = run("init", "motor")
        assert done.exit_code == 2
        assert "there is a file `motor.yaml` already" in done.output
        assert (folder / "motor.yaml").read_text() == "mine"
        assert not (folder / "protogen.schema.json").exists()

    def test_folder_that_is_not_there(self) -> None:
        done = run("init", "motor", "--output", "nowhere/motor.yaml")
        assert done.exit_code == 2
        assert "nowhere/motor.yaml: No such file or directory" in done.output


class TestProject:
    def test_says_what_to_write_where_there_is_none(self, folder: Path) -> None:
        lines = run("init", "motor", "-o", "motor.yaml").output.splitlines()
        last = "for a bare `protogen generate`, write to protogen.toml: "
        assert lines[-1].startswith(last)
        (folder / "protogen.toml").write_text(lines[-1].removeprefix(last) + "\n")
        assert run("generate", "-q").exit_code == 0
        assert (folder / "generated" / "python" / "motor.py").is_file()

    def test_says_what_to_add_to_a_project(
        self, folder: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        (folder / "protogen.toml").write_text('schemas = ["boards"]\n')
        (folder / "boards").mkdir()
        monkeypatch.chdir(folder / "boards")
        assert "protogen generate" not in run("init", "motor").output
        (folder / "lines").mkdir()
        lines = run("init", "wheel", "-o", "../lines/wheel.yaml").output.splitlines()
        added = 'add "lines/wheel.yaml" to `schemas` in ../protogen.toml'
        assert lines[-1] == f"for a bare `protogen generate`, {added}"


class TestChoices:
    def test_without_a_terminal_takes_defaults(self, folder: Path) -> None:
        assert run("init").exit_code == 0
        assert "encoding: cobs" in (folder / "my_protocol.yaml").read_text()

    @pytest.mark.parametrize(
        ("name", "said"),
        [
            ("My-Thing", "did you mean `my_thing`?"),
            ("2fast", "did you mean `fast`?"),
            ("__", "no lower snake case name"),
            ("a" * 65, "no lower snake case name"),
        ],
    )
    def test_names_that_a_protocol_cannot_have(self, name: str, said: str, folder: Path) -> None:
        done = run("init", name)
        assert done.exit_code == 2
        assert said in done.output
        assert list(folder.iterdir()) == []

    def test_unknown_framing(self) -> None:
        done = run("init", "motor", "--framing", "cob")
        assert done.exit_code == 2
        assert "did you mean `cobs`?" in done.output

    def test_asks_on_a_terminal(self, folder: Path) -> None:
        shown = on_a_terminal("wheels\nslip\n", "init")
        assert "Name of the protocol" in shown
        assert all(name in shown for name in FRAMINGS)
        assert "transparency: slip" in (folder / "wheels.yaml").read_text()

    def test_asks_only_for_what_was_not_given(self, folder: Path) -> None:
        shown = on_a_terminal("\n", "init", "wheels")
        assert "Name of the protocol" not in shown
        assert "encoding: cobs" in (folder / "wheels.yaml").read_text()


def on_a_terminal(typed: str, *arguments: str) -> str:
    """Run a command on a pseudo-terminal; return what it showed."""
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "protogen", *arguments],
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        env={**os.environ, "PYTHONPATH": str(ROOT), "TERM": "dumb", "NO_COLOR": "1"},
    )
    os.close(theirs)
    os.write(ours, typed.encode())
    shown = b""
    try:
        while piece := os.read(ours, 4096):
            shown += piece
    except OSError:
        pass  # Linux says that the other end is closed in this way.
    os.close(ours)
    assert process.wait(PATIENCE) == 0, shown
    return shown.decode()
