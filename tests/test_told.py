"""Identities that are not sent: a decoder is told them, by its program or by other frames."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

import pytest
from c_engine import check_events, process_of
from cli_support import run
from compiled import ROOT, module_at, name_of, protocol_of
from corpus import material_of, portions
from hypothesis import given
from hypothesis import strategies as st
from test_c_decoder import ALL, MESSAGES, SEEDS

from protogen.capture import CaptureError, columns
from protogen.fuzzing.c_calls import Step
from protogen.model.parts import ToldLength

FOLDER = ROOT / "tests" / "told_schemas"
ANSWERS, MODES = FOLDER / "answers.yaml", FOLDER / "modes.yaml"
LENGTHS = FOLDER / "lengths.yaml"
ENDPOINTS = [
    (ANSWERS, "gauge"),
    (ANSWERS, "probe"),
    (MODES, "motor"),
    (MODES, "motor_answer"),
    (LENGTHS, "store"),
    (LENGTHS, "radar"),
    (LENGTHS, "meter"),
    (LENGTHS, "meter_alarm"),
]
EVERY_ENDPOINT = pytest.mark.parametrize(("path", "endpoint"), ENDPOINTS, ids=name_of)
ENGINE = pytest.mark.parametrize("engine", ["fast", "construct"])

LEVEL = bytes.fromhex(
    "5A 00 02 34 12 48"
)  # Sync, state 0, two bytes, 0x1234; 0 + 2 + 52 + 18 = 72.
NAME = bytes.fromhex("5A 00 02 41 42 85")  # "AB"; 0 + 2 + 65 + 66 = 133.
REFUSED = bytes.fromhex("5A 01 01 07 09")  # State 1, one byte, 7; 1 + 1 + 7 = 9.
READ_LEVEL = bytes.fromhex("A5 01 00 01")  # Command 1, no bytes.
PICK_16 = bytes.fromhex("A5 03 01 10 14")  # Command 3, one byte, 16; 3 + 1 + 16 = 20.
LIST_2_1 = bytes.fromhex("A5 04 03 02 02 01 0C")  # Command 4: two kinds, 2 and 1; 4 + 3 + 5 = 12.


def names(events: list[Any]) -> list[str]:
    """What the events are."""
    return [item.message.NAME if item.kind == "message" else item.kind for item in events]


# --- Python ---------------------------------------------------------------------------------------


@ENGINE
def test_what_was_asked_tells_what_an_answer_is(engine: str) -> None:
    decoder = module_at(ANSWERS).Decoder("gauge", engine)
    assert names(decoder.feed(LEVEL)) == ["unknown"]  # Nothing was asked.
    decoder.tell(asked=1)
    first, second = decoder.feed(LEVEL + LEVEL)
    assert (first.message.level, first.parts.asked, second.message.level) == (0x1234, 1, 0x1234)
    decoder.tell(asked=2)
    (event,) = decoder.feed(NAME)
    assert event.message.name == "AB"
    assert event.as_json()["parts"] == {"asked": 2, "state": 0}
    assert names(decoder.feed(REFUSED)) == ["refused"]


@ENGINE
def test_what_is_told_while_a_frame_comes_in_is_of_the_next_one(engine: str) -> None:
    decoder = module_at(ANSWERS).Decoder("gauge", engine)
    decoder.tell(asked=1)
    assert decoder.feed(LEVEL[:1]) == []
    decoder.tell(asked=2)
    assert names(decoder.feed(LEVEL[1:] + NAME)) == ["level", "name"]


@ENGINE
def test_bare_bytes_have_the_size_of_what_was_asked_for(engine: str) -> None:
    decoder = module_at(ANSWERS).Decoder("probe", engine)
    assert decoder.feed(b"\x01") == []  # Noise, until something follows.
    decoder.tell(wanted=2)
    noise, event = decoder.feed(b"\x05")
    assert (noise.raw, event.message.mode) == (b"\x01", 5)
    decoder.tell(wanted=[3, 1])
    pose, speed = decoder.feed(bytes.fromhex("01 00 FF FF 34 12"))
    assert (pose.message.x, pose.message.y, speed.message.speed) == (1, -1, 0x1234)
    assert names([*decoder.feed(b"\x05"), *decoder.flush()]) == ["invalid"]  # It was told for two.


@ENGINE
def test_commands_tell_answers_on_the_same_bus(engine: str) -> None:
    module = module_at(MODES)
    ask_text = bytes.fromhex("AA 55 02 02")  # Register 2, whose exclusive or is itself.
    text = module.encode(module.Text(text="on"))
    idle = module.encode(module.Idle(state=1))
    decoder = module.Decoder(engine=engine)
    events = decoder.feed(idle + ask_text + text + idle)
    assert names(events) == ["idle", "ask_text", "text", "idle"]
    assert [item.sender for item in events] == ["motor", "host", "motor", "motor"]


@ENGINE
def test_a_decoder_hears_what_another_one_found(engine: str) -> None:
    module = module_at(ANSWERS)
    host, gauge, probe = (module.Decoder(name, engine) for name in ("host", "gauge", "probe"))

    def sent(data: bytes) -> None:
        for event in host.feed(data):
            gauge.hear(event)
            probe.hear(event)

    sent(READ_LEVEL)
    assert names(gauge.feed(LEVEL)) == ["level"]
    sent(PICK_16)  # Its command is told first, then the kind in it.
    assert names(gauge.feed(LEVEL)) == ["level"]
    sent(LIST_2_1)
    assert names(gauge.feed(LEVEL)) == ["unknown"]
    assert names(probe.feed(bytes.fromhex("07 34 12"))) == ["mode", "speed"]


@ENGINE
def test_what_is_told_while_a_frame_comes_in_is_not_used_up_by_it(engine: str) -> None:
    module = module_at(ANSWERS)
    probe = module.Decoder("probe", engine)
    probe.tell(wanted=3)
    assert probe.feed(bytes.fromhex("01 00")) == []
    probe.tell(wanted=2)
    assert names(probe.feed(bytes.fromhex("FF FF 07"))) == ["pose", "mode"]
    gauge = module.Decoder("gauge", engine)
    gauge.tell(asked=16)
    assert gauge.feed(LEVEL[:1]) == []
    gauge.tell(asked=[1, 2])
    found = gauge.feed(LEVEL[1:] + LEVEL + NAME)
    assert [item.parts.asked for item in found] == [16, 1, 2]


SAME_NAME = """
protocol: same_name
endpoints: {host: Host, gauge: Gauge}
byte_order: little
frame:
  host:
    sync: {literal: 0xA5, unprotected: start_in_data}
    command: {type: uint8, id: true}
    payload: {}
    check: {type: uint8, algorithm: sum-8, covers: command..payload}
  gauge:
    sync: {literal: 0x5A, unprotected: start_in_data}
    command: {type: uint8, told: true, once: true, set_by: command}
    payload: {}
    check: {type: uint8, algorithm: sum-8, covers: payload}
    end: {literal: 0x0D, unprotected: start_in_data}
