"""The fuzzer: its samples hold every boundary, and it finds what an engine does wrong."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from functools import cache
from itertools import islice
from pathlib import Path
from random import Random
from typing import Any

import handwritten_matty
import pytest
from cli_support import ROOT, SINK, compiled, run

from protogen.compiler import compile_file
from protogen.copying import replace
from protogen.fuzzing.engine import NOTHING_TOLD, Refused, Seen, Told
from protogen.fuzzing.python_engine import PythonEngine
from protogen.fuzzing.samples import NOTHING_HELD, Held, Values, boundary_rounds, samples
from protogen.fuzzing.trips import case_count, cases, same, smallest, try_case
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol

# --- samples --------------------------------------------------------------------------------------


def taken(message: str, sender: str, more: int = 30) -> list[tuple[Values, Values]]:
    protocol = compiled(SINK)
    frame = protocol.sender(sender).frame
    count = boundary_rounds(protocol.message(message), frame)
    found = list(islice(samples(protocol.message(message), frame, Random(1)), count + more))
    assert len(found) == count + more
    return found


def boundaries(message: str, sender: str) -> list[Values]:
    return [values for values, _ in taken(message, sender, more=0)]


@pytest.mark.parametrize(
    ("field", "expected"),
    [
        ("mode", {0, 7, 255, 1}),
        ("strict_mode", {1, 2}),
        ("angle", {-2880, 2880, 0x7FFF, 0, 1, -1}),
        ("flags", {0, 1, 2, 0x80, 255}),
        ("control", {0, 0x3F, 0xC0, 255}),
        ("on_line", {0, 1}),
        ("odd", {0x010203}),
    ],
)
def test_boundaries_of_integers(field: str, expected: set[int]) -> None:
    assert expected <= {values[field] for values in boundaries("numbers", "pc")}


def test_closed_enums_and_constants_have_no_other_value() -> None:
    for values, _ in taken("numbers", "pc", more=200):
        assert values["strict_mode"] in {1, 2}
        assert values["odd"] == 0x010203
        assert -2880 <= values["angle"] <= 2880 or values["angle"] == 0x7FFF


def test_floats_that_are_no_ordinary_numbers() -> None:
    ratios = [values["ratio"] for values in boundaries("numbers", "pc")]
    assert {"nan", "inf", "-inf"} <= set(ratios)
    assert any(isinstance(ratio, float) and ratio > 3.4e38 for ratio in ratios)


def test_counts_agree_with_what_they_count() -> None:
    found = taken("lists", "pc", more=100)
    assert all(len(values["levels"]) == values["size"] for values, _ in found)
    assert {values["size"] for values, _ in found} == {0, 1, 2, 3}


def test_texts_and_bytes_are_empty_and_full() -> None:
    found = boundaries("lists", "pc")
    assert {len(values["rest"]) // 2 for values in found} >= {0, 8}
    assert {len(values["name"]) for values in found} == {0, 4}


def test_texts_are_ascii_as_strict_encoding_wants_them() -> None:
    texts = "".join(values["name"] for values, _ in taken("lists", "pc", more=200))
    assert max(texts) == "\x7f"


def test_every_case_and_none_of_them() -> None:
    found = boundaries("choice", "board")
    whats = {values["what"] for values in found}
    assert {0, 1, 2} < whats
    assert all(values["value"] is None for values in found if values["what"] == 0)
    numbers = {values["value"]["value"] for values in found if values["what"] == 1}
    assert {0, 0xFFFF} <= numbers
    assert all(isinstance(values["value"], str) for values in found if values["what"] > 2)


def test_parts_have_boundaries_too() -> None:
    assert {parts["number"] for _, parts in taken("empty", "pc")} >= {0, 255}


RANGED = """\
protocol: ranged
endpoints: {pc: Computer}
byte_order: big
frame:
  id: {type: uint8, id: true, range: [1, 1]}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: payload}
messages:
  one:
    id: 1
    from: pc
    fields:
      third: {type: float32, range: [0.1, 0.3]}
      fixed: {type: float64, const: 1.5}
      word: {type: ascii, size: 2, const: ab}
      mark: {type: bytes, size: 2, const: {hex: 01FF}}
      pair: {type: uint8, count: 2, const: [3, 4]}
"""


def test_ranges_of_floats_and_constants() -> None:
    protocol = compiled(RANGED)
    frame = protocol.sender("pc").frame
    for values, _ in islice(samples(protocol.message("one"), frame, Random(1)), 50):
        third = values["third"]
        assert 0.1 <= third <= 0.3
        assert struct.unpack("<f", struct.pack("<f", third)) == (third,)
        assert values["fixed"] == 1.5
        assert (values["word"], values["mark"], values["pair"]) == ("ab", "01ff", [3, 4])


COUNTED = """\
protocol: counted
endpoints: {pc: Computer}
frame: {id: {type: uint8, id: true, range: [1, 1]}, payload: {}, check: {type: uint8,
  algorithm: xor-8, covers: payload}}
types:
  pair: {fields: {x: uint8, levels: {type: uint8, count: outer}}}
