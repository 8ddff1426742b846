"""Formats of captures: each is found out, and its bytes and times are those that went in."""

from __future__ import annotations

import errno
import gzip
import json
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from random import Random
from threading import Thread
from typing import Any, ClassVar

import pytest
from cli_support import ROOT, SINK, run, start

from protogen.api import load
from protogen.convert.errors import ConvertError
from protogen.convert.formats import InputKind
from protogen.convert.inputs.chunks import Chunk, Clock, joined
from protogen.convert.inputs.sources import (
    Packing,
    Source,
    expanded,
    format_of,
    open_stream,
    opened,
)
from protogen.convert.inputs.text_lines import decoded, lines_of
from protogen.convert.inputs.text_logs import log_pieces
from protogen.convert.runs.table_names import names_of
from protogen.recording import Recorder
from protogen.recording.format import HEAD, MAGIC

FRAME = bytes.fromhex("1B 02 45 00 00 45 1B 03")  # `empty` with number 0
SECOND = bytes.fromhex("1B 02 45 01 00 44 1B 03")


def read(
    path: Path | str, kind: InputKind | None = None
) -> tuple[str, bytes, list[int], list[int]]:
    """Format, bytes, ends of runs of bytes, and their times."""
    with opened(Source(str(path)), kind, "pc", ("pc", "board"), pytest.fail) as capture:
        data, ends, times = b"", [], []
        for chunk in capture.chunks:
            ends += [len(data) + end for end in chunk.ends]
            data += chunk.data
            times += chunk.times
        return str(capture.format), data, ends, times


def packed(data: bytes) -> bytes:
    """The same bytes in every process."""
    return gzip.compress(data, mtime=0)


def zstd(data: bytes) -> bytes:
    return pytest.importorskip("zstandard").compress(data)


