"""Captures as tables: what the real readers find in them is what the decoder yields."""

from __future__ import annotations

import csv
import errno
import json
import math
from pathlib import Path
from typing import Any

import pytest
from cli_support import SINK, run, start
from compiled import DOCUMENTS, module_at, name_of, protocol_of
from test_json_lines import capture_of

from protogen.convert import errors
from protogen.convert.columns.python_values import json_of_each
from protogen.convert.columns.tables import tables_of
from protogen.convert.errors import ConvertError, needed
from protogen.convert.formats import OutputFormat
from protogen.convert.writers.format_writers import open_writer
from protogen.convert.writers.mcap_json import json_schema
from protogen.convert.writers.pending_files import Pending

pytest.importorskip("pyarrow")
mcap_reader = pytest.importorskip("mcap.reader")
parquet = pytest.importorskip("pyarrow.parquet")
ipc = pytest.importorskip("pyarrow.ipc")

FORMATS = ("jsonl", "csv", "parquet", "arrow", "mcap", "mcap-ros2")
DOCUMENT_SENDERS = [
    (path, sender.name) for path in DOCUMENTS for sender in protocol_of(path).senders
]


COUNTS = """\
protocol: counts
endpoints: {robot: Robot, host: Host}
frame:
  length: {type: uint8, counts: payload}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: [length, payload]}
messages:
  m:
    from: robot
    fields:
      data_size: {type: uint8}
      inner:
        fields:
          kind: {type: uint8, when: data_size == 3}
          data: {type: bytes, size: {fill: true, max: 9}}
"""


