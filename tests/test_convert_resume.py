"""A run that is killed leaves no half file; the same command then gives what one run gives."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from cli_support import PATIENCE, ROOT, SINK, run
from test_json_lines import capture_of

from protogen.convert.batches import Tally
from protogen.convert.outputs import Pending, write_whole
from protogen.convert.state import RECORD, Done, State

pytest.importorskip("pyarrow")


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A schema and three captures."""
    folder = tmp_path_factory.mktemp("resume")
    schema = folder / "sink.yaml"
    schema.write_text(SINK)
    piece = capture_of(schema, "pc", 5, 300)
    for name, times in (("one", 1), ("two", 40), ("three", 1)):
        (folder / f"{name}.bin").write_bytes(piece * times)
    return folder


def command(workspace: Path, output: Path, to: str) -> list[str]:
    captures = [str(workspace / f"{name}.bin") for name in ("one", "two", "three")]
    schema = str(workspace / "sink.yaml")
    return ["convert", schema, *captures, "--sender", "pc", "--to", to, "-o", str(output)]


def visible(folder: Path) -> dict[str, bytes]:
    """The files that a reader sees, with what is in them."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not path.name.startswith(".")
    }


@pytest.mark.parametrize("to", ["parquet", "jsonl", "mcap"])
@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGINT], ids=["killed", "interrupted"])
def test_a_killed_run_is_gone_on_with(
    workspace: Path, tmp_path: Path, to: str, end: signal.Signals
) -> None:
    whole, torn = tmp_path / "whole", tmp_path / "torn"
    assert run(*command(workspace, whole, to)).exit_code == 0
    inputs = tmp_path / "inputs"
    shutil.copytree(workspace, inputs)
    second = (inputs / "two.bin").read_bytes()
    (inputs / "two.bin").unlink()
    os.mkfifo(inputs / "two.bin")
    process = subprocess.Popen(
        [sys.executable, "-m", "protogen", *command(inputs, torn, to)],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    # The second capture never ends, so that the run is in the middle of it: rows enough for a file,
    # which Parquet begins with 131,072 of them.
    with (inputs / "two.bin").open("wb", buffering=0) as pipe:
        pipe.write(second * (75 if to == "parquet" else 8))
        _wait_for(lambda: (torn / RECORD).exists() and any(torn.rglob(".two.*")))
        process.send_signal(end)
        process.wait(timeout=PATIENCE)
    (inputs / "two.bin").unlink()
    (inputs / "two.bin").write_bytes(second)
    assert process.returncode == (-signal.SIGKILL if end is signal.SIGKILL else 130)
    expected = visible(whole)
    before = visible(torn)
    assert before == {name: data for name, data in expected.items() if "one" in name}
    if end is signal.SIGINT:
        assert not list(torn.rglob("*.partial"))
    again = run(*command(inputs, torn, to))
    assert again.exit_code == 0
    assert again.output.splitlines()[0].endswith("one.bin: done before, nothing has changed since")
    assert again.output.count("done before") == 1
    assert visible(torn) == expected
    assert not list(torn.rglob("*.partial"))


def _wait_for(condition: object) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():  # type: ignore[operator]
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_a_changed_capture_is_converted_again(workspace: Path, tmp_path: Path) -> None:
    capture = tmp_path / "run.bin"
    schema = str(workspace / "sink.yaml")
    arguments = ["convert", schema, str(capture), "--sender", "pc", "--to", "csv"]
    arguments += ["-o", str(tmp_path / "out")]
    capture.write_bytes((workspace / "one.bin").read_bytes())
    assert run(*arguments).exit_code == 0
    assert (tmp_path / "out" / "numbers" / "run.csv").exists()
    capture.write_bytes(b"only noise now")
    again = run(*arguments)
    assert again.exit_code == 0
    assert "done before" not in again.output
    assert sorted(visible(tmp_path / "out")) == [
        "invalid_spans/run.columns.json",
        "invalid_spans/run.csv",
    ]


def test_a_lost_file_is_made_again(workspace: Path, tmp_path: Path) -> None:
    arguments = command(workspace, tmp_path, "arrow")[:3]
    arguments += ["--sender", "pc", "--to", "arrow", "-o", str(tmp_path)]
    assert run(*arguments).exit_code == 0
    (tmp_path / "numbers" / "one.arrow").unlink()
    assert "done before" not in run(*arguments).output
    assert (tmp_path / "numbers" / "one.arrow").exists()


class TestState:
    def test_what_can_not_be_read_is_no_record(self, tmp_path: Path) -> None:
        for text in ("", "[]", '{"version": 2}', '{"version": 1, "captures": {"a": {}}}'):
            (tmp_path / RECORD).write_text(text)
            assert State(tmp_path).finished("a", {}) is None

    def test_files_that_were_expected_are_owned_but_not_finished(self, tmp_path: Path) -> None:
        (tmp_path / "a.csv").write_text("")
        State(tmp_path).expect("a", ["a.csv"])
        state = State(tmp_path)
        assert state.owns("a.csv")
        assert not state.owns("b.csv")
        assert state.finished("a", {"size": 1}) is None
        state.record("a", Done({"size": 1}, ["a.csv"], Tally(3), "raw bytes"))
        found = State(tmp_path).finished("a", {"size": 1})
        assert found is not None
        assert found.tally == Tally(3)
        assert json.loads((tmp_path / RECORD).read_text())["version"] == 1


class TestPending:
    def test_files_appear_together(self, tmp_path: Path) -> None:
        pending = Pending(tmp_path)
        for name in ("a/x.csv", "b/x.csv"):
            pending.path(name).write_text(name)
        assert visible(tmp_path) == {}
        assert pending.commit() == ["a/x.csv", "b/x.csv"]
        assert sorted(visible(tmp_path)) == ["a/x.csv", "b/x.csv"]

    def test_nothing_is_left_of_what_is_discarded(self, tmp_path: Path) -> None:
        pending = Pending(tmp_path)
        pending.path("a/x.csv").write_text("")
        pending.path("y.csv")
        pending.discard()
        assert list(tmp_path.iterdir()) == []

    def test_a_whole_file_replaces_another(self, tmp_path: Path) -> None:
        for text in (b"one", b"two"):
            write_whole(tmp_path / "deep" / "file", text)
        assert (tmp_path / "deep" / "file").read_bytes() == b"two"


@pytest.mark.parametrize("to", ["parquet"])
def test_memory_does_not_grow_with_the_capture(workspace: Path, tmp_path: Path, to: str) -> None:
    """What a process needs at most, for a capture and for one of eight times its size."""
    code = (
        "import sys; from protogen.cli import app\n"
        "app(sys.argv[1:], standalone_mode=False)\n"
        # Not getrusage: its maximum begins with what the process that made this one had.
        "status = open('/proc/self/status').read()\n"
        "print(int(status.split('VmHWM:')[1].split()[0]) // 1024)"
    )
    piece = (workspace / "one.bin").read_bytes()
    peaks = []
    for megabytes in (1, 8):
        capture = tmp_path / f"{megabytes}.bin"
        capture.write_bytes(piece * (megabytes * 1_000_000 // len(piece)))
        arguments = ["convert", str(workspace / "sink.yaml"), str(capture), "--sender", "pc", "-q"]
        arguments += ["--to", to, "-o", str(tmp_path / "out")]
        done = subprocess.run(
            [sys.executable, "-c", code, *arguments],
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            check=True,
        )
        peaks.append(int(done.stdout.split()[-1]))
    assert peaks[1] < 300
    assert peaks[1] - peaks[0] < 100, peaks
