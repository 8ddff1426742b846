"""The spec hash tells whether two schemas mean the same on the wire."""

from __future__ import annotations

import pytest
from passes_support import protocol_of, repository_protocol

EXAMPLES = """\
    examples:
      first:
        frame: {hex: C0 01 FF 10 00 00 00 00 04 14 C0}
        parts: {number: 0xFF}
        values: {angle: 16}
"""

BASE = """\
protocol: demo
title: Demonstration
doc: A small protocol.
version: 1
source: {document: demo.txt, revision: 1}
link: {baud: 9600}
endpoints: {host: Host computer, robot: Robot}
byte_order: little
frame:
  start: {literal: 0xC0, doc: Starts a frame}
  id: {type: uint8, id: true, source: 5}
  number: {type: uint8, default: 0xFF}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: id..payload}
  end: {literal: 0xC0}
transparency: slip
types:
  mode: {type: uint8, values: {idle: {value: 0, doc: Does nothing}, moving: 1}}
messages:
  gyro:
    id: 1
    from: robot
    title: GYRO
    summary: What the gyroscope measures
    doc: Every 20 ms.
    source: 10-12
    fields:
      angle: {type: sint16, scale: 1/16, unit: deg, range: [-2880, 2880], doc: The angle}
      state: {type: uint8, flags: {ready: 0, failed: 7}}
      runs: {type: uint8, bits: {low: 0..3, high: 4..7}}
      mode: mode
      count: {type: uint8, const: 4, special: {none_seen: 4}}
      rest: {type: bytes, size: {fill: true, max: 8}, unknown: true}
EXAMPLES
  left: {id: 2, from: robot, fields: {range: uint16}}
  right: {id: 2, from: robot, fields: {range: uint16}}
overloads:
  sonar: {messages: [left, right], by: undecidable, yields: left, decision: one_sonar}
exchanges:
  start: {steps: [gyro]}
decisions:
  one_sonar: {question: Which one?, document: Silent., choice: The left., because: It is first.}
"""

WITH_EXAMPLES = BASE.replace("EXAMPLES\n", EXAMPLES)
WITHOUT_EXAMPLES = BASE.replace("EXAMPLES\n", "")

HASH = protocol_of(WITH_EXAMPLES).spec_hash


def changed(text: str, old: str, new: str) -> str:
    assert text.count(old) == 1, old
    return protocol_of(text.replace(old, new)).spec_hash


def test_examples_do_not_count() -> None:
    assert protocol_of(WITHOUT_EXAMPLES).spec_hash == HASH


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("title: Demonstration", "title: Other"),
        ("doc: A small protocol.", "doc: A tiny protocol."),
        ("protocol: demo\n", "# A comment.\nprotocol: demo\n"),
        ("version: 1\n", "version: 2\n"),
        ("document: demo.txt, revision: 1", "document: other.txt, revision: 2"),
        ("baud: 9600", "baud: 115200"),
        ("Host computer", "Personal computer"),
        (", doc: Starts a frame", ""),
        (", source: 5", ", source: 6"),
        (", doc: Does nothing", ", doc: Sleeps"),
        ("title: GYRO", "title: GYROSCOPE"),
        ("summary: What the gyroscope measures", "summary: Angles"),
        ("doc: Every 20 ms.", "doc: Every 40 ms."),
        ("source: 10-12", "source: 11-12"),
        (", doc: The angle", ""),
        (", unknown: true", ""),
        ("hex: C0 01 FF 10 00 00", "hex: C0 01 FF 20 00 00"),
        ("      first:\n", "      renamed:\n"),
        ("start: {steps: [gyro]}", "other: {steps: [gyro, left]}"),
        (", decision: one_sonar", ""),
        ("question: Which one?", "question: Which of them?"),
    ],
)
def test_what_people_read_does_not_count(old: str, new: str) -> None:
    assert changed(WITH_EXAMPLES, old, new) == HASH


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("protocol: demo", "protocol: other"),
        ("byte_order: little", "byte_order: big"),
        ("  start: {literal: 0xC0, doc: Starts a frame}\n", ""),
        ("number: {type: uint8", "number: {type: uint16"),
        ("number: {type: uint8", "packet: {type: uint8"),
        ("default: 0xFF", "default: 0xFE"),
        ("xor-8", "sum-8"),
        ("covers: id..payload", "covers: payload"),
        ("transparency: slip", "transparency: {preset: slip, lenient: true}"),
        ("value: 0, doc: Does nothing", "value: 2, doc: Does nothing"),
        ("moving: 1", "turning: 1"),
        ("moving: 1}", "moving: 1}, closed: true"),
        ("    id: 1\n", "    id: 3\n"),
        ("angle: {type: sint16", "angle: {type: sint17"),
        ("angle: {", "heading: {"),
        ("scale: 1/16", "scale: 1/8"),
        ("scale: 1/16", "scale: 1/16, offset: 1"),
        ("unit: deg", "unit: rad"),
        ("range: [-2880, 2880]", "range: [-2880, 2881]"),
        ("failed: 7", "failed: 6"),
        ("failed: 7", "broken: 7"),
        ("low: 0..3, high: 4..7", "low: 0..4, high: 5..7"),
        ("const: 4", "default: 4"),
        ("none_seen: 4", "none_seen: 5"),
        ("none_seen: 4", "nothing: 4"),
        ("max: 8", "max: 9"),
        ("yields: left", "yields: right"),
        ("  right: {id: 2, from: robot", "  right: {id: 2, from: [robot, host]"),
    ],
)
def test_what_is_on_the_wire_or_what_it_means_does(old: str, new: str) -> None:
    assert changed(WITHOUT_EXAMPLES, old, new) != HASH


def test_a_hash_is_sha_256_in_hex() -> None:
    assert len(bytes.fromhex(HASH)) == 32


def test_protocols_differ() -> None:
    names = ("rn1", "uherobot", "dagny", "rflex", "matty", "dialects/matty_v4")
    assert len({repository_protocol(name).spec_hash for name in names}) == len(names)
