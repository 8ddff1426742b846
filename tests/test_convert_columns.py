"""Batches from NumPy tables are those of events: the same rows and lines, whatever decodes."""

from __future__ import annotations

import io
import json
import math
import struct
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import pytest
from cli_support import SINK
from compiled import ROOT, module_at, name_of, protocol_of, senders
from corpus import portions
from test_json_lines import capture_of

np = pytest.importorskip("numpy")
pa = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

from protogen.convert.columns.arrays import Lists, Numbers  # noqa: E402
from protogen.convert.columns.arrow_tables import array_of, batch_of, schema_of  # noqa: E402
from protogen.convert.columns.batches import Batch, BatchDecoder, Tally  # noqa: E402
from protogen.convert.columns.composite_arrays import Scattered, Structs  # noqa: E402
from protogen.convert.columns.decoders import column_decoders, open_decoder  # noqa: E402
from protogen.convert.columns.physical_values import NameFinder, physical  # noqa: E402
from protogen.convert.columns.python_values import as_list  # noqa: E402
from protogen.convert.columns.tables import (  # noqa: E402
    FLOAT64,
    Listed,
    Naming,
    Physical,
    Record,
    Scalar,
    tables_of,
)
from protogen.convert.formats import OutputFormat  # noqa: E402
from protogen.convert.inputs.chunks import Chunk  # noqa: E402

ENGINES = ["python", None]
SAMPLERS = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))
GREAT = """
protocol: great
title: Numbers of 64 bits that choose, and floats whose physical values are infinite
endpoints: {one: One side}
byte_order: little
frame:
  sync: {literal: {hex: 5A A5}, unprotected: sync_in_data}
  id: {type: uint8, id: true}
  length: {type: uint8, counts: payload}
  payload: {}
decisions:
  sync_in_data: {question: Is it protected?, document: No., choice: Accept., because: It is rare.}
types:
  kind: {type: uint64, values: {low: 1, exact: 0x20000000000000, middle: 0x8000000000000000, high: 0xFFFFFFFFFFFFFFFF}}
messages:
  chosen:
    id: 1
    from: one
    fields:
      kind: kind
      value: {switch: kind, cases: {low: uint8, exact: uint8, middle: uint8, high: uint8}, unknown: true}
  scaled: {id: 2, from: one, fields: {f: {type: float64, scale: 16, unit: m}}}
"""  # noqa: E501
SAMPLED = [(path, it.name) for path in SAMPLERS for it in protocol_of(path).senders]
EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), senders() + SAMPLED, ids=name_of)


def batches_of(
    path: Path,
    sender: str,
    data: bytes,
    engine: str | None,
    timed: bool = False,
    to: OutputFormat = OutputFormat.PARQUET,
) -> list[Batch]:
    protocol = protocol_of(path)
    tables = tables_of(protocol, protocol.sender(sender))
    decoder = open_decoder(tables, module_at(path).PROTOCOL.sender(sender), to, engine)
    return fed(decoder, data, timed)


def fed(decoder: BatchDecoder, data: bytes, timed: bool) -> list[Batch]:
    """Events that a decoder makes of portions of a capture."""
    found: list[Batch] = []
    dice = Random(7)
    for place, piece in enumerate(portions(data, dice)):
        middle = len(piece) // 2
        times = ([middle, len(piece)], [1000 * place - 5, 1000 * place + 1]) if timed else ([], [])
        found += decoder.feed(Chunk(piece, *times))
    return [*found, *decoder.flush()]


def comparable(value: Any) -> Any:
    if isinstance(value, float) and math.isnan(value):
        return "nan"
    if isinstance(value, list | tuple):
        return [comparable(item) for item in value]
    if isinstance(value, dict):
        return {name: comparable(item) for name, item in value.items()}
    return value


def rows_of(batches: list[Batch]) -> dict[str, list[Any]]:
    """All rows of each table, as Python has them."""
    found: dict[str, list[Any]] = {}
    for batch in batches:
        for rows in batch.rows():
            columns = [comparable(as_list(values)) for values in rows.columns]
            found.setdefault(rows.table.name, []).extend(zip(*columns, strict=True))
    return found