class TestDetection:
    @pytest.mark.parametrize(
        ("name", "content", "expected"),
        [
            ("run.bin", FRAME, "raw bytes"),
            ("run.bin.gz", packed(FRAME), "raw bytes, gzip"),
            ("no_extension", packed(FRAME), "raw bytes, gzip"),
            ("run.hex", FRAME.hex(" ").encode(), "hex digits"),
            ("run.hex.gz", packed(FRAME.hex(" ").encode()), "hex digits, gzip"),
            ("run.log", b"(1.5) can0 123#" + FRAME.hex().encode(), "a text log with times"),
            ("run", MAGIC + HEAD.pack(7, len(FRAME), 0, 0) + FRAME, "a recording"),
        ],
        ids=lambda value: value if isinstance(value, str) else "",
    )
    def test_by_content_and_name(
        self, name: str, content: bytes, expected: str, tmp_path: Path
    ) -> None:
        (tmp_path / name).write_bytes(content)
        assert read(tmp_path / name)[:2] == (expected, FRAME)

    def test_zstd(self, tmp_path: Path) -> None:
        (tmp_path / "run.zst").write_bytes(zstd(FRAME[:3]) + zstd(FRAME[3:]))
        assert read(tmp_path / "run.zst")[:2] == ("raw bytes, zstd", FRAME)

    def test_digits_alone_are_raw_bytes(self, tmp_path: Path) -> None:
        (tmp_path / "run.bin").write_bytes(FRAME.hex().encode())
        assert read(tmp_path / "run.bin")[:2] == ("raw bytes", FRAME.hex().encode())
        assert read(tmp_path / "run.bin", InputKind.HEX)[:2] == ("hex digits", FRAME)

    def test_only_the_start_is_looked_at(self, tmp_path: Path) -> None:
        (tmp_path / "run.gz").write_bytes(gzip.compress(MAGIC + HEAD.pack(0, 1, 0, 0) + b"x"))
        found = format_of(Source(str(tmp_path / "run.gz")), None)
        assert (found.kind, found.packing, found.is_plain) == (
            InputKind.RECORD,
            Packing.GZIP,
            False,
        )

    @pytest.mark.parametrize("in_front", ["", "# what it is\n\n", " \r\n#(\r\n"])
    @pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
    def test_logs_of_any_text(self, tmp_path: Path, encoding: str, in_front: str) -> None:
        text = f"{in_front}(1.5) can0 123#{FRAME.hex()}\r\n(2) can0 123#00\r\n"
        (tmp_path / "run").write_bytes(text.encode(encoding))
        kind, *found = read(tmp_path / "run")
        assert kind == "a text log with times"
        assert found == [FRAME + b"\0", [8, 9], [1_500_000_000, 2 * 10**9]]

    @pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
    def test_digits_of_any_text(self, tmp_path: Path, encoding: str) -> None:
        (tmp_path / "run.hex").write_bytes(f"{FRAME.hex(' ')}\r\n".encode(encoding))
        assert read(tmp_path / "run.hex")[:2] == ("hex digits", FRAME)

    @pytest.mark.parametrize("pack", [packed, zstd], ids=["gzip", "zstd"])
    @pytest.mark.parametrize(
        ("expected", "content"),
        [
            ("a recording", MAGIC + HEAD.pack(7, len(FRAME), 0, 0) + FRAME),
            ("a text log with times", b"# note\n(1.5) can0 123#" + FRAME.hex().encode()),
        ],
        ids=["record", "log"],
    )
    def test_by_more_than_the_first_member(
        self, expected: str, content: bytes, pack: Callable[[bytes], bytes], tmp_path: Path
    ) -> None:
        for cut in (1, 7, len(content) - 1):
            (tmp_path / "run").write_bytes(pack(content[:cut]) + pack(content[cut:]))
            kind, data, *_ = read(tmp_path / "run")
            assert (kind.partition(",")[0], data) == (expected, FRAME)

    @pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
    @pytest.mark.parametrize(
        ("expected", "content"),
        [
            ("a recording", MAGIC + HEAD.pack(7, len(FRAME), 0, 0) + FRAME),
            ("a text log with times", f"(1) {FRAME.hex()}".encode("utf-16")),
            ("raw bytes, gzip", packed(FRAME)),
            ("raw bytes", FRAME),
        ],
        ids=["record", "log", "gzip", "raw"],
    )
    def test_by_more_than_the_first_bytes_of_a_pipe(
        self, expected: str, content: bytes, tmp_path: Path
    ) -> None:
        pipe = tmp_path / "run"
        os.mkfifo(pipe)

        def write() -> None:
            with pipe.open("wb", buffering=0) as stream:
                for byte in content:
                    stream.write(bytes((byte,)))
                    time.sleep(0.001)  # So that whoever reads gets it alone.

        writer = Thread(target=write)
        writer.start()
        assert read(pipe)[:2] == (expected, FRAME)
        writer.join()

    def test_text_in_single_bytes(self) -> None:
        for text in ("", "1", "1B 03"):
            for encoding in ("utf-8-sig", "utf-16"):
                data = text.encode(encoding)
                assert "".join(decoded(data[i : i + 1] for i in range(len(data)))) == text
        assert list(decoded([b"1"])) == ["1"]


