"""`protogen breaking` where the project's file was in another folder before."""

from __future__ import annotations

from pathlib import Path

import pytest
from repositories import GONE, OLD, SECOND, answer, complaint, git
from tooling import require_tool

THIRD = OLD.replace("protocol: demo", "protocol: third")
PROJECT = 'schemas = ["schemas", "../shared"]\n'
ARM = 'schemas = ["schemas"]\noutput = "made"\ntargets = ["c"]\n'


@pytest.fixture
def top(tmp_path: Path) -> Path:
    """A repository with a project in `robot`, one of whose schemas is in a folder beside it."""
    require_tool("git")
    git(tmp_path, "init", "--quiet", "--initial-branch", "main")
    write(tmp_path, "robot/protogen.toml", PROJECT)
    write(tmp_path, "robot/schemas/demo.yaml", OLD)
    write(tmp_path, "shared/second.yaml", SECOND)
    commit(tmp_path)
    return tmp_path


def write(top: Path, name: str, text: str) -> None:
    (top / name).parent.mkdir(parents=True, exist_ok=True)
    (top / name).write_text(text, encoding="utf-8")


def commit(top: Path) -> None:
    git(top, "add", "--all")
    git(top, "commit", "--quiet", "--message", "Before")


def move(top: Path, old: str, new: str) -> None:
    (top / new).parent.mkdir(parents=True, exist_ok=True)
    git(top, "mv", old, new)


def with_arm(top: Path, text: str) -> None:
    """Commit a second project, and move both."""
    write(top, "arm/protogen.toml", text)
    write(top, "arm/schemas/third.yaml", THIRD)
    commit(top)
    move(top, "arm", "limb")
    move(top, "robot", "firmware")
    write(top, "firmware/schemas/demo.yaml", GONE)


def test_its_schemas_stayed(top: Path) -> None:
    move(top, "robot/protogen.toml", "firmware/protogen.toml")
    write(top, "firmware/protogen.toml", 'schemas = ["../robot/schemas", "../shared"]\n')
    output = answer(top / "firmware", "breaking", code=0)
    assert output.endswith("compared 2 schemas, 0 new, 0 gone\n")
    write(top, "robot/schemas/demo.yaml", GONE)
    output = answer(top / "firmware", "breaking", code=1)
    assert "../robot/schemas/demo.yaml: ping\n  WIRE [message-deleted] ping" in output
    assert output.endswith("compared 2 schemas, 0 new, 0 gone\n")


def test_its_schemas_moved_to_third_places(top: Path) -> None:
    move(top, "robot/protogen.toml", "firmware/protogen.toml")
    move(top, "robot/schemas/demo.yaml", "common/demo.yaml")
    write(top, "firmware/protogen.toml", 'schemas = ["../common"]\n')
    (top / "shared" / "second.yaml").unlink()
    output = answer(top / "firmware", "breaking", code=1)
    assert "WIRE [schema-deleted] ../shared/second.yaml" in output
    assert output.endswith("compared 1 schema, 0 new, 1 gone\n")


@pytest.mark.parametrize("new", ["protogen.toml", "firmware/pyproject.toml"])
def test_git_has_not_been_told(new: str, top: Path) -> None:
    (top / "robot" / "protogen.toml").unlink()
    table = "[tool.protogen]\n" if new.endswith("pyproject.toml") else ""
    write(top, new, f'{table}schemas = ["schemas"]\n')
    folder = (top / new).parent
    (top / "robot" / "schemas").rename(folder / "schemas")
    output = answer(folder, "breaking", code=1)
    assert "WIRE [schema-deleted] ../shared/second.yaml" in output
    assert output.endswith("compared 1 schema, 0 new, 1 gone\n")


def test_git_tells_two_moved_projects_apart(top: Path) -> None:
    with_arm(top, ARM)
    output = answer(top / "firmware", "breaking", code=1)
    assert "WIRE [message-deleted] ping" in output
    assert output.endswith("compared 2 schemas, 0 new, 0 gone\n")
    output = answer(top / "limb", "breaking", code=0)
    assert output.endswith("compared 1 schema, 0 new, 0 gone\n")


def test_two_projects_of_one_text_are_not_guessed(top: Path) -> None:
    with_arm(top, PROJECT)
    words = " ".join(complaint(top / "firmware", "breaking").split())
    assert "`firmware/protogen.toml` is not in HEAD" in words
    assert "--against git:HEAD:FOLDER (arm, robot)" in words
    # As the hint says, named from the top.
    output = answer(top / "firmware", "breaking", "--against", "git:HEAD:robot", code=1)
    assert "WIRE [message-deleted] ping" in output
    assert output.endswith("compared 2 schemas, 0 new, 0 gone\n")


def test_a_project_that_stayed_is_not_what_a_new_one_was(top: Path) -> None:
    write(top, "arm/protogen.toml", ARM)
    write(top, "arm/schemas/third.yaml", THIRD)
    words = complaint(top / "arm", "breaking")
    assert "nothing was compared: git:HEAD holds none of these schemas" in words


def test_a_file_that_moved_to_another_new_project_is_not_meant(top: Path) -> None:
    move(top, "robot", "firmware")
    write(top, "arm/protogen.toml", ARM)
    write(top, "arm/schemas/third.yaml", THIRD)
    assert "nothing was compared" in complaint(top / "arm", "breaking")


def test_schemas_were_in_no_project(top: Path) -> None:
    (top / "robot" / "protogen.toml").unlink()
    commit(top)
    write(top, "firmware/protogen.toml", 'schemas = ["../robot/schemas"]\n')
    write(top, "robot/schemas/demo.yaml", GONE)
    output = answer(top / "firmware", "breaking", code=1)
    assert "WIRE [message-deleted] ping" in output
