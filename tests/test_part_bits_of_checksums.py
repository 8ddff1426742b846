"""Bits of parts that are a checksum, or some bits of one."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_support import run
from compiled import module_at
from passes_support import written

from protogen.evolution.findings import findings
from protogen.model.protocol import Protocol

SCHEMA = """\
protocol: halves
endpoints: {robot: Robot}
frame:
  begin: {literal: 0xC0}
  head:
    type: uint8
    bits:
      kind: {bits: 0..2, id: true}
      gate: {bits: 3}
      low: {bits: 4..7, algorithm: sum-8, covers: payload, takes: 0..3}
  payload: {}
  tail:
    type: uint8
    bits:
      high: {bits: 0..3, algorithm: sum-8, covers: payload, takes: 4..7}
      flag: {bits: 7, default: 0}
  end: {literal: 0xC0}
transparency: slip
messages:
  text: {id: 3, from: robot, fields: {text: {type: ascii, size: {fill: true, max: 15}}}}
"""
HIGH = ", algorithm: sum-8, covers: payload, takes: 4..7"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    found = tmp_path / "halves.yaml"
    found.write_text(SCHEMA, encoding="utf-8")
    return found


def undetected(protocol: Protocol) -> str:
    return " ".join(protocol.sender("robot").framing.undetected)


@pytest.mark.parametrize(
    ("old", "new", "rule", "category"),
    [
        ("takes: 4..7", "takes: 3..6", "frame-checksum-algorithm", "WIRE"),
        ("sum-8, covers: payload, takes: 4", "xor-8, covers: payload, takes: 4",
         "frame-checksum-algorithm", "WIRE"),
        ("high: {bits: 0..3", "high: {bits: 3..6", "frame-checksum-algorithm", "WIRE"),
        ("covers: payload, takes: 4", "covers: head..payload, takes: 4",
         "frame-checksum-coverage", "WIRE"),
        ("high: {", "top: {", "frame-part-renamed", "SOURCE"),
        (HIGH, ", const: 1", "frame-part-deleted", "WIRE"),
        (HIGH, ", counter: true", "frame-part-kind", "WIRE"),
    ],
)  # fmt: skip
def test_changes_of_a_checksum_in_bits(
    tmp_path: Path, old: str, new: str, rule: str, category: str
) -> None:
    assert SCHEMA.count(old) == 1
    after = SCHEMA.replace(old, new)
    protocols = written(tmp_path / "old.yaml", SCHEMA), written(tmp_path / "new.yaml", after)
    _, found = findings(*protocols)
    assert (rule, category) in [(item.rule.name, item.category) for item in found]
    assert findings(protocols[0], protocols[0])[1] == []


def test_halves_are_worked_out_explained_and_verified(path: Path) -> None:
    made = run("encode", str(path), "text", "text=AB", "@gate=1")
    assert made.stdout.strip() == "C0 3B 41 42 08 C0"  # 41 + 42 = 83; 3 << 4 | 1 << 3 | 3
    result = run("explain", str(path), "--hex", made.stdout)
    rows = [" ".join(line.split()) for line in result.stdout.splitlines()]
    assert "1 0011 low uint4 3 bits 0..3 of sum-8 of payload" in rows
    assert "4 1000 high uint4 8 bits 4..7 of sum-8 of payload" in rows
    wrong = run("explain", str(path), "--hex", "C0 3B 41 42 09 C0")
    assert "no frame: checksum, high is 9, not 8" in wrong.stdout
    lines = run("decode", str(path), "--hex", made.stdout, "--format", "jsonl")
    assert '"parts": {"kind": 3, "gate": 1, "flag": 0}' in lines.stdout
    assert run("encode", str(path), input=lines.stdout).stdout == made.stdout


@pytest.mark.parametrize("frame", ["C0 2B 41 42 08 C0", "C0 3B 41 42 09 C0", "C0 3B 41 43 08 C0"])
def test_a_wrong_half_is_a_wrong_checksum(path: Path, frame: str) -> None:
    module = module_at(path)
    decoder = module.Decoder(sender="robot")
    first, *_ = (*decoder.feed(bytes.fromhex(frame)), *decoder.flush())
    assert (first.kind, first.reason) == ("invalid", "checksum")


def test_bits_of_a_part_that_are_not_those_of_its_names_are_refused(path: Path) -> None:
    decoder = module_at(path).Decoder(sender="robot")
    first, *_ = (*decoder.feed(bytes.fromhex("C0 3B 41 42 18 C0")), *decoder.flush())
    assert (first.kind, first.reason) == ("invalid", "value")


def test_nobody_gives_a_checksum_in_bits(path: Path) -> None:
    made = run("encode", str(path), "text", "text=AB", "@gate=1", "@high=8")
    assert made.exit_code != 0


def test_two_halves_see_what_the_whole_sees(path: Path) -> None:
    assert "sum-8" not in undetected(written(path, SCHEMA))


def test_one_half_sees_less(path: Path) -> None:
    one = written(path, SCHEMA.replace(HIGH, ", const: 1"))
    told = "some wrong bytes that `low` covers: bits 0..3 of sum-8 do not see them"
    assert told in undetected(one)


def test_halves_of_different_bytes_are_no_whole(path: Path) -> None:
    other = written(path, SCHEMA.replace("covers: payload, takes: 4", "covers: head, takes: 4"))
    assert "bits 0..3 of sum-8 do not see them" in undetected(other)


def test_a_dialect_renames_what_a_checksum_in_bits_covers(path: Path) -> None:
    path.write_text(SCHEMA.replace("payload, takes: 4", "head..payload, takes: 4"), "utf-8")
    dialect = path.with_name("dialect.yaml")
    renames = "frame: {rename: {head: first}, tail: {bits: {rename: {high: top}}}}"
    found = written(dialect, f"protocol: dialect\nextends: halves.yaml\n{renames}\n")
    top = found.sender("robot").frame.checksums[-1]
    assert (top.name, top.covers) == ("top", ("first", "payload"))


def test_halves_are_in_the_reference(path: Path, tmp_path: Path) -> None:
    run("generate", str(path), "--quiet", "--target", "markdown", "-o", str(tmp_path))
    page = (tmp_path / "markdown" / "halves.md").read_text(encoding="utf-8")
    row, *of_messages = (row for row in page.splitlines() if "| `high` |" in row)
    assert "Bits 4..7 of the checksum over `payload`: the sum of all bytes" in row
    assert any("Checksum." in row for row in of_messages)
