"""`protogen encode`: frames from values and from lines of JSON."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli_support import ROOT, SINK, run, start

MATTY = str(ROOT / "schemas" / "matty.yaml")


@pytest.fixture
def sink(tmp_path: Path) -> str:
    schema = tmp_path / "sink.yaml"
    schema.write_text(SINK)
    return str(schema)


def test_frame_in_hex() -> None:
    result = run("encode", MATTY, "go", "speed=500", "steer=-2.5deg", "@counter=1")
    assert (result.exit_code, result.stdout) == (0, "55 06 01 47 F4 01 06 FF B8\n")


def test_raw_frame() -> None:
    result = start("encode", MATTY, "stop", "@counter=1", "--format", "raw")
    assert result.stdout == bytes.fromhex("55 02 01 53 AA")


def test_counter_that_is_not_given_starts_at_its_least() -> None:
    assert run("encode", MATTY, "stop").stdout == "55 02 00 53 AB\n"


def test_value_part_has_its_default(sink: str) -> None:
    # E, number FF, length 0: 45 ^ FF ^ 00 = BA.
    assert run("encode", sink, "empty").stdout == "1B 02 45 FF 00 BA 1B 03\n"
    assert run("encode", sink, "empty", "@number=0x10").stdout == "1B 02 45 10 00 55 1B 03\n"


def test_message_of_two_senders_with_one_frame(sink: str) -> None:
    frame = run("encode", sink, "numbers", "angle=0", "control=0").stdout
    assert frame == run("encode", sink, "numbers", "angle=0", "control=0", "--sender", "pc").stdout


def test_message_of_two_senders_with_two_frames(tmp_path: Path) -> None:
    schema = tmp_path / "two.yaml"
    schema.write_text("""\
protocol: two
endpoints: {pc: Computer, board: Board}
frame:
  pc:
    start: {literal: 0xC0}
    id: {type: uint8, id: true}
    payload: {}
    end: {literal: 0xC0}
  board:
    start: {literal: 0xC0}
    id: {type: uint8, id: true}
    payload: {}
    check: {type: uint8, algorithm: xor-8, covers: id}
    end: {literal: 0xC0}
transparency: slip
messages:
  ping: {id: 16, from: [pc, board]}