class TestNames:
    @pytest.mark.parametrize(
        ("places", "names"),
        [
            (["a/run.bin.gz", "s3://robots/7/run2.zst", "-"], ["run", "run2", "stdin"]),
            (["a/x.bin", "b/x.bin", "a/y"], ["a-x.bin", "b-x.bin", "y"]),
            (["../x.bin", "x.bin"], ["up-x.bin", "x.bin"]),
            (["/a/x.bin", "./b/../x.bin"], ["a-x.bin", "x.bin"]),
            (["a/.bin", "_run.bin"], ["capture.bin", "capture_run"]),
            (["bad\udcff.bin", "bad\udcfe.bin"], ["bad%xff", "bad%xfe"]),
        ],
        ids=["bare", "folders", "parent", "path", "passed_over", "no_text"],
    )
    def test_no_two_captures_have_one(self, places: list[str], names: list[str]) -> None:
        assert names_of(places) == names

    def test_what_would_be_called_alike(self) -> None:
        with pytest.raises(ConvertError, match=r"^a\.bin is given twice"):
            names_of(["a.bin"] * 2)
        with pytest.raises(ConvertError, match=r"a/run\.bin is given twice"):
            names_of(["a/../a/run.bin", "a/run.bin"])
        with pytest.raises(ConvertError, match=r"a/run\.bin and /a/run\.bin would both be called"):
            names_of(["a/run.bin", "/a/run.bin"])

    @pytest.mark.parametrize("to", ["parquet", "arrow", "csv", "jsonl", "mcap", "mcap-ros2"])
    def test_that_are_no_text(self, tmp_path: Path, to: str) -> None:
        if sys.platform != "linux":
            pytest.skip("elsewhere, names of files are text")
        pytest.importorskip("mcap" if to.startswith("mcap") else "pyarrow")
        (tmp_path / "sink.yaml").write_text(SINK)
        capture = tmp_path / "bad\udcff.bin"
        capture.write_bytes(FRAME)
        options = ["--sender", "pc", "--to", to, "-o", str(tmp_path / "out"), "--quiet"]
        done = run("convert", str(tmp_path / "sink.yaml"), str(capture), *options)
        assert done.exit_code == 0, done.output
        suffix = "ros2.mcap" if to == "mcap-ros2" else to
        assert any(path.name == f"bad%xff.{suffix}" for path in (tmp_path / "out").rglob("*"))


class TestLogs:
    def test_lines_give_bytes_and_nanoseconds(self, tmp_path: Path) -> None:
        log = (
            "(1700000000.000000001) can0 7DF#1B02\n\n# note\n"
            "(1700000001) 45 00\r\n(2.5) tty0 00451B03\n"
        )
        (tmp_path / "run.log").write_text(log)
        assert read(tmp_path / "run.log") == (
            "a text log with times",
            FRAME,
            [2, 4, 8],
            [1_700_000_000_000_000_001, 1_700_000_001_000_000_000, 2_500_000_000],
        )

    def test_lines_of_another_sender_are_left_out(self) -> None:
        lines = ["(1) pc 01", "(2) board 02", "(3) can0 03", "(4) pc 04"]
        found = list(log_pieces(lines, "pc", ("pc", "board"), pytest.fail))
        assert b"".join(data for data, _ in found) == b"\x01\x03\x04"

    @pytest.mark.parametrize(
        "line",
        [
            "(1) 5", "(1) can0 5G", "5502", "(x) 55", "(1) zz",
            "(1) 55\u00a002", "(1) 55\x1c02", "(1) \uff15\uff15", "(\u0661) 55",
        ],
    )  # fmt: skip
    def test_what_is_no_line_is_complained_of(self, line: str) -> None:
        complaints: list[str] = []
        assert not list(log_pieces([line], "pc", (), complaints.append))
        assert complaints[0].startswith("line 1: not `(SECONDS) [NAME] HEX`")

    def test_a_time_that_no_table_has_a_place_for_is_complained_of(self) -> None:
        complaints: list[str] = []
        lines = ["(9223372036.854775807) 01", "(9223372036.854775808) 02", "(17000000000) 03"]
        found = list(log_pieces(lines, "pc", (), complaints.append))
        assert found == [(b"\x01", (1 << 63) - 1)]
        assert [text.partition(":")[0] for text in complaints] == ["line 2", "line 3"]

    @pytest.mark.parametrize(
        "line",
        [
            "(1) can0 123#", "(1) can0 123#R", "(1) can0 123#R8", "(1)  can0  123   [0] ",
            "(1)  can0  123   [8]  remote request", "(1) can0 123# R",
        ],
    )  # fmt: skip
    def test_a_frame_without_bytes_has_none(self, line: str) -> None:
        assert list(log_pieces([line], "pc", (), pytest.fail)) == [(b"", 10**9)]

    @pytest.mark.parametrize(
        "line",
        [
            "(1) can0 123#5502AB", "(1) can0 123#5502AB T", "(1) can0 123##15502AB Rx",
            "(1) can0 1FFFFFFF#5502AB", "(1)  can0  123   [3]  55 02 AB", "(1) 55 02 AB",
            "(1)  can0  123   [3]  55 02 AB   'U..'", "(1)  can0  123  [03]  55 02 AB   '''''",
            "(1)  can0  TX - -  1FFFFFFF   [3]  55 02 AB", "(1) can0  RX B -  123 [3] 55 02 AB",
        ],
    )  # fmt: skip
    def test_ways_of_candump(self, line: str) -> None:
        found = list(log_pieces([line], "pc", (), pytest.fail))
        assert found == [(b"\x55\x02\xab", 10**9)]

    @pytest.mark.parametrize(
        "line",
        [
            "(1) can0 20000004#0004000000000000",
            "(1)  can0  20000080   [8]  00 00 00 00 00 00 00 00   ERRORFRAME",
        ],
    )
    def test_notes_about_errors_were_on_no_line(self, line: str) -> None:
        assert not list(log_pieces([line], "pc", (), pytest.fail))

    def test_frames_without_bytes_do_not_pile_up(self) -> None:
        requests = iter([(b"", 1)] * 50 + [(b"x", 2)] + [(b"", 3)] * 50)
        assert list(joined(requests)) == [Chunk(b"x", [1], [2])]

    @pytest.mark.timeout(120)
    @pytest.mark.parametrize("middle", [" ", "55 ", "5", "'", "[5] ", "(1) can0 "])
    def test_long_lines_that_fit_nothing_are_soon_known(self, middle: str) -> None:
        complaints: list[str] = []
        line = f"(1) can0 55 {middle * 100_000}x"
        assert not list(log_pieces([line], "pc", (), complaints.append))
        assert len(complaints) == 1


