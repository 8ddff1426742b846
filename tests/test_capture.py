"""Captures as columns, filled in pure Python."""

from __future__ import annotations

import gzip
import io
import os
import subprocess
import sys
from ctypes import sizeof
from pathlib import Path
from random import Random
from typing import Any

import pytest
from c_structs import structure_of
from capture_support import assert_same_tables, described, expected_of
from compiled import ROOT, SCHEMAS, name_of, protocol_of
from corpus import material_of, stream_of

from protogen import SchemaError
from protogen.capture import CaptureError, InvalidReason, batches, columns
from protogen.capture.arrays import numpy
from protogen.capture.gather import gathered
from protogen.capture.layout import capture_schema
from protogen.capture.schema import Number, TableSchema
from protogen.model.protocol import Protocol
from protogen.passes.context import Context
from protogen.passes.resolve import resolve

RN1 = ROOT / "schemas" / "rn1.yaml"
SAMPLERS = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))
SENDERS = [
    (path, sender.name) for path in (*SCHEMAS, *SAMPLERS) for sender in protocol_of(path).senders
]
EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), SENDERS, ids=name_of)


def stream(path: Path, sender: str, count: int = 150) -> bytes:
    dice = Random(f"{path.stem} {sender}")
    return stream_of(material_of(path, sender, greatest=3000), dice, count).data


@EVERY_SENDER
def test_the_tables_hold_what_the_events_say(path: Path, sender: str) -> None:
    data = stream(path, sender)
    tables = columns(data, protocol_of(path), sender, engine="python")
    assert described(tables) == expected_of(path, sender, data)
    assert (tables.offset, tables.size, tables.sequence) == (0, len(data), 0)


@EVERY_SENDER
def test_batches_joined_are_the_columns(path: Path, sender: str) -> None:
    data, protocol = stream(path, sender), protocol_of(path)
    parts = list(batches(data, protocol, sender, chunk=97, engine="python"))
    assert len(parts) > 5
    whole = columns(data, protocol, sender, engine="python")
    assert_same_tables(gathered(parts, None, 1), whole)
    end = count = 0
    for part in parts:
        assert (part.offset, part.sequence) == (end, count)
        end, count = end + part.size, count + part.events


@EVERY_SENDER
def test_rows_lie_as_structs_of_c(path: Path, sender: str) -> None:
    """The tables' own layout against the sizes of structs of ctypes."""
    protocol = protocol_of(path)
    for table in capture_schema(protocol, protocol.sender(sender)).messages.values():
        assert table.message is not None
        first = next((c.position for c in table.fields), None)
        if first is not None:
            size = table.row.size - first
            assert 0 <= size - sizeof(structure_of(table.message.fields)) < 8


# --- sources and protocols ------------------------------------------------------------------------


@pytest.fixture
def capture(tmp_path: Path) -> Path:
    file = tmp_path / "run.bin"
    file.write_bytes(stream(RN1, "brain"))
    return file


def test_a_source_is_a_path_bytes_or_a_file(capture: Path, tmp_path: Path) -> None:
    data, protocol = capture.read_bytes(), protocol_of(RN1)
    expected = columns(data, protocol, "brain", engine="python")
    packed = tmp_path / "run.gz"
    packed.write_bytes(gzip.compress(data))
    with capture.open("rb") as file, gzip.open(packed) as unpacked:
        sources: list[Any] = [capture, str(capture), bytearray(data), memoryview(data)]
        for source in (*sources, io.BytesIO(data), file, unpacked):
            assert_same_tables(columns(source, protocol, "brain", engine="python"), expected)


def test_a_file_is_read_from_where_it_is(capture: Path) -> None:
    with capture.open("rb") as file:
        file.seek(100)
        found = columns(file, protocol_of(RN1), "brain", engine="python")
    expected = columns(capture.read_bytes()[100:], protocol_of(RN1), "brain", engine="python")
    assert_same_tables(found, expected)


def test_a_pipe_is_read_as_it_comes() -> None:
    data = stream(RN1, "brain", 20)
    low, high = os.pipe()
    os.write(high, data)
    os.close(high)
    with os.fdopen(low, "rb") as file:
        found = columns(file, protocol_of(RN1), "brain", engine="python")
    assert_same_tables(found, columns(data, protocol_of(RN1), "brain", engine="python"))