def arrow_rows(batches: list[Batch]) -> dict[str, list[Any]]:
    """All rows of each table, as Arrow has them."""
    found: dict[str, list[Any]] = {}
    for batch in batches:
        for rows in batch.rows():
            table = batch_of(rows, schema_of(rows.table, {}))
            table.validate(full=True)
            columns = [comparable(column.to_pylist()) for column in table.columns]
            found.setdefault(rows.table.name, []).extend(zip(*columns, strict=True))
    return found


def tally_of(batches: list[Batch]) -> Tally:
    whole = Tally()
    for batch in batches:
        whole.add(batch.tally)
    return whole


def lines_of(batches: list[Batch]) -> list[bytes]:
    return b"".join(line for batch in batches for line in batch.lines()).splitlines()


@EVERY_SENDER
@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_are_those_of_events(path: Path, sender: str, engine: str | None) -> None:
    data = capture_of(path, sender, 11, 120)
    expected = batches_of(path, sender, data, "events")
    found = batches_of(path, sender, data, engine)
    assert rows_of(found) == rows_of(expected)
    assert arrow_rows(found) == arrow_rows(expected)
    lines = lines_of(batches_of(path, sender, data, engine, to=OutputFormat.JSONL))
    assert lines == lines_of(expected)
    assert tally_of(found) == tally_of(expected)


@EVERY_SENDER
def test_have_the_same_times_and_offsets(path: Path, sender: str) -> None:
    data = capture_of(path, sender, 12, 60)
    expected = batches_of(path, sender, data, "events", timed=True)
    found = batches_of(path, sender, data, None, timed=True)
    assert rows_of(found) == rows_of(expected)
    lines = lines_of(batches_of(path, sender, data, None, timed=True, to=OutputFormat.JSONL))
    assert lines == lines_of(expected)


@EVERY_SENDER
@pytest.mark.parametrize("engine", [None, "python"])
def test_that_begin_far_behind_the_start_count_on(
    path: Path, sender: str, engine: str | None
) -> None:
    data, start = capture_of(path, sender, 12, 60), 1 << 40
    protocol = protocol_of(path)
    make = column_decoders(tables_of(protocol, protocol.sender(sender)), engine)
    expected = rows_of(batches_of(path, sender, data, "events", timed=True))
    moved = {
        name: [(start + offset, *others) for offset, *others in rows]
        for name, rows in expected.items()
    }
    assert rows_of(fed(make(start), data, timed=True)) == moved


@pytest.mark.parametrize("sender", ["pc", "board"])
@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_hold_every_kind_of_value(tmp_path: Path, sender: str, engine: str | None) -> None:
    path = tmp_path / "sink.yaml"
    path.write_text(SINK)
    for seed in range(3):
        data = capture_of(path, sender, seed, 200)
        expected = batches_of(path, sender, data, "events", timed=True)
        found = batches_of(path, sender, data, engine, timed=True)
        assert rows_of(found) == rows_of(expected)
        assert arrow_rows(found) == arrow_rows(expected)
        lines = lines_of(
            batches_of(
                tmp_path / "sink.yaml", sender, data, engine, timed=True, to=OutputFormat.JSONL
            )
        )
        assert lines == lines_of(expected)


FLAT = """
      n: uint8,
      numbers: {type: uint16, count: 0},
      ratios: {type: float32, count: 0},
      scaled: {type: uint16, count: 0, scale: 2, unit: m},
      text: {type: ascii, size: 0},
      bytes: {type: bytes, size: 0}"""
IN_LISTS = """,
      structs: {count: 0, fields: {x: uint8, name: {type: ascii, size: 3}}},
      inner: {count: 2, fields: {x: uint8, more: {type: uint8, count: 0}}}"""