class TestRecorder:
    def test_what_was_recorded_comes_back(self, tmp_path: Path) -> None:
        with Recorder(tmp_path / "run.rec", clock=iter([10, 20]).__next__) as recorder:
            recorder.write(FRAME[:5])
            recorder.write(FRAME[5:])
            recorder.write(b"", t_ns=30)
            recorder.write(b"!", t_ns=-5)
        found = read(tmp_path / "run.rec")
        assert found == ("a recording", FRAME + b"!", [5, 8, 9], [10, 20, -5])

    def test_what_another_endpoint_sent_is_left_out(self, tmp_path: Path) -> None:
        with Recorder(tmp_path / "run.rec") as recorder:
            recorder.write(FRAME, t_ns=1, source="pc")
            recorder.note("the port was lost", t_ns=2)
            recorder.write(b"?", t_ns=3, source="board")
            recorder.write(b"!", t_ns=4, source="left")
        found = read(tmp_path / "run.rec")
        assert found == ("a recording", FRAME + b"!", [len(FRAME), len(FRAME) + 1], [1, 4])


class TestClock:
    def test_a_byte_has_the_time_of_its_run(self) -> None:
        clock = Clock()
        clock.take(Chunk(b"abcd", [2, 4], [10, 20]))
        clock.take(Chunk(b"ef", [2], [30]))
        assert clock.at([0, 1, 2, 3, 4, 5, 6]) == [10, 10, 20, 20, 30, 30, None]
        clock.forget(4)
        assert clock.at([4, 5]) == [30, 30]

    def test_without_times_there_is_none(self) -> None:
        clock = Clock()
        clock.take(Chunk(b"abcd"))
        assert clock.at([0, 3]) == [None, None]


