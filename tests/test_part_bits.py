"""Parts whose bits are parts: what people are shown, what changes, and what encoders refuse."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_support import run
from compiled import module_at
from passes_support import written

from protogen.compiler import compile_file
from protogen.evolution.findings import findings
from protogen.runtime.errors import EncodeError

SCHEMAS = Path(__file__).with_name("c_schemas")
SCHEMA = """\
protocol: bits
endpoints: {robot: Robot}
byte_order: little
frame:
  begin: {literal: 0xC0}
  head:
    type: uint8
    bits: {port: {bits: 4..6, default: 1}, kind: {bits: 0..3, id: true}, mark: {bits: 7, const: 1}}
  payload: {}
  crc: {type: uint8, algorithm: CRC-8/SMBUS, covers: head..payload}
  end: {literal: 0xC0}
transparency: slip
messages:
  beat: {id: 2, from: robot, fields: {value: uint8}}
  stop: {id: {kind: 3}, from: robot}
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    found = tmp_path / "bits.yaml"
    found.write_text(SCHEMA, encoding="utf-8")
    return found


@pytest.mark.parametrize(
    ("old", "new", "rule", "category"),
    [
        ("port: {bits: 4..6", "port: {bits: 4..5", "frame-part-type", "WIRE"),
        ("port: {bits: 4..6", "gate: {bits: 4..6", "frame-part-renamed", "SOURCE"),
        ("port: {bits: 4..6, default: 1}, ", "", "frame-part-deleted", "WIRE"),
        ("mark: {bits: 7, const: 1}", "mark: {bits: 7, const: 0}", "frame-literal", "WIRE"),
        (", mark: {bits: 7, const: 1}", ", mark: 7", "frame-part-added", "WIRE"),
        ("default: 1", "default: 2", "frame-part-default", "SOURCE"),
        ("4..6, default: 1", "4..6, counter: true, default: 1", "frame-part-role", "SOURCE"),
    ],
)
def test_changes_of_bits(tmp_path: Path, old: str, new: str, rule: str, category: str) -> None:
    assert SCHEMA.count(old) == 1
    before = written(tmp_path / "old.yaml", SCHEMA)
    after = written(tmp_path / "new.yaml", SCHEMA.replace(old, new))
    _, found = findings(before, after)
    assert (rule, category) in [(item.rule.name, item.category) for item in found]
    assert findings(before, before)[1] == []


def test_bits_that_change_places_are_told_by_a_frame(tmp_path: Path) -> None:
    moved = SCHEMA.replace("4..6", "0..2").replace("bits: 0..3", "bits: 3..6")
    protocols = written(tmp_path / "old.yaml", SCHEMA), written(tmp_path / "new.yaml", moved)
    found = [item for item in findings(*protocols)[1] if item.category == "WIRE"]
    assert {item.change.part for item in found} >= {"port", "kind"}
    assert any(item.witnesses for item in found)


def test_a_dialect_renames_bits_and_what_refers_to_them(path: Path) -> None:
    dialect = path.with_name("dialect.yaml")
    renames = "frame: {head: {bits: {rename: {kind: command}}}}"
    found = written(dialect, f"protocol: dialect\nextends: bits.yaml\n{renames}\n")
    assert [part.name for part in found.sender("robot").frame.identity] == ["command"]


def test_each_part_is_explained_with_its_bits(path: Path) -> None:
    result = run("explain", str(path), "--hex", "C0 92 07 A0 C0")
    rows = [line.split() for line in result.stdout.splitlines()]
    assert ["1", "92", "92", "head", "uint8", "146", "bits", "that", "are", "parts"] in rows
    assert ["1", "001", "port", "uint3", "1"] in rows
    assert ["1", "0010", "kind", "uint4", "2", "beat"] in rows


def test_bits_of_no_part_that_are_others_are_told(path: Path) -> None:
    result = run("explain", str(path), "--hex", "C0 12 07 A0 C0")
    assert "bits 80 must be 80" in result.stdout


def test_a_capture_is_decoded_and_encoded_again(path: Path) -> None:
    made = run("encode", str(path), "beat", "value=7", "@port=6")
    assert made.stdout.startswith("C0 E2 07 ")  # 80 | 6 << 4 | 2
    lines = run("decode", str(path), "--hex", made.stdout, "--format", "jsonl")
    assert '"parts": {"port": 6, "kind": 2}' in lines.stdout
    assert run("encode", str(path), input=lines.stdout).stdout == made.stdout


