"""The hooks for pre-commit and the workflow of `regenerate-in-ci.md` do what is said of them."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from cli_support import PATIENCE, ROOT, run, start
from tooling import require_module, require_tool

HOOKS = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
IDS = [hook["id"] for hook in HOOKS]
PAGE = (ROOT / "docs" / "howto" / "regenerate-in-ci.md").read_text(encoding="utf-8")
BLOCKS = [yaml.safe_load(text) for text in re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)]


def steps() -> list[str]:
    """The commands of the workflow that are ours."""
    (workflow,) = [block for block in BLOCKS if "jobs" in block]
    (job,) = workflow["jobs"].values()
    lines = [step["run"] for step in job["steps"] if "run" in step]
    return [line for line in lines if line.startswith("protogen ")]


def told() -> list[str]:
    """The commands in the tables and texts of the page."""
    return [line for line in re.findall(r"`(protogen [^`]+)`", PAGE) if "-" in line]


def hooked() -> list[str]:
    return [" ".join([hook["entry"], *hook.get("args", [])]) for hook in HOOKS]


class TestCommands:
    @pytest.mark.parametrize("line", sorted({*steps(), *told(), *hooked()}))
    def test_exist_with_their_options(self, line: str) -> None:
        line = re.sub(r"\$\{\{.*?\}\}", "main", line)
        program, command, *arguments = shlex.split(line)
        assert program == "protogen"
        shown = run(command, "--help")
        assert shown.exit_code == 0, shown.output
        for option in (word for word in arguments if word.startswith("--")):
            assert re.search(rf"{option}\b", shown.output), option

    def test_of_the_workflow_annotate_pull_requests(self) -> None:
        assert any("check" in step and "--format github" in step for step in steps())

    def test_hooks_are_those_that_the_page_names(self) -> None:
        named = {
            hook["id"]
            for block in BLOCKS
            for repo in block.get("repos", [])
            for hook in repo["hooks"]
        }
        assert named == set(IDS)


# --- tests that fail by chance --------------------------------------------------------------------

TRIED = """
from pathlib import Path
from hypothesis import given, strategies

MARK = Path(__file__).with_name("mark")


def test_passes():
    assert True


def test_fails_once():
    tried, _ = MARK.exists(), MARK.write_text("")
    assert tried, "by chance"


@given(strategies.integers())
def test_always_fails_where_a_property_is_wrong(number):
    assert abs(number) < 300
"""


@pytest.fixture
def tried(tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs tests as CI does."""
    file = tmp_path / "test_tried.py"
    file.write_text(TRIED, encoding="utf-8")

    def runs(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [ROOT / ".ci" / "tests", sys.executable, "-q", str(file), *arguments],
            env={**os.environ, "PYTEST_XDIST_AUTO_NUM_WORKERS": "1"},
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )

    return runs


class TestTriedAgain:
    def test_what_fails_by_chance_is_named(self, tried: Callable[..., Any]) -> None:
        done = tried("-k", "passes or once")
        assert done.returncode == 0, done.stderr
        closing, again, named, *wrong = done.stdout.splitlines()
        assert closing.startswith("1 failed, 1 passed")
        assert again.startswith("Tried again: 1 passed")
        assert re.match(r"FAILED .*::test_fails_once", named)
        assert wrong[0].endswith("AssertionError: by chance")

    def test_what_is_wrong_fails_again(self, tried: Callable[..., Any]) -> None:
        done = tried()
        assert done.returncode == 1
        assert done.stdout == ""
        wrong = re.findall(r"^_+ (test_\w+) _+$", done.stderr, re.MULTILINE)
        assert sorted(wrong) == [
            *["test_always_fails_where_a_property_is_wrong"] * 2,
            "test_fails_once",
        ]


# --- the real pre-commit --------------------------------------------------------------------------


