"""Several lengths in one frame: what people are shown, what changes, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_support import run
from compiled import module_at
from passes_support import written

from protogen.evolution.findings import findings
from protogen.model.sizes import SizeSet
from protogen.runtime.errors import EncodeError

SCHEMA = """\
protocol: nested
endpoints: {robot: Robot}
byte_order: little
frame:
  begin: {literal: 0xC0}
  outer: {type: uint8, counts: kind..crc, range: [4, 24]}
  kind: {type: uint8, id: true}
  inner: {type: uint16, counts: payload, doc: As a check}
  payload: {}
  crc: {type: uint8, algorithm: CRC-8/DVB-S2, covers: kind..payload}
  end: {literal: 0xC0}
transparency: slip
messages:
  beat: {id: 2, from: robot, fields: {value: uint8}}
  stop: {id: 3, from: robot, fields: {text: {type: ascii, size: {fill: true, max: 15}}}}
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    found = tmp_path / "nested.yaml"
    found.write_text(SCHEMA, encoding="utf-8")
    return found


@pytest.mark.parametrize(
    ("old", "new", "rule", "category"),
    [
        ("inner: {type: uint16, counts: payload", "inner: {type: uint16, counts: inner..payload",
         "frame-length-rule", "WIRE"),
        ("inner: {type: uint16, counts: payload", "inner: {type: uint16",
         "frame-part-kind", "WIRE"),
        ("inner: {type: uint16", "inner: {type: uint8", "frame-part-type", "WIRE"),
        ("counts: payload, doc", "counts: payload, range: [0, 16], doc",
         "frame-part-range", "SOURCE"),
        ("inner:", "size:", "frame-part-renamed", "SOURCE"),
    ],
)  # fmt: skip
def test_changes_of_lengths(tmp_path: Path, old: str, new: str, rule: str, category: str) -> None:
    assert SCHEMA.count(old) == 1
    before = written(tmp_path / "old.yaml", SCHEMA)
    after = written(tmp_path / "new.yaml", SCHEMA.replace(old, new))
    _, found = findings(before, after)
    assert (rule, category) in [(item.rule.name, item.category) for item in found]
    assert findings(before, before)[1] == []


def test_lengths_are_bounded_by_what_all_of_them_allow(tmp_path: Path) -> None:
    found = written(tmp_path / "wide.yaml", SCHEMA).sender("robot")
    assert found.plan.payload == SizeSet.between(0, 20)
    assert [(part.name, part.least, part.greatest) for part in found.frame.lengths] == [
        ("outer", 4, 24),
        ("inner", 0, 20),
    ]
    narrow = SCHEMA.replace("counts: payload, doc", "counts: payload, range: [1, 15], doc")
    found = written(tmp_path / "narrow.yaml", narrow).sender("robot")
    assert found.plan.payload == SizeSet.between(1, 15)
    assert [(part.least, part.greatest) for part in found.frame.lengths] == [(5, 19), (1, 15)]


def test_a_size_that_one_of_them_can_not_say_is_refused(path: Path) -> None:
    narrow = SCHEMA.replace("counts: payload, doc", "counts: payload, range: [1, 15], doc")
    path.write_text(narrow, encoding="utf-8")
    module = module_at(path)
    assert module.encode(module.Stop(text="a"))
    for strict in (True, False):
        with pytest.raises(EncodeError, match="payload"):
            module.encode(module.Stop(text=""), strict=strict)
        with pytest.raises(EncodeError):
            module.encode(module.Stop(text=16 * "a"), strict=strict)


def test_a_dialect_renames_a_length(path: Path) -> None:
    dialect = path.with_name("dialect.yaml")
    renames = "frame: {rename: {outer: all, inner: size}}"
    found = written(dialect, f"protocol: dialect\nextends: nested.yaml\n{renames}\n")
    assert [(item.name, item.agrees_with) for item in found.sender("robot").frame.lengths] == [
        ("all", None),
        ("size", "all"),
    ]


def test_each_length_is_explained(path: Path) -> None:
    result = run("explain", str(path), "--hex", "C0 05 02 01 00 07 5D C0")
    rows = [" ".join(line.split()) for line in result.stdout.splitlines()]
    assert "1 05 05 outer uint8 5 bytes of kind, inner, payload, crc" in rows
    assert "3 01 00 01 00 inner uint16 little 1 bytes of payload" in rows


def test_a_length_that_disagrees_is_told(path: Path) -> None:
    frame = "C0 05 02 02 00 07 6A C0"
    assert "must be 1, as outer is 5" in run("explain", str(path), "--hex", frame).stdout
    decoded = run("decode", str(path), "--hex", frame).stdout
    assert "length: inner is 2, and has to be 1" in decoded


def test_nobody_gives_a_length_and_no_event_has_it(path: Path) -> None:
    made = run("encode", str(path), "beat", "value=7")
    assert made.stdout.strip() == "C0 05 02 01 00 07 5D C0"
    lines = run("decode", str(path), "--hex", made.stdout, "--format", "jsonl")
    assert '"parts": {"kind": 2}' in lines.stdout
    assert run("encode", str(path), input=lines.stdout).stdout == made.stdout
    assert run("encode", str(path), "beat", "value=7", "@inner=1").exit_code != 0


def test_each_length_is_in_the_reference(path: Path, tmp_path: Path) -> None:
    run("generate", str(path), "--quiet", "--target", "markdown", "-o", str(tmp_path))
    page = (tmp_path / "markdown" / "nested.md").read_text(encoding="utf-8")
    assert "`outer` gives the size, and `inner` must agree with it" in page
    inner, *of_messages = (row for row in page.splitlines() if "| `inner` |" in row)
    assert "Number of bytes of `payload`. It has to agree with `outer`. As a check." in inner
    assert any("`0x0001`" in row for row in of_messages)


def test_a_wrong_length_is_noticed_by_another_one(tmp_path: Path) -> None:
    plain = SCHEMA.replace("transparency: slip\n", "").replace("begin: {literal: 0xC0}", "begin: {"
        "literal: 0xC0, unprotected: in_data}").replace("  end: {literal: 0xC0}\n", "")  # fmt: skip
    plain += "decisions: {in_data: {question: q, document: d, choice: c, because: b}}\n"
    undetected = written(tmp_path / "two.yaml", plain).sender("robot").framing.undetected
    assert undetected == ()
    alone = plain.replace("counts: payload, doc", "doc")
    undetected = written(tmp_path / "one.yaml", alone).sender("robot").framing.undetected
    assert "a wrong `outer`, which moves where `crc` is read" in " ".join(undetected)
    behind = alone.replace("  crc:", "  whole: {type: uint8, counts: kind..whole}\n  crc:")
    undetected = written(tmp_path / "late.yaml", behind).sender("robot").framing.undetected
    assert "a wrong `outer`, which moves where `crc` and `whole`" in " ".join(undetected)