""")
    result = run("encode", str(schema), "ping")
    assert result.exit_code == 2
    assert "give --sender pc or board" in result.stderr
    assert run("encode", str(schema), "ping", "--sender", "board").stdout == "C0 10 10 C0\n"


@pytest.mark.parametrize(
    ("arguments", "messages"),
    [
        (["goo"], ["`matty` has no message `goo`", "did you mean `go`?"]),
        (["xyzzy"], ["it has stop, reset"]),
        (["go", "spead=1"], ["there is no field `spead`", "did you mean `speed`?"]),
        (
            ["go", "speed=1"],
            ["steer: the value is missing", "`steer` is sint16 little: a whole number"],
        ),
        (["go", "speed=99999", "steer=0"], ["speed: 99999 is not in -32768..32767"]),
        (["go", "speed=fast", "steer=0"], ["speed: `fast` is none of: a whole number from -32768"]),
        (["go", "speed"], ["`speed` is no assignment"]),
        (["go", "@count=1"], ["there is no part `count` to give", "there are counter"]),
        (["go", "@countr=1"], ["did you mean `counter`?"]),
        (["stop", "@counter=x"], ["@counter: `x` is no number"]),
        (["stop", "@counter=256"], ["counter: 256 is not in 0..255"]),
        (["stop", "--sender", "esp"], ["esp does not send `stop`; pc does"]),
        (["stop", "--sender", "pcc"], ["`matty` has no sender `pcc`"]),
        (["gps", "nmea=" + "x" * 130], ["nmea: has 130 characters"]),
        (
            ["gps", "nmea=$\xe9"],
            ["nmea: must be ASCII, characters up to U+007F", "character 2 of 2"],
        ),
        (["go", "speed=1", "steer=1.5"], ["a whole number from -32768", "unit behind it: 1.5deg"]),
        (["stop", "--format", "xml"], ["'xml' is not one of 'hex', 'raw'"]),
    ],
)
def test_mistakes(arguments: list[str], messages: list[str]) -> None:
    result = run("encode", MATTY, *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    for message in messages:
        assert message in result.stderr


@pytest.mark.parametrize(
    ("arguments", "messages"),
    [
        (
            ["what=word"],
            ["value: the value is missing", "give value.text=... value.more=..."],
        ),
        (
            ["what=word", "value.text=abcd", "value.more=1"],
            ["value.text: has 4 characters", "`value.text` is ascii[3]"],
        ),
        (
            ["what=word", "value.text=abc", "value.more=256"],
            ["value.more: 256 is not in 0..255", "`value.more` is uint8: a whole number from 0"],
        ),
        (["what=word", "value=3"], ["value: `3` is no struct", "give value.text=... value.more="]),
        (["what=speed"], ["give value.value=..."]),
        (["what=9"], ["`value` is switch(what)"]),
        (["what=word", "value.text=abc"], ["value.more: the value is missing"]),
    ],
)
def test_hints_inside_of_a_switch(sink: str, arguments: list[str], messages: list[str]) -> None:
    result = run("encode", sink, "choice", *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    for message in messages:
        assert message in result.stderr


def test_what_a_hint_says_is_taken(sink: str) -> None:
    dotted = run("encode", sink, "choice", "what=word", "value.text=abc", "value.more=1")
    as_json = run("encode", sink, "choice", "what=word", 'value={"text": "abc", "more": 1}')
    assert dotted.exit_code == 0
    assert dotted.stdout == as_json.stdout
    assert run("encode", sink, "choice", "what=speed", "value.value=3").exit_code == 0


def test_hints_inside_of_a_list(sink: str) -> None:
    points = 'points=[{"x": 1, "y": 2}, {"x": 300, "y": 1}]'
    result = run("encode", sink, "lists", points, "size=0", "levels=", "name=a", "rest=")
    assert "points[1].x: 300 is not in" in result.stderr
    assert "`points[1].x` is sint8: a whole number from -128 to 127" in result.stderr
    result = run("encode", sink, "lists", "points=[1, 2]")
    assert 'points[0]: `1` is no struct\n  hint: give JSON: {"x": ..., "y": ...}' in result.stderr


# --- lines of JSON --------------------------------------------------------------------------------


def line(**others: object) -> str:
    known = {"event": "message", "message": "stop", "sender": "pc", "parts": {"counter": 1}}
    return json.dumps({**known, "fields": {}, **others})


def test_lines() -> None:
    lines = [
        line(),
        "",
        line(raw="0011"),
        line(event="invalid", reason="noise", raw="00"),
        line(event="unknown", parts={"counter": 5, "command": 90}, payload=""),
    ]
    result = run("encode", MATTY, input="\n".join(lines))
    assert result.stdout.splitlines() == [
        "55 02 01 53 AA",
        "00 11",
        "00",
        "55 02 05 5A 9F",
    ]


def test_text_that_is_not_ascii_comes_back_from_a_capture() -> None:
    frame = "55 04 00 50 24 E9 9F"
    lines = run("decode", MATTY, "--sender", "esp", "--hex", frame, "--format", "jsonl").stdout
    assert json.loads(lines)["fields"] == {"nmea": "$\xe9"}
    assert run("encode", MATTY, input=lines).stdout == f"{frame}\n"


def test_names_may_stand_for_numbers() -> None:
    written = line(message="mode", fields={"mode": "autonomous"})
    numbers = line(message="mode", fields={"mode": 2})
    assert run("encode", MATTY, input=written).stdout == run("encode", MATTY, input=numbers).stdout


def test_sender_may_be_given_for_all_lines() -> None:
    text = json.dumps({"message": "stop", "parts": {"counter": 1}, "fields": {}})
    assert run("encode", MATTY, "--sender", "pc", input=text).stdout == "55 02 01 53 AA\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "line 1: not JSON: "),
        ("[" * 100_000, "line 1: not JSON: "),
        ('{"fields": {"ratio": 1e400}}', "line 1: not JSON: 1e400 is too large for 64 bits"),
        ("\n[1]", "line 2: must be a JSON object"),
        (line(sender="nobody"), "line 1: sender: 'nobody' sends nothing; pc, esp do"),
        (line(message="nothing"), "line 1: message: pc sends no message called 'nothing'"),
        (line(event="invalid"), "line 1: event: 'invalid' without raw bytes can't be sent"),
        (line(raw="0"), "line 1: raw: must be hexadecimal digits"),
        (line(message="go", fields={"speed": 1}), "line 1: fields.steer: the value is missing"),
    ],
)
def test_bad_lines(text: str, message: str) -> None:
    result = run("encode", MATTY, input=text)
    assert result.exit_code == 2
    assert message in result.stderr


def test_unknown_sender_with_lines() -> None:
    assert run("encode", MATTY, "--sender", "nobody", input="").exit_code == 2


TWO_FRAMES = """\
protocol: two
endpoints: {a: A, b: B}
frame:
  a: {start: {literal: 0xC0}, id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}
  b:
    start: {literal: 0xC0}
    id: {type: uint8, id: true}
    payload: {}
    sum: {type: uint8, algorithm: xor-8, covers: [id, payload]}
    end: {literal: 0xC0}
transparency: {a: slip, b: slip}
messages:
  ping: {id: 1, from: [a, b]}
"""


def test_a_message_in_different_frames_needs_its_sender(tmp_path: Path) -> None:
    schema = tmp_path / "two.yaml"
    schema.write_text(TWO_FRAMES)
    result = run("encode", str(schema), "ping")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "their frames differ" in result.stderr
    assert "give --sender a or b" in result.stderr
    assert run("encode", str(schema), "ping", "--sender", "b").stdout == "C0 01 01 C0\n"