messages:
  ask: {id: 1, from: host}
  one: {id: 1, from: gauge, fields: {one: uint8}}
decisions:
  start_in_data: {question: q, document: d, choice: c, because: b}
"""


@ENGINE
def test_a_frame_does_not_tell_what_it_was_told(tmp_path: Path, engine: str) -> None:
    path = tmp_path / "same_name.yaml"
    path.write_text(SAME_NAME)
    decoder = module_at(path).Decoder(engine=engine)
    one = bytes.fromhex("5A 07 07 0D")
    events = decoder.feed(bytes.fromhex("A5 01 01") + one + one) + decoder.flush()
    assert names(events) == ["ask", "one", "unknown"]


EMPTY = """
protocol: empty
endpoints: {gauge: Gauge}
frame:
  asked: {type: uint8, told: true}
  payload: {}
  end: {literal: 0}
transparency: {encoding: cobs}
messages:
  none: {id: 2, from: gauge}
  size: {id: 3, from: gauge, fields: {size: uint8}}
"""


def test_c_takes_what_is_told_of_a_frame_without_content(tmp_path: Path) -> None:
    path = tmp_path / "empty.yaml"
    path.write_text(EMPTY)
    steps: list[Step] = [
        ("tell", bytes.fromhex("00 00000002")),
        ("feed", bytes.fromhex("01 00")),  # Nothing, in COBS.
        ("tell", bytes.fromhex("00 00000003")),
        ("feed", bytes.fromhex("02")),
        ("tell", bytes.fromhex("00 00000002")),  # The frame has begun: this is of the next one.
        ("feed", bytes.fromhex("07 00 01 00")),
        ("flush",),
    ]
    check_events(process_of(path), module_at(path), "gauge", steps)
    module = module_at(path)
    decoder = module.Decoder("gauge")
    decoder.tell(asked=2)
    assert names(decoder.feed(bytes.fromhex("01 00"))) == ["none"]


LINES = """
protocol: lines
endpoints: {gauge: Gauge}
byte_bits: 7
forms:
  short:
    from: gauge
    frame:
      asked: {type: uint8, told: true}
      payload: {}
      check: {type: uint8, byte_order: little, algorithm: sum-8, covers: payload}
      end: {literal: 0x80}
  long:
    from: gauge
    behind: short_first
    frame:
      asked: {type: uint8, told: true}
      payload: {}
      check: {type: uint16, byte_order: little, algorithm: sum-16, covers: payload}
      end: {literal: 0x80}
