"""Recordings: what was written comes back, and nothing that was written is lost."""

from __future__ import annotations

import io
import os
import signal
import subprocess
import sys
import time
from array import array
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protogen.recording import Record, Recorder, RecordKind, records
from protogen.recording.format import GREATEST

BEGIN = bytes.fromhex("50 47 52 45 43 00 02 0A")  # PGREC, format 2
OF_FORMAT_1 = bytes.fromhex("50 47 52 45 43 00 01 0A")


def read(data: bytes) -> list[Record]:
    return list(records([data], pytest.fail))


class TestWrites:
    def test_bytes_with_time_and_size(self) -> None:
        stream = io.BytesIO()
        recorder = Recorder(stream)
        recorder.write(b"xy", t_ns=1)
        recorder.close()
        time_ = "01 00 00 00 00 00 00 00"
        # 2 bytes; of the line; of nobody who is known
        assert stream.getvalue() == BEGIN + bytes.fromhex(time_ + "02 00 00 00 00 00 00 00") + b"xy"

    def test_the_name_of_a_source_in_front_of_its_first_bytes(self) -> None:
        stream = io.BytesIO()
        recorder = Recorder(stream, clock=lambda: 0x0102)
        recorder.write(b"a", source="pc")
        recorder.write(b"b", source="pc")
        time_ = "02 01 00 00 00 00 00 00"
        assert stream.getvalue() == BEGIN + b"".join(
            (
                bytes.fromhex(time_ + "02 00 00 00 01 01 00 00") + b"pc",  # kind 1: name of 1
                bytes.fromhex(time_ + "01 00 00 00 00 01 00 00") + b"a",
                bytes.fromhex(time_ + "01 00 00 00 00 01 00 00") + b"b",
            )
        )

    def test_elements_that_are_larger_than_a_byte(self) -> None:
        stream = io.BytesIO()
        Recorder(stream).write(memoryview(array("H", [1, 2, 3])), t_ns=1)
        assert [len(record.data) for record in read(stream.getvalue())] == [6]

    def test_a_long_piece_as_several_records(self) -> None:
        stream = io.BytesIO()
        Recorder(stream).write(bytes(GREATEST + 1), t_ns=1)
        assert [len(record.data) for record in read(stream.getvalue())] == [GREATEST, 1]

    def test_no_more_sources_than_there_are_numbers(self) -> None:
        recorder = Recorder(io.BytesIO())
        for number in range(255):
            recorder.write(b"x", source=f"source {number}")
        with pytest.raises(ValueError, match="at most 255 sources"):
            recorder.write(b"x", source="one more")


class TestReads:
    @given(
        st.lists(
            st.tuples(
                st.binary(max_size=20),
                st.integers(-(2**63), 2**63 - 1),
                st.sampled_from(["", "pc", "esp", "größe"]),
            )
        )
    )
    def test_what_was_written(self, pieces: list[tuple[bytes, int, str]]) -> None:
        stream = io.BytesIO()
        with Recorder(stream) as recorder:
            for data, when, source in pieces:
                recorder.write(data, when, source)
        found = [(record.data, record.when, record.source) for record in read(stream.getvalue())]
        assert found == [piece for piece in pieces if piece[0]]

    def test_notes(self) -> None:
        stream = io.BytesIO()
        Recorder(stream).note("the port was lost", t_ns=7)
        note = Record(b"the port was lost", 7, "", RecordKind.NOTE)
        assert read(stream.getvalue()) == [note]

    def test_format_1(self) -> None:
        record = bytes.fromhex("05 00 00 00 00 00 00 00  03 00 00 00") + b"abc"
        assert read(OF_FORMAT_1 + record * 2) == [Record(b"abc", 5)] * 2

    @pytest.mark.parametrize(
        ("damage", "left", "problem"),
        [
            (lambda data: data[:-2], b"abc", "ends inside a record, 2 bytes too early"),
            (lambda data: data[:-8], b"", "ends inside the head of a record, at byte 21"),
            (
                lambda data: data[:16] + b"\xff" * 4 + data[20:],
                b"",
                "no record can stand at 8",
            ),
            (lambda data: data[:20] + b"\x03" + data[21:], b"", "no record can stand at 8"),
            (lambda data: b"?" + data, b"", "this is no recording: it begins with 3F 50"),
            (lambda data: b"", b"", "this is no recording: it begins with nothing"),
        ],
    )
    def test_up_to_damage_and_says_where_it_is(
        self, damage: Callable[[bytes], bytes], left: bytes, problem: str
    ) -> None:
        head = bytes.fromhex("01 00 00 00 00 00 00 00  05 00 00 00  00 00 00 00")
        complaints: list[str] = []
        pieces = (bytes((byte,)) for byte in damage(BEGIN + head + b"abcde"))
        found = b"".join(record.data for record in records(pieces, complaints.append))
        assert found == left
        assert complaints[0].startswith(problem)


WRITER = """
import sys
from protogen.recording import Recorder

with Recorder(sys.argv[1]) as recorder:
    number = 0
    while True:
        recorder.write(number.to_bytes(4, "little") * 50, source="board")
        number += 1
        print(number, flush=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="kill -9 is of POSIX")
@pytest.mark.parametrize("delay", [0.0, 0.003, 0.01, 0.02, 0.05])
def test_nothing_is_lost_that_was_written_before_a_kill(tmp_path: Path, delay: float) -> None:
    file = tmp_path / "run.pgrec"
    writer = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(file)], stdout=subprocess.PIPE, text=True
    )
    assert writer.stdout is not None
    writer.stdout.readline()
    time.sleep(delay)
    writer.send_signal(signal.SIGKILL)
    told = [line for line in writer.stdout.read().splitlines(keepends=True) if line.endswith("\n")]
    writer.wait()
    complaints: list[str] = []
    found = [record.data for record in records([file.read_bytes()], complaints.append)]
    whole = [data for data in found if len(data) == 200]
    assert len(whole) >= max(1, len(told))
    assert whole == [number.to_bytes(4, "little") * 50 for number in range(len(whole))]
