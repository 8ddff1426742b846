"""Parquet files: how numbers are spelled in them, and tables that go on in another file."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

import pytest
from cli_support import SINK, run
from test_convert_columns import batches_of
from test_json_lines import capture_of

np = pytest.importorskip("numpy")
pa = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

from protogen.convert.columns.arrow_tables import batch_of, schema_of  # noqa: E402
from protogen.convert.writers import arrow_writers  # noqa: E402
from protogen.convert.writers.parquet_encodings import spelling_of  # noqa: E402
from protogen.convert.writers.pending_files import Pending, continuation, sweep  # noqa: E402

COUNT = 5000
DICE = Random(3)
WALK = np.cumsum([DICE.randint(-3, 3) for _ in range(COUNT)])
NOISE = np.frombuffer(DICE.randbytes(8 * COUNT), "u8")
COLUMNS: dict[str, tuple[Any, str, str]] = {
    "walk": (WALK.astype("i2"), "DELTA_BINARY_PACKED", "SNAPPY"),
    "byte": (NOISE.astype("u1"), "DELTA_BINARY_PACKED", "SNAPPY"),
    "offset": (np.arange(COUNT, dtype="u8") * 9, "DELTA_BINARY_PACKED", "SNAPPY"),
    "far": (np.where(NOISE & 1, 0, 1 << 62).astype("u8"), "PLAIN", "SNAPPY"),
    "noise2": (NOISE.astype("u2"), "PLAIN", "UNCOMPRESSED"),
    "noise8": (NOISE, "PLAIN", "UNCOMPRESSED"),
    "same": (np.full(COUNT, 7, "u4"), "PLAIN", "SNAPPY"),
    "smooth": (WALK / 10, "PLAIN", "SNAPPY"),
    "rough": (np.sqrt(NOISE), "PLAIN", "UNCOMPRESSED"),
    "few": (pa.array([3] + [None] * (COUNT - 1), "u2"), "PLAIN", "SNAPPY"),
    "none": (pa.nulls(COUNT, pa.int64()), "PLAIN", "SNAPPY"),
    "text": (["a"] * COUNT, "PLAIN", "SNAPPY"),
}


def written(rows: Any, path: Path) -> dict[str, tuple[str, str]]:
    """Encoding and compression of each column of a file, as the file says."""
    spelling = spelling_of(rows)
    parquet.write_table(
        rows,
        path,
        use_dictionary=False,
        compression=spelling.compression,
        column_encoding=spelling.encodings or None,
    )
    assert parquet.read_table(path).equals(rows)
    group = parquet.ParquetFile(path).metadata.row_group(0)
    columns = [group.column(number) for number in range(group.num_columns)]
    return {
        column.path_in_schema: (
            next(name for name in column.encodings if name != "RLE"),
            column.compression,
        )
        for column in columns
    }


@pytest.mark.parametrize("name", list(COLUMNS))
def test_numbers_are_spelled_as_they_are_shortest(name: str, tmp_path: Path) -> None:
    values, *expected = COLUMNS[name]
    found = written(pa.table({name: values}), tmp_path / "x.parquet")
    assert found == {name: tuple(expected)}


def test_numbers_in_lists_of_structs_have_spellings_of_their_own(tmp_path: Path) -> None:
    points = pa.StructArray.from_arrays(
        [pa.array(WALK.astype("i2")), pa.array(NOISE.astype("u2"))], ["near", "far"]
    )
    ends = pa.array(np.arange(0, COUNT + 1, 10, dtype="i4"))
    rows = pa.table(
        {
            "points": pa.ListArray.from_arrays(ends, points),
            "walks": pa.FixedSizeListArray.from_arrays(pa.array(WALK), 10),
        }
    )
    found = written(rows, tmp_path / "x.parquet")
    assert found == {
        "points.list.element.near": ("DELTA_BINARY_PACKED", "SNAPPY"),
        "points.list.element.far": ("PLAIN", "UNCOMPRESSED"),
        "walks.list.element": ("DELTA_BINARY_PACKED", "SNAPPY"),
    }


@pytest.fixture(scope="module")
def capture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A capture beside its schema."""
    folder = tmp_path_factory.mktemp("parts")
    (folder / "sink.yaml").write_text(SINK)
    (folder / "run.bin").write_bytes(capture_of(folder / "sink.yaml", "pc", 5, 300) * 800)
    return folder / "run.bin"


