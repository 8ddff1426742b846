"""FIELD=VALUE: what people write, and what that is on the wire."""

from __future__ import annotations

import math
from typing import Any

import pytest
from cli_support import SINK, compiled

from protogen.cli.exits import UsageError
from protogen.cli.wire.values import raw_values, split_assignment, tree_of


def raw(message: str, *assignments: str) -> dict[str, Any]:
    steps = compiled(SINK).message(message).plan.steps
    return raw_values(steps, tree_of(map(split_assignment, assignments)))


@pytest.mark.parametrize(
    ("assignment", "field", "value"),
    [
        ("angle=5", "angle", 5),
        ("angle=-0x10", "angle", -16),
        ("angle=90deg", "angle", 1440),
        ("angle=-1/16 deg", "angle", -1),
        ("angle=12.5deg", "angle", 200),
        ("angle=missing", "angle", 0x7FFF),
        ("mode=run", "mode", 7),
        ("mode=9", "mode", 9),
        ("flags=ready|wet", "flags", 0x81),
        ("flags=ready|0x40", "flags", 0x41),
        ("flags.hot=1", "flags", 2),
        ("flags.hot=true", "flags", 2),
        ("control.gear=rear", "control", 0xC0),
        ("control.speed=0x3F", "control", 0x3F),
        ("letter='N'", "letter", 0x4E),
        ("letter=N", "letter", 0x4E),
        ("letter=5", "letter", 5),
        ("letter='5'", "letter", 0x35),
        ("on_line=true", "on_line", 1),
        ("ratio=1.5", "ratio", 1.5),
        ("ratio=1.5V", "ratio", 3.0),
        ("ratio=-inf", "ratio", -math.inf),
        ("letter={", "letter", 0x7B),
        ("flags={}", "flags", 0),
    ],
)
def test_numbers(assignment: str, field: str, value: object) -> None:
    assert raw("numbers", assignment) == {field: value}


def test_several_bits_of_one_integer() -> None:
    assert raw("numbers", "control.gear=first", "control.speed=5") == {"control": 0x45}


def test_bits_as_json() -> None:
    assert raw("numbers", 'control={"gear": "first", "speed": 5}') == {"control": 0x45}


def test_lists_and_structs() -> None:
    points = 'points=[{"x": -1, "y": "3mm"}, {"x": 1, "y": 4}]'
    assert raw("lists", points, "levels=1,0x10", "name=ab") == {
        "points": [{"x": -1, "y": 3}, {"x": 1, "y": 4}],
        "levels": [1, 16],
        "name": "ab",
    }


@pytest.mark.parametrize("written", ["hex:1B 02", "hex:1b02", "1b02", r"hex:\x1b\x02"])
def test_bytes_in_hex(written: str) -> None:
    assert raw("lists", f"rest={written}") == {"rest": "1b02"}


def test_bytes_as_text() -> None:
    assert raw("lists", "rest=text:a=b") == {"rest": "613d62"}


def test_empty_list() -> None:
    assert raw("lists", "levels=") == {"levels": []}


def test_cases_of_a_switch() -> None:
    assert raw("choice", "what=nothing") == {"what": 0, "value": None}
    assert raw("choice", "what=speed", "value=300") == {"what": 1, "value": {"value": 300}}
    assert raw("choice", "what=word", "value.text=abc", "value.more=1") == {
        "what": 2,
        "value": {"text": "abc", "more": 1},
    }
    assert raw("choice", "what=9", "value=0102") == {"what": 9, "value": "0102"}