@pytest.mark.parametrize(("more", "size"), [("", 1), (IN_LISTS, 3)], ids=["flat", "in_lists"])
@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_hold_lists_that_are_always_empty(
    tmp_path: Path, engine: str | None, more: str, size: int
) -> None:
    path = tmp_path / "great.yaml"
    scaled = GREAT.index("  scaled:")
    message = f"  empty: {{id: 3, from: one, fields: {{{FLAT}{more}}}}}\n"
    path.write_text(GREAT[:scaled] + message)
    data = (b"\x5a\xa5\x03" + bytes([size]) + b"\x01\x02\x03"[:size]) * 3
    expected = batches_of(path, "one", data, "events")
    found = batches_of(path, "one", data, engine)
    assert len(rows_of(expected)["empty"]) == 3
    assert rows_of(found) == rows_of(expected)
    assert arrow_rows(found) == arrow_rows(expected)
    lines = lines_of(batches_of(path, "one", data, engine, to=OutputFormat.JSONL))
    assert lines == lines_of(expected)
    for rows in (rows for batch in found for rows in batch.rows()):
        table = pa.Table.from_batches([batch_of(rows, schema_of(rows.table, {}))])
        parquet.write_table(table, tmp_path / "rows.parquet")
        assert parquet.read_table(tmp_path / "rows.parquet").to_pylist() == table.to_pylist()


@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_hold_lists_of_structs_without_values(tmp_path: Path, engine: str | None) -> None:
    """They have as many elements as a number says, though nothing of them is in the rows."""
    path = tmp_path / "great.yaml"
    fields = """{
      n: uint8,
      which: {type: uint8, values: {a: 1, b: 2}},
      pick: {switch: which, cases: {
        a: {fields: {x: {type: uint8, const: 4}}},
        b: {fields: {inner: {fields: {y: {type: uint8, const: 5}}}}}}},
      marks: {count: n, fields: {}},
      fixed: {count: 2, fields: {}},
      sevens: {count: n, fields: {seven: {type: uint8, const: 7}, yes: {type: bool, const: true}}},
      two: {type: uint8, const: 2},
      twice: {count: two, fields: {}},
      around: {fields: {
        three: {type: uint8, const: 3},
        thrice: {count: three, fields: {}},
        deep: {count: n, fields: {n: {type: uint8, const: 1}, once: {count: n, fields: {}}}}}},
      points: {count: 2, fields: {
        k: {type: uint8, values: {a: 1, b: 2}},
        marks: {count: k, fields: {}},
        outer: {count: n, fields: {}},
        choice: {switch: k, cases: {
          a: {fields: {x: {type: uint8, const: 4}}},
          b: {fields: {y: {type: uint8, const: 5}}}}}}}}"""
    scaled = GREAT.index("  scaled:")
    path.write_text(GREAT[:scaled] + f"  marked: {{id: 3, from: one, fields: {fields}}}\n")
    data = b"".join(
        b"\x5a\xa5\x03" + bytes((len(payload), *payload))
        for n, *pick in ((2, 1, 4), (0, 2, 5), (3, 1, 4))
        for payload in [(n, *pick, *(7, 1) * n, 2, 3, *(1,) * n, 1, 4, 2, 5)]
    )
    expected = batches_of(path, "one", data, "events")
    found = batches_of(path, "one", data, engine)
    shown = [json.loads(line)["fields"] for line in lines_of(expected)]
    assert [len(it["marks"]) for it in shown] == [2, 0, 3]
    assert rows_of(found) == rows_of(expected)
    assert arrow_rows(found) == arrow_rows(expected)
    lines = lines_of(batches_of(path, "one", data, engine, to=OutputFormat.JSONL))
    assert lines == lines_of(expected)


@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_hold_switches_whose_cases_are_all_empty(tmp_path: Path, engine: str | None) -> None:
    path = tmp_path / "great.yaml"
    fields = """{
      k: {type: uint8, values: {a: 1, b: 2}},
      v: {switch: k, cases: {a: {fields: {}}, b: {fields: {}}}},
      s: {fields: {j: {type: uint8, values: {a: 1}}, w: {switch: j, cases: {a: {fields: {}}}}}}}"""
    scaled = GREAT.index("  scaled:")
    path.write_text(GREAT[:scaled] + f"  m: {{id: 3, from: one, fields: {fields}}}\n")
    data = b"\x5a\xa5\x03\x02\x01\x01" + b"\x5a\xa5\x03\x02\x02\x01"
    expected = batches_of(path, "one", data, "events")
    found = batches_of(path, "one", data, engine)
    assert len(rows_of(expected)["m"]) == 2
    assert rows_of(found) == rows_of(expected)
    lines = lines_of(batches_of(path, "one", data, engine, to=OutputFormat.JSONL))
    assert lines == lines_of(expected)