def convert(capture: Path, folder: Path) -> None:
    arguments = [str(capture.with_name("sink.yaml")), str(capture), "--sender", "pc"]
    done = run("convert", *arguments, "--to", "parquet", "-o", str(folder))
    assert done.exit_code == 0, done.output


def test_a_table_with_many_groups_goes_on_in_another_file(
    capture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    convert(capture, tmp_path / "whole")
    monkeypatch.setattr(arrow_writers, "_MOST_ROWS", 100)
    monkeypatch.setattr(arrow_writers, "_MOST_PIECES", 20)
    convert(capture, tmp_path / "parts")
    assert (tmp_path / "parts" / "numbers" / "run.part-0001.parquet").exists()
    for table in (tmp_path / "whole").iterdir():
        if table.is_dir():
            files = [
                tmp_path / "parts" / continuation(f"{table.name}/run.parquet", number)
                for number in range(len(list((tmp_path / "parts" / table.name).iterdir())))
            ]
            found = [row for file in files for row in parquet.read_table(file).to_pylist()]
            expected = parquet.read_table(table / "run.parquet").to_pylist()
            # As texts, because no NaN is the same as another.
            assert list(map(repr, found)) == list(map(repr, expected)), table.name
            metadata = [parquet.read_schema(file).metadata for file in files]
            assert all(it == metadata[0] for it in metadata)
    monkeypatch.undo()
    capture.touch()
    convert(capture, tmp_path / "parts")
    assert [path.name for path in (tmp_path / "parts" / "numbers").iterdir()] == ["run.parquet"]


def test_a_capture_may_have_the_name_of_another_ones_part(
    capture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Then neither takes the place of the other."""
    monkeypatch.setattr(arrow_writers, "_MOST_ROWS", 100)
    monkeypatch.setattr(arrow_writers, "_MOST_PIECES", 20)
    convert(capture, tmp_path / "out")
    part = tmp_path / "out" / "numbers" / "run.part-0001.parquet"
    before = part.read_bytes()
    (tmp_path / "run.part-0001.bin").write_bytes(capture.read_bytes()[:20_000])
    for more in ([], ["--force"]):
        done = run("convert", str(capture.with_name("sink.yaml")), "--sender", "pc",
                   str(tmp_path / "run.part-0001.bin"), "--to", "parquet",
                   "-o", str(tmp_path / "out"), *more)  # fmt: skip
        assert done.exit_code == 2
        assert "made of another capture" in done.output.replace("\n", " ")
        assert part.read_bytes() == before
    assert not list((tmp_path / "out").rglob("*.partial"))


def test_rare_rows_wait_in_few_batches(
    capture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of a table that gets a row now and then would wait for long, each by itself."""
    path = capture.with_name("sink.yaml")
    batches = batches_of(path, "pc", capture.read_bytes()[:60_000], None)
    assert len(batches) > 8
    monkeypatch.setattr(arrow_writers, "_MOST_BATCHES", 3)
    pending = Pending(tmp_path)
    writer = arrow_writers.ArrowWriter("run", pending)
    for batch in batches:
        writer.write(batch)
        assert all(len(kept.batches) < 3 for kept in writer._kept.values())
    writer.close()
    pending.commit()
    found = {
        file.parent.name: pa.ipc.open_file(file).read_all().to_pylist()
        for file in tmp_path.glob("*/run.arrow")
    }
    expected: dict[str, list[Any]] = {}
    for batch in batches:
        for rows in batch.rows():
            schema = schema_of(rows.table, {})
            expected.setdefault(rows.table.name, []).extend(batch_of(rows, schema).to_pylist())
    assert repr(dict(sorted(found.items()))) == repr(dict(sorted(expected.items())))


def test_what_others_left_of_parts_is_swept_away(tmp_path: Path) -> None:
    names = (
        "a.000001.parquet",
        "a.000001.part-0001.parquet",
        ".a.000001.part-0002.parquet.x.partial",
    )
    (tmp_path / "table").mkdir()
    for name in (*names, "b.part-0001.parquet"):
        (tmp_path / "table" / name).write_text("")
    sweep(tmp_path, ["a.000001.parquet"], ["table/a.000001.parquet"])
    left = sorted(path.name for path in (tmp_path / "table").iterdir())
    assert left == ["a.000001.parquet", "b.part-0001.parquet"]
