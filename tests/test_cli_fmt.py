"""`protogen fmt`: what is written, what is reported, and what is left alone."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_support import SINK, run

from protogen.layout import formatting

WIDE = "protocol:   wide\n" + SINK.partition("\n")[2].replace("byte_order: big\n", "").replace(
    "endpoints:", "byte_order: big   # most significant byte first\nendpoints:"
)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_writes_the_canonical_layout_once(folder: Path) -> None:
    file = folder / "wide.yaml"
    file.write_text(WIDE)
    first = run("fmt", "wide.yaml")
    assert (first.exit_code, first.output) == (0, "laid out wide.yaml\n")
    text = file.read_text()
    assert text.startswith(
        "protocol: wide\ntitle: One of everything\nlink: {baud: 9600}\nendpoints"
    )
    assert "byte_order: big   # most significant byte first\n" in text
    again = run("fmt", "wide.yaml")
    assert (again.exit_code, again.output) == (0, "")
    assert file.read_text() == text


def test_check_lists_files_and_writes_nothing(folder: Path) -> None:
    (folder / "wide.yaml").write_text(WIDE)
    (folder / "good.yaml").write_text(formatting.format_text(SINK))
    done = run("fmt", ".", "--check")
    assert done.exit_code == 1
    assert done.output == "wide.yaml: would be laid out anew; fix it with: protogen fmt wide.yaml\n"
    assert (folder / "wide.yaml").read_text() == WIDE
    assert run("fmt", "good.yaml", "--check").exit_code == 0


def test_quiet_says_nothing(folder: Path) -> None:
    (folder / "wide.yaml").write_text(WIDE)
    assert run("fmt", "wide.yaml", "--quiet").output == ""


def test_a_file_with_errors_is_reported_and_left_alone(folder: Path) -> None:
    text = WIDE.replace("type: char", "type: chr")
    (folder / "bad.yaml").write_text(text)
    (folder / "wide.yaml").write_text(WIDE)
    done = run("fmt", "bad.yaml", "wide.yaml")
    assert done.exit_code == 1
    assert "bad.yaml:8:16: error[" in done.output
    assert "laid out wide.yaml" in done.output
    assert (folder / "bad.yaml").read_text() == text


def test_a_layout_that_says_something_else_is_a_bug_and_not_written(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "wide.yaml").write_text(WIDE)
    (folder / "other.yaml").write_text(WIDE.replace("baud: 9600", "baud: 4800"))
    format_text = formatting.format_text
    monkeypatch.setattr(
        formatting, "format_text", lambda text: format_text(text.replace("9600", "960"))
    )
    done = run("fmt", "wide.yaml", "other.yaml")
    assert done.exit_code == 70
    assert "this is a bug in protogen" in done.output
    assert "wide.yaml would mean something else" in done.output
    assert (folder / "wide.yaml").read_text() == WIDE
    assert "laid out other.yaml\n" in done.output


NAN = """protocol:   nan
endpoints: {a: A}
byte_order: big
frame:
  start: {literal: 0x75, unprotected: x}
  payload: {}
messages:
  data:
    from: a
    fields: {z: float32, list: {type: float32, count: 2}}
    examples: {n: {frame: {hex: 75 7FC00000 7FC00000 00000000}, values: {z: .nan, list: [.nan, 0]}}}
decisions: {x: {question: q, document: d, choice: c, because: b}}
"""


def test_a_value_that_is_not_a_number_is_the_same_in_any_layout(folder: Path) -> None:
    (folder / "nan.yaml").write_text(NAN)
    done = run("fmt", "nan.yaml")
    assert (done.exit_code, done.output) == (0, "laid out nan.yaml\n")
    assert "protocol: nan\n" in (folder / "nan.yaml").read_text()


class TestProject:
    def test_without_schemas_those_of_the_project(
        self, folder: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        (folder / "protogen.toml").write_text('schemas = ["boards/*.yaml"]\n')
        (folder / "boards").mkdir()
        (folder / "boards" / "wide.yaml").write_text(WIDE)
        (folder / "other.yaml").write_text(WIDE)
        monkeypatch.chdir(folder / "boards")
        assert run("fmt", "--check").exit_code == 1
        done = run("fmt")
        assert (done.exit_code, done.output) == (0, "laid out ../boards/wide.yaml\n")
        assert (folder / "other.yaml").read_text() == WIDE

    def test_a_project_whose_schemas_are_not_there(self, folder: Path) -> None:
        (folder / "protogen.toml").write_text('schemas = ["nix.yaml"]\n')
        done = run("fmt")
        assert done.exit_code == 2
        assert "protogen.toml:1:12: error[PG033]: there is nothing at `nix.yaml`" in done.output

    def test_without_a_project(self) -> None:
        done = run("fmt")
        assert done.exit_code == 2
        assert "no schema is named, and there is no protogen.toml that names some" in done.output


def test_no_such_file() -> None:
    done = run("fmt", "none.yaml")
    assert done.exit_code == 2
    assert "there is no file or folder `none.yaml`" in done.output