class TestCommand:
    @pytest.fixture
    def schema(self, tmp_path: Path) -> Path:
        (tmp_path / "sink.yaml").write_text(SINK)
        return tmp_path / "sink.yaml"

    def lines(self, schema: Path, name: str) -> list[dict[str, Any]]:
        text = (schema.parent / "out" / f"{name}.jsonl").read_text("utf-8")
        return [json.loads(line) for line in text.splitlines()]

    def options(self, schema: Path) -> list[str]:
        return ["--sender", "pc", "--to", "jsonl", "-o", str(schema.parent / "out")]

    def test_a_row_has_the_time_of_its_last_byte(self, schema: Path) -> None:
        recording = schema.parent / "run.rec"
        with Recorder(recording) as recorder:
            recorder.write(FRAME[:5], t_ns=100)
            recorder.write(FRAME[5:] + SECOND[:1], t_ns=200)
            recorder.write(SECOND[1:], t_ns=300)
        run("convert", str(schema), str(recording), *self.options(schema))
        shown = [(line["offset"], line["t_ns"]) for line in self.lines(schema, "run")]
        assert shown == [(0, 200), (8, 300)]
        run("convert", str(schema), str(recording), "--to", "mcap", *self.options(schema)[:2],
            "-o", str(schema.parent / "out"))  # fmt: skip
        reader = pytest.importorskip("mcap.reader")
        with (schema.parent / "out" / "run.mcap").open("rb") as file:
            messages = [item for _, _, item in reader.make_reader(file).iter_messages()]
        assert [item.log_time for item in messages] == [200, 300]

    def test_times_before_1970_are_the_start_of_the_log_in_mcap(self, schema: Path) -> None:
        reader = pytest.importorskip("mcap.reader")
        with Recorder(schema.parent / "run.rec") as recorder:
            recorder.write(FRAME, t_ns=-5)
        done = run("convert", str(schema), str(schema.parent / "run.rec"), "--sender", "pc",
                   "--to", "mcap", "-o", str(schema.parent / "out"))  # fmt: skip
        assert done.exit_code == 0, done.output
        with (schema.parent / "out" / "run.mcap").open("rb") as file:
            ((_, _, message),) = reader.make_reader(file).iter_messages()
        assert (message.log_time, json.loads(message.data)["t_ns"]) == (0, -5)

    def test_standard_input(self, schema: Path) -> None:
        data = packed(FRAME)
        done = start("convert", str(schema), "-", *self.options(schema), input=data)
        assert done.returncode == 0, done.stderr
        assert done.stdout.splitlines()[0] == b"-: raw bytes, gzip, 8 bytes"
        assert [line["message"] for line in self.lines(schema, "stdin")] == ["empty"]
        again = start("convert", str(schema), "-", *self.options(schema), input=FRAME + SECOND)
        assert b"done before" not in again.stdout
        assert len(self.lines(schema, "stdin")) == 2

    def test_a_lost_line_is_complained_of_and_exits_with_1(self, schema: Path) -> None:
        log = schema.parent / "run.log"
        log.write_text(f"(1) {FRAME.hex()}\n" + "oops\n" * 25)
        for _ in range(2):
            done = run("convert", str(schema), str(log), *self.options(schema))
            assert done.exit_code == 1
        first = run("convert", str(schema), str(log), *self.options(schema), "--force")
        assert f"warning: {log}: line 2: not `(SECONDS) [NAME] HEX`: 'oops'" in first.output
        assert "warning: 5 more lines can't be used" in first.output

    @pytest.mark.parametrize(
        ("name", "content", "problem"),
        [
            ("run.gz", packed(FRAME)[:10] + b"\x07" * 20, "its compression is damaged"),
            ("run.hex", b"1B\n0", "line 2, column 1: `0` has an odd number"),
        ],
        ids=["damaged", "odd"],
    )
    def test_a_damaged_file_is_told_by_name(
        self, schema: Path, name: str, content: bytes, problem: str
    ) -> None:
        path = schema.parent / name
        path.write_bytes(content)
        done = run("convert", str(schema), str(path), *self.options(schema))
        assert done.exit_code == 2
        assert f"{path}: {problem}" in done.output
        assert not list((schema.parent / "out").rglob("*.jsonl"))

    @pytest.mark.parametrize("pack", [packed, zstd], ids=["gzip", "zstd"])
    @pytest.mark.parametrize("missing", [1, 9])
    def test_what_was_packed_before_the_power_failed_is_read(
        self, schema: Path, pack: Callable[[bytes], bytes], missing: int
    ) -> None:
        noise = Random(1).randbytes(100_000)  # Which nothing packs, so that there are more blocks.
        path = schema.parent / "run.packed"
        path.write_bytes(pack(FRAME) + pack(FRAME + noise)[:-missing])
        done = run("convert", str(schema), str(path), *self.options(schema))
        assert done.exit_code == 1
        assert f"{path}: its compressed bytes end too early" in done.output
        first, second = self.lines(schema, "run")[:2]
        assert [first["event"], second["event"]] == ["message", "message"]
        assert second["offset"] == len(FRAME)

    @pytest.mark.parametrize("padding", [512, 100_000], ids=["some", "more_than_is_read_at_once"])
    def test_empty_members_and_padding_are_nothing(self, tmp_path: Path, padding: int) -> None:
        first, last = packed(b"") + packed(FRAME) + bytes(padding), packed(SECOND) + bytes(padding)
        (tmp_path / "run.gz").write_bytes(first + last)
        assert read(tmp_path / "run.gz")[:2] == ("raw bytes, gzip", FRAME + SECOND)
        (tmp_path / "run.zst").write_bytes(zstd(b"") + zstd(FRAME) + zstd(b""))
        assert read(tmp_path / "run.zst")[:2] == ("raw bytes, zstd", FRAME)

    @pytest.mark.parametrize("pack", [packed, zstd], ids=["gzip", "zstd"])
    def test_large_files_of_few_bytes(self, tmp_path: Path, pack: Callable[[bytes], bytes]) -> None:
        data = bytes(3 << 20) + b"end"
        (tmp_path / "run.packed").write_bytes(pack(data))
        assert read(tmp_path / "run.packed")[1] == data

    def test_frames_that_zstd_skips_hold_nothing(self, tmp_path: Path) -> None:
        """As `pzstd` has one in front of each frame, with its size."""
        capture = tmp_path / "run.bin"
        skipped = [
            (0x184D2A50 + number).to_bytes(4, "little") + size.to_bytes(4, "little") + bytes(size)
            for number, size in ((0, 4), (15, 0), (3, 100_000))
        ]
        pieces = [*skipped, zstd(FRAME), skipped[0], zstd(SECOND), skipped[2]]
        capture.write_bytes(b"".join(pieces))
        assert read(capture)[:2] == ("raw bytes, zstd", FRAME + SECOND)
        capture.write_bytes(skipped[0] + FRAME)
        assert read(capture)[:2] == ("raw bytes", skipped[0] + FRAME)

    def test_damaged_zstd_is_told_by_name(self, schema: Path) -> None:
        path = schema.parent / "run.zst"
        path.write_bytes(zstd(FRAME)[:6] + b"\xff" * 20)
        done = run("convert", str(schema), str(path), *self.options(schema))
        assert (done.exit_code, "its compression is damaged" in done.output) == (2, True)

    def test_a_url(self, schema: Path) -> None:
        pytest.importorskip("fsspec")
        (schema.parent / "run.bin").write_bytes(FRAME)
        url = f"file://{schema.parent / 'run.bin'}"
        done = run("convert", str(schema), url, *self.options(schema))
        assert done.exit_code == 0, done.output
        assert len(self.lines(schema, "run")) == 1
        wrong = run("convert", str(schema), "nowhere://x", *self.options(schema))
        assert wrong.exit_code == 2
        assert "nowhere://x: Protocol not known" in wrong.output
        gone = run("convert", str(schema), "memory://gone.bin", *self.options(schema))
        assert gone.exit_code == 2
        assert f"memory://gone.bin: {os.strerror(errno.ENOENT)}" in gone.output

    def test_a_url_that_has_changed_is_read_again_whatever_its_size(self, schema: Path) -> None:
        fsspec = pytest.importorskip("fsspec")
        (schema.parent / "run.bin").write_bytes(FRAME)
        fsspec.filesystem("memory").pipe_file("/run2.bin", FRAME)
        for url in (f"file://{schema.parent / 'run.bin'}", "memory://run2.bin"):
            command = ("convert", str(schema), url, *self.options(schema))
            assert "done before" not in run(*command).output
            assert "done before" in run(*command).output
            with fsspec.open(url, "wb") as file:
                file.write(bytes(len(FRAME)))
            again = run(*command)
            assert "done before" not in again.output
            assert f"invalid:noise{len(FRAME)}bytes" in again.output.replace(" ", "")

    def test_a_url_of_many(self, schema: Path) -> None:
        pytest.importorskip("fsspec")
        for name in ("b.bin", "a.bin", "c.txt"):
            (schema.parent / name).write_bytes(FRAME)
        done = run("convert", str(schema), f"file://{schema.parent}/*.bin", *self.options(schema))
        assert done.exit_code == 0, done.output
        shown = [line for line in done.output.splitlines() if "raw bytes" in line]
        assert [line.partition(": ")[0] for line in shown] == [
            f"file://{schema.parent / name}" for name in ("a.bin", "b.bin")
        ]
        assert self.lines(schema, "a") == self.lines(schema, "b")
        none = run("convert", str(schema), f"file://{schema.parent}/*.raw", *self.options(schema))
        assert (none.exit_code, "*.raw: there is no such file" in none.output) == (2, True)
        wrong = run("convert", str(schema), "nowhere://*.bin", *self.options(schema))
        assert (wrong.exit_code, "Protocol not known" in wrong.output) == (2, True)


