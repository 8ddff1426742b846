"""Rows printed by C: numbers as Python spells them, and the same lines as those of events."""

from __future__ import annotations

import csv
import io
import json
import struct
import tracemalloc
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import pytest
from compiled import ROOT, module_at, name_of, protocol_of, senders
from test_convert_columns import batches_of, lines_of
from test_json_lines import capture_of
from tooling import require_tool

np = pytest.importorskip("numpy")

from protogen.convert.arrays import Lists, Numbers  # noqa: E402
from protogen.convert.batches import Rows, Tally  # noqa: E402
from protogen.convert.composed import ListsOf, Structs  # noqa: E402
from protogen.convert.csv_writer import CsvWriter  # noqa: E402
from protogen.convert.outputs import Pending  # noqa: E402
from protogen.convert.printed_csv import CsvPrinter, json_texts  # noqa: E402
from protogen.convert.programs import PLAIN, QUOTED, Programs, operand  # noqa: E402
from protogen.convert.tables import TEXT, tables_of  # noqa: E402
from protogen.convert.writers import write_all  # noqa: E402
from protogen.native.printer import CODES, Kind, Printer, Table, _function  # noqa: E402
from protogen.runtime.assembly import encode_frame  # noqa: E402

SAMPLERS = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))
SENDERS = [(path, it.name) for path in SAMPLERS for it in protocol_of(path).senders]


@pytest.fixture(scope="module", autouse=True)
def _has_compiler() -> None:
    require_tool("cc")


def printed(columns: list[Any], programs: Programs) -> str:
    offsets = np.arange(len(columns[0]), dtype="u8")
    table = Table([offsets, *columns], 0, len(offsets))
    return b"".join(Printer(programs.script()).texts([table])).decode()


def numbers(values: Any) -> list[str]:
    code = "?" if values.dtype == bool else values.dtype.str[1:]
    programs = Programs()
    programs.number(operand(code, source=1), code, QUOTED)
    programs.text("\n")
    programs.end()
    return printed([values], programs).splitlines()


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

    @pytest.mark.parametrize("code", CODES[:8])
    def test_of_integers_reach_the_limits(self, code: str) -> None:
        limits = np.iinfo(code)
        least, most = int(limits.min), int(limits.max)
        every = {least, least + 1, 0, 1, 9, 10, 99, 100, most - 1, most}
        every |= {10**power + more for power in range(20) for more in (-1, 0)}
        values = sorted(value for value in every if least <= value <= most)
        assert numbers(np.array(values, code)) == [str(value) for value in values]

    def test_of_bools_are_words(self) -> None:
        assert numbers(np.array([True, False])) == ["true", "false"]


class TestTexts:
    def test_are_as_long_as_they_are(self) -> None:
        programs = Programs()
        programs.step(Kind.STRING, b=4, c=PLAIN, x=operand("u1", source=1))
        programs.text("|")
        programs.end()
        assert printed([np.array([b"ab", b"", b"a\0b", b"\xe9"], "S4")], programs) == "ab||a\0b|é|"

    def test_may_be_longer_than_the_room(self) -> None:
        programs = Programs()
        programs.step(Kind.SPAN, 2, x=operand("u8", source=1), y=operand("u8", source=1, offset=8))
        programs.end()
        line = bytes(range(256)) * 8000
        spans = np.array([[0, 2], [1, len(line) - 1]], "u8")
        assert printed([spans, line], programs) == "0001" + line[1:].hex()

    def test_are_chosen_by_number(self) -> None:
        programs = Programs()
        programs.name(operand("i2", source=1), ("a", "bc"))
        programs.text(";")
        programs.end()
        assert printed([np.array([1, -1, 0, 2], "i2")], programs) == "bc;;a;;"


@pytest.mark.parametrize(("path", "sender"), SENDERS, ids=name_of)
@pytest.mark.parametrize("timed", [False, True])
def test_lines_are_those_of_events(path: Path, sender: str, timed: bool) -> None:
    for seed in range(3):
        data = capture_of(path, sender, seed, 150)
        expected = batches_of(path, sender, data, "events", 1 << 40, timed)
        assert lines_of(batches_of(path, sender, data, None, 1 << 40, timed)) == lines_of(expected)


