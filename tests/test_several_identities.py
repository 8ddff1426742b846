"""Messages with several identities, from the schema to every output."""

from __future__ import annotations

import json
from types import ModuleType
from typing import Any

import pytest
from cli_support import run
from compiled import ROOT, module_at, protocol_of
from markdown_pages import page
from passes_support import HEAD
from passes_support import protocol_of as model_of

from protogen.live.codec import module_of
from protogen.model.identities import Identities
from protogen.model.parts import IdentityPart
from protogen.model.types import Integer
from protogen.runtime.api import EncodeError

SEVERAL = ROOT / "tests" / "framings" / "several_identities.yaml"
RANGES = ROOT / "tests" / "framings" / "identity_ranges.yaml"
ENGINES = ["fast", "construct"]


@pytest.fixture(scope="module")
def several() -> ModuleType:
    return module_at(SEVERAL)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_encoder_writes_the_first_or_what_it_is_given(several: Any, engine: str) -> None:
    ping = several.Ping()
    assert several.encode(ping, engine=engine) == bytes.fromhex("7E 02 00 00 02")
    assert several.encode(ping, engine=engine, version=1) == bytes.fromhex("7E 01 00 00 01")
    assert several.Encoder("station").encode(ping, version=1) == bytes.fromhex("7E 01 00 00 01")


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("strict", [True, False])
@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"version": 3}, "version: 3 is not ping, whose version is 2 or 1"),
        ({"id": 1}, "id: 1 is not ping, whose id is 0"),
        ({"version": "2"}, "version: must be an integer"),
        ({"version": 1.5}, "version: must be an integer"),
    ],
)
def test_another_identity_is_refused(
    several: Any, engine: str, strict: bool, parts: Any, words: str
) -> None:
    with pytest.raises(EncodeError, match=words):
        several.encode(several.Ping(), strict=strict, engine=engine, **parts)


@pytest.mark.parametrize("engine", ENGINES)
def test_the_only_value_of_a_part_may_be_given(several: Any, engine: str) -> None:
    wire = several.encode(several.Ping(), engine=engine, version=1, id=0)
    assert wire == bytes.fromhex("7E 01 00 00 01")


def test_the_class_knows_all_of_them(several: Any) -> None:
    assert several.Ping.IDENTITY == (2, 0)
    assert list(several.Ping.IDENTITIES) == [(2, 0), (1, 0)]
    assert (5, 0x4F) in several.Wind.IDENTITIES
    assert (5, 0x50) not in several.Wind.IDENTITIES
    assert several.Levels.IDENTITIES is None


def test_a_line_of_json_says_which_one_it_was(several: Any) -> None:
    wire = several.encode(several.Ping(), version=1)
    (event,) = several.Decoder("station").feed(wire)
    line = event.as_json()
    assert line["parts"] == {"version": 1, "id": 0}
    assert "raw" not in line
    assert several.PROTOCOL.encode_line(json.loads(json.dumps(line))) == wire


def test_no_identity_of_a_message_is_unknown(several: Any) -> None:
    with pytest.raises(EncodeError, match=r"version: \(1, 0\) is the identity of ping"):
        several.PROTOCOL.encode_unknown("station", {"version": 1, "id": 0}, b"")


def test_the_command_line_takes_and_shows_it() -> None:
    made = run("encode", str(RANGES), "level", "level=300", "@start=0x9A")
    assert made.output.split() == ["9A", "2C", "02"]
    assert "90 2C 02" in run("encode", str(RANGES), "level", "level=300").output
    shown = run("decode", str(RANGES), "--hex", "9A 2C 02").output
    assert "level" in shown and "@start=154" in shown
    explained = run("explain", str(RANGES), "--hex", "E5 64").output
    assert "rain" in explained and "229" in explained


def test_the_reference_lists_them() -> None:
    text = page(protocol_of(RANGES), "gauges.md")
    assert "`0x90`..`0x9F` level" in text
    assert "`0xE1`, `0xE4`..`0xE7`" in text


WIDE = """\
frame:
  sync: {literal: 0x55, unprotected: accepted}
  id: {type: uint32, id: true}
  length: {type: uint8, counts: payload}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: id..payload}
messages:
  low: {id: {range: [0, 0x7FFFFFFF]}, from: robot, fields: {a: uint8}}
  high: {id: [0x80000000, {range: [0x80000002, 0xFFFFFFFF]}], from: robot, fields: {a: uint8}}
decisions: {accepted: {question: q, document: d, choice: c, because: b}}
"""


def test_a_range_may_be_as_wide_as_its_part() -> None:
    module: Any = module_of(model_of(HEAD + WIDE))
    for value, name in [
        (0, "low"),
        (0x7FFFFFFF, "low"),
        (0x80000000, "high"),
        (0xFFFFFFFF, "high"),
    ]:
        wire = module.encode(module.MESSAGES[name](a=1), id=value)
        (event,) = module.Decoder("robot").feed(wire)
        assert (event.message.NAME, event.parts.id, event.raw) == (name, value, wire)
    unknown = module.PROTOCOL.encode_unknown("robot", {"id": 0x80000001}, b"\0")
    assert [event.kind for event in module.Decoder("robot").feed(unknown)] == ["unknown"]


class TestIdentities:
    RUNS = Identities((((1, 3), (7, 7)), ((0, 1),)))

    def test_all_values_of_the_parts_make_them_up_together(self) -> None:
        assert self.RUNS.count == len(list(self.RUNS)) == 8
        assert self.RUNS.first == (1, 0)
        assert (7, 1) in self.RUNS
        assert (4, 1) not in self.RUNS
        one, other = (
            IdentityPart(name=name, type=Integer(bits=8), least=0, greatest=255) for name in "ab"
        )
        assert self.RUNS.shown([one, other]) == "0x01..0x03, 0x07 0x00..0x01"

    def test_one_that_two_have_in_common(self) -> None:
        assert self.RUNS.meet(Identities((((3, 9),), ((1, 5),)))) == (3, 1)
        assert self.RUNS.meet(Identities((((4, 6),), ((1, 5),)))) is None
        assert self.RUNS.meet(Identities((((1, 1),),))) is None

    def test_neighbours_cover_what_reaches_over_both(self) -> None:
        joined = Identities((((4, 6), (1, 3)), ((0, 9),)))
        assert joined.covers(Identities((((2, 5),), ((0, 1),))))
        assert not joined.covers(self.RUNS)