class TestUrls:
    """Options that need no file of a capture."""

    @pytest.fixture
    def hosted(self, monkeypatch: pytest.MonkeyPatch) -> Any:
        """A file system whose URLs begin with a host, as those of FTP."""
        fsspec = pytest.importorskip("fsspec")
        registry = pytest.importorskip("fsspec.registry")

        class Hosted(fsspec.AbstractFileSystem):  # type: ignore[name-defined,misc]
            protocol = "hosted"
            root_marker = "/"
            cachable = False
            facts: ClassVar[dict[str, Any]] = {}

            @classmethod
            def _strip_protocol(cls, path: str) -> str:
                return "/" + path.partition("://")[2].partition("/")[2] if "://" in path else path

            @staticmethod
            def _get_kwargs_from_urls(path: str) -> dict[str, str]:
                return {"host": path.partition("://")[2].partition("/")[0]}

            def __init__(self, host: str, **options: Any) -> None:
                super().__init__(**options)
                assert host == "me@robot"

            def ls(self, path: str, detail: bool = True, **options: Any) -> list[Any]:
                names = ("/runs/b.bin", "/runs/a.bin", "/runs/c.txt")
                return [{"name": it, "type": "file", "size": 1, **self.facts} for it in names]

        monkeypatch.setitem(registry._registry, "hosted", Hosted)
        return Hosted

    def test_of_many_keep_their_host(self, hosted: Any) -> None:
        found = expanded(["hosted://me@robot/runs/*.bin"])
        assert found == ["hosted://me@robot/runs/a.bin", "hosted://me@robot/runs/b.bin"]
        assert [Source(place).stamp() for place in found] == [(1, None)] * 2

    @pytest.mark.parametrize(
        "word", ["ETag", "Last-Modified", "mtime", "modify", "modificationTime", "sha"]
    )
    def test_tell_what_differs(self, hosted: Any, word: str) -> None:
        hosted.facts[word] = "then"
        assert Source("hosted://me@robot/runs/a.bin").stamp() == (1, "then")

    def test_of_many_are_no_folders(self, tmp_path: Path) -> None:
        pytest.importorskip("fsspec")
        (tmp_path / "run.bin").touch()
        (tmp_path / "folder.bin").mkdir()
        assert expanded([f"file://{tmp_path}/*.bin"]) == [f"file://{tmp_path}/run.bin"]
        (tmp_path / "run.bin").unlink()
        with pytest.raises(ConvertError, match="there is no such file"):
            expanded([f"file://{tmp_path}/*.bin"])

    @pytest.mark.parametrize("url", ["https://robot/run.bin?key=a*b", "cached::s3://robot/*.bin"])
    def test_may_have_an_asterisk_that_stands_for_itself(self, url: str) -> None:
        assert expanded([url]) == [url]