@pytest.mark.skipif(sys.platform == "win32", reason="pipes always wait there")
def test_a_pipe_that_does_not_wait_is_not_at_its_end() -> None:
    low, high = os.pipe()
    os.set_blocking(low, False)
    os.write(high, stream(RN1, "brain", 20))
    with (
        os.fdopen(high, "wb"),
        os.fdopen(low, "rb") as file,
        pytest.raises(CaptureError, match="non-blocking"),
    ):
        columns(file, protocol_of(RN1), "brain", engine="python")


def test_an_empty_capture_has_empty_tables(tmp_path: Path) -> None:
    empty = tmp_path / "empty.bin"
    empty.touch()
    tables = columns(empty, RN1, "brain", engine="python")
    assert (tables.events, tables.size) == (0, 0)
    assert all(len(table) == 0 for table in tables.messages.values())
    assert set(tables.messages) >= {"gyro", "lidar"}


def test_a_protocol_is_a_name_a_path_or_a_model(
    capture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = columns(capture, protocol_of(RN1), "brain", engine="python")
    monkeypatch.chdir(ROOT)
    for protocol in ("rn1", "schemas/rn1.yaml", RN1):
        assert_same_tables(columns(capture, protocol, "brain", engine="python"), expected)
    with pytest.raises(CaptureError, match=r"no schema 'rn2' here; there are .*rn1"):
        columns(capture, "rn2", "brain")
    (tmp_path / "protogen.toml").write_text(f'schemas = ["{ROOT}/schemas"]\n')
    monkeypatch.chdir(tmp_path)
    assert_same_tables(columns(capture, "rn1", "brain", engine="python"), expected)
    (tmp_path / "protogen.toml").unlink()
    with pytest.raises(CaptureError, match="give the path"):
        columns(capture, "rn1", "brain")
    with pytest.raises(CaptureError, match=r"no schema 'schemas/rn1\.yaml'"):
        columns(capture, "schemas/rn1.yaml", "brain")
    (tmp_path / "schemas").mkdir()
    with pytest.raises(CaptureError, match="give the path"):
        columns(capture, "rn1", "brain")


def test_a_path_is_compiled_again_only_once_a_file_of_it_holds_something_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    base, dialect = tmp_path / "base.yaml", tmp_path / "dialect.yaml"
    base.write_text(
        """
protocol: base
endpoints: {one: One side}
byte_order: little
frame:
  length: {type: uint8, counts: payload}
  id: {type: uint8, id: true}
  payload: {}
  crc: {type: uint8, algorithm: sum-8, covers: length..payload}
messages:
  point: {id: 1, from: one, fields: {x: uint8}}
"""
    )
    dialect.write_text("extends: base.yaml\nprotocol: dialect\n")
    compiled: list[Any] = []

    def counted(context: Context) -> Protocol | None:
        compiled.append(context)
        return resolve(context)

    monkeypatch.setattr("protogen.compiler.resolve", counted)
    frame = bytes.fromhex("01 01 05 07")  # length, id, x, their sum

    def fields() -> tuple[str, ...]:
        schema = columns(frame, dialect, "one", engine="python").schema.messages["point"]
        return tuple(column.name for column in schema.fields)

    assert (fields(), fields()) == (("x",), ("x",))
    assert len(compiled) == 1
    before = base.stat()
    base.write_text(base.read_text().replace("{x: uint8}", "{y: uint8}"))
    os.utime(base, ns=(before.st_atime_ns, before.st_mtime_ns))  # As a fast editor leaves it.
    assert (fields(), fields()) == (("y",), ("y",))
    assert len(compiled) == 2
    base.unlink()
    with pytest.raises(SchemaError, match="the base can't be read"):
        fields()


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        ({"sender": "motor"}, "'motor' sends nothing in rn1; host and brain do"),
        ({"engine": "quick"}, "no engine 'quick'; there are native and python"),
        ({"source": "/no/such/file"}, "/no/such/file: No such file"),
        ({"source": io.StringIO("text")}, "opened as text"),
        ({"source": 5}, "a path, bytes or a binary file, not int"),
        ({"source": memoryview(b"abcd")[::2]}, "do not lie side by side"),
        ({"workers": 0}, "workers has to be at least 1, not 0"),
    ],
)
def test_what_can_not_be_read_is_said(given: dict[str, Any], problem: str) -> None:
    usual: dict[str, Any] = {"source": b"", "sender": "brain", "engine": "python"}
    with pytest.raises(CaptureError, match=problem):
        columns(protocol=RN1, **{**usual, **given})


