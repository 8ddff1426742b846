"""`protogen explain` and `protogen fuzz`."""

from __future__ import annotations

from pathlib import Path

import handwritten_matty
import pytest
from cli_support import ROOT, run

from protogen.cli.wire.explain import _not_looked_at
from protogen.copying import replace
from protogen.model.reading.annotate import Row

MATTY = str(ROOT / "schemas" / "matty.yaml")
TWO_BYTES = """\
protocol: two
endpoints: {board: The board}
byte_order: little
frame:
  start: {literal: 0xC0}
  id: {type: uint8, id: true}
  payload: {}
  crc: {type: uint16, algorithm: CRC-16/KERMIT, covers: id}
  end: {literal: 0xC0}
transparency: slip
messages:
  ping: {id: 1, from: board}
"""
UHEROBOT = str(ROOT / "schemas" / "uherobot.yaml")


def test_dump_of_a_frame() -> None:
    # speed 22260 is 56F4, and its high byte is escaped: 56 A9.
    result = run("explain", MATTY, "--sender", "pc", "--hex", "55 06 01 47 F4 56 A9 06 FF 63")
    assert result.exit_code == 0
    assert result.output.splitlines() == [
        "offset 0, 10 bytes from pc: message go",
        "offset  wire      unstuffed  name     type           raw    meaning",
        "0       55        55         sync     literal",
        "1       06        06         length   uint8          6      "
        "bytes of counter, command, payload",
        "2       01        01         counter  uint8          1",
        "3       47        47         command  char           71     'G' go",
        "4       F4 56 A9  F4 56      speed    sint16 little  22260  22260 mm/s",
        "7       06 FF     06 FF      steer    sint16 little  -250   -2.5 deg",
        "9       63        63         crc      uint8          99     "
        "sum-8/negated of length, counter, command, payload",
        "",
    ]


@pytest.mark.parametrize("given", [["55020141BC"], ["55", "02", "01"]])
def test_bytes_without_hex_are_told_how_to_be_given(given: list[str]) -> None:
    result = run("explain", MATTY, *given)
    assert result.exit_code == 2
    assert f"bytes are given as --hex '{' '.join(given)}'" in result.output


def test_what_is_wrong_stands_beside_it() -> None:
    result = run("explain", MATTY, "--sender", "pc", "--hex", "00 55 02 01 53 00")
    lines = result.output.splitlines()
    assert lines[0] == "offset 0, 1 byte from pc: no frame: noise"
    # The title and the row say it in one way.
    assert lines[4].endswith("no frame: checksum, crc is 00, not aa")
    assert lines[-2].endswith("! crc is 00, not aa")


def test_a_checksum_of_two_bytes_is_shown_as_on_the_wire(tmp_path: Path) -> None:
    schema = tmp_path / "two.yaml"
    schema.write_text(TWO_BYTES)
    result = run("explain", str(schema), "--hex", "C0 01 31 EC C0")
    assert result.output.splitlines()[0].endswith("no frame: checksum, crc is 31 ec, not 89 11")
    assert "! crc is 31 ec, not 89 11" in result.output
    assert "0x" not in result.output


def test_unknown_identity() -> None:
    result = run("explain", MATTY, "--sender", "pc", "--hex", "55 02 05 5A 9F")
    assert "a valid frame, but no message has its identity" in result.output
    assert "'Z' no message has this identity" in result.output


def test_no_column_for_stuffing_where_there_is_none() -> None:
    result = run(
        "explain", str(ROOT / "schemas" / "dagny.yaml"), "--sender", "host", "--hex", "430A"
    )
    assert result.output.splitlines()[1].split()[:3] == ["offset", "wire", "name"]


def test_many_bytes_take_several_lines(tmp_path: Path) -> None:
    payload = "24" + "47" * 11
    frame = bytes.fromhex(f"55 0E 00 50 {payload}")
    crc = -sum(frame[1:]) & 0xFF
    result = run("explain", MATTY, "--sender", "esp", "--hex", f"{frame.hex()} {crc:02X}")
    lines = result.output.splitlines()
    assert lines[6].split()[:9] == ["4", "24", *["47"] * 7]
    assert lines[7].split() == ["12", *["47"] * 8]
    assert '"$GGGGGGGGGGG"' in lines[6]


def test_base16_stands_beside_its_bytes() -> None:
    result = run("explain", UHEROBOT, "--sender", "daemon", "--hex", b"b060300000000e".hex())
    assert "1       30 36        06         length" in result.output


def test_bytes_from_standard_input() -> None:
    result = run("explain", MATTY, "--sender", "pc", input="55 02 01 53 AA")
    assert result.output.startswith("offset 0, 5 bytes from pc: message stop\n")


@pytest.mark.parametrize("arguments", [["--hex", ""], []])
def test_no_bytes(arguments: list[str]) -> None:
    result = run("explain", MATTY, "--sender", "pc", *arguments, input="")
    assert (result.exit_code, result.output) == (0, "no bytes\n")


