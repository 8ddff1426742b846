"""A fleet makes the rows of one machine, whatever the split, and whoever dies."""

from __future__ import annotations

import errno
import gzip
import io
import os
import pickle
import signal
import socket
import subprocess
import sys
import time
from concurrent.futures import CancelledError
from contextlib import suppress
from pathlib import Path
from random import Random
from typing import Any, ClassVar

import pytest
from cli_support import PATIENCE, ROOT, SINK, run
from compiled import module_at, name_of, protocol_of, senders
from test_json_lines import capture_of

pytest.importorskip("numpy")
parquet = pytest.importorskip("pyarrow.parquet")
dataset = pytest.importorskip("pyarrow.dataset")

from protogen.convert.columns.batches import Tally  # noqa: E402
from protogen.convert.columns.decoders import column_decoders  # noqa: E402
from protogen.convert.columns.python_values import as_list  # noqa: E402
from protogen.convert.columns.tables import tables_of  # noqa: E402
from protogen.convert.errors import ConvertError  # noqa: E402
from protogen.convert.inputs.sources import Source  # noqa: E402
from protogen.convert.runs.byte_ranges import (  # noqa: E402
    END,
    START,
    Frame,
    RangeDecoder,
    guess_entry,
)
from protogen.convert.runs.capture_parts import (  # noqa: E402
    Part,
    PartDone,
    Work,
    convert_part,
    read_marker,
    write_marker,
)
from protogen.convert.runs.conversion import Fleet, Job, convert, plan  # noqa: E402
from protogen.convert.runs.fleet import LOCAL_CLUSTER, convert_fleet  # noqa: E402
from protogen.convert.runs.journal import MARKERS  # noqa: E402
from protogen.convert.runs.run_record import RECORD  # noqa: E402
from protogen.convert.writers.format_writers import OutputFormat  # noqa: E402
from protogen.version import VERSION  # noqa: E402

EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), senders(), ids=name_of)
RN1 = ROOT / "schemas" / "rn1.yaml"

# --- ranges ---------------------------------------------------------------------------------------


class Splitter:
    """Decodes a capture in ranges, as a fleet does, and all of it at once."""

    def __init__(self, path: Path, sender: str, data: bytes) -> None:
        self.protocol = protocol_of(path)
        self.tables = tables_of(self.protocol, self.protocol.sender(sender))
        self.make = column_decoders(self.tables, None)
        self.data = data
        self.repaired = 0

    def range(self, span: tuple[int, int], entry: Frame) -> tuple[list[Any], Tally, Frame]:
        """Rows, what was in them, and the exit."""
        decoder = RangeDecoder(io.BytesIO(self.data), len(self.data), span, entry, self.make)
        rows, tally = [], Tally()
        for batch in decoder.batches():
            tally.add(batch.tally)
            for item in batch.rows():
                columns = [as_list(values) for values in item.columns]
                rows += [(item.table.name, *row) for row in zip(*columns, strict=True)]
        return sorted(rows, key=lambda row: row[1]), tally, decoder.exit

    def split(self, places: list[int], lead: int) -> tuple[list[Any], Tally]:
        """The rows of all ranges, one after another."""
        rows, tally, right = [], Tally(), START
        for start, end in zip([0, *places], [*places, len(self.data)], strict=True):
            entry = START
            if start:
                stream = io.BytesIO(self.data)
                entry = guess_entry(stream, len(self.data), start, lead, self.make)
            self.repaired += entry != right
            found, amount, right = self.range((start, end), right)
            rows += found
            tally.add(amount)
        return rows, tally


@EVERY_SENDER
def test_ranges_give_the_rows_of_one_decoder(path: Path, sender: str) -> None:
    dice = Random(5)
    for seed in range(2):
        data = capture_of(path, sender, 30 + seed, 40)
        splitter = Splitter(path, sender, data)
        expected, amount, exit = splitter.range((0, len(data)), START)
        assert exit == END
        for pieces in (2, 6):
            places = sorted(dice.sample(range(1, len(data)), pieces - 1))
            rows, tally = splitter.split(places, lead=dice.choice([1, 64, 2000]))
            assert [repr(row) for row in rows] == [repr(row) for row in expected]
            assert tally == amount