@pytest.mark.parametrize("chunk", [0, -1])
def test_a_chunk_of_no_bytes_is_not_an_empty_capture(chunk: int) -> None:
    with pytest.raises(CaptureError, match="chunk has to be at least 1"):
        next(batches(b"abc", RN1, "brain", chunk=chunk, engine="python"))


def test_memory_of_any_items_is_read_as_its_bytes(capture: Path) -> None:
    data = capture.read_bytes()
    data = data[: len(data) // 8 * 8]
    expected = columns(data, RN1, "brain", engine="python")
    for source in (memoryview(data).cast("I"), memoryview(data).cast("B", (len(data) // 8, 8))):
        assert_same_tables(columns(source, RN1, "brain", engine="python"), expected)
    nothing = memoryview(numpy().zeros((0, 3)))
    assert columns(nothing, RN1, "brain", engine="python").events == 0


def test_without_numpy_it_says_how_to_get_it() -> None:
    program = """
import sys
sys.modules["numpy"] = None
import protogen.capture
try:
    protogen.capture.columns(b"", "schemas/rn1.yaml", "brain")
except ImportError as error:
    print(error)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert "pip install 'protogen-serial[capture]'" in done.stdout


# --- what columns mean ----------------------------------------------------------------------------


def table(path: Path, sender: str, message: str) -> TableSchema:
    protocol = protocol_of(path)
    return capture_schema(protocol, protocol.sender(sender)).messages[message]


def test_a_column_knows_what_its_values_mean() -> None:
    row = table(RN1, "brain", "lidar").row
    distances = row.column("distances")
    assert distances.counts == (360,)
    assert (distances.unit, [item.name for item in distances.special]) == ("mm", ["no_datapoint"])
    assert not distances.scaled
    status = row.column("status")
    assert status.flags is not None
    assert status.enum is None
    assert status.doc
    gyro = table(RN1, "brain", "gyro").row.column("status")
    assert gyro.enum is not None
    assert [(item.name, item.value) for item in gyro.enum.values] == [("ok", 1)]
    offset = row.column("offset")
    assert (offset.unit, offset.doc, offset.type, offset.enum) == (None, "", None, None)
    assert row.column("start").part is not None
    with pytest.raises(KeyError):
        row.column("nothing")


def test_a_name_that_is_taken_gets_an_underscore(tmp_path: Path) -> None:
    schema = tmp_path / "taken.yaml"
    schema.write_text(
        """\
protocol: taken
title: Fields with the names of other columns
endpoints: {one: One side}
byte_order: little
frame:
  length: {type: uint8, counts: payload}
  id: {type: uint8, id: true}
  payload: {}
  crc: {type: uint8, algorithm: sum-8, covers: length..payload}
messages:
  clash:
    id: 1
    from: one
    fields:
      id: uint16
      size: {type: uint8, range: [0, 3]}
      offset: {type: uint16, count: size}
      sequence:
        switch: size
        cases: {1: {fields: {a: uint8}}, 2: {fields: {b: {type: uint8, count: size}}}}
"""
    )
    frame = bytes.fromhex("09 01 0700 02 0100 0200 0304")
    frame += bytes([sum(frame) & 0xFF])
    (row,) = columns(frame, schema, "one", engine="python").messages["clash"]
    assert row.dtype.names == (
        "offset",
        "sequence",
        "size",
        "id",
        "id_",
        "size_",
        "offset_",
        "sequence_",
    )
    assert (row["size"], row["id_"], row["size_"], row["offset_"].tolist()) == (12, 7, 2, [1, 2, 0])
    assert row["sequence_"]["case_2"]["b"].tolist() == [3, 4, 0]


def test_reasons_have_the_words_of_events() -> None:
    assert InvalidReason(4).word == "noise"
    assert Number("u2", 2).alignment == 2