@pytest.fixture(scope="module")
def sink(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("schema") / "sink.yaml"
    path.write_text(SINK)
    return path


def convert(
    schema: Path, sender: str, capture: Path, to: str, folder: Path, *more: str
) -> list[str]:
    """The lines that the command prints."""
    arguments = [str(schema), "--sender", sender, str(capture), "--to", to, "-o", str(folder)]
    done = run("convert", *arguments, *more)
    assert done.exit_code == 0, done.output
    return done.output.splitlines()


def events_of(schema: Path, sender: str, data: bytes) -> list[Any]:
    decoder = module_at(schema).Decoder(sender)
    return [*decoder.feed(data), *decoder.flush()]


def rows_of(folder: Path, name: str, to: str) -> dict[str, list[dict[str, Any]]]:
    """The rows of each table, as the format's own reader has them."""
    tables = {}
    for path in sorted(folder.glob(f"*/{name}.{to}")):
        if to == "parquet":
            tables[path.parent.name] = parquet.read_table(path).to_pylist()
        else:
            with path.open("rb") as file:
                tables[path.parent.name] = ipc.open_file(file).read_all().to_pylist()
    return tables


def frame_facts(events: list[Any]) -> dict[str, list[tuple[int, int]]]:
    """Offset and size of each event, by the table that it belongs to."""
    found: dict[str, list[tuple[int, int]]] = {}
    for event in events:
        name = {"unknown": "unknown_frames", "invalid": "invalid_spans"}.get(event.kind)
        name = name or event.message.NAME
        found.setdefault(name, []).append((event.offset, event.size))
    return found


@pytest.mark.parametrize(("path", "sender"), DOCUMENT_SENDERS, ids=name_of)
@pytest.mark.parametrize("to", ["parquet", "arrow"])
def test_tables_hold_every_event(path: Path, sender: str, to: str, tmp_path: Path) -> None:
    data = capture_of(path, sender, 1)
    (tmp_path / "run.bin").write_bytes(data)
    convert(path, sender, tmp_path / "run.bin", to, tmp_path / "out")
    tables = rows_of(tmp_path / "out", "run", to)
    events = events_of(path, sender, data)
    names = {
        name: [("_" if kind in _fields(path, name) else "") + kind for kind in ("offset", "size")]
        for name in tables
    }
    shown = {
        name: [tuple(row[key] for key in names[name]) for row in rows]
        for name, rows in tables.items()
    }
    assert shown == frame_facts(events)
    for name, rows in tables.items():
        if name in ("unknown_frames", "invalid_spans"):
            continue
        messages = [
            event.message
            for event in events
            if event.kind == "message" and name == event.message.NAME
        ]
        for row, message in zip(rows, messages, strict=True):
            for field, value in message.to_dict().items():
                if field in row and not isinstance(value, dict | str):
                    assert row[field] == value


def _fields(path: Path, message: str) -> set[str]:
    protocol = protocol_of(path)
    return {
        field.name for item in protocol.messages if item.name == message for field in item.fields
    }


@pytest.mark.parametrize("sender", ["pc", "board"])
def test_every_kind_of_value_has_a_column(sink: Path, sender: str, tmp_path: Path) -> None:
    data = capture_of(sink, sender, 3, 200)
    (tmp_path / "run.bin").write_bytes(data)
    convert(sink, sender, tmp_path / "run.bin", "parquet", tmp_path / "out")
    tables = rows_of(tmp_path / "out", "run", "parquet")
    events = [event for event in events_of(sink, sender, data) if event.kind == "message"]
    numbers = [event for event in events if event.message.NAME == "numbers"]
    assert len(numbers) > 20
    for row, event in zip(tables["numbers"], numbers, strict=True):
        message = event.message
        assert row["@number"] == event.parts.number
        assert row["mode"] == message.mode
        assert row["mode_name"] == {0: "idle", 7: "run"}.get(message.mode)
        assert row["angle_deg"] == message.angle_deg
        assert row["flags"] == message.flags
        assert row["on_line"] is message.on_line
        assert _same(row["ratio"], message.ratio)
        assert _same(row["ratio_v"], message.ratio_v)
    if sender == "board":
        choices = [event.message for event in events if event.message.NAME == "choice"]
        for row, message in zip(tables["choice"], choices, strict=True):
            assert [row[name] for name in row if name.startswith("value.")] == _choice(message)
    else:
        lists = [event.message for event in events if event.message.NAME == "lists"]
        for row, message in zip(tables["lists"], lists, strict=True):
            assert row["points"] == [{"x": point.x, "y": point.y} for point in message.points]
            assert row["levels"] == message.levels
            assert (row["name"], row["rest"]) == (message.name, message.rest)
            assert (row["size"], "_size" in row) == (message.size, True)


def _choice(message: Any) -> list[Any]:
    """Columns of a switch: the number, the text and the byte of a word, the rest."""
    value = message.value
    match int(message.what):
        case 0:
            return [None, None, None, None]
        case 1:
            return [getattr(value, "value", value), None, None, None]
        case 2:
            return [None, value.text, value.more, None]
        case _:
            return [None, None, None, value]


def _same(one: float, other: float) -> bool:
    return one == other or (math.isnan(one) and math.isnan(other))


def test_metadata_says_what_columns_mean(sink: Path, tmp_path: Path) -> None:
    (tmp_path / "run.bin").write_bytes(capture_of(sink, "pc", 3, 100))
    convert(sink, "pc", tmp_path / "run.bin", "parquet", tmp_path / "out")
    schema = parquet.read_schema(tmp_path / "out" / "numbers" / "run.parquet")
    protocol = protocol_of(sink)
    assert schema.metadata[b"protogen.spec_hash"].decode() == protocol.spec_hash
    assert schema.metadata[b"protogen.message"] == b"numbers"
    assert schema.metadata[b"protogen.capture"] == b"run"
    angle = schema.field("angle").metadata
    assert angle[b"protogen.unit"] == b"deg"
    assert angle[b"protogen.scale"] == b"1/16"
    assert json.loads(angle[b"protogen.special"]) == {"missing": 0x7FFF}
    assert schema.field("angle_deg").metadata[b"protogen.of"] == b"angle"
    assert json.loads(schema.field("mode").metadata[b"protogen.values"]) == {"idle": 0, "run": 7}
    assert json.loads(schema.field("flags").metadata[b"protogen.flags"])["wet"] == 7
    assert json.loads(schema.field("control").metadata[b"protogen.bits"])["gear"] == [6, 7]


@pytest.mark.parametrize(("path", "sender"), DOCUMENT_SENDERS, ids=name_of)
def test_json_lines_are_those_of_decode(path: Path, sender: str, tmp_path: Path) -> None:
    capture = tmp_path / "run.bin"
    capture.write_bytes(capture_of(path, sender, 2))
    convert(path, sender, capture, "jsonl", tmp_path / "out")
    lines = (tmp_path / "out" / "run.jsonl").read_text("utf-8")
    decoded = run("decode", str(path), "--sender", sender, str(capture), "--format", "jsonl")
    assert lines == decoded.output
    back = start("encode", str(path), "--format", "raw", input=lines.encode())
    assert back.stdout == capture.read_bytes()


def test_a_number_around_is_told_from_a_count_of_the_same_name(tmp_path: Path) -> None:
    """The rows have a count of `data`, which is not the `data_size` that `kind` asks for."""
    schema = tmp_path / "counts.yaml"
    schema.write_text(COUNTS)
    capture = tmp_path / "counts.bin"
    capture.write_bytes(bytes.fromhex("03 03 07 08 15  03 02 07 08 14"))
    convert(schema, "robot", capture, "parquet", tmp_path / "out")
    found = rows_of(tmp_path / "out", "counts", "parquet")["m"]
    assert [row["inner.kind"] for row in found] == [7, None]
    assert [row["inner.data"] for row in found] == [b"\x08", b"\x07\x08"]


def test_csv_shows_lists_as_json_and_bytes_as_digits(sink: Path, tmp_path: Path) -> None:
    (tmp_path / "run.bin").write_bytes(capture_of(sink, "pc", 3, 100))
    convert(sink, "pc", tmp_path / "run.bin", "csv", tmp_path / "out")
    convert(sink, "pc", tmp_path / "run.bin", "arrow", tmp_path / "out")
    rows = rows_of(tmp_path / "out", "run", "arrow")
    for name, expected in rows.items():
        with (tmp_path / "out" / name / "run.csv").open(encoding="utf-8", newline="") as file:
            found = list(csv.DictReader(file))
        assert len(found) == len(expected)
        for row, other in zip(found, expected, strict=True):
            assert list(row) == list(other)
            assert row["offset"] == str(other["offset"])
        if name == "lists":
            assert [json.loads(row["levels"]) for row in found] == [
                row["levels"] for row in rows[name]
            ]
            assert [bytes.fromhex(row["rest"]) for row in found] == [
                row["rest"] for row in rows[name]
            ]
        if name == "numbers":
            angles = [float(row["angle_deg"]) if row["angle_deg"] else None for row in found]
            assert angles == [row["angle_deg"] for row in rows[name]]
    facts = json.loads((tmp_path / "out" / "numbers" / "run.columns.json").read_text("utf-8"))
    assert facts["columns"]["angle"]["unit"] == "deg"
    assert facts["table"]["protogen.message"] == "numbers"


@pytest.mark.parametrize(
    "values",
    [
        [],
        [[]],
        [[1, 2.5, None, True], {}, {"a": {"b": [b"\x01\xff"]}}, "é", float("nan")],
        ["\ud800", ["\ud800", "\ud800"], ', "\ud800", ', "\\ud800"],
    ],
    ids=["none", "an empty one", "of every kind", "as the seam"],
)
def test_json_of_many_values_is_that_of_each(values: list[Any]) -> None:
    expected = [json.dumps(value, default=bytes.hex) for value in values]
    assert json_of_each(values, bytes.hex) == expected


@pytest.mark.parametrize("sender", ["pc", "board"])
def test_mcap_has_a_topic_with_a_json_schema_for_each_message(
    sink: Path, sender: str, tmp_path: Path
) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    data = capture_of(sink, sender, 3, 150)
    (tmp_path / "run.bin").write_bytes(data)
    convert(sink, sender, tmp_path / "run.bin", "mcap", tmp_path / "out")
    found: dict[str, list[tuple[int, int]]] = {}
    offsets = []
    with (tmp_path / "out" / "run.mcap").open("rb") as file:
        reader = mcap_reader.make_reader(file)
        (metadata,) = reader.iter_metadata()
        assert metadata.metadata["protogen.spec_hash"] == protocol_of(sink).spec_hash
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            row = json.loads(message.data, parse_constant=pytest.fail)
            jsonschema.validate(row, as_2020_12(json.loads(schema.data)))
            assert None not in row.values()
            _, _, by, name = channel.topic.split("/")
            assert by == sender
            size = row["_size"] if name == "lists" else row["size"]
            found.setdefault(name, []).append((row["offset"], size))
            # 9600 baud, ten bit times a byte
            assert message.log_time == (row["offset"] + size) * 10 * 10**9 // 9600
            offsets.append(row["offset"])
    assert found == frame_facts(events_of(sink, sender, data))
    assert offsets == sorted(offsets)


def as_2020_12(schema: dict[str, Any]) -> dict[str, Any]:
    """A schema with the `nullable` of OpenAPI 3.0 in the words that the validator knows."""
    plain = {key: value for key, value in schema.items() if key != "nullable"}
    if "properties" in plain:
        members = plain["properties"].items()
        plain["properties"] = {name: as_2020_12(member) for name, member in members}
    if "items" in plain:
        plain["items"] = as_2020_12(plain["items"])
    return {"anyOf": [plain, {"type": "null"}]} if schema.get("nullable") else plain


def assert_foxglove_reads(schema: dict[str, Any]) -> None:
    """Foxglove Studio refuses a topic whose schema has another type, or more than one.

    Its source has the rules: packages/mcap-support/src/parseJsonSchema.ts.
    """
    assert schema["type"] == "object"
    for member in schema["properties"].values():
        assert not {"oneOf", "contentEncoding"} & set(member)
        inner = member
        if member["type"] == "array":
            inner = member["items"]
            assert "contentEncoding" not in inner
        if inner["type"] == "object":
            assert_foxglove_reads(inner)
        else:
            assert inner["type"] in ("boolean", "string", "number", "integer")


@pytest.mark.parametrize(("path", "sender"), DOCUMENT_SENDERS, ids=str)
def test_foxglove_reads_the_schema_of_each_topic(path: Path, sender: str) -> None:
    protocol = protocol_of(path)
    for table in tables_of(protocol, protocol.sender(sender)).all_tables:
        assert_foxglove_reads(json_schema(table))


def test_what_has_no_value_is_left_out_of_mcap(tmp_path: Path) -> None:
    schema = tmp_path / "gaps.yaml"
    schema.write_text(
        """protocol: gaps
title: Gaps
endpoints: {board: Board}
byte_order: little
frame:
  start: {literal: 0xAA, unprotected: bare}
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: [id, payload]}
decisions:
  bare: {question: Is the start kept out of data?, document: silent, choice: no, because: A test}
types:
  turn:
    fields:
      kind: uint8
      value: {switch: kind, cases: {1: uint8, 2: float32}}
messages:
  readings:
    id: 1
    from: board
    fields:
      heading: {type: uint8, scale: 2, unit: deg, special: {lost: 255}}
      ranges: {type: uint8, count: 3, scale: 2, unit: mm, special: {nothing: 0}}
      warmth: {type: float32}
      turns: {type: turn, count: 2}
"""
    )
    payload = bytes.fromhex(
        "ff"  # heading: lost
        "01 00 02"  # ranges: 2 mm, nothing, 4 mm
        "00 00 c0 7f"  # warmth: not a number
        "01 07"  # turns: kind 1 with an integer
        "02 00 00 c0 7f"  # kind 2 with a float that is none
    )
    frame = bytes((0xAA, 1, *payload, (1 + sum(payload)) & 0xFF))
    (tmp_path / "run.bin").write_bytes(frame)
    convert(schema, "board", tmp_path / "run.bin", "mcap", tmp_path / "out")
    with (tmp_path / "out" / "run.mcap").open("rb") as file:
        ((found, _, message),) = mcap_reader.make_reader(file).iter_messages()
    row = json.loads(message.data)
    assert row == {
        "offset": 0,
        "size": 18,
        "heading": 255,
        "ranges": [1, 0, 2],
        "ranges_mm": [2.0, None, 4.0],
        "turns": [
            {"kind": 1, "value": {"case_1": {"value": 7}}},
            {"kind": 2, "value": {"case_2": {}}},
        ],
    }
    described = json.loads(found.data)
    pytest.importorskip("jsonschema").validate(row, as_2020_12(described))
    assert_foxglove_reads(described)
    assert "heading" in described["required"]
    assert {"t_ns", "heading_deg", "warmth"}.isdisjoint(described["required"])


def test_the_summary_counts_messages_and_invalid_bytes(sink: Path, tmp_path: Path) -> None:
    data = capture_of(sink, "pc", 3, 100)
    (tmp_path / "run.bin").write_bytes(data)
    lines = convert(sink, "pc", tmp_path / "run.bin", "jsonl", tmp_path / "out")
    assert lines[0] == f"{tmp_path / 'run.bin'}: raw bytes, {len(data)} bytes"
    assert lines[-1] == f"  wrote 1 file in {tmp_path / 'out'}"
    events = events_of(sink, "pc", data)
    invalid: dict[str, int] = {}
    for event in events:
        if event.kind == "invalid":
            invalid[event.reason] = invalid.get(event.reason, 0) + event.size
    shown = dict(line.strip().rsplit("  ", 1) for line in lines[1:-1])
    shown = {name.strip(): text.strip() for name, text in shown.items()}
    for reason, size in invalid.items():
        assert shown[f"invalid: {reason}"] == f"{size} bytes"
    assert shown["numbers"] == str(
        sum(event.kind == "message" and event.message.NAME == "numbers" for event in events)
    )
    again = convert(sink, "pc", tmp_path / "run.bin", "jsonl", tmp_path / "out")
    assert again[0].endswith("done before, nothing has changed since")
    assert again[1:] == lines[1:-1]


def test_quiet_prints_nothing(sink: Path, tmp_path: Path) -> None:
    (tmp_path / "run.bin").write_bytes(b"noise")
    assert not convert(sink, "pc", tmp_path / "run.bin", "csv", tmp_path / "out", "--quiet")


class TestNames:
    def test_tables_of_no_message_make_way_for_messages(self) -> None:
        from cli_support import compiled

        text = SINK.replace("  empty:", "  unknown_frames:").replace("  lists:", "  invalid_spans:")
        protocol = compiled(text)
        tables = tables_of(protocol, protocol.sender("pc"))
        assert tables.unknown.name == "_unknown_frames"
        assert tables.invalid.name == "_invalid_spans"

    def test_columns_of_the_frame_make_way_for_fields(self) -> None:
        from cli_support import compiled

        text = SINK.replace("mode:", "angle_deg:").replace("letter:", "t_ns:")
        protocol = compiled(text)
        columns = tables_of(protocol, protocol.sender("pc")).messages["numbers"].all_columns
        names = [column.name for column in columns]
        assert len(names) == len(set(names))
        assert {"_t_ns", "t_ns", "angle_deg", "angle_deg_value", "angle_deg_name"} <= set(names)

    def test_captures_of_one_name_are_told_apart_by_their_folders(
        self, sink: Path, tmp_path: Path
    ) -> None:
        for folder in ("a", "b"):
            (tmp_path / folder).mkdir()
            (tmp_path / folder / "run.bin").write_bytes(b"x")
        places = [str(tmp_path / folder / "run.bin") for folder in ("a", "b")]
        out = tmp_path / "out"
        arguments = ["--sender", "pc", "--to", "jsonl", "-o", str(out)]
        assert run("convert", str(sink), *places, *arguments).exit_code == 0
        written = sorted(path.name for path in out.glob("*.jsonl"))
        assert [name[-11:] for name in written] == ["a-run.bin.jsonl"[-11:]] * 2
        assert len(written) == 2
        twice = run("convert", str(sink), places[0], places[0], *arguments)
        assert twice.exit_code == 2
        assert "is given twice" in twice.output


class TestErrors:
    def test_a_missing_package_is_named_with_its_extra(self, monkeypatch: Any) -> None:
        monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
        with pytest.raises(ConvertError, match="package pyarrow") as caught:
            needed("pyarrow", "writing Parquet")
        assert caught.value.hint == "pip install 'protogen-serial[parquet]'"

    def test_a_package_that_does_not_fit_is_not_called_missing(self, monkeypatch: Any) -> None:
        def refuse(module: str) -> None:
            raise ImportError("compiled for another NumPy")

        monkeypatch.setattr(errors, "import_module", refuse)
        with pytest.raises(ConvertError, match="package pyarrow: compiled for another NumPy"):
            needed("pyarrow", "writing Parquet")

    def test_the_command_says_so_before_it_reads_anything(
        self, sink: Path, tmp_path: Path, monkeypatch: Any
    ) -> None:
        monkeypatch.setitem(__import__("sys").modules, "mcap", None)
        arguments = ["--sender", "pc", "--to", "mcap", "-o", str(tmp_path / "out")]
        done = run("convert", str(sink), "-", *arguments)
        assert done.exit_code == 2
        assert "pip install 'protogen-serial[mcap]'" in done.output
        assert not (tmp_path / "out").exists()

    def test_a_capture_that_is_not_there(self, sink: Path, tmp_path: Path) -> None:
        done = run("convert", str(sink), "--sender", "pc", "nowhere.bin", "--to", "csv")
        assert done.exit_code == 2
        assert "nowhere.bin: No such file" in done.output

    @pytest.mark.parametrize("to", FORMATS)
    def test_a_folder_that_cannot_be_written_is_named(
        self, sink: Path, tmp_path: Path, to: str
    ) -> None:
        capture, folder = tmp_path / "run.bin", tmp_path / "file" / "out"
        capture.write_bytes(capture_of(sink, "board", 3))
        (tmp_path / "file").touch()
        done = run("convert", str(sink), "--sender", "board", str(capture), "--to", to,
                   "-o", str(folder))  # fmt: skip
        assert done.exit_code == 2
        assert f"error: {folder}" in done.output.replace("\n", "")

    @pytest.mark.parametrize("frames", [200, 150_000], ids=["at the end", "on the way"])
    @pytest.mark.parametrize("to", FORMATS)
    def test_a_full_disk_is_that_of_the_folder(
        self, sink: Path, tmp_path: Path, to: str, frames: int
    ) -> None:
        """No file may grow beyond some bytes, which is told as a full disk is."""
        resource = pytest.importorskip("resource")
        capture, folder = tmp_path / "run.bin", tmp_path / "out"
        capture.write_bytes(bytes.fromhex("1B 02 45 00 00 45 1B 03") * frames)  # `empty`
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        (tmp_path / "one.bin").write_bytes(capture.read_bytes()[:8])
        convert(sink, "pc", tmp_path / "one.bin", to, tmp_path / "other")  # What is compiled.
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
        try:
            done = run("convert", str(sink), "--sender", "pc", str(capture), "--to", to,
                       "-o", str(folder))  # fmt: skip
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
        assert done.exit_code == 2
        assert f"error: {folder}: " in done.output.replace("\n", "")
        assert list(folder.rglob("*")) == []

    def test_mcap_is_closed_where_its_end_has_no_room(
        self, sink: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Else it is closed some day, and Python complains of it then."""

        def fail() -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

        protocol = protocol_of(sink)
        tables = tables_of(protocol, protocol.sender("pc"))
        writer: Any = open_writer(OutputFormat.MCAP, "x", Pending(tmp_path), tables)
        monkeypatch.setattr(writer._mcap, "close", fail)
        with pytest.raises(OSError, match="No space"):
            writer.close()
        assert writer._file.closed

    def test_without_a_compiler_the_command_says_what_is_slow(
        self, sink: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        capture = tmp_path / "run.bin"
        capture.write_bytes(capture_of(sink, "board", 3))
        monkeypatch.setenv("CC", f"no-such-cc-{tmp_path.name}")
        lines = convert(sink, "board", capture, "csv", tmp_path / "out")
        assert lines[0].startswith("warning: columns are filled from Python's events, ")
        assert "there is no C compiler 'no-such-cc" in lines[0]
        assert lines[1].startswith(f"{capture}: raw bytes")

    def test_what_parquet_has_no_place_for(self, tmp_path: Path) -> None:
        schema, capture = tmp_path / "empty.yaml", tmp_path / "run.bin"
        schema.write_text("""
protocol: empty
title: Structs without members
endpoints: {one: One side}
frame:
  sync: {literal: {hex: 5A A5}, unprotected: sync_in_data}
  length: {type: uint8, counts: payload}
  id: {type: uint8, id: true}
  payload: {}
messages:
  items: {id: 1, from: one, fields: {a: uint8, list: {count: 2, fields: {}}}}
decisions:
  sync_in_data: {question: Is it protected?, document: No., choice: Accept., because: It is rare.}
""")
        capture.write_bytes(b"\x5a\xa5\1\1\7")
        done = run("convert", str(schema), str(capture), "--to", "parquet",
                   "-o", str(tmp_path / "out"))  # fmt: skip
        assert done.exit_code == 2
        assert "Parquet has no place for what items holds" in done.output.replace("\n", " ")
        assert not list((tmp_path / "out").rglob("*.partial"))

    def test_a_file_of_somebody_else_stays(self, sink: Path, tmp_path: Path) -> None:
        (tmp_path / "run.bin").write_bytes(b"noise")
        theirs = tmp_path / "out" / "run.jsonl"
        theirs.parent.mkdir()
        theirs.write_text("mine")
        arguments = ["--sender", "pc", "--to", "jsonl", "-o", str(tmp_path / "out")]
        done = run("convert", str(sink), str(tmp_path / "run.bin"), *arguments)
        assert done.exit_code == 2
        assert "no earlier run made it" in done.output
        assert theirs.read_text() == "mine"
        assert [path.name for path in theirs.parent.iterdir()] == ["run.jsonl"]
        forced = run("convert", str(sink), str(tmp_path / "run.bin"), *arguments, "--force")
        assert forced.exit_code == 0
        assert json.loads(theirs.read_text())["raw"] == b"noise".hex()

    def test_an_error_survives_a_trip_to_another_process(self) -> None:
        import pickle

        error = pickle.loads(pickle.dumps(ConvertError("what", "mend")))
        assert (str(error), error.hint) == ("what", "mend")
