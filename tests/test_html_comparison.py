"""The page of two versions: `protogen diff --format html`, as text and in Chromium."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browser_pages import SCHEMES, Opened, chromium, explained
from cli_support import run
from test_html_page import Elements

from protogen.cli.wire.codec import open_codec
from protogen.compiler import compile_file
from protogen.evolution.findings import findings
from protogen.evolution.side_by_side import message_fields

SCHEMA = """\
protocol: rover
version: 1.0.0
byte_order: little
endpoints: {base: Sends commands., rover: Sends its state.}
frame:
  start: {literal: 0x55, unprotected: accepted}
  id: {type: uint8, id: true}
  length: {type: uint8, counts: [payload]}
  payload: {}
  check: {type: uint16, algorithm: crc-16/ibm-3740, covers: [id, length, payload]}
messages:
  drive:
    id: 1
    from: base
    fields:
      speed: {type: sint16, unit: mm/s}
      turn: {type: sint8, unit: deg}
  stop: {id: 2, from: base}
  state: {id: 3, from: rover, fields: {volts: {type: uint8, unit: V, scale: 0.1}}}
decisions:
  accepted:
    question: What if the start is inside of a frame?
    document: Nothing.
    choice: It is taken as content.
    because: The length says where a frame ends.
"""
NEWER = (
    SCHEMA.replace("speed: {type: sint16", "pace: {renamed_from: speed, type: uint16")
    .replace("turn: {type: sint8, unit: deg}", "gear: uint8")
    .replace("rover: Sends", "robot: Sends")
    .replace("from: rover", "from: robot")
)
DRIVE = "55 01 03 FF FF 05"
"""drive with speed -1 and turn 5, without its check."""


@pytest.fixture(scope="module")
def versions(tmp_path_factory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("versions")
    paths = folder / "old" / "rover.yaml", folder / "new" / "rover.yaml"
    for path, text in zip(paths, (SCHEMA, NEWER), strict=True):
        path.parent.mkdir()
        path.write_text(text, encoding="utf-8")
    return paths


@pytest.fixture(scope="module")
def page(versions, tmp_path_factory) -> Path:
    done = run("diff", *map(str, versions), "--format", "html")
    assert done.exit_code == 1, done.output
    path: Path = tmp_path_factory.mktemp("page") / "changes.html"
    path.write_text(done.output, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


@pytest.fixture
def opened(browser, page) -> Iterator[Opened]:
    with Opened(browser, page) as found:
        yield found
        assert found.complaints == []
        assert found.requests == [found.url]


@pytest.fixture(scope="module")
def drive(versions) -> bytes:
    """The frame of DRIVE with its check."""
    from protogen.fuzzing.python_engine import PythonEngine

    codec = open_codec(versions[0])
    data = PythonEngine(codec.runtime).frame("base", "drive", {"speed": -1, "turn": 5}, {})
    assert data.hex(" ").upper().startswith(DRIVE)
    return data


def rows_of(column: Any) -> list[list[list[str]]]:
    """The cells of each event of a column, without the last one, which says what differs."""
    return [
        [row.locator("td").all_inner_texts()[:-1] for row in article.locator("tbody tr").all()]
        for article in column.locator("article").all()
    ]


def due(codec: Any, sender: str, data: bytes) -> list[list[list[str]]]:
    """The rows of `explain`, with the fault behind the meaning; nothing is stuffed."""
    return [
        [[*row[:2], *row[3:6], f"{row[6]} {row[7]}".strip() if row[7] else row[6]] for row in event]
        for event in explained(codec, sender, data)
    ]


class TestFields:
    def test_rows_are_in_wire_order_with_the_change_of_each(self, versions):
        protocols = [compile_file(path).protocol for path in versions]
        comparison, _ = findings(*protocols)
        rows = message_fields(comparison, "drive")
        assert [(str(row.name), row.mark) for row in rows] == [
            ("<code>start</code>", ""),
            ("<code>id</code>", ""),
            ("<code>length</code>", ""),
            ("<code>speed</code>, now <code>pace</code>", "changed"),
            ("<code>turn</code>", "removed"),
            ("<code>gear</code>", "added"),
            ("<code>check</code>", ""),
        ]
        assert [str(cell) for cell in rows[3].old] == [
            "3..4", "2", "<code>sint16</code> LE", "mm/s", "-32768..32767",
        ]  # fmt: skip
        assert str(rows[3].new[2]) == "<code>uint16</code> LE"

    def test_a_message_of_one_version_has_the_rows_of_that_one(self, versions, tmp_path):
        path = tmp_path / "rover.yaml"
        path.write_text(SCHEMA.replace("  stop: {id: 2, from: base}\n", ""), encoding="utf-8")
        comparison, _ = findings(compile_file(versions[0]).protocol, compile_file(path).protocol)
        assert {row.mark for row in message_fields(comparison, "stop")} == {"removed"}

    def test_texts_of_a_schema_stay_text(self, versions, tmp_path):
        path = tmp_path / "rover.yaml"
        unit = "<b>alert</b></script>"
        text = SCHEMA.replace("unit: mm/s", f"unit: '{unit}'").replace("sint16", "uint16")
        path.write_text(text, encoding="utf-8")
        found = Elements(run("diff", str(versions[0]), str(path), "--format", "html").output)
        assert "b" not in found.names
        assert unit in found.words
        assert found.names.count("script") == 2


class TestPage:
    def test_the_tables_need_no_javascript(self, browser, page):
        with Opened(browser, page, java_script_enabled=False) as opened:
            text = opened.page.inner_text("main")
            assert opened.page.is_visible("table.fields >> nth=0")
            assert "Old sends" in text
            assert "New reads" in text
            assert "Without JavaScript there are the tables, and no bench." in text

    def test_a_page_is_one_file_that_may_run_its_own_script_alone(self, page):
        text = page.read_text(encoding="utf-8")
        policy = "default-src 'none'; script-src 'sha256-"
        assert [value for _, value in Elements(text).attributes if str(value).startswith(policy)]
        assert len(text) <= 400 * 1024

    def test_each_witness_is_shown_as_both_decode_it(self, opened, versions):
        protocols = [compile_file(path).protocol for path in versions]
        _, found = findings(*protocols)
        frames = [witness for item in found for witness in item.witnesses]
        sides = opened.page.locator(".sides")
        codecs = [open_codec(path) for path in versions]
        assert frames
        assert sides.count() == len(frames)
        for holder, witness in zip(sides.all(), frames, strict=True):
            heads = holder.locator(".side").all_inner_texts()
            verbs = ("sends", "reads") if witness.old_sends else ("reads", "sends")
            assert heads == [f"Old {verbs[0]}", f"New {verbs[1]}"]
            names = {"rover": ("rover", "robot"), "robot": ("rover", "robot")}
            senders = names.get(witness.sender, (witness.sender,) * 2)
            for column, codec, sender in zip(
                holder.locator(":scope > div").all(), codecs, senders, strict=True
            ):
                assert rows_of(column) == due(codec, sender, witness.frame)

    def test_own_bytes_are_decoded_by_both(self, opened, versions, drive):
        """Behind a good frame comes one whose check is wrong, which both give up alike."""
        damaged = drive[:-1] + bytes([drive[-1] ^ 1])
        opened.page.fill(".own textarea", (drive + damaged).hex(" "))
        opened.page.wait_for_selector(".own .sides >> nth=1")
        for side, path in enumerate(versions):
            found = [
                event
                for sides in opened.page.locator(".own .sides").all()
                for event in rows_of(sides.locator(":scope > div").nth(side))
            ]
            assert found == due(open_codec(path), "base", drive + damaged)
        first = opened.page.locator(".own .sides >> nth=0")
        marked = first.locator(".run.differs").all_inner_texts()
        assert [text.split() for text in marked] == [
            ["FF", "FF", "≠", "speed"],
            ["05", "≠", "turn"],
            ["FF", "FF", "≠", "pace"],
            ["05", "≠", "gear"],
        ]
        assert "check is" in opened.page.locator(".own .sides >> nth=1").inner_text()

    def test_lines_that_name_an_endpoint_by_either_name_are_its_own(self, opened, versions):
        """The state of 12.0 V, 78 hex, with its check, in a log of both names."""
        from protogen.fuzzing.python_engine import PythonEngine

        engine = PythonEngine(open_codec(versions[0]).runtime)
        state = engine.frame("rover", "state", {"volts": 120}, {}).hex(" ")
        opened.page.fill(".own textarea", f"12:00:00.5 rover {state}\n12:00:01 robot {state}\n")
        opened.page.wait_for_selector(".own .sides >> nth=1")
        titles = opened.page.locator(".own article h3").all_inner_texts()
        assert len(titles) == 4
        assert [title.endswith("message state") for title in titles] == [True] * 4
        assert sum("from robot" in title for title in titles) == 2

    def test_what_is_no_hex_is_told(self, opened):
        opened.page.fill(".own textarea", "55 0q")
        opened.page.wait_for_function(
            "() => document.querySelector('.own [role=status]').textContent.includes('no hex')"
        )

    def test_pointing_at_a_byte_lights_up_its_row(self, opened):
        run_, table = ".sides .run >> nth=3", ".sides table >> nth=0"
        opened.page.hover(run_)
        lit = opened.page.locator(table).locator("tr.lit td").all_inner_texts()
        assert "speed" in lit

    @pytest.mark.parametrize("scheme", SCHEMES)
    def test_axe_finds_nothing(self, browser, page, scheme):
        with Opened(browser, page, color_scheme=scheme) as opened:
            opened.page.fill(".own textarea", DRIVE)
            opened.page.wait_for_selector(".own article")
            assert opened.barriers(scheme) == []


def test_schemas_that_did_not_change_have_no_bench(versions):
    page_ = Elements(run("diff", str(versions[0]), str(versions[0]), "--format", "html").output)
    assert "script" not in page_.names