messages:
  one:
    id: 1
    from: pc
    fields:
      few: {type: uint8, values: {none_at_all: 0, two: 2}, closed: true}
      names: {type: ascii, size: few}
      outer: {type: uint8, range: [1, 5]}
      first: {type: uint8, count: outer}
      pair: {type: pair}
      raw: {type: bytes, size: outer}
"""


def test_one_count_for_several_and_a_count_that_is_an_enum() -> None:
    protocol = compiled(COUNTED)
    frame = protocol.sender("pc").frame
    for values, _ in islice(samples(protocol.message("one"), frame, Random(1)), 80):
        assert len(values["names"]) == values["few"]
        assert values["few"] in {0, 2}
        lengths = {len(values["first"]), len(values["pair"]["levels"]), len(values["raw"]) // 2}
        assert lengths == {values["outer"]}
        assert 1 <= values["outer"] <= 5


BOUNDED = """\
protocol: bounded
endpoints: {a: A, b: B}
byte_order: little
frame:
  sync: {literal: 0x55, unprotected: accepted}
  length: {type: uint8, counts: payload, range: [5, 40]}
  id: {type: uint8, id: true}
  payload: {}
  sum: {type: uint8, algorithm: xor-8, covers: id..payload}
decisions:
  accepted: {question: May it occur?, document: Silent., choice: Yes., because: The sum tells.}
types:
  item: {fields: {n: uint8, data: {type: bytes, size: n}}}
messages:
  raw: {id: 1, from: a, fields: {all: {type: bytes, size: fill}}}
  words: {id: 2, from: a, fields: {first: uint8, all: {type: uint16, count: fill}}}
  items: {id: 3, from: a, fields: {all: {type: item, count: fill}}}
"""


def test_samples_have_the_sizes_that_the_length_part_allows(tmp_path: Path) -> None:
    path = tmp_path / "bounded.yaml"
    path.write_text(BOUNDED)
    protocol = compile_file(path).protocol
    assert protocol is not None
    sizes: dict[str, set[int]] = {"raw": set(), "words": set(), "items": set()}
    for case in cases(protocol, 200, 1):
        values = case.values["all"]
        match case.message:
            case "raw":
                size = len(bytes.fromhex(values))
            case "words":
                size = 1 + 2 * len(values)
            case _:
                size = sum(1 + item["n"] for item in values)
                assert all(len(item["data"]) == 2 * item["n"] for item in values)
        sizes[case.message].add(size)
    assert {min(found) for found in sizes.values()} == {5}
    assert [max(found) for found in sizes.values()] == [40, 39, 40]
    engine = PythonEngine(module_of(protocol).PROTOCOL)
    assert not any(try_case(engine, protocol, case).problem for case in cases(protocol, 50, 1))


# --- cases ----------------------------------------------------------------------------------------


@cache
def matty() -> Protocol:
    protocol = compile_file(ROOT / "schemas" / "matty.yaml").protocol
    assert protocol is not None
    return protocol


def test_a_seed_gives_the_same_cases() -> None:
    assert list(cases(matty(), 10, 5)) == list(cases(matty(), 10, 5))
    assert list(cases(matty(), 10, 5)) != list(cases(matty(), 10, 6))


def test_one_message_has_the_same_cases_as_among_others() -> None:
    among = [case for case in cases(matty(), 20, 5) if case.message == "go"]
    assert list(cases(matty(), 20, 5, "go")) == among
    assert case_count(matty(), 20, "go") == len(among) == 20


def test_boundaries_are_taken_even_if_fewer_are_asked_for() -> None:
    assert case_count(matty(), 1) == len(list(cases(matty(), 1, 5))) > len(matty().messages)


# --- trips ----------------------------------------------------------------------------------------


class Broken(PythonEngine):
    """An engine with one mistake."""

    def __init__(self) -> None:
        super().__init__(handwritten_matty.PROTOCOL)


class ForgetsSign(Broken):
    def values(self, message: str, payload: bytes, held: Held = NOTHING_HELD) -> Values:
        return {name: abs(value) for name, value in super().values(message, payload).items()}


class LosesFrames(Broken):
    def events(self, sender: str, pieces: Sequence[bytes], told: Told = NOTHING_TOLD) -> list[Seen]:
        return []


class MindsChunks(Broken):
    def events(self, sender: str, pieces: Sequence[bytes], told: Told = NOTHING_TOLD) -> list[Seen]:
        return super().events(sender, pieces, told) if len(pieces) == 1 else []


class RefusesMuch(Broken):
    def payload(self, message: str, values: Values) -> bytes:
        raise Refused("speed: no")


class RefusesFrames(Broken):
    def frame(self, sender: str, message: str, values: Values, parts: Values) -> bytes:
        raise Refused("payload: a decoder would end the frame behind 4 of its 9 bytes")


class Crashes(Broken):
    def values(self, message: str, payload: bytes, held: Held = NOTHING_HELD) -> Values:
        raise KeyError("speed")


def changes(**others: Any) -> type[Broken]:
    class Changes(Broken):
        def events(
            self, sender: str, pieces: Sequence[bytes], told: Told = NOTHING_TOLD
        ) -> list[Seen]:
            return [replace(seen, **others) for seen in super().events(sender, pieces, told)]

    return Changes


def problems(engine: PythonEngine) -> set[str]:
    outcomes = [try_case(engine, matty(), case) for case in cases(matty(), 5, 1, "go")]
    return {" ".join(outcome.problem.split(" ")[:4]) for outcome in outcomes} - {""}


def test_a_good_engine_passes() -> None:
    assert problems(PythonEngine(handwritten_matty.PROTOCOL)) == set()


@pytest.mark.parametrize(
    ("broken", "problem"),
    [
        (LosesFrames, "the frame decodes to"),
        (MindsChunks, "byte by byte it"),
        (RefusesMuch, "refused: speed: no"),
        (RefusesFrames, "refused: payload: a decoder"),
        (Crashes, "raised KeyError: 'speed'"),
        (changes(kind="unknown"), "the frame decodes to"),
        (changes(size=1), "the frame decodes to"),
        (changes(payload=b""), "the frame carries another"),
        (changes(message="stop"), "the frame decodes to"),
        (changes(values={}), "the frame decodes to"),
        (changes(parts={}), "the frame decodes to"),
    ],
)
def test_mistakes_are_found(broken: type[Broken], problem: str) -> None:
    assert {found[: len(problem)] for found in problems(broken())} == {problem}


def test_what_an_engine_refuses_is_a_finding() -> None:
    case = next(cases(matty(), 1, 1, "go"))
    engine = PythonEngine(handwritten_matty.PROTOCOL)
    too_much = replace(case, values={"speed": 99999, "steer": 0})
    problem = "refused: speed: 99999 is not in -32768..32767"
    assert try_case(engine, matty(), too_much).problem.startswith(problem)
    no_part = replace(case, parts={"counter": 256})
    assert try_case(engine, matty(), no_part).problem.startswith("refused: counter: 256")


def test_a_failure_is_made_smaller() -> None:
    outcomes = (try_case(ForgetsSign(), matty(), case) for case in cases(matty(), 100, 1, "go"))
    failure = next(outcome for outcome in outcomes if outcome.case.values["steer"] < -1)
    small = smallest(ForgetsSign(), matty(), failure)
    assert small.problem
    changed = [name for name, value in small.case.values.items() if value != -32768]
    assert len(changed) <= 1


CUT = """\
protocol: cut
endpoints: {pc: Computer}
frame:
  id: {type: char, id: true}
  payload: {}
  end: {literal: 10, unprotected: newline}