@pytest.mark.parametrize("bits", ["7fc00000", "ffc00000", "7fc00001", "7f800001", "7f800000"])
def test_a_nan_that_json_does_not_tell_has_its_bytes(bits: str) -> None:
    path = SAMPLERS[0]
    spec = module_at(path).PROTOCOL.sender("one")
    message = spec.named("floats")
    assert message is not None
    payload = bytes.fromhex(bits) + bytes(protocol_of(path).message("floats").sizes.greatest - 4)
    data = encode_frame(spec, message.IDENTITY, payload, {}, strict=False)
    (line,) = lines_of(batches_of(path, "one", data, None))
    assert lines_of(batches_of(path, "one", data, "events")) == [line]
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
        lines = lines_of(batches_of(path, "station", data, "events"))
        assert lines_of(batches_of(path, "station", data, None)) == lines
    plain = lines_of(batches_of(path, "station", b"".join(frames), None))
    assert sum(b'"unknown"' in line for line in plain) > 200
    assert not any(b'"raw"' in line for line in plain)


def csv_files(batches: list[Any], folder: Path) -> dict[str, bytes]:
    writer = CsvWriter("run", pending := Pending(folder))
    write_all(writer, batches, Tally())
    pending.commit()
    return {path.parent.name: path.read_bytes() for path in folder.glob("*/*.csv")}


@pytest.mark.parametrize(("path", "sender"), [*senders(), *SENDERS], ids=name_of)
def test_csv_is_that_of_events(path: Path, sender: str, tmp_path: Path) -> None:
    data = capture_of(path, sender, 4, 150)
    each = [
        csv_files(batches_of(path, sender, data, engine, 7, timed), tmp_path / f"{engine} {timed}")
        for engine in ("events", None)
        for timed in (False, True)
    ]
    assert each[:2] == each[2:]


def test_csv_puts_in_quotes_what_csv_does(tmp_path: Path) -> None:
    texts = ['"', "a,b", "", "\r", "\n", " x ", "é", 'say ""', "'", "a;b"]
    table = tables_of(protocol_of(SENDERS[0][0]), protocol_of(SENDERS[0][0]).sender("one")).unknown
    column = replace(table.columns[0], type=TEXT)
    offsets = Numbers(np.arange(len(texts), dtype="u8"))
    rows = Rows(replace(table, frame_columns=table.frame_columns[:1], columns=(column,)), [])
    expected = io.StringIO(newline="")
    csv.writer(expected, lineterminator="\n").writerows(enumerate(texts))
    printer = CsvPrinter(lambda column, values: values)
    found = b"".join(printer.lines(replace(rows, columns=[offsets, texts])))
    assert found.decode() == expected.getvalue()


