"""MCAP with messages of ROS 2: what independent readers find in them is what the tables hold."""

from __future__ import annotations

import math
import re
import struct
from pathlib import Path
from random import Random
from typing import Any

import pytest
from cli_support import SINK, run
from compiled import module_at, name_of, protocol_of, senders
from test_convert_columns import GREAT, SAMPLED, batches_of
from test_json_lines import capture_of

from protogen.convert.columns.batches import Tally
from protogen.convert.columns.decoders import _PRINTERS
from protogen.convert.columns.python_values import as_list
from protogen.convert.columns.tables import Tables, tables_of
from protogen.convert.formats import OutputFormat
from protogen.convert.ros2.layout import Layout, ListOf, Message, Number, RosType, String
from protogen.convert.writers.format_writers import open_writer, write_all
from protogen.convert.writers.mcap_ros2 import Ros2Messages
from protogen.convert.writers.pending_files import Pending
from protogen.runtime.framing.assembly import encode_frame

reading = pytest.importorskip("mcap.reader")
highlevel = pytest.importorskip("rosbags.highlevel")
typesys = pytest.importorskip("rosbags.typesys")
ros2 = pytest.importorskip("mcap_ros2.decoder")

ENGINES = ("events", None)
HEAD = """protocol: gaps
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
"""


def written(
    folder: Path, path: Path, sender: str, data: bytes, engine: str | None, timed: bool = False
) -> Path:
    """The file of a capture."""
    tables = the_tables(path, sender)
    writer = open_writer(OutputFormat.MCAP_ROS2, "run", pending := Pending(folder), tables)
    batches = batches_of(path, sender, data, engine, timed, to=OutputFormat.MCAP_ROS2)
    write_all(writer, batches, Tally())
    assert pending.commit() == ["run.ros2.mcap"]
    return folder / "run.ros2.mcap"


def the_tables(path: Path, sender: str) -> Tables:
    protocol = protocol_of(path)
    return tables_of(protocol, protocol.sender(sender))