TWO_BYTE_END = """\
protocol: ended
endpoints: {board: The board}
frame:
  sync: {literal: 0xAA, unprotected: plain}
  id: {type: uint8, id: true}
  payload: {}
  end: {literal: {hex: 0D 0A}, unprotected: plain}
decisions: {plain: {question: q, document: d, choice: c, because: b}}
messages:
  m: {id: 1, from: board, fields: {z: uint8}}
"""


def test_what_is_behind_the_byte_that_decided_was_not_looked_at(tmp_path: Path) -> None:
    schema = tmp_path / "ended.yaml"
    schema.write_text(TWO_BYTE_END)
    output = run("explain", str(schema), "--hex", "AA 01 07 55 0A").output
    assert "! must be 0D 0A" in output
    assert "missing" not in output
    cut = run("explain", str(schema), "--hex", "AA 01 07").output
    assert "missing bytes: 2" in cut


def test_rows_behind_the_byte_that_decided() -> None:
    row = Row(
        offset=5, wire=b"", bytes=b"", path="z", type="uint8", fault="missing bytes: 1", cut=True
    )
    assert (_not_looked_at(row).fault, _not_looked_at(row).meaning) == ("", "not looked at")
    begun = _not_looked_at(replace(row, wire=b"\1", bytes=b"\1"))
    assert begun.meaning == "the rest was not looked at"


def test_bytes_that_are_no_text() -> None:
    result = run("explain", MATTY, "--sender", "pc", input=b"55 \xff")
    assert result.exit_code == 2
    assert "line 1, column 4" in result.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--sender", "pc", "--hex", "5"], "line 1, column 1: `5` has an odd number"),
        (["--sender", "nobody", "--hex", "55"], "`matty` has no sender `nobody`"),
    ],
)
def test_mistakes(arguments: list[str], message: str) -> None:
    result = run("explain", MATTY, *arguments)
    assert result.exit_code == 2
    assert message in result.stderr


# --- fuzz -----------------------------------------------------------------------------------------


def test_everything_comes_back() -> None:
    result = run("fuzz", MATTY, "--examples", "5", "--seed", "7")
    assert result.exit_code == 0
    assert result.output.startswith("construct: ")
    assert result.output.endswith("samples, all came back (seed 7)\n")


def test_one_message() -> None:
    result = run("fuzz", MATTY, "--message", "go", "--examples", "20", "--seed", "7")
    due = [f"{name}: 20 samples, all came back (seed 7)" for name in ("construct", "python")]
    assert result.output.splitlines()[:2] == due


def test_another_seed_each_time() -> None:
    outputs = {run("fuzz", MATTY, "--message", "go", "--examples", "1").output for _ in range(4)}
    assert len(outputs) > 1


def test_unknown_message() -> None:
    result = run("fuzz", MATTY, "--message", "goo")
    assert result.exit_code == 2
    assert "did you mean `go`?" in result.stderr


def test_refusals_are_counted() -> None:
    result = run("fuzz", str(ROOT / "schemas" / "dagny.yaml"), "--examples", "30", "--seed", "1")
    assert result.exit_code == 0
    assert "were refused because a decoder would cut them elsewhere" in result.output


def test_failure_is_reported_with_all_that_it_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(self: object) -> dict[str, int]:
        return {"speed": 1, "steer": 2}

    def module(protocol: object) -> object:
        return handwritten_matty

    monkeypatch.setattr("protogen.live.codec.module_of", module)
    monkeypatch.setattr(handwritten_matty.Go, "to_dict", wrong)
    result = run("fuzz", MATTY, "--message", "go", "--seed", "7", "--examples", "3")
    assert result.exit_code == 1
    lines = result.output.splitlines()
    assert lines[0] == "go, sent by pc, through construct:"
    assert lines[1].startswith("  the payload ")
    assert lines[1].endswith("gives other values: {'speed': 1, 'steer': 2}")
    assert lines[2].startswith('  fields: {"speed": ')
    assert lines[3].startswith('  parts:  {"counter": ')
    assert lines[4] == "  again:  --seed 7 --message go"
    assert lines[5].endswith("samples, 1 message fails (seed 7)")


def test_long_samples_are_shortened(monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(self: object) -> dict[str, list[int]]:
        return {"speed": list(range(5000))}

    def module(protocol: object) -> object:
        return handwritten_matty

    monkeypatch.setattr("protogen.live.codec.module_of", module)
    monkeypatch.setattr(handwritten_matty.Go, "to_dict", wrong)
    result = run("fuzz", MATTY, "--message", "go", "--seed", "7", "--examples", "3")
    assert result.exit_code == 1
    assert max(map(len, result.output.splitlines())) < 500
    assert "go, sent by pc, through construct:\n  the payload " in result.output