CASES_IN_LISTS = """
  m:
    id: 3
    from: one
    fields:
      n: uint8
      l:
        count: n
        fields:
          k: {type: uint8, values: {a: 1, b: 2, c: 3}}
          v:
            switch: k
            cases:
              a:
                fields:
                  text: {type: ascii, size: 2}
                  deep: {fields: {pairs: {count: 2, fields: {z: uint8, more: {type: uint8, count: 1}}}}}
              b: uint8
              c: {type: uint8, count: 2}
      fixed:
        count: 2
        fields: {k: {type: uint8, values: {a: 1}}, v: {switch: k, cases: {a: uint8}, unknown: true}}
"""  # noqa: E501


@pytest.mark.parametrize("picks", ["a", "b", "c", "abc", "bab", ""])
@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_hold_cases_in_lists_as_parquet_takes_them(
    tmp_path: Path, engine: str | None, picks: str
) -> None:
    path = tmp_path / "great.yaml"
    path.write_text(GREAT[: GREAT.index("  scaled:")] + CASES_IN_LISTS)
    cases = {"a": b"\x01hi\x01\x02\x03\x04", "b": b"\x02\x09", "c": b"\x03\x01\x02"}
    payload = bytes([len(picks)]) + b"".join(cases[pick] for pick in picks) + b"\x01\x07" * 2
    data = (b"\x5a\xa5\x03" + bytes([len(payload)]) + payload) * 2
    expected = batches_of(path, "one", data, "events")
    found = batches_of(path, "one", data, engine)
    assert len(rows_of(expected)["m"]) == 2
    assert arrow_rows(found) == arrow_rows(expected)
    for rows in (rows for batch in [*expected, *found] for rows in batch.rows()):
        table = pa.Table.from_batches([batch_of(rows, schema_of(rows.table, {}))])
        parquet.write_table(table, tmp_path / "rows.parquet")
        assert parquet.read_table(tmp_path / "rows.parquet").to_pylist() == table.to_pylist()


@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_are_chosen_by_what_is_in_front(tmp_path: Path, engine: str | None) -> None:
    """A struct's field may have the name of one around it, which chooses until then.

    Here that has another name in the table, too, because a part of the frame has its own.
    """
    path = tmp_path / "great.yaml"
    fields = """
      id: {type: uint8, values: {a: 1, b: 2}}
      count: uint8
      inner:
        fields:
          first: {switch: id, cases: {a: uint8, b: sint8}}
          id: {type: uint8, values: {a: 1, b: 2}}
          second: {switch: id, cases: {a: uint8, b: sint8}}
          list: {type: uint8, count: count}
          count: uint8
          names: {count: count, fields: {x: uint8}}
"""
    scaled = GREAT.index("  scaled:")
    path.write_text(f"{GREAT[:scaled]}  inside:\n    id: 3\n    from: one\n    fields:{fields}")
    payloads = [
        bytes((first, 2, 200, second, 201, 7, 8, 3, 4, 5, 6))
        for first in (1, 2)
        for second in (1, 2)
    ]
    data = b"".join(b"\x5a\xa5\x03" + bytes((len(it),)) + it for it in payloads)
    expected = batches_of(path, "one", data, "events")
    found = batches_of(path, "one", data, engine)
    chosen = [json.loads(line)["fields"]["inner"]["first"]["value"] for line in lines_of(expected)]
    assert chosen == [200, 200, -56, -56]
    assert rows_of(found) == rows_of(expected)
    assert arrow_rows(found) == arrow_rows(expected)
    lines = lines_of(batches_of(path, "one", data, engine, to=OutputFormat.JSONL))
    assert lines == lines_of(expected)