@pytest.mark.parametrize("strict", [True, False])
def test_values_that_the_bits_can_not_hold_are_refused(path: Path, strict: bool) -> None:
    module = module_at(path)
    with pytest.raises(EncodeError, match="port"):
        module.encode(module.Stop(), strict=strict, port=8)
    with pytest.raises(EncodeError, match="port"):
        module.encode(module.Stop(), port=-1)


def test_values_out_of_their_range_fit_the_wire(path: Path) -> None:
    path.write_text(SCHEMA.replace("4..6, default: 1", "4..6, range: [1, 5]"), encoding="utf-8")
    module = module_at(path)
    with pytest.raises(EncodeError, match="port"):
        module.encode(module.Stop(), port=6)
    assert module.encode(module.Stop(), strict=False, port=6)[1] == 0xE3


def test_bits_count_frames() -> None:
    module = module_at(SCHEMAS / "part_bits.yaml")
    encoder = module.Encoder(sender="wide")
    frames = [encoder.encode(module.Ping()) for _ in range(17)]
    assert [frame[4] for frame in frames] == [*range(16), 0]


def test_bits_may_be_called_as_c_calls_something(path: Path, tmp_path: Path) -> None:
    text = SCHEMA.replace("port:", "register:").replace("kind: {bits", "class: {bits")
    path.write_text(text.replace("{kind: 3}", "{class: 3}"), encoding="utf-8")
    assert (
        run("generate", str(path), "--quiet", "--target", "c", "-o", str(tmp_path)).exit_code == 0
    )
    header = (tmp_path / "c" / "bits.h").read_text(encoding="utf-8")
    assert "uint8_t register_" in header
    assert "register;" not in header
    result = run("fuzz", str(path))
    assert "c: 200 samples, all came back" in result.stdout


def test_bits_that_are_always_the_same_are_in_the_reference(path: Path, tmp_path: Path) -> None:
    path.write_text(SCHEMA.replace("const: 1}", "const: 1, doc: Top bit}"), encoding="utf-8")
    run("generate", str(path), "--quiet", "--target", "markdown", "-o", str(tmp_path))
    page = (tmp_path / "markdown" / "bits.md").read_text(encoding="utf-8")
    (row,) = (line for line in page.splitlines() if line.startswith("|") and "`mark`" in line)
    assert "Its bits are parts. `mark`, bit 7: always `0x1`. Top bit." in row
    assert "other bits" not in row


LENGTH = """\
protocol: sized
endpoints: {robot: Robot}
byte_order: big
frame:
  begin: {literal: 0xC0}
  head:
    type: uint16
    bits: {kind: {bits: 0..2, id: true}, length: {bits: 4..7, counts: payload}, gate: {bits: 8..11}}
  payload: {}
  crc: {type: uint8, algorithm: sum-8, covers: head..payload}
  end: {literal: 0xC0}
transparency: slip
messages:
  beat: {id: 2, from: robot, fields: {value: uint8}}
  text: {id: 3, from: robot, fields: {text: {type: ascii, size: {fill: true, max: 15}}}}
"""


@pytest.mark.parametrize(
    ("old", "new", "rule", "category"),
    [
        ("length: {bits: 4..7", "length: {bits: 12..15", "frame-part-type", "WIRE"),
        ("length: {bits: 4..7", "size: {bits: 4..7", "frame-part-renamed", "SOURCE"),
        ("counts: payload", "counts: head..payload", "frame-length-rule", "WIRE"),
        ("counts: payload", "counts: payload, range: [0, 9]", "frame-length-range", "WIRE"),
        ("counts: payload", "const: 1", "frame-part-deleted", "WIRE"),
        (", counts: payload", "", "frame-part-kind", "WIRE"),
    ],
)
def test_changes_of_a_length_in_bits(
    tmp_path: Path, old: str, new: str, rule: str, category: str
) -> None:
    assert LENGTH.count(old) == 1
    after = LENGTH.replace(old, new)
    if "head.." in new or "range" in new:
        after = after.replace("max: 15", "max: 9")
    protocols = written(tmp_path / "old.yaml", LENGTH), written(tmp_path / "new.yaml", after)
    _, found = findings(*protocols)
    assert (rule, category) in [(item.rule.name, item.category) for item in found]
    assert findings(protocols[0], protocols[0])[1] == []