def test_every_split_of_a_hostile_capture_gives_the_same_rows() -> None:
    """False starts in front of frames, and frames inside of what one decoder takes for noise."""
    path = ROOT / "schemas" / "matty.yaml"
    data = capture_of(path, "esp", 77, 12) * 2 + b"\x55" * 40 + capture_of(path, "esp", 78, 4)
    splitter = Splitter(path, "esp", data)
    expected, amount, _ = splitter.range((0, len(data)), START)
    for place in range(1, len(data), 5):
        rows, tally = splitter.split([place], lead=8)
        assert rows == expected
        assert tally == amount


def test_a_capture_without_frames_is_all_of_the_first_range() -> None:
    data = bytes(5000)
    splitter = Splitter(RN1, "brain", data)
    expected, _, _ = splitter.range((0, len(data)), START)
    rows, _ = splitter.split([1000, 2000, 3000], lead=100)
    assert rows == expected
    assert splitter.range((1000, 2000), END)[0] == []


def frames_in_frames() -> tuple[Path, bytes]:
    """A capture in which whole frames are the data of others, and nothing keeps them apart."""
    path = ROOT / "tests" / "framings" / "sync_length_crc.yaml"
    module = module_at(path)
    ping = module.encode(module.Ping())
    dumps = [module.encode(module.Dump(address=place, memory=ping * 5)) for place in range(60)]
    return path, b"".join(dumps)


def test_a_wrong_guess_is_seen_and_put_right() -> None:
    path, data = frames_in_frames()
    splitter = Splitter(path, "station", data)
    expected, amount, _ = splitter.range((0, len(data)), START)
    assert dict(amount.messages) == {"dump": 60}
    rows, tally = splitter.split(list(range(97, len(data), 97)), lead=0)
    assert rows == expected
    assert tally == amount
    assert splitter.repaired > 10


class _Far(io.BytesIO):
    """The end of a capture of terabytes."""

    FRONT: ClassVar = 7 << 40

    def seek(self, offset: int, whence: int = 0, /) -> int:
        assert whence == 0
        return super().seek(offset - self.FRONT) + self.FRONT


def test_ranges_meet_terabytes_behind_the_start() -> None:
    front, data = _Far.FRONT, capture_of(RN1, "brain", 5, 100)
    splitter = Splitter(RN1, "brain", data)
    size, middle = front + len(data), front + len(data) // 2
    decoder = RangeDecoder(_Far(data), size, (front, middle), Frame(front, 0), splitter.make)
    assert sum(batch.tally.bytes for batch in decoder.batches()) == decoder.exit.end - front
    assert middle < decoder.exit.end < size
    assert guess_entry(_Far(data), size, middle, 500, splitter.make) == decoder.exit


def test_a_capture_that_became_shorter_is_an_error() -> None:
    splitter = Splitter(RN1, "brain", bytes(100))
    decoder = RangeDecoder(io.BytesIO(bytes(50)), 100, (0, 100), START, splitter.make)
    with pytest.raises(EOFError, match="ends at byte 50, not at 100"):
        list(decoder.batches())


@pytest.mark.parametrize("entry", [START, None], ids=["known", "guessed"])
def test_a_capture_that_became_shorter_is_told_by_name(tmp_path: Path, entry: Frame | None) -> None:
    capture = tmp_path / "run.bin"
    capture.write_bytes(bytes(50))
    work = Work(protocol_of(RN1), "brain", str(tmp_path / "out"))
    part = Part("run.000000", str(capture), "run", {}, None, 100, (60, 100), entry)
    with pytest.raises(ConvertError, match=r"run\.bin: the capture ends at byte \d+, not at 100"):
        convert_part(work, part)
    assert not list(tmp_path.rglob("*.partial"))


def test_a_full_disk_is_told_by_the_name_of_the_folder(tmp_path: Path, monkeypatch: Any) -> None:
    def fill(*arguments: object) -> None:
        raise OSError(errno.ENOSPC, "no space")

    capture = tmp_path / "run.bin"
    capture.write_bytes(bytes(50))
    monkeypatch.setattr("protogen.convert.runs.capture_parts.write_all", fill)
    work = Work(protocol_of(RN1), "brain", str(tmp_path / "out"))
    for span in ((0, 50), None):
        with pytest.raises(OSError, match="no space") as found:
            convert_part(work, Part("run", str(capture), "run", {}, None, 50, span, START))
        assert pickle.loads(pickle.dumps(found.value)).filename == str(tmp_path / "out")