messages:
  one: {id: 1, from: gauge, fields: {one: char}}
  two: {id: 2, from: gauge, fields: {two: char}}
decisions:
  short_first: {question: q, document: d, choice: c, because: b}
"""


@ENGINE
def test_the_first_frame_of_an_input_is_told_before_any_byte(tmp_path: Path, engine: str) -> None:
    path = tmp_path / "lines.yaml"
    path.write_text(LINES)
    module = module_at(path)
    decoder = module.Decoder("gauge", engine)
    assert decoder.feed(b"") == []  # A frame may begin where the input does.
    decoder.tell(asked=2)
    assert names(decoder.feed(module.encode(module.Two(two=7)))) == ["two"]


def test_one_frame_alone_is_read_as_it_is_told() -> None:
    module = module_at(ANSWERS)
    assert module.decode(LEVEL, "gauge", told={"asked": 0x10}).level == 0x1234
    with pytest.raises(module.DecodeError, match="no message has the identity"):
        module.decode(LEVEL, "gauge")
    assert module.encode(module.Level(level=0x1234)) == LEVEL
    assert module.encode(module.Level(level=0x1234), asked=16) == LEVEL
    with pytest.raises(ValueError, match="asked can't be 300: it has 8 bits"):
        module.decode(LEVEL, "gauge", told={"asked": 300})
    with pytest.raises(module.EncodeError, match="asked: 5 is not level, whose asked is 1 or 16"):
        module.encode(module.Level(level=0x1234), asked=5)


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        ({"wanted": 1}, "no part that is told is called 'wanted': asked"),
        ({"asked": 256}, "asked can't be 256: it has 8 bits"),
        ({"asked": "level"}, "asked must be an integer, not 'l'"),
    ],
)
def test_what_can_not_be_told_is_said(given: dict[str, Any], problem: str) -> None:
    decoder = module_at(ANSWERS).Decoder("gauge")
    with pytest.raises(ValueError, match=problem):
        decoder.tell(**given)


@given(st.data())
def test_portions_change_nothing(data: st.DataObject) -> None:
    """Frames of both kinds that are told by commands between them, on one line."""
    module = module_at(MODES)
    ask = [module.encode(module.AskSpeed()), module.encode(module.AskText())]
    answers = [module.encode(module.Speed(speed=-2)), module.encode(module.Text(text="\x03x"))]
    pieces = data.draw(st.lists(st.sampled_from([*ask, *answers, b"\x02", b"\xaa"]), max_size=12))
    stream = b"".join(pieces)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=6)))
    decoder = module.Decoder()
    found = [
        event
        for low, high in zip([0, *cuts], [*cuts, len(stream)], strict=True)
        for event in decoder.feed(stream[low:high])
    ]
    whole = module.Decoder()
    assert [*found, *decoder.flush()] == [*whole.feed(stream), *whole.flush()]


# --- C --------------------------------------------------------------------------------------------


def told_steps(path: Path, endpoint: str, dice: Random) -> list[Step]:
    """Frames, some of them damaged, and bytes of frames, with what is told in between."""
    protocol = protocol_of(path)
    forms = [item for item in protocol.senders if endpoint in (item.name, item.endpoint)]
    materials = [material_of(path, item.name) for item in forms]
    parts = list({part.name: part for item in forms for part in item.frame.told}.values())
    steps: list[Step] = []
    for _ in range(30):
        form, material = dice.choice(list(zip(forms, materials, strict=True)))
        piece = bytearray(dice.choice(material.frames))
        if dice.random() < 0.3:
            piece[dice.randrange(len(piece))] = dice.choice(material.marks)
        if dice.random() < 0.7:
            number = dice.randrange(len(parts))
            value = dice.randrange(6)
            if isinstance(parts[number], ToldLength) and dice.random() < 0.8:
                fitting = form.plan.told_size(len(piece)).get(parts[number].name, 0)
                value = min(fitting + dice.choice((0, 0, 0, 1, 300)), parts[number].type.greatest)
            steps.append(("tell", bytes((number,)) + value.to_bytes(4, "big")))
        kind = "feed" if dice.random() < 0.5 else "push"
        steps += [(kind, part) for part in portions(bytes(piece), dice)]
        if dice.random() < 0.1:
            steps.append(("flush",))
        if dice.random() < 0.03:
            steps.append(("clear",))
    return [*steps, ("flush",)]


@pytest.mark.parametrize("options", [ALL, MESSAGES], ids=["all", "messages"])
@EVERY_ENDPOINT
def test_c_finds_what_python_finds(path: Path, endpoint: str, options: Any) -> None:
    for seed in range(len(SEEDS) * 4):
        dice = Random(f"{path.stem} {endpoint} {seed}")
        steps = told_steps(path, endpoint, dice)
        check_events(process_of(path, options), module_at(path), endpoint, steps)


# --- commands -------------------------------------------------------------------------------------


def told(*arguments: str, input: str = "") -> tuple[int, str]:
    """The exit code of a command and what it prints."""
    result = run(*arguments, input=input)
    return result.exit_code, result.output


def test_decode_is_told_on_the_command_line() -> None:
    line = ("--sender", "gauge", "--hex", LEVEL.hex())
    code, text = told("decode", str(ANSWERS), *line, "--told", "asked=0x10")
    assert (code, text.split()) == (0, ["0", "level", "@asked=16", "level=4660"])
    code, text = told("decode", str(ANSWERS), *line, "--told", "asked=x")
    assert (code, "--told asked=x: expected PART=NUMBER" in text) == (2, True)
    code, text = told("decode", str(ANSWERS), *line, "--told", "akked=1")
    assert (code, "no part that is told is called 'akked': asked" in text) == (2, True)


def test_a_log_of_both_ways_tells_by_itself() -> None:
    log = (
        f"host: {LIST_2_1.hex()}\nprobe: 07 34 12\nhost: {READ_LEVEL.hex()}\ngauge: {LEVEL.hex()}\n"
    )
    code, text = told("decode", str(ANSWERS), "--tagged", "-", input=log)
    assert code == 0
    assert [line.split()[2] for line in text.splitlines()] == [
        "list",
        "mode",
        "speed",
        "read_level",
        "level",
    ]


def test_a_log_is_heard_of_senders_that_are_not_shown() -> None:
    log = f"host: {READ_LEVEL.hex()}\ngauge: {LEVEL.hex()}\n"
    given = ("--tagged", "-", "--sender", "gauge")
    code, text = told("decode", str(ANSWERS), *given, input=log)
    assert (code, text.split()[:3]) == (0, ["0", "level", "@asked=1"])


def test_what_is_told_nothing_says_so() -> None:
    given = ("--sender", "gauge", "--hex", LEVEL.hex())
    code, text = told("decode", str(ANSWERS), *given)
    assert (
        code,
        "hint: some frames do not say what they are: give --told asked=NUMBER" in text,
    ) == (0, True)


def test_explain_shows_what_was_told() -> None:
    given = ("--sender", "gauge", "--hex", LEVEL.hex(), "--told", "asked=1")
    code, text = told("explain", str(ANSWERS), *given)
    assert code == 0
    assert "message level" in text
    assert "told, not sent" in text


def test_tables_say_that_they_are_told_nothing(tmp_path: Path) -> None:
    with pytest.raises(CaptureError, match=r"frames of gauge do not say what they are: .* asked"):
        columns(LEVEL, protocol=ANSWERS, sender="gauge")
    capture = tmp_path / "run.bin"
    capture.write_bytes(LEVEL)
    given = ("--sender", "gauge", "--output", str(tmp_path / "out"), "--to", "csv")
    code, text = told("convert", str(ANSWERS), str(capture), *given)
    assert (code, "a decoder is told asked, and tables are not" in text) == (2, True)


@pytest.mark.parametrize("path", [ANSWERS, MODES], ids=["answers", "modes"])
def test_every_engine_takes_samples_there_and_back(path: Path) -> None:
    code, text = told("fuzz", str(path), "--examples", "20")
    assert code == 0, text
    assert text.count("all came back") == 3


def test_one_form_of_frame_is_told() -> None:
    module = module_at(MODES)
    given = ("--sender", "motor_answer", "--hex", module.encode(module.Speed(speed=-2)).hex())
    code, text = told("decode", str(MODES), *given, "--told", "mode=1")
    assert (code, text.split()) == (0, ["0", "speed", "speed=-2"])


def test_what_tells_a_part_may_have_another_name(tmp_path: Path) -> None:
    """It is the same number of the same frames; a teller that is left out is not."""
    text = ANSWERS.read_text("utf-8")
    path = tmp_path / "answers.yaml"
    path.write_text(
        text.replace("command", "order").replace("kinds", "sorts").replace("pick", "choose")
    )
    code, output = told("breaking", str(ANSWERS), str(path))
    assert (code, "[frame-told]" in output) == (0, False), output
    path.write_text(text.replace("[command, pick.kind]", "command"))
    code, output = told("breaking", str(ANSWERS), str(path))
    assert (code, "[frame-told]" in output) == (1, True)
