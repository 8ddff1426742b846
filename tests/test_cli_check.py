"""`protogen check` and `protogen generate`."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from cli_support import ROOT, SINK, run, start

MATTY = str(ROOT / "schemas" / "matty.yaml")
BAD = "protocol: bad\ncolour: red\nendpoints: {a: A}\nframe: {}\nmessages: {}\n"


@pytest.fixture
def bad(tmp_path: Path) -> Path:
    schema = tmp_path / "bad.yaml"
    schema.write_text(BAD)
    return schema


# --- check ----------------------------------------------------------------------------------------


def test_all_schemas_are_clean() -> None:
    result = start("check", "schemas", "--quiet")
    assert (result.returncode, result.stdout) == (0, b"")


def test_analysis() -> None:
    result = run("check", MATTY)
    assert result.exit_code == 0
    lines = result.output.splitlines()
    assert lines[0] == f"{MATTY}: Matty serial protocol, version 2, in Robbus frames"
    assert "messages: 11, examples verified: 7" in lines[1]
    assert "  pc: PC" in lines
    assert any(line.split() == ["go", "9..14", "822.9"] for line in lines)
    assert any(line.startswith("    self-synchronising  yes: ") for line in lines)
    assert lines[-1] == "1 schema, no problems"


def test_plain_where_nobody_watches() -> None:
    assert b"\x1b" not in start("check", MATTY).stdout
    assert max(map(len, start("check", MATTY).stdout.split(b"\n"))) > 100


def test_problems_have_a_place_and_the_line(bad: Path) -> None:
    result = run("check", str(bad))
    assert result.exit_code == 1
    assert f"{bad}:2:1: error[" in result.stdout
    assert "    2 | colour: red" in result.stdout
    assert "Traceback" not in result.output
    assert result.stdout.splitlines()[-1].startswith("1 schema, ")


def test_problems_as_json(bad: Path) -> None:
    result = run("check", str(bad), MATTY, "--format", "json")
    assert result.exit_code == 1
    report = json.loads(result.stdout)
    first = report["problems"][0]
    assert (first["file"], first["line"], first["column"]) == (str(bad), 2, 1)
    (matty,) = report["protocols"]
    assert matty["protocol"] == "matty"
    assert matty["examples_verified"] == 7
    assert [item["sender"] for item in matty["senders"]] == ["pc", "esp"]
    assert matty["senders"][0]["self_synchronising"] is True


def test_json_without_analysis(bad: Path) -> None:
    report = json.loads(run("check", MATTY, "--format", "json", "--quiet").stdout)
    assert report == {"problems": []}


def test_problems_for_github(bad: Path) -> None:
    result = run("check", str(bad), "--format", "github")
    assert result.exit_code == 1
    assert result.stdout.startswith(f"::error file={bad},line=2,col=1,title=PG")


def test_folders_are_searched_but_not_hidden_ones(tmp_path: Path) -> None:
    for name in ("a.yaml", "sub/b.yaml", ".hidden/c.yaml"):
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(SINK)
    assert "2 schemas, no problems" in run("check", str(tmp_path)).stdout


def test_a_file_that_is_named_twice_is_checked_once(tmp_path: Path) -> None:
    schema = tmp_path / "a.yaml"
    schema.write_text(SINK)
    assert "1 schema, no problems" in run("check", str(schema), str(tmp_path)).stdout


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
@pytest.mark.parametrize("schemas", [".", "*.yaml"])
def test_a_pipe_in_a_folder_is_no_schema_to_wait_for(
    schemas: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "protogen.toml").write_text(f'schemas = ["{schemas}"]\n')
    (tmp_path / "a.yaml").write_text(SINK)
    os.mkfifo(tmp_path / "pipe.yaml")
    assert "1 schema, no problems" in run("check").stdout


@pytest.mark.parametrize("command", ["check", "generate"])
def test_nothing_to_read(command: str, tmp_path: Path) -> None:
    result = run(command, str(tmp_path / "nowhere"))
    assert result.exit_code == 2
    assert "there is no file or folder" in result.stderr
    result = run(command, str(tmp_path))
    assert result.exit_code == 2
    assert "holds no .yaml file" in result.stderr


# --- generate -------------------------------------------------------------------------------------


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with two schemas where the defaults look for them."""
    schemas = tmp_path / "schemas"
    schemas.mkdir()
    (schemas / "sink.yaml").write_text(SINK)
    (schemas / "other.yaml").write_text(SINK.replace("protocol: sink", "protocol: other"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_defaults(project: Path) -> None:
    result = run("generate")
    assert result.exit_code == 0
    assert "wrote generated/python/sink.py" in result.stdout.splitlines()
    assert "wrote generated/markdown/sink.md" in result.stdout.splitlines()
    assert (project / "generated" / "python" / "other.py").is_file()


def test_second_run_changes_nothing(project: Path) -> None:
    run("generate")
    result = run("generate", "--target", "python")
    assert result.stdout == "unchanged in generated/python: 5\n"
    assert run("generate", "--check").exit_code == 0
    assert run("generate", "--diff").stdout == ""


def test_stale_files(project: Path) -> None:
    run("generate", "-q")
    schema = project / "schemas" / "sink.yaml"
    schema.write_text(SINK.replace("id: E", "id: X"))
    checked = run("generate", "--check")
    assert checked.exit_code == 1
    assert "generated/python/sink.py: stale" in checked.stdout.splitlines()
    diff = run("generate", "--diff")
    assert diff.exit_code == 1
    assert "--- a/generated/python/sink.py" in diff.stdout
    assert "wrote generated/python/sink.py" in run("generate").stdout.splitlines()


def test_removed_schema(project: Path) -> None:
    run("generate", "-q")
    (project / "schemas" / "other.yaml").unlink()
    assert "generated/python/other.py: extra" in run("generate", "--check").stdout.splitlines()
    assert "removed generated/python/other.py" in run("generate").stdout.splitlines()


def test_naming_one_schema_keeps_the_files_of_the_others(project: Path) -> None:
    run("generate", "-q")
    result = run("generate", "schemas/sink.yaml", "--target", "markdown")
    assert result.exit_code == 0
    assert "removed" not in result.stdout
    assert (project / "generated" / "markdown" / "other.md").is_file()


def test_files_of_others_are_not_touched(project: Path) -> None:
    mine = project / "generated" / "python" / "sink.py"
    mine.parent.mkdir(parents=True)
    mine.write_text("print('mine')\n")
    result = run("generate", "--target", "python")
    assert result.exit_code == 2
    assert "generated/python/sink.py: not written, not made by protogen" in result.stderr
    assert mine.read_text() == "print('mine')\n"
    checked = run("generate", "--check", "--target", "python")
    assert "generated/python/sink.py: refused, not made by protogen" in checked.stdout


def test_errors_stop_everything(project: Path) -> None:
    (project / "schemas" / "bad.yaml").write_text(BAD)
    result = run("generate")
    assert result.exit_code == 1
    assert "bad.yaml:2:1: error[" in result.stderr
    assert not (project / "generated").exists()


def test_unknown_target(project: Path) -> None:
    result = run("generate", "--target", "pyton")
    assert result.exit_code == 2
    assert "there is no target `pyton`" in result.stderr
    assert "did you mean `python`?" in result.stderr


def test_standalone_modules_need_no_protogen(project: Path) -> None:
    result = run("generate", "--standalone", "--target", "python", "-q")
    assert (result.exit_code, result.output) == (0, "")
    text = (project / "generated" / "python" / "sink" / "__init__.py").read_text()
    assert "protogen.runtime" not in text


def test_standalone_is_for_python(project: Path) -> None:
    result = run("generate", "--standalone", "--target", "markdown")
    assert result.exit_code == 2
    assert "--standalone is for the target python" in result.stderr


def test_quiet(project: Path) -> None:
    assert run("generate", "--quiet").output == ""
    assert run("generate", "--check", "--quiet").output == ""
    assert "files are current" in run("generate", "--check").output


def test_a_wrong_choice_is_said_without_the_words_of_a_library() -> None:
    result = run("check", str(ROOT / "schemas"), "--format", "jsno")
    assert result.exit_code == 2
    assert "'jsno' is not one of 'text', 'json', 'github'; did you mean `json`?" in result.stderr
    assert "Value error" not in result.stderr
    other = run("check", ".", "--format", "x").stderr
    assert "'x' is not one of 'text', 'json', 'github'.\n" in other


BAD_EXAMPLE = """\
protocol: seen
endpoints: {pc: Computer}
frame:
  sync: {literal: 0x02}
  id: {type: uint8, id: true}
  payload: {}
  etx: {literal: 0x03}
transparency: {covers: id..payload, escape: {byte: 0x10, of: [2, 3, 0x10], transform: {xor: 0x40}}}
messages:
  m:
    id: 1
    from: pc
    fields: {a: uint8}
    examples: {one: {frame: {hex: 02 01 05 04}, values: {a: 5}}}
"""


def test_a_wrong_last_byte_is_named(tmp_path: Path) -> None:
    schema = tmp_path / "seen.yaml"
    schema.write_text(BAD_EXAMPLE)
    output = run("check", str(schema)).output
    assert "`etx` must be 03, and the last bytes are 04" in output


def test_a_struct_with_a_field_called_text_is_no_byte_string(tmp_path: Path) -> None:
    schema = tmp_path / "named.yaml"
    schema.write_text("""\
protocol: named
endpoints: {board: Board}
frame:
  sync: {literal: 0x02}
  type: {type: uint8, id: true}
  payload: {}
  end: {literal: 0x03}
messages:
  line:
    id: 1
    from: board
    fields:
      x: {fields: {text: {type: ascii, size: 1}}, count: 2}
      hex: {fields: {hex: {type: bytes, size: 1}}}
    examples:
      one:
        frame: {hex: 02 01 41 42 07 03}
        values: {x: [{text: A}, {text: B}], hex: {hex: {hex: "07"}}}
""")
    result = run("check", str(schema))
    assert "PG160" not in result.output, result.output


@pytest.mark.parametrize("option", [[], ["--check"], ["--diff"]])
def test_nothing_is_generated_where_an_example_fails(tmp_path: Path, option: list[str]) -> None:
    schema = tmp_path / "seen.yaml"
    schema.write_text(BAD_EXAMPLE.replace("05 04", "06 03"))
    made = tmp_path / "made"
    result = run("generate", str(schema), "-o", str(made), "--target", "markdown", *option)
    assert result.exit_code == 1
    assert "error[PG160]: `one` of `m`: `a` is 6, not 5" in result.stderr
    assert not made.exists()