def test_a_length_in_bits_is_explained_and_tells_where_the_payload_ends(path: Path) -> None:
    path.write_text(LENGTH, encoding="utf-8")
    made = run("encode", str(path), "text", "text=AB", "@gate=5")
    assert made.stdout.strip() == "C0 05 23 41 42 AB C0"  # 05 + 23 + 41 + 42
    result = run("explain", str(path), "--hex", made.stdout)
    rows = [" ".join(line.split()) for line in result.stdout.splitlines()]
    assert "1 0010 length uint4 2 bytes of payload" in rows
    lines = run("decode", str(path), "--hex", made.stdout, "--format", "jsonl")
    assert '"parts": {"kind": 3, "gate": 5}' in lines.stdout
    assert run("encode", str(path), input=lines.stdout).stdout == made.stdout


def test_nobody_gives_a_length_in_bits(path: Path) -> None:
    path.write_text(LENGTH, encoding="utf-8")
    assert run("encode", str(path), "text", "text=AB", "@gate=5", "@length=2").exit_code != 0


@pytest.mark.parametrize("strict", [True, False])
def test_a_payload_that_the_bits_can_not_count_is_refused(path: Path, strict: bool) -> None:
    path.write_text(LENGTH, encoding="utf-8")
    module = module_at(path)
    with pytest.raises(EncodeError, match="text"):
        module.encode(module.Text(text="A" * 16), strict=strict, gate=1)
    assert len(module.encode(module.Text(text="A" * 15), strict=strict, gate=1)) == 20


def test_a_dialect_renames_what_a_length_in_bits_counts(path: Path) -> None:
    counting = LENGTH.replace("counts: payload", "counts: head..payload").replace("15", "9")
    path.write_text(counting, encoding="utf-8")
    dialect = path.with_name("dialect.yaml")
    renames = "frame: {rename: {head: first}, first: {bits: {rename: {length: size}}}}"
    found = written(dialect, f"protocol: dialect\nextends: bits.yaml\n{renames}\n")
    length = found.sender("robot").frame.length
    assert length is not None
    assert (length.name, length.counts) == ("size", ("first", "payload"))


def test_a_length_in_bits_is_in_the_reference(path: Path, tmp_path: Path) -> None:
    path.write_text(LENGTH, encoding="utf-8")
    run("generate", str(path), "--quiet", "--target", "markdown", "-o", str(tmp_path))
    page = (tmp_path / "markdown" / "sized.md").read_text(encoding="utf-8")
    row, *of_messages = (row for row in page.splitlines() if "| `length` |" in row)
    assert "bits 4..7" in row
    assert "Number of bytes of `payload`." in row
    assert any("| `0x1` |" in row for row in of_messages)


FORMS = """\
protocol: forms
endpoints: {robot: Robot}
forms:
  short:
    from: robot
    frame:
      begin: {literal: 0xC0, unprotected: begin_in_data}
      head: {type: uint8, bits: {way: {bits: 6..7, const: 0}, kind: {bits: 0..5, id: true}}}
      payload: {}
      crc: {type: uint8, algorithm: sum-8, covers: head..payload}
  long:
    from: robot
    frame:
      begin: {literal: 0xC0, unprotected: begin_in_data}
      head: {type: uint8, bits: {way: {bits: 6..7, KEYS}, length: {bits: 0..5, counts: payload}}}
      kind: {type: uint8, id: true}
      payload: {}
      crc: {type: uint8, algorithm: sum-8, covers: head..payload}
messages:
  beat: {id: 2, from: robot, fields: {value: uint8}}
decisions: {begin_in_data: {question: q, document: d, choice: c, because: b}}
"""


def test_bits_that_are_always_the_same_tell_forms_apart(path: Path) -> None:
    protocol = written(path, FORMS.replace("KEYS", "const: 1"))
    assert [sender.name for sender in protocol.senders] == ["robot_short", "robot_long"]


@pytest.mark.parametrize("keys", ["range: [1, 3]", "const: 0"])
def test_values_that_a_receiver_hands_on_tell_no_forms_apart(path: Path, keys: str) -> None:
    path.write_text(FORMS.replace("KEYS", keys), encoding="utf-8")
    assert [item.code for item in compile_file(path).problems] == ["PG173"]
