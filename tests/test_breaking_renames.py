"""Renames that change nothing but words, and those that may hide another meaning.

Each pair is the schema below with some edits, the rules of WIRE and VALUE that have to stop it, and
the reason. Where nothing stops it, each frame of one version is read alike by the other: what only
has another name lies at the same bytes.
"""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import NamedTuple

import pytest

from protogen.compiler import compile_file
from protogen.evolution.findings import findings
from protogen.fuzzing.samples import samples
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol

SCHEMA = """\
protocol: demo
endpoints: {host: Computer, board: Sensor board}
byte_order: little
frame:
  start:   {literal: 0xAA}
  kind:    {type: uint8, id: true}
  payload: {}
  crc:     {type: uint16, algorithm: CRC-16/KERMIT, covers: [kind, payload]}
transparency:
  covers: kind..crc
  substitute: {0xAA: [0xAB, 0x01], 0xAB: [0xAB, 0x02]}
messages:
  lamp:  {id: 1, from: host, fields: {level: uint8}}
  drive: {id: 2, from: host, fields: {left: sint16, right: sint16}}
  stop:  {id: 3, from: host}
  state:
    id: 4
    from: board
    fields:
      mode:  {type: uint8, values: {idle: 0, run: 1}}
      lamps: {type: uint8, flags: {hot: 0, wet: 1}}
      gear:  {type: uint8, bits: {step: 0..2, rest: 3..7}}
      place: {fields: {x: sint16, y: sint16}}
      n:     {type: uint8, range: [0, 4]}
      list:  {type: uint16, count: n}
      tag:   {type: uint8, values: {small: 0, large: 1}}
      body:  {switch: tag, cases: {small: uint8, large: uint16}}
      way:   {type: uint16, unit: mm}
      speed: {type: sint16, unit: m/s}
"""


class Pair(NamedTuple):
    reason: str
    edits: tuple[tuple[str, str], ...]
    stops: tuple[str, ...] = ()


PAIRS = [
    # What may hide another meaning.
    Pair(
        "a lamp's level may have become rounds to fire",
        (("lamp:  {id: 1", "fire:  {id: 1"), ("level: uint8", "rounds: uint8")),
        ("identity-reused", "message-deleted"),
    ),
    Pair(
        "wheels may have become a turret",
        (("drive: {id: 2", "aim: {id: 2"), ("left: sint16, right: s", "pan: sint16, tilt: s")),
        ("identity-reused", "message-deleted"),
    ),
    Pair(
        "the names say that left and right were swapped",
        (("left: sint16, right: s", "right_speed: sint16, left_speed: s"),),
        ("field-reused", "field-reused"),
    ),
    Pair(
        "nothing in the names says which was which",
        (("left: sint16, right: s", "pan: sint16, tilt: s"),),
        ("field-reused", "field-reused"),
    ),
    Pair(
        "the names of values were swapped",
        (("idle: 0, run: 1", "run_1: 0, idle_1: 1"),),
        ("enum-value",) * 2,
    ),
    Pair(
        "the names of flags were swapped",
        (("hot: 0, wet: 1", "wet_1: 0, hot_1: 1"),),
        ("flag-moved",) * 2,
    ),
    Pair(
        "two runs of bits were swapped",
        (("step: 0..2, rest: 3..7", "rest: 0..4, step: 5..7"),),
        ("bits",),
    ),
    Pair(
        "fields of a struct were swapped",
        (("x: sint16, y: s", "y_2: sint16, x_2: s"),),
        ("field-reused",) * 2,
    ),
    # What only has another name.
    Pair(
        "the schema says it",
        (
            ("lamp:  {id: 1,", "fire:  {id: 1, renamed_from: lamp,"),
            ("level: uint8", "rounds: {type: uint8, renamed_from: level}"),
        ),
    ),
    Pair(
        "the schema says it of both",
        (
            (
                "left: sint16, right: sint16",
                "pan: {type: sint16, renamed_from: left}, "
                "tilt: {type: sint16, renamed_from: right}",
            ),
        ),
    ),
    Pair("a message with the same fields", (("lamp:  {id: 1", "light: {id: 1"),)),
    Pair(
        "each name is like its own",
        (("left: sint16, right: s", "left_speed: sint16, right_speed: s"),),
    ),
    Pair("a field with an inline enum", (("mode:  {", "state_mode:  {"),)),
    Pair("a field with inline flags", (("lamps: {", "lights: {"),)),
    Pair("a field that is a struct", (("place: {", "position: {"),)),
    Pair("a field that is a union", (("body:  {", "content:  {"),)),
    Pair("an array", (("list:  {", "ways:  {"),)),
    Pair(
        "the field that counts an array", (("n:     {", "number: {"), ("count: n", "count: number"))
    ),
    Pair("the field that selects", (("tag:   {", "form: {"), ("switch: tag", "switch: form"))),
    Pair("a run of bits", (("step: 0..2", "stage: 0..2"),)),
    # What is written in another way.
    Pair("the order of runs of bits", (("step: 0..2, rest: 3..7", "rest: 3..7, step: 0..2"),)),
    Pair(
        "the order of substitutes",
        (("0xAA: [0xAB, 0x01], 0xAB: [0xAB, 0x02]", "0xAB: [0xAB, 0x02], 0xAA: [0xAB, 0x01]"),),
    ),
    Pair(
        "a checksum by its parameters",
        (
            (
                "CRC-16/KERMIT",
                "{width: 16, poly: 0x1021, init: 0, refin: true, refout: true, xorout: 0}",
            ),
        ),
    ),
    Pair("1 mm is 1/1000 m", (("unit: mm", "unit: m, scale: 1/1000"),)),
    Pair("1 m/s is 3.6 km/h", (("unit: m/s", "unit: km/h, scale: 18/5"),)),
]


def compiled(path: Path, text: str) -> Protocol:
    path.write_text(text, encoding="utf-8")
    compilation = compile_file(path)
    assert compilation.protocol is not None, compilation.problems
    return compilation.protocol


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: pair.reason)
def test_renames(pair: Pair, tmp_path: Path) -> None:
    text = SCHEMA
    for before, now in pair.edits:
        assert text.count(before) == 1, before
        text = text.replace(before, now)
    old, new = compiled(tmp_path / "old.yaml", SCHEMA), compiled(tmp_path / "new.yaml", text)
    for one, other in ((old, new), (new, old)):
        names = [f.rule.name for f in findings(one, other)[1] if f.category in ("WIRE", "VALUE")]
        if one is old or not pair.stops:
            back = "renamed_from" in text and one is new  # Nothing says it on the way back.
            assert back or sorted(names) == sorted(pair.stops), names
    if not pair.stops:
        check_same_bytes(old, new)


def check_same_bytes(old: Protocol, new: Protocol) -> None:
    """Check with frames that each field, in its order, has the same raw value in both."""
    modules = [module_of(protocol) for protocol in (old, new)]
    for sender in old.senders:
        for message in sender.messages:
            drawn = samples(message, sender.frame, Random(1))
            for (values, _), _ in zip(drawn, range(8), strict=False):
                kind = modules[0].MESSAGES[message.name]
                frame = modules[0].encode(kind.from_dict(values))
                read = [list_of(module.decode(frame, sender.name).to_dict()) for module in modules]
                assert read[0] == read[1]


def list_of(value: object) -> object:
    """The value without names."""
    if isinstance(value, dict):
        return [list_of(item) for item in value.values()]
    return [list_of(item) for item in value] if isinstance(value, list) else value