def test_what_a_storage_says_is_no_bug(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its errors are of its own package, and no OSError."""
    memory = pytest.importorskip("fsspec.implementations.memory")

    class NoCredentialsError(Exception):
        pass

    def refuse(*arguments: object) -> None:
        raise NoCredentialsError("Unable to locate credentials")

    monkeypatch.setattr(memory.MemoryFileSystem, "info", refuse)
    with pytest.raises(ConvertError, match=r"memory://run\.bin: Unable to locate credentials"):
        Source("memory://run.bin").stamp()


def test_what_a_storage_says_while_it_is_read_is_no_bug(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As where credentials expire: by one machine, and by a part that a worker makes."""
    memory = pytest.importorskip("fsspec.implementations.memory")
    parts = pytest.importorskip("protogen.convert.runs.capture_parts")

    class ClientError(Exception):
        pass

    class Expiring(memory.MemoryFile):  # type: ignore[name-defined,misc]
        def read(self, size: int = -1) -> bytes:
            if self.tell() < 1 << 16:
                return super().read(min(size, 1 << 16))
            raise ClientError("The provided token has expired")

        def readinto(self, buffer: Any) -> int:
            data = self.read(len(buffer))
            buffer[: len(data)] = data
            return len(data)

    data = FRAME * 100_000
    storage = memory.MemoryFileSystem()
    monkeypatch.setitem(storage.store, "/run3.bin", Expiring(storage, "/run3.bin", data))
    said = r"memory://run3\.bin: The provided token has expired"
    with pytest.raises(ConvertError, match=said):
        read("memory://run3.bin")
    work = parts.Work(load(ROOT / "schemas" / "rflex.yaml"), "flex", str(tmp_path))
    span = (0, len(data))
    part = parts.Part("run3", "memory://run3.bin", "run3", {}, None, len(data), span, parts.START)
    with pytest.raises(ConvertError, match=said):
        parts.convert_part(work, part)


def test_parts_are_read_from_storages_that_do_not_say_where_they_seek_to(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As SFTP, whose files give nothing back."""
    memory = pytest.importorskip("fsspec.implementations.memory")

    class Silent(memory.MemoryFile):  # type: ignore[name-defined,misc]
        def seek(self, offset: int, whence: int = 0) -> None:
            super().seek(offset, whence)

    storage = memory.MemoryFileSystem()
    monkeypatch.setitem(storage.store, "/run4.bin", Silent(storage, "/run4.bin", FRAME * 100))
    with open_stream("memory://run4.bin") as stream:
        stream.seek(3 * len(FRAME))
        assert stream.read(len(FRAME)) == FRAME


def test_endless_lines_are_no_text() -> None:
    with pytest.raises(ConvertError, match=r"run\.log: a line has over .* this is no text"):
        list(lines_of([b"(1) " * (1 << 20)] * 5, "run.log"))