@pytest.mark.parametrize("code", ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8"])
def test_integers_of_any_length_are_those_of_python(code: str) -> None:
    limits = np.iinfo(code)
    around = [10**power + more for power in range(20) for more in (-1, 0, 1)]
    values = [sign * value for value in [*around, 1 << 31, 1 << 32, 1 << 63] for sign in (-1, 1)]
    fitting = [value for value in values if limits.min <= value <= limits.max]
    rows = np.array([*fitting, limits.min, limits.max], code)
    programs = Programs()
    programs.number(operand(code, source=1), code)
    programs.text("\n")
    programs.end()
    assert printed([rows], programs).splitlines() == [str(it) for it in rows.tolist()]


@pytest.mark.parametrize("counts", [[0, 0], [2, 0], [1, 2]])
def test_lists_in_lists_may_all_be_empty(counts: list[int]) -> None:
    """Then there is no struct that has the inner ones."""
    inside = np.arange(sum(counts)) % 2
    innermost = Structs({"y": Numbers(np.arange(sum(inside)))}, sum(inside))
    inner = Structs({"x": ListsOf(innermost, inside)}, sum(counts))
    lists = ListsOf(inner, np.array(counts))
    assert json_texts(lists, str) == [json.dumps(value) for value in lists.tolist()]


def nested_values(dice: Random, rows: int, deep: int) -> Any:
    """Numbers, lists and structs of them, and now and then a text, which lists hold no more of."""
    kind = dice.choice(["number", "list", "struct", "lists"] if deep else ["number", "list"])
    if kind == "struct":
        names = dice.sample(["x", "naïve", 'a "b"', "y%", "z"], dice.randrange(1, 4))
        return Structs({name: nested_values(dice, rows, deep - 1) for name in names}, rows)
    if kind == "lists":
        counts = np.array([dice.randrange(4) for _ in range(rows)], "i4")
        return ListsOf(nested_values(dice, int(counts.sum()), deep - 1), counts)
    if dice.random() < 0.05:
        return [dice.choice(["", '"', "é"]) for _ in range(rows)]
    code = dice.choice(["u1", "i2", "u8", "?", "f4", "f8"])
    size = np.dtype(code).itemsize
    many = 3 if kind == "list" else 1
    data = np.frombuffer(dice.randbytes(rows * many * size), "u1" if code == "?" else code)
    matrix = (data % 2 == 1 if code == "?" else data).reshape(rows, many)
    if kind == "number":
        return Numbers(matrix[:, 0].copy())
    counts = np.array([dice.randrange(many + 1) for _ in range(rows)], "i4")
    return Lists(matrix, dice.choice([counts, None]))


def csv_of_lists(values: ListsOf) -> tuple[str, str, int]:
    """Lines that C printed, those of Python, and how many columns C knew nothing of."""
    table = tables_of(protocol_of(SENDERS[0][0]), protocol_of(SENDERS[0][0]).senders[0]).invalid
    table = replace(table, frame_columns=table.frame_columns[:1], columns=table.columns[-1:])
    asked = []

    def show(column: Any, shown: Any) -> list[str]:
        asked.append(column)
        return json_texts(shown, str)

    printer = CsvPrinter(show)
    rows = Rows(table, [Numbers(np.arange(len(values), dtype="u8")), values])
    found = b"".join(printer.lines(rows)).decode()
    expected = io.StringIO(newline="")
    texts = map(json.dumps, values.tolist())
    csv.writer(expected, lineterminator="\n").writerows(enumerate(texts))
    return found, expected.getvalue(), len(asked)


def test_lists_of_anything_are_those_of_python() -> None:
    known = 0
    for seed in range(150):
        dice = Random(seed)
        counts = np.array([dice.randrange(5) for _ in range(dice.randrange(1, 40))], "i4")
        inside = nested_values(dice, int(counts.sum()), 3)
        found, expected, asked = csv_of_lists(ListsOf(inside, counts))
        assert found == expected, seed
        known += not asked
    assert known > 100


def test_lists_that_are_long_and_short_by_turns_take_no_room() -> None:
    counts = np.zeros(5000, "i4")
    counts[7] = 300
    found, expected, asked = csv_of_lists(ListsOf(Numbers(np.arange(300)), counts))
    assert found == expected
    assert asked == 1


def test_lists_in_lists_of_any_length_take_little_memory() -> None:
    """Each may need many times the room of what it holds, and those inside of it as well."""
    values: Any = Numbers(np.arange(100_000, dtype="u8"))
    for _ in range(3):
        counts = np.ones(len(values), "i4")
        counts[::14] = 256
        counts = counts[: np.searchsorted(np.cumsum(counts), len(values)) + 1]
        counts[-1] -= counts.sum() - len(values)
        values = ListsOf(values, counts)
    tracemalloc.start()
    try:
        found, expected, asked = csv_of_lists(values)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert found == expected
    assert asked == 1
    assert most < 150_000_000


def test_lists_in_lists_are_printed_as_deep_as_there_is_room() -> None:
    for deep, is_printed in ((9, True), (10, False)):
        values: Any = Numbers(np.arange(1))
        for _ in range(deep):
            values = ListsOf(values, np.ones(1, "i4"))
        found, expected, asked = csv_of_lists(values)
        assert found == expected == f"0,{'[' * deep}0{']' * deep}\n"
        assert bool(asked) != is_printed


def test_without_a_compiler_csv_is_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, sender = SENDERS[0]
    batches = batches_of(path, sender, capture_of(path, sender, 1, 100), None)
    expected = csv_files(batches, tmp_path / "one")
    monkeypatch.setenv("CC", "no-such-cc")
    _function.cache_clear()
    assert csv_files(batches, tmp_path / "other") == expected


def test_without_a_compiler_lines_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    path, sender = SENDERS[0]
    data = capture_of(path, sender, 1, 100)
    expected = lines_of(batches_of(path, sender, data, None))
    monkeypatch.setenv("CC", "no-such-cc")
    _function.cache_clear()
    with pytest.warns(UserWarning, match="columns are filled from Python's events"):
        assert lines_of(batches_of(path, sender, data, None)) == expected
