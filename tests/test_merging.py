"""Merging of branches that change different schemas: generated files must not conflict in git."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import permutations
from pathlib import Path

import pytest
from cli_support import run
from repositories import git
from tooling import require_tool

NAMES = ("alpha", "beta", "gamma", "omega")
BASE = """\
protocol: {name}
title: The line of {name}
endpoints: {{board: Sensor board, pc: Computer}}
byte_order: little
frame:
  start:   {{literal: 0xAA}}
  kind:    {{type: uint8, id: true}}
  payload: {{}}
  crc:     {{type: uint16, algorithm: CRC-16/KERMIT, covers: [kind, payload]}}
transparency:
  covers: kind..crc
  escape: {{byte: 0xAB, of: [0xAA, 0xAB], transform: {{xor: 0x20}}}}
messages:
  reading: {{id: 1, from: board, fields: {{value: {{type: uint16, unit: mm}}}}}}
"""
PING = "  ping: {id: 3, from: pc, fields: {n: uint8}%s}\n"
EXAMPLE = ", examples: {one: {frame: {hex: AA 03 07 D7 5E}, values: {n: 7}}}"
SLIP = "values: {n: 8}, contradicts: {fails: values, reads: {n: 7}, why: A slip}"
WRONG = EXAMPLE.replace("values: {n: 7}", SLIP)
EDITS: dict[str, Callable[[str], str]] = {
    "a title": lambda text: text.replace("The line", "The new line"),
    "a message": lambda text: text + PING % "",
    "a number": lambda text: text.replace("id: 1", "id: 2"),
    "the name of a message": lambda text: text.replace("reading", "measurement"),
    "the name of an endpoint": lambda text: text.replace("board", "sensor"),
    "a field": lambda text: text.replace("{value:", "{time: uint8, value:"),
    "a document": lambda text: f"{text}source: {{document: paper.pdf}}\n",
    "why there is no example": lambda text: f"{text}source: {{note: It shows no bytes}}\n",
    "an example": lambda text: text + PING % EXAMPLE,
    "an example that contradicts": lambda text: text + PING % WRONG,
    "a base": lambda text: f"extends: ../base.yaml\n{text}",
}
"""Ways to change a schema."""
SCHEMAS = "schemas"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository without schemas, in which the commands run."""
    require_tool("git")
    monkeypatch.chdir(tmp_path)
    git(tmp_path, "init", "--quiet", "--initial-branch", "main")
    (tmp_path / SCHEMAS).mkdir()
    (tmp_path / "protogen.toml").write_text("")
    (tmp_path / "base.yaml").write_text(BASE.format(name="base"))
    return tmp_path


def schema(folder: Path, name: str) -> Path:
    return folder / SCHEMAS / f"{name}.yaml"


def generate(folder: Path, *arguments: str) -> None:
    done = run("generate", "--quiet", *arguments)
    assert done.exit_code == 0, done.output


def commit(folder: Path) -> None:
    """Commit the schemas as they are, and what is generated from them."""
    generate(folder)
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--message", "Change")


def begin(folder: Path, names: Sequence[str]) -> dict[str, str]:
    """Commit schemas, and return their texts."""
    texts = {name: BASE.format(name=name) for name in names}
    for name, text in texts.items():
        schema(folder, name).write_text(text)
    commit(folder)
    return texts


def branch(folder: Path, name: str, changes: dict[str, str]) -> None:
    """Make a branch of main on which schemas have other texts."""
    git(folder, "checkout", "--quiet", "-b", name, "main")
    for changed, text in changes.items():
        schema(folder, changed).write_text(text)
    commit(folder)


def merge(folder: Path, ours: str, theirs: str) -> None:
    """Merge two branches without a conflict, and find that the files made of both are current."""
    git(folder, "checkout", "--quiet", "--detach", ours)
    git(folder, "merge", "--quiet", "--message", "Merge", theirs)
    generate(folder, "--check")


@pytest.mark.parametrize("edit", EDITS)
def test_branches_that_change_a_schema_each_merge(edit, folder):
    names = NAMES[:3]
    texts = begin(folder, names)
    for name in names:
        branch(folder, name, {name: EDITS[edit](texts[name])})
    for ours, theirs in permutations(names, 2):
        merge(folder, ours, theirs)


@pytest.mark.parametrize("names", [NAMES[:2], NAMES])
def test_branches_that_change_every_second_schema_merge(names, folder):
    texts = begin(folder, names)
    edits = ("an example that contradicts", "a base", "why there is no example", "a document")
    new = {name: EDITS[edit](texts[name]) for name, edit in zip(names, edits, strict=False)}
    branch(folder, "even", {name: new[name] for name in names[::2]})
    branch(folder, "odd", {name: new[name] for name in names[1::2]})
    merge(folder, "even", "odd")
    merge(folder, "odd", "even")


def test_a_conflict_of_branches_that_add_schemas_is_solved_by_generating(folder):
    begin(folder, NAMES[::3])
    for name in NAMES[1:3]:
        branch(folder, name, {name: BASE.format(name=name)})
    git(folder, "merge", "--quiet", NAMES[1], fails=True)
    assert "schemas" not in git(folder, "diff", "--name-only", "--diff-filter=U")
    generate(folder)
    assert "<<<<" not in (folder / "generated" / "markdown" / "index.md").read_text()
    generate(folder, "--check")
