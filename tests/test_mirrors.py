"""Parts that follow from others: what people are shown, what changes, and what is noticed."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_support import run
from compiled import module_at
from passes_support import written

from protogen.evolution.findings import findings
from protogen.runtime.errors import EncodeError

SCHEMA = """\
protocol: twice
endpoints: {robot: Robot}
byte_order: little
frame:
  begin: {literal: 0xC0}
  kind: {type: uint8, id: true}
  length: {type: uint8, counts: payload}
  again: {type: uint8, repeats: length, doc: As a check}
  head:
    type: uint8
    bits: {port: {bits: 0..2, default: 1}, port_not: {bits: 4..6, complements: port}}
  payload: {}
  end: {literal: 0xC0}
transparency: slip
messages:
  beat: {id: 2, from: robot, fields: {value: uint8}}
  stop: {id: 3, from: robot, fields: {text: {type: ascii, size: {fill: true, max: 5}}}}
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    found = tmp_path / "twice.yaml"
    found.write_text(SCHEMA, encoding="utf-8")
    return found


@pytest.mark.parametrize(
    ("old", "new", "rule", "category"),
    [
        ("repeats: length", "complements: length", "frame-mirror", "WIRE"),
        ("repeats: length", "repeats: kind", "frame-mirror", "WIRE"),
        ("complements: port", "repeats: port", "frame-mirror", "WIRE"),
        ("{bits: 4..6, complements: port}", "4..6", "frame-part-added", "WIRE"),
        ("{bits: 4..6, complements: port}", "{bits: 4..6, const: 6}", "frame-literal", "WIRE"),
        ("bits: 4..6, comp", "bits: 5..7, comp", "frame-literal", "WIRE"),
        (
            "{type: uint8, repeats: length, doc: As a check}",
            "{type: uint8}",
            "frame-part-kind",
            "WIRE",
        ),
    ],
)
def test_changes_of_what_follows(
    tmp_path: Path, old: str, new: str, rule: str, category: str
) -> None:
    assert SCHEMA.count(old) == 1
    before = written(tmp_path / "old.yaml", SCHEMA)
    after = written(tmp_path / "new.yaml", SCHEMA.replace(old, new))
    _, found = findings(before, after)
    assert (rule, category) in [(item.rule.name, item.category) for item in found]
    assert findings(before, before)[1] == []


def test_another_name_of_the_number_is_no_other_number(tmp_path: Path) -> None:
    before = written(tmp_path / "old.yaml", SCHEMA)
    renamed = SCHEMA.replace("port:", "gate:").replace(": port}", ": gate}")
    after = written(tmp_path / "new.yaml", renamed)
    assert [item.rule.name for item in findings(before, after)[1]] == ["frame-part-renamed"]


def test_a_dialect_renames_a_number_and_what_follows_from_it(path: Path) -> None:
    dialect = path.with_name("dialect.yaml")
    renames = "frame: {rename: {length: size}, head: {bits: {rename: {port: gate}}}}"
    found = written(dialect, f"protocol: dialect\nextends: twice.yaml\n{renames}\n")
    mirrors = found.sender("robot").frame.mirrors
    assert [(item.name, item.of.name) for item in mirrors] == [
        ("again", "size"),
        ("port_not", "gate"),
    ]


def test_what_follows_is_explained(path: Path) -> None:
    result = run("explain", str(path), "--hex", "C0 02 01 01 61 07 C0")
    rows = [" ".join(line.split()) for line in result.stdout.splitlines()]
    assert "3 01 01 again uint8 1 length again" in rows
    assert "4 001 port uint3 1" in rows
    assert "4 110 port_not uint3 6 port with all bits inverted" in rows


@pytest.mark.parametrize(
    ("frame", "fault"),
    [
        ("C0 02 01 02 61 07 C0", "must be 1, as length is 1"),
        ("C0 02 01 01 51 07 C0", "must be 6, as port is 1"),
        ("C0 02 01 01 69 07 C0", "bits 88 must be 0"),
    ],
)
def test_what_does_not_follow_is_told(path: Path, frame: str, fault: str) -> None:
    assert fault in run("explain", str(path), "--hex", frame).stdout
    assert "value" in run("decode", str(path), "--hex", frame).stdout


def test_nobody_gives_what_follows_and_no_event_has_it(path: Path) -> None:
    made = run("encode", str(path), "beat", "value=7", "@port=5")
    assert made.stdout.strip() == "C0 02 01 01 25 07 C0"  # 5 ^ 7 = 2
    lines = run("decode", str(path), "--hex", made.stdout, "--format", "jsonl")
    assert '"parts": {"kind": 2, "port": 5}' in lines.stdout
    assert run("encode", str(path), input=lines.stdout).stdout == made.stdout
    assert run("encode", str(path), "beat", "value=7", "@again=1").exit_code != 0


@pytest.mark.parametrize("strict", [True, False])
def test_values_that_the_bits_can_not_hold_are_refused(path: Path, strict: bool) -> None:
    module = module_at(path)
    with pytest.raises(EncodeError, match="port"):
        module.encode(module.Beat(value=1), strict=strict, port=8)


def test_what_follows_is_in_the_reference(path: Path, tmp_path: Path) -> None:
    run("generate", str(path), "--quiet", "--target", "markdown", "-o", str(tmp_path))
    page = (tmp_path / "markdown" / "twice.md").read_text(encoding="utf-8")
    again, *of_messages = (row for row in page.splitlines() if "| `again` |" in row)
    assert "The value of `length` again. As a check." in again
    assert all("Follows from another part." in row for row in of_messages)
    (port_not, *_) = (row for row in page.splitlines() if "| `port_not` |" in row)
    assert "bits 4..6" in port_not
    assert "The bits of `port`, each of them inverted." in port_not


def test_a_wrong_byte_is_noticed_where_another_byte_has_the_complement(path: Path) -> None:
    undetected = " ".join(written(path, SCHEMA).sender("robot").framing.undetected)
    assert "`length`" not in undetected
    assert "a wrong `port`: no checksum covers it" in undetected  # All of it is in one byte.
    apart = SCHEMA.replace(", port_not: {bits: 4..6, complements: port}", "")
    apart = apart.replace(
        "  payload:", "  other: {type: uint8, bits: {x: {bits: 0..2, repeats: port}}}\n  payload:"
    )
    assert "`port`" not in " ".join(written(path, apart).sender("robot").framing.undetected)


def test_a_start_has_the_values_that_its_bits_can_have_together(path: Path) -> None:
    text = SCHEMA.replace("  begin: {literal: 0xC0}\n", "").replace("transparency: slip\n", "")
    bits = "{one: {bits: 0..3, id: true}, two: {bits: 4..7, complements: one}}"
    head = f"  kind: {{type: uint8, bits: {bits}}}\n"
    text = text.replace("  kind: {type: uint8, id: true}\n", head).replace(
        "  end: {literal: 0xC0}\n", ""
    )
    framing = written(path, text).sender("robot").framing
    assert framing.finds_start.startswith("at 0F, 1E, 2D, 3C, 4B, 5A, 69, 78, 87, 96, A5, B4")