def messages_of(file: Path) -> list[Any]:
    with file.open("rb") as opened:
        reader = reading.make_reader(opened, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        found = list(reader.iter_messages(log_time_order=False))
        assert len(list(reader.iter_messages())) == len(found)
        assert reader.get_summary().statistics.message_count == len(found)
        return found


def frame_of(number: int, payload: bytes) -> bytes:
    return bytes((0xAA, number, *payload, (number + sum(payload)) & 0xFF))


# --- bytes by hand --------------------------------------------------------------------------------

GAPS = (
    HEAD
    + """types:
  turn:
    fields:
      kind: uint8
      value: {switch: kind, cases: {1: uint8, 2: float32}}
messages:
  readings:
    id: 1
    from: board
    fields:
      heading: {type: uint8, scale: 2, unit: deg, special: {lost: 255}, doc: Where it looks.}
      ranges: {type: uint8, count: 3, scale: 2, unit: mm, special: {nothing: 0}}
      warmth: {type: float32}
      turns: {type: turn, count: 2}
"""
)
GAPS_DEFINITION = """# readings
uint64 offset  # [B]
uint32 size  # [B]
bool has_t_ns
int64 t_ns  # When the last byte came, since 1970-01-01 UTC. [ns]
uint8 HEADING_LOST=255
uint8 heading  # Where it looks. [deg] (scale 2, offset 0)
float64 heading_deg  # [deg] (of heading)
uint8 RANGES_NOTHING=0
uint8[3] ranges  # [mm] (scale 2, offset 0)
float64[3] ranges_mm  # [mm] (of ranges)
float32 warmth
gaps/ReadingsTurns[2] turns
================================================================================
MSG: gaps/ReadingsTurns
uint8 kind
gaps/ReadingsTurnsValue value
================================================================================
MSG: gaps/ReadingsTurnsValue
bool has_case_1
gaps/ReadingsTurnsValueCase1 case_1
bool has_case_2
gaps/ReadingsTurnsValueCase2 case_2
================================================================================
MSG: gaps/ReadingsTurnsValueCase1
uint8 value
================================================================================
MSG: gaps/ReadingsTurnsValueCase2
float32 value
"""
GAPS_PAYLOAD = (
    "ff"  # heading: lost
    "01 00 02"  # ranges: 2 mm, nothing, 4 mm
    "01 00 a0 ff"  # warmth: not a number, one that says more
    "01 07"  # turns: kind 1 with an integer
    "02 00 00 c0 7f"  # kind 2 with a float that is none
)
GAPS_MESSAGE = (
    "00 01 00 00"  # plain CDR, the least significant byte first
    "00 00 00 00 00 00 00 00"  # offset
    "12 00 00 00"  # size: 18
    "00 00 00 00 00 00 00 00 00 00 00 00"  # has_t_ns, up to a multiple of 8, t_ns
    "ff 00 00 00 00 00 00 00"  # heading
    "00 00 00 00 00 00 f8 7f"  # heading_deg: none
    "01 00 02 00 00 00 00 00"  # ranges
    "00 00 00 00 00 00 00 40 00 00 00 00 00 00 f8 7f 00 00 00 00 00 00 10 40"  # 2, none, 4
    "00 00 c0 7f"  # warmth
    "01 01 07 00 00 00 00 00"  # kind 1: has_case_1, 7, no has_case_2
    "02 00 00 01 00 00 c0 7f"  # kind 2
)

LISTS = (
    HEAD
    + """messages:
  lists:
    id: 2
    from: board
    fields:
      n: uint8
      levels: {type: uint16, count: n, scale: 1/2, unit: V}
      name: {type: ascii, size: 3}
      mode: {type: uint8, when: n, values: {idle: 0, run: 7}}
"""
)
LISTS_DEFINITION = """# lists
uint64 offset  # [B]
uint32 size  # [B]
bool has_t_ns
int64 t_ns  # When the last byte came, since 1970-01-01 UTC. [ns]
uint8 n
uint16[] levels  # [V] (scale 1/2, offset 0)
float64[] levels_v  # [V] (of levels)
string name
bool has_mode
uint8 MODE_IDLE=0
uint8 MODE_RUN=7
uint8 mode
"""
LISTS_MESSAGES = (
    "00 01 00 00"
    "00 00 00 00 00 00 00 00"  # offset
    "0a 00 00 00"  # size: 10
    "00 00 00 00 00 00 00 00 00 00 00 00"  # no t_ns
    "01 00 00 00"  # n
    "01 00 00 00 05 00 00 00"  # one level, and two bytes up to a multiple of 4
    "01 00 00 00 00 00 00 00 00 00 04 40"  # one of 2.5
    "04 00 00 00 41 c3 a9 00"  # name
    "01 07",  # mode: run
    "00 01 00 00"
    "0a 00 00 00 00 00 00 00"
    "07 00 00 00"
    "00 00 00 00 00 00 00 00 00 00 00 00"
    "00 00 00 00"
    "00 00 00 00"  # no levels
    "00 00 00 00"
    "04 00 00 00 41 42 43 00"
    "00 00",  # no mode
)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_message_has_the_bytes_of_cdr(tmp_path: Path, engine: str | None) -> None:
    path = tmp_path / "gaps.yaml"
    path.write_text(GAPS)
    frame = frame_of(1, bytes.fromhex(GAPS_PAYLOAD))
    ((schema, channel, message),) = messages_of(written(tmp_path, path, "board", frame, engine))
    assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")
    assert schema.name == "gaps/msg/Readings"
    assert channel.topic == "/gaps/board/readings"
    assert schema.data.decode() == GAPS_DEFINITION
    assert message.data == bytes.fromhex(GAPS_MESSAGE)
    assert message.log_time == 18_000  # a microsecond a byte


@pytest.mark.parametrize("engine", ENGINES)
def test_lists_may_be_empty_and_values_missing(tmp_path: Path, engine: str | None) -> None:
    path = tmp_path / "gaps.yaml"
    path.write_text(LISTS)
    first = frame_of(2, bytes.fromhex("01 05 00 41 E9 00 07"))
    second = frame_of(2, bytes.fromhex("00 41 42 43"))
    found = messages_of(written(tmp_path, path, "board", first + second, engine))
    assert found[0][0].data.decode() == LISTS_DEFINITION
    assert [message.data for *_, message in found] == [*map(bytes.fromhex, LISTS_MESSAGES)]


# --- independent readers --------------------------------------------------------------------------

FIELD = re.compile(
    r"(?P<type>[a-z0-9]+|[a-z0-9_]+/[A-Z][A-Za-z0-9]*)(\[\d*\])? [a-z]+(_?[a-z0-9]+)*"
)
CONSTANT = re.compile(r"u?int(8|16|32|64) [A-Z]+(_?[A-Z0-9]+)*=-?\d+")


@pytest.mark.parametrize(("path", "sender"), [*senders(), *SAMPLED], ids=name_of)
def test_definitions_are_those_of_ros(path: Path, sender: str) -> None:
    tables = the_tables(path, sender)
    encoding = Ros2Messages(tables)
    known: set[str] = set()
    for table in tables.all_tables:
        name, data = encoding.schema(table)
        types = typesys.get_types_from_msg(data.decode(), name)
        assert not known & types.keys()  # Each is defined once, for one table.
        known |= types.keys()
        for line in data.decode().splitlines():
            if line.startswith(("#", "MSG: ", "=====")):
                continue
            bare = line.partition("  #")[0]
            assert FIELD.fullmatch(bare) or CONSTANT.fullmatch(bare), line


@pytest.mark.parametrize(("path", "sender"), [*senders(), *SAMPLED], ids=name_of)
def test_readers_find_the_rows(path: Path, sender: str, tmp_path: Path) -> None:
    data = capture_of(path, sender, 4, 100)
    by_events, printed = (
        written(tmp_path / f"{engine}", path, sender, data, engine, timed=True)
        for engine in ENGINES
    )
    found = messages_of(printed)
    assert messages_of(by_events) == found
    assert_rows(the_tables(path, sender), found, expected_rows(path, sender, data, timed=True))
    assert_mcap_ros2_reads(printed, found)


def expected_rows(
    path: Path, sender: str, data: bytes, timed: bool = False
) -> dict[str, list[Any]]:
    """The rows of each table, by their columns, without any of the code for ROS."""
    found: dict[str, list[Any]] = {}
    for batch in batches_of(path, sender, data, "events", timed):
        for rows in batch.rows():
            names = [column.name for column in rows.table.all_columns]
            values = zip(*map(as_list, rows.columns), strict=True)
            found.setdefault(rows.table.name, []).extend(
                dict(zip(names, row, strict=True)) for row in values
            )
    return found


def assert_rows(tables: Tables, found: list[Any], expected: dict[str, list[Any]]) -> None:
    """Each message, as rosbags reads it, is a row."""
    layout = Layout(tables)
    store = typesys.get_typestore(typesys.Stores.EMPTY)
    known: set[str] = set()
    rows = {name: iter(each) for name, each in expected.items()}
    assert len(found) == sum(map(len, expected.values()))
    for schema, channel, message in found:
        if schema.name not in known:
            known.add(schema.name)
            store.register(typesys.get_types_from_msg(schema.data.decode(), schema.name))
        name = channel.topic.rpartition("/")[2]
        row = next(rows[name])
        read = store.deserialize_cdr(message.data, schema.name)
        for member in layout.messages[name].members:
            assert_member(read, member, row[member.source])
        # What a row has that a message has not is the names of values, which are constants.
        others = row.keys() - {member.source for member in layout.messages[name].members}
        for other in others:
            assert_named(read, layout.messages[name], row[other], other.removesuffix("_name"))


def assert_named(read: Any, message: Message, name: str | None, source: str) -> None:
    member = next((it for it in message.members if it.source == source), None)
    if member is not None and name is not None:
        words = "_".join([member.name, *filter(None, name.split("_"))]).upper()
        constants = {it.name: it.value for it in member.constants}
        assert constants[words] == getattr(read, member.name)


def assert_member(read: Any, member: Any, value: Any) -> None:
    there = getattr(read, member.name)
    if member.flag is not None:
        assert getattr(read, member.flag) is (value is not None)
    assert_value(there, member.type, value, nan=member.flag is None)


def assert_value(read: Any, type: RosType, value: Any, nan: bool = True) -> None:
    match type:
        case Number():
            empty = math.nan if nan and type.is_float else 0
            shown = empty if value is None else value
            assert read == shown or (math.isnan(read) and math.isnan(shown))
            assert math.copysign(1, read) == math.copysign(1, shown) or math.isnan(read)
        case String():
            assert read == (value or "")
        case ListOf(element=element):
            values = value if value is not None else ()
            assert len(read) == len(values)
            for one, other in zip(read, values, strict=True):
                assert_value(one, element, other)
        case Message(is_list=True):
            assert_value(read.values, type.members[0].type, value)
        case Message(members=members):
            for member in members:
                inner = (value or {}).get(member.source)
                there = getattr(read, member.name)
                assert member.flag is None or getattr(read, member.flag) is (inner is not None)
                assert_value(there, member.type, inner, nan=False)


def assert_mcap_ros2_reads(file: Path, found: list[Any]) -> None:
    """The reader of the MCAP project reads it, too."""
    with file.open("rb") as opened:
        reader = reading.make_reader(opened, decoder_factories=[ros2.DecoderFactory()])
        each = list(reader.iter_decoded_messages(log_time_order=False))
    assert len(each) == len(found)


@pytest.mark.parametrize("sender", ["pc", "board"])
def test_the_command_makes_what_both_readers_read(sender: str, tmp_path: Path) -> None:
    path = tmp_path / "sink.yaml"
    path.write_text(SINK)
    data = capture_of(path, sender, 3, 150)
    (tmp_path / "run.bin").write_bytes(data)
    arguments = [str(path), "--sender", sender, str(tmp_path / "run.bin"), "-o", str(tmp_path)]
    for to in ("mcap", "mcap-ros2"):
        assert run("convert", *arguments, "--to", to).exit_code == 0
    assert (tmp_path / "run.mcap").exists()  # Both stand beside each other.
    found = messages_of(tmp_path / "run.ros2.mcap")
    assert_rows(the_tables(path, sender), found, expected_rows(path, sender, data))
    with highlevel.AnyReader([tmp_path / "run.ros2.mcap"]) as bag:
        each = [message for _, _, message in bag.messages()]
    in_order = sorted(found, key=lambda it: it[2].log_time)
    assert each == [message.data for *_, message in in_order]
    again = run("convert", *arguments, "--to", "mcap-ros2")
    assert "done before" in again.output


# --- packing --------------------------------------------------------------------------------------

LONG = (
    HEAD
    + """messages:
  {long}:
    id: 3
    from: board
    fields:
      n: {type: uint32, range: [0, 700000]}
      values: {type: uint8, count: n, scale: 1/3, unit: m}
  short: {id: 4, from: board, fields: {a: sint16, b: {type: uint8, values: {low: 1}}}}
"""
).replace("{long}", "long")


def test_thousands_of_messages_are_those_of_the_line(tmp_path: Path) -> None:
    path = tmp_path / "gaps.yaml"
    path.write_text(LONG)
    dice = Random(3)
    short = [frame_of(4, dice.randbytes(3)) for _ in range(2_500)]
    data = b"".join([*short, *[frame_of(4, bytes(3))] * 2_500])
    found = messages_of(written(tmp_path / "c", path, "board", data, None))
    assert messages_of(written(tmp_path / "python", path, "board", data, "events")) == found
    for frame, (*_, message) in zip(short, found[:2_500], strict=True):
        assert message.data[-3:] == frame[2:5]


def test_messages_may_be_longer_than_what_is_printed_at_once(tmp_path: Path) -> None:
    path = tmp_path / "gaps.yaml"
    path.write_text(LONG)
    dice = Random(3)
    short = b"".join(frame_of(4, dice.randbytes(3)) for _ in range(12))
    # At once 512 KB are printed, which is room for some 58,000 of these values.
    values = [dice.randbytes(n) for n in (3, 9_000, 5, 7_200, 7_300, 60_000, 0, 530_000, 1, 7_270)]
    data = b"".join(frame_of(3, struct.pack("<I", len(it)) + it) + short for it in values)
    found = messages_of(written(tmp_path, path, "board", data, None))
    long = [message.data for schema, _, message in found if schema.name == "gaps/msg/Long"]
    assert len(found) == 13 * len(values)
    for raw, message in zip(values, long, strict=True):
        count = struct.pack("<I", len(raw))
        assert message[28:36] == count + count  # n, then the number of values
        assert message[36 : 36 + len(raw)] == raw
        physical = struct.unpack(f"<{len(raw)}d", message[len(message) - 8 * len(raw) :])
        assert physical == tuple(value / 3 for value in raw)


def test_without_a_compiler_messages_are_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "gaps.yaml"
    path.write_text(LONG)
    data = frame_of(4, bytes(3)) * 3
    expected = messages_of(written(tmp_path / "one", path, "board", data, None))
    monkeypatch.setenv("CC", "no-such-ros")
    _PRINTERS.clear()
    with pytest.warns(UserWarning, match="columns are filled from Python's events"):
        assert messages_of(written(tmp_path / "other", path, "board", data, None)) == expected


# --- numbers --------------------------------------------------------------------------------------

SCALED = """
      a: {type: uint64, scale: 1/3, offset: 5, unit: m}
      b: {type: sint64, scale: 1e-9, unit: s, special: {absent: 0}}
      c: {type: uint32, scale: 1/1000, offset: -273.15, unit: degC, special: {absent: 0xFFFFFFFF}}
      d: {type: float32, scale: 16, offset: 0.1, unit: m}
      e: {type: uint16, count: 5, scale: -1/7, offset: 0.3, unit: m, special: {absent: 0}}
      g: {type: uint8, unit: m, special: {absent: 0, far: 255}}
      f: {type: float32, unit: m, special: {absent: 0}}
      h: {type: sint8, values: {minus: -1, zero: 0, one: 1}}
      n: {type: uint8, range: [0, 2]}
      t: {type: ascii, size: n}
      u: {type: uint64, count: n, scale: 3/7, unit: m}
      s: {type: float64, when: n == 1, scale: 2, unit: m}
      w: {type: uint16, count: 2, when: n == 1, scale: 2, unit: m}
      v: {type: float64, count: n}
"""
GREATER = "      q: {type: uint64, scale: 123456789012345678901/7, unit: m}\n"


@pytest.mark.parametrize("more", ["", GREATER], ids=["in_c", "in_python"])
def test_physical_values_are_those_of_tables(tmp_path: Path, more: str) -> None:
    path = tmp_path / "great.yaml"
    message = f"  scaled:\n    id: 3\n    from: one\n    fields:{SCALED}{more}"
    path.write_text(GREAT[: GREAT.index("  scaled:")] + message)
    data = capture_of(path, "one", 4, 300)
    found = messages_of(written(tmp_path / "c", path, "one", data, None))
    assert messages_of(written(tmp_path / "python", path, "one", data, "events")) == found
    expected = expected_rows(path, "one", data)
    assert len(expected["scaled"]) > 20
    assert {row["n"] for row in expected["scaled"]} >= {0, 1, 2}
    assert_rows(the_tables(path, "one"), found, expected)


FLOATS = """
      one: {type: float32, scale: 1e30, unit: m}
      many: {type: float64, count: 2}
      n: {type: uint8, range: [1, 2]}
      of:
        switch: n
        cases: {1: float32, 2: {fields: {inner: float64, text: {type: ascii, size: 2}}}}
"""


def test_floats_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "great.yaml"
    message = f"  scaled:\n    id: 3\n    from: one\n    fields:{FLOATS}"
    path.write_text(GREAT[: GREAT.index("  scaled:")] + message)
    spec = module_at(path).PROTOCOL.sender("one")
    frames = b""
    for odd in (float("nan"), float("inf"), -float("inf"), -0.0, 1e10):
        front = struct.pack("<f2d", odd, odd, 1.0)
        for last in (struct.pack("<f", odd), struct.pack("<d2s", odd, b"a")):
            payload = front + bytes([1 if len(last) == 4 else 2]) + last
            frames += encode_frame(spec, (3,), payload, {}, strict=False)
    found = messages_of(written(tmp_path / "c", path, "one", frames, None))
    assert messages_of(written(tmp_path / "python", path, "one", frames, "events")) == found
    assert_rows(the_tables(path, "one"), found, expected_rows(path, "one", frames))