def test_parts_that_fit_are_not_looked_at_again() -> None:
    """Else captures of thousands of parts would take time that grows with their square."""
    from protogen.convert.runs import fleet

    class Counted(dict[int, PartDone]):
        looks = 0

        def get(self, place: int, other: Any = None) -> Any:
            self.looks += 1
            return super().get(place, other)

    done, count = Counted(), 100
    parts = [Part(f"run.{place}", "run.bin", "run", {}, None) for place in range(count)]
    capture = fleet._Capture("run", Source("run.bin"), Path(), "", {}, parts, done)
    frames = [START, *(Frame(place, 1) for place in range(count))]
    for place in range(count):
        assert not capture.is_done
        done[place] = PartDone(frames[place], frames[place + 1], Tally(), ())
        assert not list(capture.wrong())
    assert capture.is_done
    assert done.looks < 3 * count


def test_a_lost_scheduler_is_no_bug() -> None:
    distributed = pytest.importorskip("distributed")
    from protogen.convert.runs import fleet

    # Older versions have but the class that theirs is made of.
    error = getattr(distributed.client, "FutureCancelledError", CancelledError)

    class Future:
        def result(self) -> None:
            raise error("part", "scheduler-connection-lost")

    with pytest.raises(ConvertError, match="the scheduler is gone"):
        fleet._result(Future())


# --- real clusters --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def captures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with captures of RN1: large, noise, compressed, a log."""
    folder = tmp_path_factory.mktemp("captures")
    piece = capture_of(RN1, "brain", 5, 200)
    (folder / "large.bin").write_bytes(b"".join(piece[7 * i :] + piece for i in range(300)))
    (folder / "noise.bin").write_bytes(bytes(2_000_000))
    (folder / "small.bin.gz").write_bytes(gzip.compress(piece))
    lines = [f"({i}.5) brain {piece[8 * i : 8 * i + 8].hex()}" for i in range(50)]
    (folder / "lines.log").write_text("\n".join([*lines, "oops"]))
    return folder


NAMES = ("large.bin", "noise.bin", "small.bin.gz", "lines.log")


def arguments(captures: Path, output: Path, *names: str) -> list[str]:
    places = [str(captures / name) for name in names or NAMES]
    return ["convert", str(RN1), *places, "--sender", "brain", "--to", "parquet", "-o", str(output)]