class Scratch:
    """A repository with schemas that takes our hooks from a clone, as a user's does."""

    def __init__(self, folder: Path, python: str) -> None:
        self._python = python
        self.hooks, self.user, self._bin = (folder / name for name in ("hooks", "user", "bin"))
        self._environment = {
            **os.environ,
            "PATH": f"{self._bin}{os.pathsep}{os.environ['PATH']}",
            "PYTHONPATH": str(ROOT),
            "PRE_COMMIT_HOME": str(folder / "home"),
            "GIT_CONFIG_GLOBAL": os.devnull,
        }
        for path in (self.hooks, self.user, self._bin):
            path.mkdir(parents=True)
        program = self._bin / "protogen"
        program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m protogen "$@"\n')
        program.chmod(0o755)

    @property
    def schema(self) -> Path:
        return self.user / "schemas" / "motor.yaml"

    def git(self, folder: Path, *arguments: str) -> str:
        identity = ["-c", "user.name=A", "-c", "user.email=a@b.c"]
        command = [require_tool("git"), "-C", str(folder), *identity, *arguments]
        return self._run(command, folder, check=True).stdout.strip()

    def commit(self, folder: Path) -> str:
        self.git(folder, "add", "--all")
        self.git(folder, "commit", "--quiet", "--no-verify", "--message", "a commit")
        return self.git(folder, "rev-parse", "HEAD")

    def pre_commit(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        self.git(self.user, "add", "--all")
        command = [self._python, "-m", "pre_commit", *arguments]
        return self._run(command, self.user, check=False)

    def _run(
        self, command: list[str], folder: Path, *, check: bool
    ) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            command,
            cwd=folder,
            env=self._environment,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
        assert not check or done.returncode == 0, done.stderr
        return done


@pytest.fixture
def scratch(tmp_path: Path) -> Scratch:
    require_module("pre_commit")
    return prepared(tmp_path)


def prepared(folder: Path, python: str = sys.executable) -> Scratch:
    """A repository with a schema that nothing is wrong with; `python` has pre-commit."""
    made = Scratch(folder, python)
    made.git(made.hooks, "init", "--quiet")
    text = (ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8")
    (made.hooks / ".pre-commit-hooks.yaml").write_text(text)
    revision = made.commit(made.hooks)
    made.git(made.user, "init", "--quiet")
    made.schema.parent.mkdir()
    assert start("init", "motor", "-o", str(made.schema), cwd=made.user).returncode == 0
    assert start("generate", "-q", cwd=made.user).returncode == 0
    # What is installed is tested by the wheel; here the command is the one of this checkout.
    hooks: list[dict[str, Any]] = [{"id": name, "language": "system"} for name in IDS]
    repos = {"repos": [{"repo": str(made.hooks), "rev": revision, "hooks": hooks}]}
    (made.user / ".pre-commit-config.yaml").write_text(yaml.safe_dump(repos))
    made.commit(made.user)
    return made


class TestPreCommit:
    def test_hooks_pass_where_nothing_is_wrong(self, scratch: Scratch) -> None:
        done = scratch.pre_commit("run", "--all-files")
        assert done.returncode == 0, done.stdout
        assert done.stdout.count("Passed") == len(IDS)

    @pytest.mark.parametrize(
        ("hook", "old", "new", "said"),
        [
            ("protogen-check", "type: sint16", "type: snit16", "did you mean `sint16`?"),
            ("protogen-fmt", "type: sint16", "type:   sint16", "files were modified by this hook"),
            ("protogen-generate-check", "scale: 1/100", "scale: 1/10", "motor.py"),
            ("protogen-breaking", "type: sint16", "type: sint32", "temperature"),
        ],
    )
    def test_each_hook_stops_what_it_is_for(
        self, scratch: Scratch, hook: str, old: str, new: str, said: str
    ) -> None:
        text = scratch.schema.read_text()
        examples = re.compile(r"    examples:\n(?: {6}.*\n)+")
        changed = examples.sub("", text).replace(old, new)
        scratch.schema.write_text(examples.sub("", text))
        scratch.commit(scratch.user)
        scratch.schema.write_text(changed)
        done = scratch.pre_commit("run", hook)
        assert done.returncode == 1, done.stdout
        assert said in done.stdout

    def test_a_hook_that_lays_out_passes_the_second_time(self, scratch: Scratch) -> None:
        text = scratch.schema.read_text()
        scratch.schema.write_text(text.replace("title: ", "title:    "))
        assert scratch.pre_commit("run", "protogen-fmt").returncode == 1
        assert scratch.schema.read_text() == text
        assert scratch.pre_commit("run", "protogen-fmt").returncode == 0