messages:
  any: {id: A, from: pc, fields: unspecified, max_size: 9}
decisions:
  newline: {question: A, document: B, choice: C, because: D}
"""


def test_an_engine_may_refuse_what_would_be_cut_elsewhere() -> None:
    class Echo:
        name = "echo"

        def payload(self, message: str, values: Values) -> bytes:
            return bytes.fromhex(values["data"])

        def values(self, message: str, payload: bytes, held: Held = NOTHING_HELD) -> Values:
            return {"data": payload.hex()}

        def frame(self, sender: str, message: str, values: Values, parts: Values) -> bytes:
            raise Refused("payload: a decoder would end the frame elsewhere")

        def events(
            self, sender: str, pieces: Sequence[bytes], told: Told = NOTHING_TOLD
        ) -> list[Seen]:
            return []

    protocol = compiled(CUT)
    outcome = try_case(Echo(), protocol, next(cases(protocol, 1, 1)))
    assert outcome.problem == ""
    assert outcome.refused == "payload: a decoder would end the frame elsewhere"


@pytest.mark.parametrize(
    ("left", "right", "equal"),
    [
        (0.0, -0.0, False),
        (-0.0, -0.0, True),
        (True, 1, True),
        ([0.0], [-0.0], False),
        ({"a": [1, {"b": 0.0}]}, {"a": [1, {"b": 0.0}]}, True),
        ({"a": 1}, {"b": 1}, False),
        ([1], [1, 2], False),
        (math.inf, math.inf, True),
    ],
)
def test_equality_of_values(left: object, right: object, equal: bool) -> None:
    assert same(left, right) is equal


NEVER = """\
protocol: never
endpoints: {device: Device}
decisions:
  newline: {question: Can the end be inside?, document: silent, choice: yes, because: no stuffing}
frame:
  kind: {type: char, id: true}
  payload: {}
  end: {literal: {hex: 0D 0A}, unprotected: newline}
messages:
  note:
    id: N
    from: device
    fields:
      mark: {type: bytes, size: 2, const: {hex: 0D 0A}}
      text: {type: bytes, size: {fill: true, max: 4}}
"""


def test_a_message_that_can_never_be_encoded_fails(tmp_path: Path) -> None:
    path = tmp_path / "never.yaml"
    path.write_text(NEVER, encoding="utf-8")
    done = run("fuzz", str(path), "--examples", "20")
    assert done.exit_code == 1
    assert "note through construct: no sample can be encoded: payload: a decoder" in done.stdout
    assert "all came back" not in done.stdout
