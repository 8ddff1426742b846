"""`protogen generate --watch`, and what notices changes for it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from cli_support import PATIENCE, ROOT, SINK, run, start

from protogen.cli.generation import watching
from protogen.project.watch import changes, states, wait_for_change

DIALECT = "protocol: dialect\nextends: base/sink.yaml\ntitle: Other\n"


class TestStates:
    def test_what_has_changed(self, tmp_path: Path) -> None:
        one, two, three = (tmp_path / name for name in ("one", "two", "three"))
        one.touch()
        two.touch()
        before = states([one, two, three])
        assert before[three] is None
        two.write_text("more")
        three.touch()
        one.unlink()
        assert changes(before, states([one, two, three])) == (one, three, two)

    def test_a_change_counts_when_it_has_settled(self, tmp_path: Path) -> None:
        path = tmp_path / "a"
        path.touch()
        texts = iter(["", "x", "xx", "xxx"])

        def sleep(_: float) -> None:
            path.write_text(next(texts, "xxx"))
            os.utime(path, (1, 1))  # Times may be coarser than changes are fast.

        before = states([path])
        assert wait_for_change(before, lambda: [path], sleep) == (path,)
        assert next(texts, None) is None

    def test_files_may_come(self, tmp_path: Path) -> None:
        found = [[tmp_path / "a"], [tmp_path / "a", tmp_path / "b"]]
        (tmp_path / "b").touch()
        looks = iter(found)
        changed = wait_for_change(
            states(found[0]), lambda: next(looks, found[1]), lambda seconds: None
        )
        assert changed == (tmp_path / "b",)


def test_what_changes_while_it_is_read_for_the_first_time_is_a_change(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs: list[int] = []
    original = watching.generate_once

    def generate_once(*given: Any) -> int:
        code = original(*given)
        runs.append(code)
        if len(runs) == 1:
            put(folder / "base" / "sink.yaml", SINK.replace("id: E", "id: X"))
        if len(runs) == 2:
            raise KeyboardInterrupt
        return code

    monkeypatch.chdir(folder)
    monkeypatch.setattr(watching, "generate_once", generate_once)
    output = run("generate", "--watch").output
    assert runs == [0, 0]
    assert "changed: base/sink.yaml\nwrote generated/python/" in output


class Watch:
    """The command as a process, whose output is read line by line."""

    def __init__(self, folder: Path, *options: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "protogen", "generate", "--watch", *options],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": str(ROOT), "NO_COLOR": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def until(self, words: str) -> str:
        """Read up to the line with these words; return all of it."""
        assert self.process.stdout is not None
        lines = []
        for line in self.process.stdout:
            lines.append(line)
            if words in line:
                return "".join(lines)
        raise AssertionError(f"{words} is not in {''.join(lines)}")

    def interrupt(self) -> int:
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(PATIENCE)


def put(path: Path, text: str) -> None:
    """Write a file that is whole at once: whoever looks while this waits finds no half of it."""
    fresh = path.with_name(f".{path.name}.new")
    fresh.write_text(text)
    fresh.replace(path)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "base").mkdir()
    (tmp_path / "base" / "sink.yaml").write_text(SINK)
    (tmp_path / "dialect.yaml").write_text(DIALECT)
    (tmp_path / "protogen.toml").write_text('schemas = ["*.yaml"]\ntargets = ["python"]\n')
    return tmp_path


@pytest.fixture
def watch(folder: Path) -> Iterator[Watch]:
    started = Watch(folder)
    yield started
    started.process.kill()
    started.process.wait()
    assert started.process.stdout is not None
    started.process.stdout.close()


def test_generates_after_each_change(folder: Path, watch: Watch) -> None:
    first = watch.until("watching")
    assert "wrote generated/python/dialect.py" in first
    assert "watching 3 files, Ctrl-C ends it" in first

    put(folder / "dialect.yaml", DIALECT.replace("Other", "Another"))
    assert watch.until("wrote") == ("changed: dialect.yaml\nwrote generated/python/dialect.py\n")
    watch.until("unchanged")

    put(folder / "base" / "sink.yaml", SINK.replace("id: E", "id: X"))
    assert "changed: base/sink.yaml" in watch.until("wrote generated/python/dialect.py")

    put(folder / "fresh.yaml", DIALECT.replace("dialect", "fresh"))
    assert "changed: fresh.yaml" in watch.until("wrote generated/python/fresh.py")

    (folder / "fresh.yaml").unlink()
    assert "changed: fresh.yaml" in watch.until("removed generated/python/fresh.py")

    put(folder / "protogen.toml", 'schemas = ["*.yaml"]\ntargets = ["markdown"]\n')
    assert "changed: protogen.toml" in watch.until("wrote generated/markdown/dialect.md")

    assert watch.interrupt() == 0


def test_bases_are_watched_where_nothing_had_to_be_compiled(folder: Path) -> None:
    assert start("generate", "-q", cwd=folder).returncode == 0
    watch = Watch(folder)
    try:
        assert "watching 3 files" in watch.until("watching")
        put(folder / "base" / "sink.yaml", SINK.replace("id: E", "id: X"))
        assert "changed: base/sink.yaml" in watch.until("wrote generated/python/dialect.py")
        assert watch.interrupt() == 0
    finally:
        watch.process.kill()
        watch.process.communicate()


def test_problems_do_not_end_it(folder: Path, watch: Watch) -> None:
    watch.until("watching")
    put(folder / "dialect.yaml", DIALECT.replace("sink.yaml", "more.yaml"))
    watch.until("error[PG022]")

    put(folder / "base" / "more.yaml", SINK)  # The base that was missing.
    assert "changed: base/more.yaml" in watch.until("unchanged")

    put(folder / "protogen.toml", "schmas = 1\n")
    watch.until("error[PG031]")
    put(folder / "protogen.toml", 'schemas = ["*.yaml"]\n[c]\nonly = ["none"]\n')
    watch.until("has no message `none`")
    put(folder / "protogen.toml", 'schemas = ["*.yaml"]\ntargets = ["c"]\n')
    watch.until("wrote generated/c/dialect.h")
    (folder / "dialect.yaml").unlink()
    watch.until("error[PG033]")
    put(folder / "dialect.yaml", DIALECT)
    watch.until("unchanged")
    assert watch.interrupt() == 0


def test_filled_pages_are_no_change(folder: Path) -> None:
    put(folder / "a.md", "<!-- protogen:dialect.lists -->\n<!-- /protogen -->\n")
    with (folder / "protogen.toml").open("a") as stream:
        stream.write('blocks = ["*.md"]\n')
    watch = Watch(folder)
    try:
        assert "wrote a.md" in watch.until("watching")
        put(folder / "dialect.yaml", DIALECT.replace("Other", "Another"))
        assert "changed: dialect.yaml\n" in watch.until("unchanged")
        put(folder / "a.md", "<!-- protogen:dialect.empty -->\n<!-- /protogen -->\n")
        assert "changed: a.md" in watch.until("wrote a.md")
        assert watch.interrupt() == 0
    finally:
        watch.process.kill()
        watch.process.communicate()


def test_a_wrong_call_ends_it(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    for option in ("--check", "--diff"):
        result = run("generate", "--watch", option)
        assert result.exit_code == 2
        assert "--watch writes; --check and --diff do not" in result.stderr
    assert run("generate", "--watch", "--target", "pyton").exit_code == 2
    assert run("generate", "--watch", "none.yaml").exit_code == 2
