"""A run that has nothing to do does not compile, and a run that has something always does."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from cli_support import SINK, run, start

import protogen.compiler
from protogen import program
from protogen.project import record

END = "<!-- /protogen -->"
DIALECT = "protocol: dialect\nextends: base/sink.yaml\ntitle: Other\n"


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The schemas that are compiled from now on."""
    names: list[str] = []
    original = protogen.compiler.compile_file

    def spy(path: Path, **options: bool) -> protogen.compiler.Compilation:
        names.append(path.name)
        return original(path, **options)

    monkeypatch.setattr(protogen.compiler, "compile_file", spy)
    return names


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compiled: list[str]) -> Path:
    """A project that was just generated; its base is not one of its own schemas."""
    (tmp_path / "base").mkdir()
    (tmp_path / "base" / "sink.yaml").write_text(SINK)
    (tmp_path / "dialect.yaml").write_text(DIALECT)
    (tmp_path / "notes.md").write_text(f"<!-- protogen:dialect.lists -->\n{END}\n")
    (tmp_path / "protogen.toml").write_text(
        'schemas = ["*.yaml"]\nblocks = ["notes.md"]\n[c]\nstubs = true\n'
    )
    monkeypatch.chdir(tmp_path)
    assert run("generate", "-q").exit_code == 0
    compiled.clear()
    return tmp_path


def test_nothing_is_compiled_and_the_same_is_said(folder: Path, compiled: list[str]) -> None:
    fast = [run("generate").output, run("generate", "--check").output]
    assert run("generate", "--diff").output == ""
    assert run("generate", "--quiet").output == ""
    assert compiled == []
    (path,) = (folder / record.FOLDER).glob("*.json")
    path.unlink()
    assert [run("generate").output, run("generate", "--check").output] == fast
    assert set(compiled) == {"dialect.yaml"}


def test_git_does_not_see_the_record(folder: Path) -> None:
    subprocess.run(["git", "init", "-q"], check=True)
    text = subprocess.run(
        ["git", "status", "--porcelain"], capture_output=True, text=True, check=True
    ).stdout
    assert "notes.md" in text
    assert record.FOLDER not in text


def edit(name: str, old: str, new: str) -> Callable[[Path], None]:
    def change(folder: Path) -> None:
        path = folder / name
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new, 1))

    return change


def remove(name: str) -> Callable[[Path], None]:
    return lambda folder: (folder / name).unlink()


def copy(name: str, to: str) -> Callable[[Path], None]:
    def change(folder: Path) -> None:
        (folder / to).write_text((folder / name).read_text())

    return change


def new_schema(folder: Path) -> None:
    (folder / "fresh.yaml").write_text(DIALECT.replace("dialect", "fresh"))


CHANGES = {
    "schema": edit("dialect.yaml", "Other", "Another"),
    "comment in a schema": edit("dialect.yaml", "Other", "Other # really"),
    "base": edit("base/sink.yaml", "id: E", "id: X"),
    "new schema": new_schema,
    "output by hand": edit("generated/python/dialect.py", "import", "import  "),
    "first line by hand": edit("generated/c/dialect.h", "generated", "generated "),
    "output deleted": remove("generated/markdown/index.md"),
    "file without a banner": edit("generated/c/library.json", "{", "{ "),
    "manifest": remove("generated/c/manifest.json"),
    "stubs deleted": remove("generated/c/dialect_stubs.c"),
    "stale file of ours": copy("generated/python/dialect.py", "generated/python/old.py"),
    "block by hand": edit("notes.md", "`points[i].x`", "`points`"),
    "around a block": edit("notes.md", END, f"{END}\nmore\n"),
    "options": edit("protogen.toml", "[c]", '[c]\nevents = "messages"'),
    "targets": edit("protogen.toml", "[c]", "[python]\nstandalone = true\n[c]"),
    "output": edit("protogen.toml", "blocks", 'output = "other"\nblocks'),
    "base outside of the project": lambda folder: (folder / "base" / ".git").touch(),
    "record damaged": lambda folder: [
        path.write_text("{") for path in (folder / record.FOLDER).glob("*.json")
    ],
    "record of something else": lambda folder: [
        path.write_text('{"made": [{"a": 1}]}') for path in (folder / record.FOLDER).glob("*.json")
    ],
}


@pytest.mark.parametrize("change", CHANGES)
def test_no_change_is_missed(change: str, folder: Path, compiled: list[str]) -> None:
    CHANGES[change](folder)
    result = run("generate", "--check")
    assert "dialect.yaml" in compiled, result.output


def test_the_user_may_go_on_with_stubs(folder: Path, compiled: list[str]) -> None:
    edit("generated/c/dialect_stubs.c", "(void)", "(void) ")(folder)
    assert run("generate", "--check").exit_code == 0
    assert compiled == []


def test_another_program(
    folder: Path, compiled: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(program, "VERSION", "9.9.9")
    run("generate", "--check")
    assert compiled == ["dialect.yaml"]


def test_a_changed_file_of_the_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.py").write_text("1")
    monkeypatch.setattr(program, "_PACKAGE", tmp_path)
    before = program.program()
    assert program.program() == before
    (tmp_path / "a.py").write_text("longer")
    changed = program.program()
    (tmp_path / "b.j2").write_text("")
    assert len({before, changed, program.program()}) == 3


def test_options_do_not_forget_each_other(folder: Path, compiled: list[str]) -> None:
    run("generate", "--target", "python", "-q")
    compiled.clear()
    run("generate", "-q")
    run("generate", "--target", "python", "-q")
    assert compiled == []


def test_problems_are_shown_each_time(folder: Path, compiled: list[str]) -> None:
    edit("dialect.yaml", "title", "nonsense: 1\ntitle")(folder)
    assert run("generate").exit_code == 1
    assert run("generate").exit_code == 1
    assert compiled == ["dialect.yaml"] * 2


def test_a_folder_that_can_not_be_written(folder: Path, compiled: list[str]) -> None:
    for path in (folder / record.FOLDER).iterdir():
        path.unlink()
    (folder / record.FOLDER).rmdir()
    (folder / record.FOLDER).touch()
    assert run("generate", "-q").exit_code == 0
    assert run("generate", "-q").exit_code == 0
    assert compiled == ["dialect.yaml"] * 2


def test_checks_leave_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "sink.yaml").write_text(SINK)
    (tmp_path / "protogen.toml").write_text('schemas = ["sink.yaml"]\n')
    monkeypatch.chdir(tmp_path)
    assert run("generate", "--check", "-q").exit_code == 1
    assert run("generate", "--diff", "-q").exit_code == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["protogen.toml", "sink.yaml"]


def test_a_hundred_schemas_take_no_time(tmp_path: Path) -> None:
    """The aim is half a second, of the processor's time: the machine may be busy with others."""
    (tmp_path / "schemas").mkdir()
    for number in range(100):
        text = SINK.replace("protocol: sink", f"protocol: sink{number}")
        (tmp_path / "schemas" / f"sink{number}.yaml").write_text(text)
    (tmp_path / "protogen.toml").write_text("")
    assert start("generate", "-q", cwd=tmp_path).returncode == 0
    times = []
    for _ in range(3):
        before = os.times()
        assert start("generate", "-q", cwd=tmp_path).returncode == 0
        after = os.times()
        times.append(
            after.children_user
            - before.children_user
            + after.children_system
            - before.children_system
        )
    assert min(times) < 2
