"""Rows printed by C: numbers as Python spells them, and the same lines as those of events."""

from __future__ import annotations

import csv
import io
import json
import struct
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import pytest
from compiled import ROOT, module_at, name_of, protocol_of, senders
from test_convert_columns import GREAT, batches_of
from test_convert_columns import lines_of as lines_in
from test_json_lines import capture_of
from tooling import require_tool

np = pytest.importorskip("numpy")

from protogen.convert.columns.batches import Tally  # noqa: E402
from protogen.convert.columns.csv_text import quoted_characters  # noqa: E402
from protogen.convert.columns.decoders import _PRINTERS  # noqa: E402
from protogen.convert.columns.tables import tables_of  # noqa: E402
from protogen.convert.formats import OutputFormat  # noqa: E402
from protogen.convert.writers.csv_writer import CsvWriter  # noqa: E402
from protogen.convert.writers.format_writers import open_writer, write_all  # noqa: E402
from protogen.convert.writers.pending_files import Pending  # noqa: E402
from protogen.native.print_steps import (  # noqa: E402
    IN_CELLS,
    IN_LINES,
    Place,
    Source,
    Spelling,
    Step,
    UnprintableError,
    characters,
    hex_of,
    literal,
    named,
    number,
    physical,
    quoted,
)
from protogen.native.printer import PrintedRows, Printer, build_printer  # noqa: E402
from protogen.runtime.framing.assembly import encode_frame  # noqa: E402

SAMPLERS = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))
SENDERS = [(path, it.name) for path in SAMPLERS for it in protocol_of(path).senders]
CODES = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8")


@pytest.fixture(scope="module", autouse=True)
def _has_compiler() -> None:
    require_tool("cc")


def printed(values: Any, *steps: Step, line: bytes = b"") -> list[str]:
    """Each value as these steps print it; it lies at offset 8 of its row."""
    rows = np.zeros(len(values), [("offset", "u8"), ("value", values.dtype, values.shape[1:])])
    rows["offset"] = np.arange(len(values))
    rows["value"] = values
    built = build_printer("test", [[*steps, literal("\0")]], quoted_characters())
    texts = Printer(built).texts([PrintedRows(0, rows)], line)
    return b"".join(texts).decode().split("\0")[:-1]


def place_of(values: Any) -> Place:
    return Place(0, "?" if values.dtype == bool else values.dtype.str[1:], 8)


def numbers(values: Any) -> list[str]:
    return printed(values, number(place_of(values), IN_LINES))


class TestNumbers:
    def test_of_floats_are_the_shortest(self) -> None:
        dice = Random(5)
        values = [0.0, -0.0, 1e-4, 9.999e-5, 1e15, 1e16, 123456789012345.0, 5e-324, 1.7e308, 0.1]
        values += [999999999999999.9, 2.0**53, 1e22, 100.0, -2880 / 16, 1 / 3, 4503599627370497.5]
        for _ in range(3000):
            digits = dice.randrange(17)
            values.append(dice.randrange(-(10**digits), 10**digits + 1) / 10 ** dice.randrange(18))
            values.append(dice.randrange(1 << 20) / (1 << dice.randrange(24)))
            values.append(dice.uniform(-1, 1) * 10.0 ** dice.randrange(-6, 18))
            (anything,) = struct.unpack("<d", dice.randbytes(8))
            values += [anything] if anything - anything == 0 else []
        assert numbers(np.array(values)) == [repr(value) for value in values]

    def test_of_short_floats_are_those_of_long_ones(self) -> None:
        values = np.array([0.1, 16777216.0, 1e-45, 3.4e38, -0.5], "f4")
        assert numbers(values) == [repr(value) for value in values.tolist()]

    def test_that_are_not_finite_are_texts(self) -> None:
        found = numbers(np.array([float("nan"), float("inf"), -float("inf")]))
        assert found == ['"nan"', '"inf"', '"-inf"']

    @pytest.mark.parametrize("code", CODES)
    def test_of_integers_are_those_of_python(self, code: str) -> None:
        limits = np.iinfo(code)
        least, most = int(limits.min), int(limits.max)
        every = {least, least + 1, 0, 1, 9, most - 1, most, 1 << 31, 1 << 32, 1 << 63}
        every |= {10**power + more for power in range(20) for more in (-1, 0, 1)}
        every |= {-value for value in every}
        values = sorted(value for value in every if least <= value <= most)
        assert numbers(np.array(values, code)) == [str(value) for value in values]

    def test_of_bools_are_words(self) -> None:
        assert numbers(np.array([True, False])) == ["true", "false"]