@pytest.mark.parametrize(
    ("message", "assignments", "error", "hint"),
    [
        ("numbers", ["mod=1"], "there is no field `mod`", "did you mean `mode`?"),
        ("empty", ["x=1"], "there is no field `x`", "there are none"),
        (
            "lists",
            ['points=[{"z": 1}]'],
            "there is no field `points[0].z`",
            "there are x, y",
        ),
        (
            "numbers",
            ["angle=90.03deg"],
            "angle: `90.03deg` is no whole number of steps of 0.0625deg",
            "the nearest that can be sent is 90deg",
        ),
        (
            "numbers",
            ["mode=ran"],
            "mode: `ran` is none of: a whole number from 0 to 255, idle, run",
            "did you mean `run`?",
        ),
        (
            "numbers",
            ["angle=far"],
            "angle: `far` is none of: a whole number from -2880 to 2880, a number with its unit",
            None,
        ),
        (
            "numbers",
            ["letter=NO"],
            "letter: `NO` is none of: a whole number from 0 to 255, a character",
            None,
        ),
        (
            "numbers",
            ["control.gear=4"],
            "control.gear: `4` is none of: a whole number from 0 to 3, first, rear",
            None,
        ),
        (
            "numbers",
            ["control.gaer=1"],
            "control has no bits called `gaer`",
            "did you mean `gear`?",
        ),
        (
            "numbers",
            ["flags=redy,hot"],
            "flags: `redy,hot` is none of: a whole number from 0 to 255, ready, hot, wet",
            "flags are joined by `|`, in quotes for the shell: 'ready|hot'",
        ),
        (
            "numbers",
            ["angle=12.5"],
            "angle: `12.5` is none of: a whole number from -2880 to 2880, a number with its unit",
            "a value in deg has its unit behind it: 12.5deg",
        ),
        (
            "numbers",
            ["angle=12.51"],
            "angle: `12.51` is none of: a whole number",
            "a value in deg has its unit behind it: 12.5deg",
        ),
        ("numbers", ["mode=1.5"], "mode: `1.5` is none of: a whole number from 0 to 255", None),
        ("numbers", ["flags=[1]"], "flags: `[1]` is none of: a whole number from 0 to 255", ...),
        ("numbers", ["ratio=fast"], 'ratio: "fast" is none of: a number', None),
        ("numbers", ["mode={}"], "mode: {} is none of: a whole number from 0 to 255", ...),
        ("numbers", ["angle={}"], "angle: {} is none of: a whole number", ...),
        ("numbers", ["on_line={}"], "on_line: {} is none of: a whole number", ...),
        ("numbers", ["letter={}"], "letter: {} is none of: a whole number", ...),
        ("lists", ["levels=[true]"], "levels[0]: `true` is none of: a whole number", ...),
        ("numbers", ["angle=1e999999999deg"], "angle: `1e999999999deg` is none of", ...),
        ("numbers", ["angle=1e99999999"], "angle: `1e99999999` is none of", ...),
        ("numbers", ["ratio=1e999999999V"], 'ratio: "1e999999999V" is none of: a number', ...),
        ("numbers", ["ratio=1e999V"], "ratio: `1e999V` is too large for 64 bits", ...),
        ("numbers", ["ratio=1e400"], "ratio: `1e400` is too large for 64 bits", ...),
        ("lists", ["levels=[1e400]"], "1e400 is too large for 64 bits", ...),
        ("numbers", ["mode=1", "mode=2"], "`mode` is given twice", None),
        ("numbers", ["flags=1", "flags.hot=1"], "`flags.hot` is given twice", None),
        ("numbers", ["mode"], "`mode` is no assignment", "write FIELD=VALUE, or @PART=VALUE"),
        ("numbers", ["=3"], "`=3` is no assignment", ...),
        ("lists", ["points=3"], "points[0]: `3` is no struct", 'give JSON: {"x": ..., "y": ...}'),
        ("lists", ["points={}"], "points: a list is written `1,2,3` or as JSON", ...),
        ("lists", ["points=[{]"], "points: `[{]` is not JSON", ...),
        ("lists", ["levels=[1.5]"], "levels[0]: 1.5 is none of: a whole number", ...),
        ("lists", ["levels.a=1"], "levels: a list is written `1,2,3` or as JSON", ...),
        ("lists", ["rest=hex:1"], "rest: `hex:1`: line 1, column 1", ...),
        ("lists", ["rest=text:\u20ac"], "rest: `\u20ac` is not one byte", None),
        ("choice", ["value=3"], "value: `what` says what this is; give it, too", None),
        ("choice", ["what=word", "value.more=[]"], "value.more: `[]` is none of", ...),
    ],
)
def test_mistakes(message: str, assignments: list[str], error: str, hint: object) -> None:
    with pytest.raises(UsageError) as caught:
        raw(message, *assignments)
    assert error in str(caught.value)
    if hint is not ...:
        assert caught.value.hint == hint


def test_values_of_a_wrong_kind_in_json() -> None:
    steps = compiled(SINK).message("lists").plan.steps
    for written in ({"name": 3}, {"rest": 3}, {"size": [1]}, {"points": 3}, {"points": [3]}):
        with pytest.raises(UsageError):
            raw_values(steps, written)
