"""A run that is killed leaves no half file; the same command then gives what one run gives."""

from __future__ import annotations

import errno
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from threading import Thread

import pytest
from cli_support import PATIENCE, ROOT, SINK, run
from click.testing import Result
from test_json_lines import capture_of

import protogen
from protogen.convert.columns.batches import Tally
from protogen.convert.columns.tables import tables_of
from protogen.convert.errors import ConvertError
from protogen.convert.formats import OutputFormat
from protogen.convert.runs import folder_locks
from protogen.convert.runs.folder_locks import alone
from protogen.convert.runs.run_record import RECORD, Done, State
from protogen.convert.writers.format_writers import first_files
from protogen.convert.writers.pending_files import Pending, forget_torn, write_whole

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


@pytest.mark.parametrize("to", ["parquet", "jsonl", "mcap", "mcap-ros2"])
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


_KILLED_EVERYWHERE = """
import os, shutil, sys
from pathlib import Path
import protogen
from protogen.convert.formats import OutputFormat
from protogen.convert.runs.conversion import Job, convert, plan

schema, folder, to = Path(sys.argv[1]), Path(sys.argv[2]), OutputFormat(sys.argv[3])
protocol = protogen.load(schema)
runtime = protogen.module_of(protocol).PROTOCOL
capture, out = folder / "run.bin", folder / "out"


def go(target):
    job = Job(protocol, runtime, protocol.sender("pc"), to, target, engine="events")
    list(convert(job, plan(job, [str(capture)]), print, lambda count: None))


def tree(target):
    files = (path for path in sorted(target.rglob("*")) if path.is_file())
    found = {path.relative_to(target).as_posix(): path.read_bytes() for path in files}
    del found[".protogen-convert.json"]
    return found


def killed(step):
    if (child := os.fork()) == 0:
        steps = iter(range(1, step))

        def hook(event, arguments):
            if event in ("open", "os.rename", "os.remove", "os.rmdir", "os.mkdir"):
                if any(str(out) in str(it) for it in arguments) and next(steps, None) is None:
                    os._exit(9)

        sys.addaudithook(hook)
        go(out)
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 9


go(folder / "before")
before = tree(folder / "before")
capture.write_bytes(b"only noise")
go(folder / "after")
after = tree(folder / "after")
step = 0
while True:
    step += 1
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(folder / "before", out)
    if not killed(step):
        break
    for name, data in tree(out).items():
        is_hidden = name.rpartition("/")[2].startswith(".")
        assert is_hidden or data in (before.get(name), after.get(name))
    go(out)
    assert tree(out) == after, (step, sorted(tree(out)))
print(step)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="it forks")
@pytest.mark.parametrize("to", ["csv", "jsonl"])
def test_a_run_that_is_killed_anywhere_is_gone_on_with(
    workspace: Path, tmp_path: Path, to: str
) -> None:
    (tmp_path / "run.bin").write_bytes((workspace / "one.bin").read_bytes())
    arguments = [str(workspace / "sink.yaml"), str(tmp_path), to]
    done = subprocess.run(
        [sys.executable, "-c", _KILLED_EVERYWHERE, *arguments],
        cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE * 4, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert int(done.stdout) > 15


def test_captures_of_one_name_do_not_replace_each_other(workspace: Path, tmp_path: Path) -> None:
    for day in ("monday", "tuesday"):
        (tmp_path / day).mkdir()
        (tmp_path / day / "run.bin").write_bytes((workspace / "one.bin").read_bytes())
    schema, out = str(workspace / "sink.yaml"), tmp_path / "out"

    def convert(day: str, *more: str, sender: str = "pc") -> Result:
        capture = str(tmp_path / day / "run.bin")
        return run(
            "convert", schema, capture, "--sender", sender, "--to", "csv", "-o", str(out), *more
        )

    assert convert("monday").exit_code == 0
    before = visible(out)
    refused = convert("tuesday")
    assert refused.exit_code == 2
    assert f"{out} has tables called run of {tmp_path / 'monday' / 'run.bin'}" in refused.output
    assert convert("monday", sender="board").exit_code == 2
    assert visible(out) == before
    assert convert("tuesday", "--force").exit_code == 0
    assert convert("monday").exit_code == 2
    shutil.rmtree(out)
    assert convert("monday").exit_code == 0


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
def test_what_came_through_a_pipe_may_be_something_else_now(
    workspace: Path, tmp_path: Path
) -> None:
    pipe, out = tmp_path / "pipe", tmp_path / "out"
    os.mkfifo(pipe)
    sizes = []
    for name in ("one", "two"):
        data = (workspace / f"{name}.bin").read_bytes()
        writer = Thread(target=pipe.write_bytes, args=(data,))
        writer.start()
        schema = str(workspace / "sink.yaml")
        arguments = [schema, str(pipe), "--sender", "pc", "--to", "jsonl", "-o", str(out)]
        done = run("convert", *arguments)
        writer.join()
        assert done.exit_code == 0, done.output
        assert f"{len(data)} bytes" in done.output
        sizes.append((out / "pipe.jsonl").stat().st_size)
    assert sizes[1] > 30 * sizes[0]


class TestState:
    def test_what_can_not_be_read_is_no_record(self, tmp_path: Path) -> None:
        for text in ("", "[]", '{"version": 2}', '{"version": 1, "captures": {"a": {}}}'):
            (tmp_path / RECORD).write_text(text)
            assert State(tmp_path).finished("a", {}) is None

    def test_files_that_were_expected_are_owned_but_not_finished(self, tmp_path: Path) -> None:
        (tmp_path / "a.csv").write_text("")
        State(tmp_path).expect("a", ["a.csv"], {"capture": "x"})
        state = State(tmp_path)
        assert state.origin("a") == {"capture": "x"}
        assert state.origin("b") == {}
        assert state.owns("a.csv")
        assert not state.owns("b.csv")
        assert state.finished("a", {"size": 1}) is None
        state.record("a", Done({"size": 1}, ["a.csv"], Tally(3), "raw bytes"))
        found = State(tmp_path).finished("a", {"size": 1})
        assert found is not None
        assert found.tally == Tally(3)
        assert json.loads((tmp_path / RECORD).read_text())["version"] == 1

    def test_what_earlier_runs_made_stays_ours_until_it_is_done(self, tmp_path: Path) -> None:
        state = State(tmp_path)
        state.record("a", Done({"size": 1}, ["old.csv"], Tally(), ""))
        state.expect("a", ["new.csv"], {})
        assert State(tmp_path).files("a") == ["new.csv", "old.csv"]

    def test_runs_at_the_same_time_keep_what_others_did(self, tmp_path: Path) -> None:
        one, other = State(tmp_path / "out"), State(tmp_path / "out")
        one.record("a", Done({"size": 1}, [], Tally(1), ""))
        other.record("b", Done({"size": 2}, [], Tally(2), ""))
        found = State(tmp_path / "out")
        assert found.finished("a", {"size": 1}) is not None
        assert found.finished("b", {"size": 2}) is not None

    def test_a_capture_has_a_line_of_the_record(self, tmp_path: Path) -> None:
        state = State(tmp_path)
        for size, name in ((1, "b"), (2, 'a"'), (3, "b")):
            state.record(name, Done({"size": size}, [f"{name}.csv"], Tally(size), "raw"))
        text = (tmp_path / RECORD).read_text()
        captures = json.loads(text)["captures"]
        assert {name: it["stamp"]["size"] for name, it in captures.items()} == {'a"': 2, "b": 3}
        assert len(text.splitlines()) == 4

    def test_what_has_no_size_is_never_finished(self, tmp_path: Path) -> None:
        state = State(tmp_path)
        state.record("a", Done({"size": None}, [], Tally(), ""))
        assert state.finished("a", {"size": None}) is None


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such locks")
class TestLocks:
    def test_one_run_at_a_time_writes_a_capture(self, workspace: Path, tmp_path: Path) -> None:
        arguments = command(workspace, tmp_path, "csv")
        with alone(tmp_path, "two.csv"):
            held = run(*arguments)
        assert held.exit_code == 2
        assert f"another run is writing two.csv in {tmp_path}" in held.output
        assert run(*arguments).exit_code == 0
        assert not list(tmp_path.glob(".*.lock"))

    def test_the_lock_of_a_file_that_was_removed_is_none(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def lock_late(descriptor: int, *, wait: bool) -> bool:
            if not late:
                (tmp_path / ".a.lock").unlink()  # As the run does that had it until now.
            late.append(descriptor)
            return lock(descriptor, wait=wait)

        lock, late = folder_locks._lock, list[int]()
        monkeypatch.setattr(folder_locks, "_lock", lock_late)
        with alone(tmp_path, "a"):
            assert len(late) == 2
            with pytest.raises(ConvertError), alone(tmp_path, "a"):
                pass

    def test_a_file_system_without_locks_is_as_good_as_it_can(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def refuse(descriptor: int, how: int) -> None:
            raise OSError(errno.ENOLCK, "no locks")

        monkeypatch.setattr("fcntl.flock", refuse)
        with alone(tmp_path, "a"), alone(tmp_path, "a"):
            assert (tmp_path / ".a.lock").exists()


class TestTorn:
    @pytest.mark.parametrize("to", list(OutputFormat))
    def test_all_files_of_a_format_are_known(
        self, workspace: Path, tmp_path: Path, to: OutputFormat
    ) -> None:
        pytest.importorskip("mcap")
        assert run(*command(workspace, tmp_path, to)).exit_code == 0
        protocol = protogen.load(workspace / "sink.yaml")
        tables = tables_of(protocol, protocol.sender("pc"))
        known = {file for name in ("one", "two", "three") for file in first_files(to, name, tables)}
        assert known >= set(visible(tmp_path))

    def test_nothing_is_left_of_what_was_killed(self, tmp_path: Path) -> None:
        here = tmp_path / "gyro"
        here.mkdir()
        (here / "x.csv").touch()
        (here / "x.part-0001.csv").touch()
        for name in ("x", "x.part-0002", "x.part-0003", "y"):
            (here / f".{name}.csv.partial").touch()
        (tmp_path / "other").mkdir()
        (tmp_path / "other" / ".x.csv.partial").touch()
        forget_torn(tmp_path, ["gyro/x.csv", "other/x.csv", "third/x.csv"])
        assert sorted(path.name for path in here.iterdir()) == [
            ".x.csv.partial", ".y.csv.partial", "x.csv", "x.part-0001.csv",
        ]  # fmt: skip
        assert not (tmp_path / "other").exists()


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

    def test_what_has_too_long_a_name_leaves_nothing(self, tmp_path: Path) -> None:
        pending = Pending(tmp_path)
        with pytest.raises(OSError, match="too long") as found:
            pending.path(f"a/{'x' * 300}").write_text("")
        pending.discard()
        assert found.value.errno == errno.ENAMETOOLONG
        assert list(tmp_path.iterdir()) == []

    def test_what_is_not_whole_leaves_nothing_and_is_told_by_name(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fill(path: Path, data: bytes) -> None:
            path.touch()
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

        write_whole(tmp_path / "file", b"before")
        monkeypatch.setattr(Path, "write_bytes", fill)
        with pytest.raises(OSError, match=r"file'$") as found:
            write_whole(tmp_path / "file", b"after")
        assert found.value.filename == str(tmp_path / "file")
        assert [path.name for path in tmp_path.iterdir()] == ["file"]
        assert (tmp_path / "file").read_bytes() == b"before"

    def test_a_whole_file_replaces_another(self, tmp_path: Path) -> None:
        for text in (b"one", b"two"):
            write_whole(tmp_path / "deep" / "file", text)
        assert (tmp_path / "deep" / "file").read_bytes() == b"two"


@pytest.mark.parametrize("to", ["parquet"])
def test_memory_does_not_grow_with_the_capture(workspace: Path, tmp_path: Path, to: str) -> None:
    """Memory that a process needs. Rows of the larger capture would show, if they stayed."""
    code = (
        "import sys; from protogen.cli import app\n"
        "app(sys.argv[1:], standalone_mode=False)\n"
        # Not getrusage: its maximum begins with what the process that made this one had.
        "status = open('/proc/self/status').read()\n"
        "print(int(status.split('VmHWM:')[1].split()[0]) // 1024)"
    )
    piece = (workspace / "one.bin").read_bytes()
    peaks = []
    for megabytes in (16, 64):
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
    assert peaks[1] - peaks[0] < 40, peaks
