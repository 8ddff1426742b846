"""Mistakes that people make out of habit, and the hint that each gets: what to write instead."""

from __future__ import annotations

from pathlib import Path

import pytest

from protogen.compiler import compile_file

SCHEMA = """\
protocol: demo
endpoints: {board: Sensor board}
byte_order: little
frame:
  start:   {literal: 0xAA}
  kind:    {type: uint8, id: true}
  payload: {}
  crc:     {type: uint16, algorithm: CRC-16/KERMIT, covers: [kind, payload]}
transparency:
  covers: kind..crc
  escape: {byte: 0xAB, of: [0xAA, 0xAB], transform: {xor: 0x20}}
messages:
  reading:
    id: 1
    from: board
    fields:
      value: {type: uint16, scale: 1/10, unit: V}
"""
VALUE = "{type: uint16, scale: 1/10, unit: V}"
MESSAGES = SCHEMA[SCHEMA.index("messages:") :]

HABITS = [
    ("a decimal comma", VALUE, "{type: uint16, scale: 0,1}", "a decimal number has a point"),
    (
        "a physical range",
        VALUE,
        "{type: uint16, scale: 1/10, range: [0, 6553.5]}",
        "for 0 to 6553.5 write [0, 65535]",
    ),
    ("numbers in front", VALUE, "{type: uint8, values: {0: idle, 1: run}}", "{idle: 0, run: 1}"),
    ("names alone", VALUE, "{type: uint8, values: [a, b]}", "each name has its number: `{a: 0, b:"),
    ("nothing tells", "uint8, id: true}", "uint8}", "`kind: {type: uint8, id: true}`"),
    ("a brace", VALUE, "{type: uint16}}", "there is one `}` too many"),
    (
        "a comma in a text",
        VALUE,
        "{type: uint16, doc: between the pins, behind the fuse, in volts}",
        '`doc: "between the pins, behind the fuse, in volts"`',
    ),
    ("a key without a value", VALUE, "{type: uint16, big}", "keys are type, fields"),
    ("a comment", VALUE, "{type: uint16, doc: see # 5}", "a `#` behind a space begins a comment"),
    (
        "messages in a list",
        MESSAGES,
        "messages:\n  - reading\n",
        "leave out the `-` or `[ ]`: `messages:`",
    ),
    (
        "fields in a list between brackets",
        "    fields:\n      value",
        "    fields: [value]\n    other:\n      value",
        "leave out the `-` or `[ ]`: `fields:`",
    ),
    ("not indented", "  reading:\n", "reading:\n", "indent it, if it belongs to `messages`"),
    ("fields not indented", "      value", "    value", "indent it, if it belongs to `fields`"),
    (
        "fields beside the message",
        "    fields:\n      value",
        "  fields:\n    value",
        "`fields` is a key of a message: indent it",
    ),
    ("an array of C", VALUE, "uint16[4]", "write `{type: uint16, count: 4}`"),
    ("a text of C", VALUE, "ascii[8]", "write `{type: ascii, size: 8}`"),
    ("an enum", VALUE, "{type: enum, values: {a: 0}}", "`values: {NAME: NUMBER}` beside it"),
    ("a struct", VALUE, "{type: struct}", "leave out `type`, and write `fields:`"),
    (
        "a length",
        "  payload: {}",
        "  n: {type: uint8, length: payload}\n  payload: {}",
        "counts: p",
    ),
    (
        "an inverse",
        "  payload: {}",
        "  again: {type: uint8, inverse: kind}\n  payload: {}",
        "write `complements: PART`",
    ),
    ("bounds", VALUE, "{type: uint16, min: 0}", "write `range: [MIN, MAX]`"),
    ("endianness", VALUE, "{type: uint16, endian: big}", "write `byte_order: little` or"),
    (
        "a decision",
        "{literal: 0xAA}",
        "{literal: 0xAA, unprotected: foo}",
        "add it: `decisions: {foo: {question: ..., document: ..., choice: ..., because: ...}}`",
    ),
    ("a number in quotes", "id: 1\n", 'id: "0x10"\n', "write it without quotes: 0x10"),
    ("a number of assembler", "id: 1\n", "id: 10h\n", "write 0x10"),
    ("a title", "from: board", "from: Sensor board", "write the endpoint's name: `board`"),
    ("other letters", "from: board", "from: Board", "did you mean `board`?"),
    ("no sender", "    from: board\n", "", "say who sends it: `from: board`"),
    ("two bytes", "{literal: 0xAA}", "{literal: 0x1B02}", "in their order: [0x1B, 0x02]"),
    (
        "a merge",
        "    from: board\n",
        "<<<<<<< HEAD\n    from: board\n",
        "remove the lines with",
    ),
    ("a language", SCHEMA, "#include <stdint.h>\nint main(void);\n", "this looks like C"),
    ("no algorithm", "CRC-16/KERMIT", "MD5", "there are xor-8, sum-8,"),
    ("variants", "CRC-16/KERMIT", "CRC-16/ZMODEMX-LIKE", "CRC-16/XMODEM"),
]


@pytest.mark.parametrize(
    ("before", "after", "hint"), [item[1:] for item in HABITS], ids=[item[0] for item in HABITS]
)
def test_a_habit_gets_a_hint(before: str, after: str, hint: str, tmp_path: Path) -> None:
    assert SCHEMA.count(before) == 1
    path = tmp_path / "schema.yaml"
    path.write_text(SCHEMA.replace(before, after), encoding="utf-8")
    compilation = compile_file(path)
    assert compilation.errors
    hints = [problem.hint or "" for problem in compilation.errors]
    assert any(hint in item for item in hints), compilation.errors


def test_parts_in_a_list_get_a_hint(tmp_path: Path) -> None:
    head, parts = SCHEMA.split("frame:\n")
    parts, rest = parts.split("transparency:")
    listed = "".join(f"  - {line.strip()}\n" for line in parts.splitlines())
    path = tmp_path / "schema.yaml"
    path.write_text(f"{head}frame:\n{listed}transparency:{rest}", encoding="utf-8")
    hints = [problem.hint for problem in compile_file(path).errors]
    assert any((hint or "").startswith("leave out the `-` or `[ ]`: `frame:`") for hint in hints)


@pytest.mark.parametrize("endpoints", ["{board: [a, b]}", "{board: {title: {a: b}}}", "[board]"])
def test_a_sender_gets_a_hint_whatever_the_endpoints_are(endpoints: str, tmp_path: Path) -> None:
    text = SCHEMA.replace("{board: Sensor board}", endpoints).replace("from: board", "from: Board")
    path = tmp_path / "schema.yaml"
    path.write_text(text, encoding="utf-8")
    assert "PG103" in {problem.code for problem in compile_file(path).errors}


def test_an_unknown_type_is_the_only_thing_that_is_said_of_it(tmp_path: Path) -> None:
    path = tmp_path / "schema.yaml"
    path.write_text(SCHEMA.replace(VALUE, "{type: snit16, range: [-500, 500]}"), encoding="utf-8")
    (problem,) = compile_file(path).errors
    assert (problem.code, problem.hint) == ("PG104", "did you mean `sint16`?")


def test_what_holds_no_names_gets_no_hint_about_a_list(tmp_path: Path) -> None:
    path = tmp_path / "schema.yaml"
    path.write_text(SCHEMA.replace(VALUE, "{type: uint16, unit: [mm]}"), encoding="utf-8")
    (problem,) = compile_file(path).errors
    assert (problem.code, problem.hint) == ("PG102", None)