@pytest.fixture(scope="module")
def whole(captures: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Tables that one machine makes of them."""
    folder = tmp_path_factory.mktemp("whole")
    done = run(*arguments(captures, folder))
    assert done.exit_code == 1, done.output  # one line of the log is lost
    return folder


def assert_same_rows(one: Path, other: Path, names: tuple[str, ...] = NAMES) -> None:
    tables = sorted(path.name for path in one.iterdir() if path.is_dir())
    assert tables == sorted(path.name for path in other.iterdir() if not path.name.startswith("."))
    for table in tables:
        for name in (name.partition(".")[0] for name in names):
            ours = [sorted(folder.glob(f"{table}/{name}.*")) for folder in (one, other)]
            assert bool(ours[0]) == bool(ours[1])
            if ours[0]:
                found = [dataset.dataset([*map(str, files)]).to_table() for files in ours]
                assert found[0].equals(found[1]), (table, name)
                assert found[0].schema.equals(found[1].schema, check_metadata=True), (table, name)
                assert {_capture_in(file) for each in ours for file in each} == {name}


def _capture_in(file: Path) -> str:
    """Which capture the metadata say that a file is of."""
    metadata = parquet.read_schema(file).metadata
    return str(metadata[b"protogen.capture"].decode())


def test_a_fleet_gives_the_rows_of_one_machine(captures: Path, whole: Path, tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    fleet = ["--dask", "--workers", "2", "--part-size", "1"]
    done = run(*arguments(captures, tmp_path), *fleet)
    assert done.exit_code == 1, done.output
    assert "lines.log: line 51: not `(SECONDS) [NAME] HEX`" in done.output
    assert len(list(tmp_path.glob("lidar/large.*"))) > 5
    assert_same_rows(whole, tmp_path)
    assert not list(tmp_path.rglob("*.partial"))
    assert not (tmp_path / MARKERS).exists()
    again = run(*arguments(captures, tmp_path), *fleet)
    assert again.output.count("done before") == 4
    first = run(*arguments(captures, whole))
    kept = [line for line in first.output.splitlines() if line.startswith("  ")]
    assert kept == [line for line in again.output.splitlines() if line.startswith("  ")]


def test_workers_on_this_machine_leave_ctrl_c_to_the_command() -> None:
    pytest.importorskip("distributed")
    from protogen.convert.runs import fleet

    with fleet._client(Fleet(workers=1), pytest.fail) as client:
        (handler,) = client.run(lambda: signal.getsignal(signal.SIGINT)).values()
    assert handler == signal.SIG_IGN


@pytest.mark.parametrize(
    "config",
    [
        {"preload": "preloaded.py"},
        {"preload": None},
        {"preload": ["preloaded.py"], "preload-argv": ["one"]},
        {"preload": ["preloaded.py"], "preload-argv": [["one"]]},
    ],
    ids=str,
)
def test_what_settings_have_workers_run_at_their_start_goes_in_front(
    config: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    dask = pytest.importorskip("dask")
    preloading = pytest.importorskip("distributed.preloading")
    from protogen.convert.runs import fleet

    monkeypatch.setattr(preloading, "_import_module", lambda name, folder: None)
    theirs = ["preloaded.py"] if config["preload"] else []
    with dask.config.set({f"distributed.worker.{key}": item for key, item in config.items()}):
        found = fleet._preloads()
    loaded = preloading.process_preloads(None, found["preload"], found["preload_argv"])
    assert [item.name for item in loaded] == [*theirs, fleet._DEAF]


_DYING = """
import os, signal, threading
from protogen.convert.runs import capture_parts as parts

def is_first(name):
    try:
        os.close(os.open(os.path.join({folder!r}, name), os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return False
    return True

def die():
    os.kill(os.getpid(), signal.SIGKILL)

def commit(pending):
    if is_first("in_front_of_files"):
        die()
    return settle(pending)

def write_marker(*arguments, **options):
    if is_first("in_front_of_marker"):
        die()
    write(*arguments, **options)
    if is_first("behind_marker"):  # While the result is on its way, or with the next part begun.
        threading.Timer(0.02, die).start()

if not hasattr(parts, "is_dying"):  # Dask may run it twice.
    parts.is_dying = True
    settle, write = parts.Pending.commit, parts.write_whole
    parts.Pending.commit, parts.write_whole = commit, write_marker
"""
"""Code that a worker runs first: the first ones that come so far end, as if killed."""


def test_a_worker_that_is_killed_loses_and_doubles_nothing(
    captures: Path, whole: Path, tmp_path: Path
) -> None:
    distributed = pytest.importorskip("distributed")
    died, fleets, single = (tmp_path / name for name in ("died", "fleet", "single"))
    died.mkdir()
    preload = tmp_path / "dying.py"
    preload.write_text(_DYING.format(folder=str(died)))
    with distributed.LocalCluster(n_workers=2, preload=[str(preload)], **LOCAL_CLUSTER) as cluster:
        fleet = ["--dask", cluster.scheduler_address, "--part-size", "1"]
        done = run(*arguments(captures, fleets, "large.bin"), *fleet)
    assert done.exit_code == 0, done.output
    assert sorted(path.name for path in died.iterdir()) == [
        "behind_marker", "in_front_of_files", "in_front_of_marker",
    ]  # fmt: skip
    assert run(*arguments(captures, single, "large.bin")).exit_code == 0
    assert len(list(fleets.glob("lidar/large.*"))) == 8
    assert_same_rows(single, fleets, ("large.bin",))
    assert not list(fleets.rglob("*.partial"))
    assert not (fleets / MARKERS).exists()


_WAITING = """
import time
from protogen.convert.runs import capture_parts as parts

def write_marker(path, *arguments, **options):
    write(path, *arguments, **options)
    if path.name.startswith("large."):
        written.append(path)
    while len(written) >= 3:
        time.sleep(1)

if not hasattr(parts, "is_waiting"):  # Dask may run it twice.
    parts.is_waiting = True
    written, write = [], parts.write_whole
    parts.write_whole = write_marker
"""
"""Code with which a worker gets no further than three parts of `large`, however late it ends."""


def test_a_fleet_goes_on_where_another_was_ended(
    captures: Path, whole: Path, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    pytest.importorskip("distributed")
    fleet = ["--dask", "--workers", "1", "--part-size", "1"]
    preload = tmp_path_factory.mktemp("preload") / "waiting.py"
    preload.write_text(_WAITING)
    preloaded = {"DASK_DISTRIBUTED__WORKER__PRELOAD": repr([str(preload)])}
    process = subprocess.Popen(
        [sys.executable, "-m", "protogen", *arguments(captures, tmp_path), *fleet],
        env={**os.environ, "PYTHONPATH": str(ROOT), **preloaded},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    deadline = time.monotonic() + PATIENCE
    while len(list((tmp_path / MARKERS).glob("large.*.json"))) < 3:
        assert process.poll() is None, "it ended before"
        assert time.monotonic() < deadline
        time.sleep(0.005)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait(timeout=PATIENCE)
    # What is left where the end comes while a worker writes down that a part is done.
    (tmp_path / MARKERS / ".large.000001.json.0123456789ab.partial").write_bytes(b"{")
    finished = [path.stem for path in (tmp_path / MARKERS).glob("large.*.json")]
    files = [tmp_path / "lidar" / f"{name}.parquet" for name in finished]
    stamps = {path: path.stat().st_mtime_ns for path in files}
    assert len(stamps) >= 3
    done = run(*arguments(captures, tmp_path), *fleet)
    assert done.exit_code == 1, done.output
    assert_same_rows(whole, tmp_path)
    assert not list(tmp_path.rglob("*.partial"))
    assert not (tmp_path / MARKERS).exists()
    assert stamps == {path: path.stat().st_mtime_ns for path in stamps}


def test_a_fleet_has_wrong_guesses_done_again(tmp_path: Path, monkeypatch: Any) -> None:
    distributed = pytest.importorskip("distributed")
    from protogen.convert.runs import capture_parts as parts

    path, data = frames_in_frames()
    (tmp_path / "run.bin").write_bytes(data)
    monkeypatch.setattr(parts, "lead_of", lambda tables: 0)
    out = tmp_path / "out"
    with distributed.LocalCluster(n_workers=1, processes=False, **LOCAL_CLUSTER) as cluster:
        job = job_of(path, "station", out)
        scheduler = Fleet(cluster.scheduler_address, None, 97)
        named = plan(job, [str(tmp_path / "run.bin")])
        (result,) = convert_fleet(job, named, scheduler, pytest.fail, lambda amount: None)
    assert dict(result.done.tally.messages) == {"dump": 60}
    found = dataset.dataset([str(out / file) for file in result.done.files]).to_table()
    assert found.column("address").to_pylist() == list(range(60))
    assert {path.name for path in out.rglob("*.parquet")} == {
        Path(f).name for f in result.done.files
    }


@pytest.mark.parametrize("ended", ["_finished", "finish"], ids=["in_front", "when_it_is_recorded"])
@pytest.mark.parametrize("second", [97, 10_000, None], ids=["same", "larger", "one_machine"])
def test_what_a_fleet_did_not_finish_is_not_left_beside_it(
    tmp_path: Path, monkeypatch: Any, second: int | None, ended: str
) -> None:
    distributed = pytest.importorskip("distributed")
    from protogen.convert.runs import fleet

    path, data = frames_in_frames()
    (tmp_path / "run.bin").write_bytes(data)
    out = tmp_path / "out"
    job = job_of(path, "station", out)
    named = plan(job, [str(tmp_path / "run.bin")])
    with distributed.LocalCluster(n_workers=1, processes=False, **LOCAL_CLUSTER) as cluster:

        def convert_in_parts(size: int) -> list[Any]:
            scheduler = Fleet(cluster.scheduler_address, None, size)
            return list(convert_fleet(job, named, scheduler, pytest.fail, lambda amount: None))

        def end(*arguments: Any) -> None:
            raise InterruptedError

        with monkeypatch.context() as patched:
            patched.setattr(fleet, ended, end)
            with pytest.raises(InterruptedError):
                convert_in_parts(97)
        assert len(list(out.glob("*/run.0*.parquet"))) > 3
        if second is None:
            (result,) = convert(job, named, pytest.fail, lambda amount: None)
        else:
            (result,) = convert_in_parts(second)
    assert {file.relative_to(out).as_posix() for file in out.rglob("*.parquet")} == {
        *result.done.files
    }
    assert sorted(item.name for item in out.iterdir() if item.name.startswith(".")) == [RECORD]


def job_of(path: Path, sender: str, folder: Path) -> Job:
    protocol = protocol_of(path)
    runtime = module_at(path).PROTOCOL
    return Job(protocol, runtime, protocol.sender(sender), OutputFormat.PARQUET, folder)


# --- what is refused ------------------------------------------------------------------------------


class TestOptions:
    @pytest.fixture
    def sink(self, tmp_path: Path) -> Path:
        (tmp_path / "sink.yaml").write_text(SINK)
        (tmp_path / "run.bin").write_bytes(b"noise")
        return tmp_path

    @pytest.mark.parametrize(
        ("options", "problem"),
        [
            (("--to", "csv", "--dask"), "--dask makes Parquet"),
            (
                ("--to", "parquet", "--dask", "tcp://127.0.0.1:1", "--workers", "2"),
                "--workers is for workers on this machine",
            ),
            (("--to", "parquet", "--workers", "2"), "--workers is for --dask"),
            (("--to", "parquet", "--part-size", "2"), "--part-size is for --dask"),
        ],
        ids=["csv", "workers", "workers alone", "part size alone"],
    )
    def test_that_do_not_go_together(
        self, sink: Path, options: tuple[str, ...], problem: str
    ) -> None:
        common = ["convert", str(sink / "sink.yaml"), str(sink / "run.bin"), "--sender", "pc"]
        done = run(*common, *options, "-o", str(sink / "out"))
        assert done.exit_code == 2
        assert problem in done.output

    def test_standard_input_is_for_one_machine(self, sink: Path) -> None:
        pytest.importorskip("distributed")
        common = ["convert", str(sink / "sink.yaml"), "-", "--sender", "pc", "--to", "parquet"]
        done = run(*common, "--dask", "-o", str(sink / "out"))
        assert (done.exit_code, "give files or URLs" in done.output) == (2, True)

    @pytest.mark.parametrize("error", [OSError("timed out"), TypeError("no ssl_context")])
    def test_no_scheduler(self, sink: Path, monkeypatch: Any, error: Exception) -> None:
        distributed = pytest.importorskip("distributed")

        def refuse(*arguments: object, **options: object) -> None:
            raise error

        monkeypatch.setattr(distributed, "Client", refuse)
        common = ["convert", str(sink / "sink.yaml"), str(sink / "run.bin"), "--sender", "pc"]
        done = run(*common, "--to", "parquet", "--dask", "nowhere:8786", "-o", str(sink / "out"))
        assert done.exit_code == 2
        assert f"no scheduler answers at nowhere:8786: {error}" in done.output

    @pytest.mark.parametrize("module", ["numpy", "pyarrow", "distributed"])
    def test_a_missing_package_is_named(self, sink: Path, module: str) -> None:
        """In a process of its own, as here all of them have been imported."""
        code = f"import sys; sys.modules[{module!r}] = None; from protogen.cli import main; main()"
        arguments = ["convert", "sink.yaml", "run.bin", "--sender", "pc", "--to", "parquet"]
        for fleet in ((), ("--dask",)):
            if (module, fleet) == ("distributed", ()):
                continue
            done = subprocess.run(
                [sys.executable, "-c", code, *arguments, *fleet],
                cwd=sink,
                env={**os.environ, "PYTHONPATH": str(ROOT)},
                capture_output=True,
                text=True,
                check=False,
            )
            assert done.returncode == 2, done.stderr
            assert f"needs the package {module}, which is not installed" in done.stderr
            assert "pip install 'protogen-serial[" in done.stderr

    def test_files_of_somebody_else_stay(self, sink: Path) -> None:
        pytest.importorskip("distributed")
        theirs = sink / "out" / "numbers" / "run.000000.parquet"
        theirs.parent.mkdir(parents=True)
        theirs.write_text("mine")
        common = ["convert", str(sink / "sink.yaml"), str(sink / "run.bin"), "--sender", "pc"]
        done = run(*common, "--to", "parquet", "--dask", "-o", str(sink / "out"))
        assert done.exit_code == 2
        assert "no earlier run made it" in done.output
        assert theirs.read_text() == "mine"

    def test_captures_whose_parts_have_one_name(self, sink: Path) -> None:
        pytest.importorskip("distributed")
        common = ["convert", str(sink / "sink.yaml"), "--sender", "pc", "--to", "parquet"]
        out = ["-o", str(sink / "out")]
        (sink / "run.000000.bin.gz").write_bytes(gzip.compress((sink / "run.bin").read_bytes()))
        packed, plain = str(sink / "run.000000.bin.gz"), str(sink / "run.bin")
        both = run(*common, plain, packed, "--dask", *out)
        assert both.exit_code == 2
        assert "would both be called run.000000" in both.output.replace("\n", " ")
        assert not list(sink.glob("out/*/*"))
        assert run(*common, packed, *out).exit_code == 0
        before = {path: path.read_bytes() for path in sink.glob("out/*/*")}
        assert {path.name for path in before} == {"run.000000.parquet"}
        for more in ([], ["--force"]):
            late = run(*common, plain, "--dask", *out, *more)
            assert late.exit_code == 2
            assert "made of another capture" in late.output.replace("\n", " ")
        assert {path: path.read_bytes() for path in sink.glob("out/*/*")} == before


# --- clusters of others ---------------------------------------------------------------------------


@pytest.fixture
def small(tmp_path: Path) -> list[str]:
    """The command that converts a little capture."""
    (tmp_path / "small.bin").write_bytes(capture_of(RN1, "brain", 5, 20))
    return arguments(tmp_path, tmp_path / "out", "small.bin")


class _FakeClient:
    """A scheduler's client whose workers say this."""

    said: ClassVar[dict[str, Any]]

    def __init__(self, address: str) -> None: ...

    def __enter__(self) -> _FakeClient:
        return self

    def __exit__(self, *error: object) -> None: ...

    def run(self, function: Any, *arguments: Any, on_error: str) -> dict[str, Any]:
        assert function(*arguments) == VERSION
        return self.said

    def submit(self, *arguments: Any, **options: Any) -> None:
        raise ConvertError("something was submitted")


@pytest.mark.parametrize(
    ("said", "problem"),
    [
        (ModuleNotFoundError("No module named 'protogen'"), "the worker tcp://b has no protogen"),
        ("0.0.1", f"the worker tcp://b has protogen 0.0.1, not {VERSION}"),
        (OSError("it has just gone"), "something was submitted"),
    ],
    ids=["none", "another", "not known"],
)
def test_workers_need_the_same_protogen(
    small: list[str], monkeypatch: pytest.MonkeyPatch, said: Any, problem: str
) -> None:
    """Else each of them ends when it is given a part, and the command waits for ever."""
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(_FakeClient, "said", {"tcp://b": said, "tcp://a": VERSION}, raising=False)
    monkeypatch.setattr(distributed, "Client", _FakeClient)
    done = run(*small, "--dask", "anywhere:1")
    assert (done.exit_code, problem in done.output) == (2, True), done.output


def test_a_scheduler_without_workers_is_said(
    small: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(_FakeClient, "said", {}, raising=False)
    monkeypatch.setattr(distributed, "Client", _FakeClient)
    done = run(*small, "--dask", "anywhere:1")
    assert "warning: the scheduler at anywhere:1 has no workers; waiting for some" in done.output


def test_workers_on_this_machine_take_no_port_that_others_have(
    small: list[str], recwarn: pytest.WarningsRecorder
) -> None:
    pytest.importorskip("distributed")
    with socket.socket() as taken:
        with suppress(OSError):  # Another one has it already.
            taken.bind(("127.0.0.1", 8787))
            taken.listen()
        done = run(*small, "--dask", "--workers", "1")
    assert done.exit_code == 0, done.output
    assert not [item for item in recwarn if "already in use" in str(item.message)]


def test_a_marker_holds_only_for_what_it_was_made_of(tmp_path: Path) -> None:
    part = Part("run.000000", "run.bin", "run", {"size": 3}, None)
    assert read_marker(tmp_path, part) is None
    done = PartDone(START, Frame(5, 8), Tally(3), ["a/run.000000.parquet"], ["lost"])
    write_marker(tmp_path, part, done)
    assert read_marker(tmp_path, part) is None  # its file is gone
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "run.000000.parquet").write_text("")
    assert read_marker(tmp_path, part) == done
    assert read_marker(tmp_path, Part("run.000000", "", "run", {"size": 4}, None)) is None
    assert issubclass(ConvertError, Exception)


def test_a_worker_can_begin_with_any_module() -> None:
    """It gets a function by the name of its module, and imports nothing else before."""
    for name in ("inputs.sources", "runs.capture_parts", "runs.fleet"):
        module = f"protogen.convert.{name}"
        done = subprocess.run([sys.executable, "-c", f"import {module}"], cwd=ROOT, check=False)
        assert done.returncode == 0, module