class TestPhysicalValues:
    @pytest.mark.parametrize("code", CODES)
    @pytest.mark.parametrize(
        ("scale", "offset"),
        [
            (Fraction(1, 3), Fraction(1, 7)),
            (Fraction(1, 16), Fraction(0)),
            (Fraction(-3), Fraction(5)),
            (Fraction(-3, 4), Fraction(0)),
            (Fraction(1, 10**9), Fraction(-27315, 100)),
            (Fraction(10**12 + 1, 7), Fraction(-1, 10**6)),
        ],
    )
    def test_are_exact_and_rounded_once(self, code: str, scale: Fraction, offset: Fraction) -> None:
        dice = Random(f"{code} {scale}")
        limits = np.iinfo(code)
        least, most = int(limits.min), int(limits.max)
        values = [least, most, 0, 1, 3, 77, most // 3]
        values += [dice.randint(least, most) >> dice.randrange(64) for _ in range(500)]
        raw = np.array([value for value in values if least <= value <= most], code)
        found = printed(raw, physical(place_of(raw), scale, offset, [3, 77], "", IN_CELLS))
        due = [float(it * scale + offset) for it in raw.tolist()]
        missing = [it in (3, 77) for it in raw.tolist()]
        pairs = zip(due, missing, strict=True)
        assert found == ["" if none else repr(value) for value, none in pairs]

    @pytest.mark.parametrize("code", ["f4", "f8"])
    def test_of_floats_are_rounded_twice_as_in_python(self, code: str) -> None:
        dice = Random(code)
        scale, offset = Fraction(1, 3), Fraction(1, 7)
        raw = np.array([0.0, 1e30, 3.0, *(dice.uniform(-9, 9) for _ in range(500))], code)
        found = printed(raw, physical(place_of(raw), scale, offset, [3], "none", IN_CELLS))
        due = ["none" if it == 3 else repr(it * scale + offset) for it in raw.tolist()]
        assert found == due

    def test_are_left_to_python_where_c_has_no_such_numbers(self) -> None:
        with pytest.raises(UnprintableError):
            physical(Place(0, "u8", 8), Fraction(1 << 64, 3), Fraction(0), [], "", IN_CELLS)


class TestTexts:
    def test_are_as_long_as_they_are(self) -> None:
        values = np.array([b"ab", b"", b"a\1b", b"\xe9"], "S4")
        step = characters(Place(0, "u1", 8), 4, None, Spelling.PLAIN)
        assert printed(values, step) == ["ab", "", "a\1b", "é"]

    def test_hold_and_end_with_nul_where_they_have_a_length(self) -> None:
        values = np.array([b"ab", b"", b"a\0b"], "S4")
        step = characters(Place(0, "u1", 8), 4, 3, Spelling.JSON)
        assert printed(values, step) == ["ab\\u0000", 3 * "\\u0000", "a\\u0000b"]

    @pytest.mark.parametrize("spelling", [Spelling.JSON, Spelling.JSON_ASCII])
    def test_have_every_character_as_json_does(self, spelling: Spelling) -> None:
        values = np.arange(256, dtype="u1").reshape(256, 1)
        is_ascii = spelling is Spelling.JSON_ASCII
        due = [json.dumps(chr(code), ensure_ascii=is_ascii)[1:-1] for code in range(256)]
        assert printed(values, characters(Place(0, "u1", 8), 1, 1, spelling)) == due

    def test_may_be_longer_than_the_room(self) -> None:
        line = bytes(range(256)) * 8000
        spans = np.array([[0, 2], [1, len(line) - 1]], "u8")
        step = hex_of(Source.LINE, Place(0, "u8", 8), Place(0, "u8", 16))
        assert "".join(printed(spans, step, line=line)) == "0001" + line[1:].hex()

    def test_are_chosen_by_number(self) -> None:
        values = np.array([1, -1, 0, 2, -3], "i2")
        assert printed(values, named(place_of(values), {0: "a", 1: "b?", -3: "c"})) == [
            "b?", "", "a", "", "c",
        ]  # fmt: skip

    def test_are_in_quotes_where_csv_puts_them(self) -> None:
        texts = ['"', "a,b", "", "\r", "\n", " x ", "é", 'say ""', "'", "a;b"]
        values = np.array([text.encode("latin-1") for text in texts], "S8")
        found = printed(values, quoted([characters(Place(0, "u1", 8), 8, None, Spelling.PLAIN)]))
        assert found == [csv_cell(text) for text in texts]


def csv_cell(text: str) -> str:
    file = io.StringIO(newline="")
    csv.writer(file, lineterminator="\n").writerow([text, ""])
    return file.getvalue().removesuffix(",\n")


# --- lines ----------------------------------------------------------------------------------------


def lines_of(path: Path, sender: str, data: bytes, engine: str | None, *how: Any) -> list[bytes]:
    return lines_in(batches_of(path, sender, data, engine, *how, to=OutputFormat.JSONL))


@pytest.mark.parametrize(("path", "sender"), SENDERS, ids=name_of)
@pytest.mark.parametrize("timed", [False, True])
def test_lines_are_those_of_events(path: Path, sender: str, timed: bool) -> None:
    for seed in range(3):
        data = capture_of(path, sender, seed, 150)
        expected = lines_of(path, sender, data, "events", timed)
        assert lines_of(path, sender, data, None, timed) == expected


@pytest.mark.parametrize("bits", ["7fc00000", "ffc00000", "7fc00001", "7f800001", "7f800000"])
def test_a_nan_that_json_does_not_tell_has_its_bytes(bits: str) -> None:
    path = ROOT / "tests" / "c_schemas" / "elements.yaml"
    spec = module_at(path).PROTOCOL.sender("one")
    message = spec.named("floats")
    assert message is not None
    payload = bytes.fromhex(bits) + bytes(protocol_of(path).message("floats").sizes.greatest - 4)
    data = encode_frame(spec, message.IDENTITY, payload, {}, strict=False)
    (line,) = lines_of(path, "one", data, None)
    assert lines_of(path, "one", data, "events") == [line]
    assert (b'"raw"' in line) == (bits not in ("7fc00000", "7f800000"))


@pytest.mark.parametrize("name", ["hdlc", "hdlc_lenient", "slip", "slip_end_only"])
def test_unknown_frames_have_their_bytes_where_an_encoder_makes_others(name: str) -> None:
    path = ROOT / "tests" / "framings" / f"{name}.yaml"
    spec = module_at(path).PROTOCOL.sender("station")
    dice = Random(name)
    known = {message.IDENTITY for message in spec.messages}
    frames = [
        encode_frame(spec, (number,), dice.randbytes(dice.randrange(12)), {}, strict=False)
        for number in range(256)
        if (number,) not in known
    ]
    escaped = [frame[:2] + bytes([0x7D, frame[2] ^ 0x20]) + frame[3:] for frame in frames]
    for data in (
        b"".join(frames),
        frames[0] + b"".join(frame[1:] for frame in frames[1:]),
        b"".join(escaped),
        b"".join(2 * frame[:1] + frame[1:] + frame[-1:] for frame in frames),
    ):
        expected = lines_of(path, "station", data, "events")
        assert lines_of(path, "station", data, None) == expected
    plain = lines_of(path, "station", b"".join(frames), None)
    assert sum(b'"unknown"' in line for line in plain) > 200
    assert not any(b'"raw"' in line for line in plain)


# --- CSV ------------------------------------------------------------------------------------------


def csv_files(
    folder: Path, path: Path, sender: str, data: bytes, engine: str | None, *how: Any
) -> dict[str, bytes]:
    writer = CsvWriter("run", pending := Pending(folder))
    batches = batches_of(path, sender, data, engine, *how, to=OutputFormat.CSV)
    write_all(writer, batches, Tally())
    pending.commit()
    return {path.parent.name: path.read_bytes() for path in folder.glob("*/*.csv")}


@pytest.mark.parametrize(("path", "sender"), [*senders(), *SENDERS], ids=name_of)
def test_csv_is_that_of_events(path: Path, sender: str, tmp_path: Path) -> None:
    data = capture_of(path, sender, 4, 150)
    each = [
        csv_files(tmp_path / f"{engine} {timed}", path, sender, data, engine, timed)
        for engine in ("events", None)
        for timed in (False, True)
    ]
    assert each[:2] == each[2:]


# --- MCAP -----------------------------------------------------------------------------------------


def mcap_messages(
    folder: Path, path: Path, sender: str, data: bytes, engine: str | None, *how: Any
) -> list[Any]:
    reading = pytest.importorskip("mcap.reader")
    protocol = protocol_of(path)
    tables = tables_of(protocol, protocol.sender(sender))
    writer = open_writer(OutputFormat.MCAP, "run", pending := Pending(folder), tables)
    batches = batches_of(path, sender, data, engine, *how, to=OutputFormat.MCAP)
    write_all(writer, batches, Tally())
    pending.commit()
    with (folder / "run.mcap").open("rb") as file:
        reader = reading.make_reader(file, validate_crcs=True)
        found = list(reader.iter_messages(log_time_order=False))
        statistics = reader.get_summary().statistics
        assert statistics.message_count == len(found)
        if found:
            assert statistics.message_start_time == min(it.log_time for _, _, it in found)
            ordered = [it.log_time for _, _, it in reader.iter_messages()]
            assert ordered == sorted(it.log_time for _, _, it in found)
        return found


@pytest.mark.parametrize(("path", "sender"), [*senders(), *SENDERS], ids=name_of)
def test_messages_of_mcap_are_those_of_events(path: Path, sender: str, tmp_path: Path) -> None:
    data = capture_of(path, sender, 4, 150)
    each = [
        mcap_messages(tmp_path / f"{engine} {timed}", path, sender, data, engine, timed)
        for engine in ("events", None)
        for timed in (False, True)
    ]
    assert each[:2] == each[2:]


SCALED = """
      a: {type: uint64, scale: 1/3, offset: 5, unit: m}
      b: {type: sint64, scale: 1e-9, unit: s, special: {absent: 0}}
      c: {type: uint32, scale: 1/1000, offset: -273.15, unit: degC, special: {absent: 0xFFFFFFFF}}
      d: {type: float32, scale: 16, offset: 0.1, unit: m}
      e: {type: uint16, count: 5, scale: -1/7, offset: 0.3, unit: m, special: {absent: 0}}
      f: {type: uint64, count: 3, scale: 3/7, unit: m}
      g: {type: uint8, unit: m, special: {absent: 0, far: 255}}
      h: {type: sint8, values: {minus: -1, zero: 0, one: 1}}
      n: uint8
      t: {type: ascii, size: n}
"""
GREATER = "      q: {type: uint64, scale: 123456789012345678901/7, unit: m}\n"


@pytest.mark.parametrize("more", ["", GREATER], ids=["in_c", "in_python"])
def test_csv_has_the_same_physical_values(tmp_path: Path, more: str) -> None:
    path = tmp_path / "great.yaml"
    message = f"  scaled:\n    id: 3\n    from: one\n    fields:{SCALED}{more}"
    path.write_text(GREAT[: GREAT.index("  scaled:")] + message)
    data = capture_of(path, "one", 4, 200)
    expected = csv_files(tmp_path / "events", path, "one", data, "events")
    assert expected["scaled"].count(b"\n") > 20
    assert csv_files(tmp_path / "native", path, "one", data, None) == expected
    messages = mcap_messages(tmp_path / "messages", path, "one", data, "events")
    assert mcap_messages(tmp_path / "printed", path, "one", data, None) == messages


FLOATS = """
      one: {type: float32, scale: 1e30, unit: m}
      many: {type: float64, count: 2}
      n: {type: uint8, range: [1, 2]}
      pairs:
        count: 2
        fields:
          kind: {type: uint8, values: {real: 1, whole: 2}}
          first: float32
          of: {switch: kind, cases: {real: float32, whole: uint16}}
      of:
        switch: n
        cases: {1: float32, 2: {fields: {inner: float64, text: {type: ascii, size: 2}}}}
"""


def test_messages_of_mcap_leave_out_what_is_no_number(tmp_path: Path) -> None:
    path = tmp_path / "great.yaml"
    message = f"  scaled:\n    id: 3\n    from: one\n    fields:{FLOATS}"
    path.write_text(GREAT[: GREAT.index("  scaled:")] + message)
    spec = module_at(path).PROTOCOL.sender("one")
    frames = b""
    for odd in (float("nan"), float("inf"), -0.0, 1e10):
        front = struct.pack("<f2d", odd, odd, 1.0)
        pairs = struct.pack("<BffBfH", 1, odd, odd, 2, 1.5, 7)
        for last in (struct.pack("<f", odd), struct.pack("<d2s", odd, b"a")):
            number = bytes([1 if len(last) == 4 else 2])
            payload = front + number + pairs + last
            frames += encode_frame(spec, (3,), payload, {}, strict=False)
    found = mcap_messages(tmp_path / "messages", path, "one", frames, "events")
    assert mcap_messages(tmp_path / "printed", path, "one", frames, None) == found
    rows = [json.loads(message.data) for _, _, message in found]
    assert rows[0]["pairs"] == [
        {"kind": 1, "of": {"real": {}}},
        {"kind": 2, "first": 1.5, "of": {"whole": {"value": 7}}},
    ]
    assert rows[0]["many"] == [None, 1.0]
    assert rows[0].keys() == {"offset", "size", "many", "n", "pairs"}
    assert rows[1].keys() - rows[0].keys() == {"of.case_2.text"}
    assert rows[7]["one_m"] > 9e39


@pytest.mark.parametrize("to", [OutputFormat.JSONL, OutputFormat.CSV])
def test_without_a_compiler_text_is_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, to: OutputFormat
) -> None:
    path, sender = SENDERS[0]
    data = capture_of(path, sender, 1, 100)

    def text(folder: Path) -> Any:
        if to is OutputFormat.JSONL:
            return lines_of(path, sender, data, None)
        return csv_files(folder, path, sender, data, None)

    expected = text(tmp_path / "one")
    monkeypatch.setenv("CC", f"no-such-{to.value}")
    _PRINTERS.clear()
    with pytest.warns(UserWarning, match="columns are filled from Python's events"):
        assert text(tmp_path / "other") == expected