@pytest.mark.parametrize("engine", ENGINES, ids=str)
def test_hold_numbers_that_floats_have_not(tmp_path: Path, engine: str | None) -> None:
    path = tmp_path / "great.yaml"
    path.write_text(GREAT)
    powers = (0, 53, 63, 64)
    kinds = sorted({(1 << power) + more for power in powers for more in (-1, 0, 1)})
    payloads = [(1, struct.pack("<QB", kind, 7)) for kind in kinds if kind < 1 << 64]
    payloads += [(2, struct.pack("<d", value)) for value in (1e308, -1e308, math.inf, math.nan)]
    data = b"".join(b"\x5a\xa5" + bytes((id, len(it))) + it for id, it in payloads)
    expected = batches_of(path, "one", data, "events")
    found = batches_of(path, "one", data, engine)
    assert len(lines_of(expected)) == len(payloads)
    assert rows_of(found) == rows_of(expected)
    assert arrow_rows(found) == arrow_rows(expected)
    lines = lines_of(batches_of(path, "one", data, engine, to=OutputFormat.JSONL))
    assert lines == lines_of(expected)


class TestPhysical:
    @pytest.mark.parametrize("dtype", ["u1", "i2", "u4", "i8", "u8"])
    @pytest.mark.parametrize(
        ("scale", "offset"),
        [
            (Fraction(1, 3), Fraction(1, 7)),
            (Fraction(1, 16), Fraction(0)),
            (Fraction(-3), Fraction(5)),
            (Fraction(-3, 4), Fraction(0)),
        ],
    )
    def test_is_the_exact_value_rounded_once(
        self, dtype: str, scale: Fraction, offset: Fraction
    ) -> None:
        meaning = Physical(scale, offset, frozenset({3}), is_float=False)
        limits = np.iinfo(dtype)
        raw = [int(limits.min), int(limits.max), 0, 1, 3, 77, int(limits.max) // 3]
        found = physical(meaning, Numbers(np.array(raw, dtype))).tolist()
        due = [None if it == 3 else float(it * scale + offset) for it in raw]
        assert repr(found) == repr(due)  # 0.0 equals -0.0.

    def test_of_lists_has_gaps(self) -> None:
        meaning = Physical(Fraction(1), Fraction(0), frozenset({0}), is_float=False)
        raw = Lists(np.array([[1, 0, 3], [0, 5, 6]], "u2"), np.array([3, 2]))
        found = physical(meaning, raw)
        assert found.tolist() == [[1, None, 3], [None, 5]]
        type = Listed(Scalar("uint16"), None)
        assert array_of(type, found).to_pylist() == [[1, None, 3], [None, 5]]
        whole = Lists(raw.values, None, found.missing)
        assert array_of(type, whole).to_pylist() == [[1, None, 3], [None, 5, 6]]
        assert array_of(Listed(Scalar("uint16"), 3), whole).to_pylist() == whole.tolist()
        assert FLOAT64.kind == "float64"


@pytest.mark.parametrize("dtype", ["u1", "i1", "u2", "i2", "u4", "i8"])
def test_names_are_found(dtype: str) -> None:
    finder = NameFinder(Naming({0: "off", 5: "on", 127: "high", 300: "far", -2: "below"}))
    limits = np.iinfo(dtype)
    raw = [value for value in (0, 1, 5, 127, 300, -2) if limits.min <= value <= limits.max]
    found = finder.find(Numbers(np.array(raw, dtype))).tolist()
    names = {0: "off", 5: "on", 127: "high", 300: "far", -2: "below"}
    assert found == [names.get(value) for value in raw]


def test_what_is_missing_has_members_that_parquet_takes() -> None:
    pa = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    values = Scattered(Structs({"a": Numbers(np.arange(2, dtype="u2"))}, 2), np.array([0, -1, 1]))
    found = values.to_arrow(Record((("a", Scalar("uint16")),), gaps=False))
    assert found.to_pylist() == [{"a": 0}, None, {"a": 1}]
    assert found.field(0).null_count == 0
    lists = pa.FixedSizeListArray.from_arrays(found, 3)
    parquet.write_table(pa.table({"lists": lists}), io.BytesIO())
