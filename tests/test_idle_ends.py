"""Frames that only a silence of the line ends, from the schema to every output.

Bytes and events are worked out by hand; the CRCs were computed with crccheck (CrcModbus).
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import pytest
from c_engine import check_events, process_of
from cli_support import run
from compiled import ROOT, module_at, protocol_of
from corpus import DAMAGES, damaged, material_of
from markdown_pages import page

from protogen.api import load, module_of
from protogen.fuzzing.c_calls import Step
from protogen.model.frame_plan import EndRule
from protogen.targets.c.options import COptions

IDLE = ROOT / "tests" / "framings" / "idle_end.yaml"
SILENCES = ROOT / "tests" / "c_schemas" / "silences.yaml"
SENDERS = [(IDLE, "station")] + [(SILENCES, name) for name in ("meter", "probe", "gauge", "panel")]
EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), SENDERS, ids=str)
PING = bytes.fromhex("00 BF 40")
WIND = bytes.fromhex("7E C0 00 DB FE EB 7A")


def brief(events: list[Any]) -> list[tuple[str, str]]:
    return [(event.kind, event.raw.hex(" ")) for event in events]


# --- what decoders find ---------------------------------------------------------------------------


@pytest.mark.parametrize("engine", ["fast", "construct"])
def test_a_silence_ends_a_frame_and_nothing_else_does(engine: str) -> None:
    decoder = module_at(IDLE).Decoder("station", engine=engine)
    assert decoder.feed(PING) == []
    assert brief(decoder.idle()) == [("message", "00 bf 40")]
    assert decoder.feed(WIND) == []
    assert brief(decoder.flush()) == [("message", "7e c0 00 db fe eb 7a")]
    assert decoder.idle() == []


def test_an_unknown_frame_ends_as_any_other() -> None:
    decoder = module_at(IDLE).Decoder("station")
    assert decoder.feed(bytes.fromhex("42 01 02 51 85")) == []  # The CRC of 42 01 02 is 8551.
    (event,) = decoder.idle()
    assert (event.kind, event.payload.hex()) == ("unknown", "0102")


def test_a_byte_behind_a_frame_of_one_size_makes_it_a_wrong_one() -> None:
    decoder = module_at(SILENCES).Decoder("gauge")
    frame = bytes.fromhex("00 03 03")  # No payload, so no sum: 00 ^ 03 is 03.
    assert [*decoder.feed(frame), *brief(decoder.idle())] == [("message", "00 03 03")]
    assert decoder.feed(frame + b"\xff") == []
    assert brief(decoder.idle()) == [("invalid", "00 03 03 ff")]


def test_of_frames_without_a_silence_between_them_the_last_is_found() -> None:
    decoder = module_at(IDLE).Decoder("station")
    decoder.feed(PING + WIND)
    assert brief(decoder.idle()) == [("invalid", PING.hex(" ")), ("message", WIND.hex(" "))]


def test_without_a_checksum_all_between_two_silences_is_one_frame() -> None:
    decoder = module_at(SILENCES).Decoder("probe")
    decoder.feed(bytes.fromhex("04 10 00 02"))
    (event,) = decoder.idle()
    assert (event.message.address, event.message.count) == (0x10, 2)
    decoder.feed(bytes.fromhex("04 10 00"))  # A byte is missing, and 10 is an unknown identity.
    assert brief(decoder.idle()) == [("invalid", "04"), ("unknown", "10 00")]


def test_a_start_that_stands_nowhere_else_gives_up_what_is_in_front() -> None:
    decoder = module_at(SILENCES).Decoder("panel")
    assert brief(decoder.feed(b"\x0241\x0241007")) == [("invalid", "02 34 31")]
    assert brief(decoder.idle()) == [("message", "02 34 31 30 30 37")]


def test_a_frame_of_the_greatest_size_is_one_until_a_byte_follows() -> None:
    module = module_at(SILENCES)
    frame = module.PROTOCOL.encode_unknown("probe", {"kind": 9}, bytes(15))
    decoder = module.Decoder("probe")
    assert len(frame) == 16 and decoder.feed(frame) == []
    assert brief(decoder.idle()) == [("unknown", frame.hex(" "))]
    decoder.feed(b"\x07" + frame)
    assert brief(decoder.idle()) == [("invalid", "07"), ("unknown", frame.hex(" "))]


@EVERY_SENDER
def test_behind_noise_and_damage_every_frame_is_found_that_a_silence_ends(
    path: Path, sender: str
) -> None:
    """Except where nothing tells a frame from noise, and noise in front is part of it."""
    material, dice = material_of(path, sender), Random(sender)
    decoder = module_at(path).Decoder(sender)
    has_mark = sender != "probe"
    taken = 0
    for _ in range(150):
        frame = dice.choice(material.frames)
        wrong = damaged(dice.choice(list(DAMAGES)), frame, material, dice)
        front = wrong if has_mark and len(wrong + frame) < 40 else b""
        events = [*decoder.feed(front + frame), *decoder.idle()]
        assert b"".join(event.raw for event in events) == front + frame
        taken += events[-1].raw == frame
        decoder.feed(wrong)
        decoder.idle()
    # A longer frame, of damage and all, has its checksum of 8 bits right once in 256.
    assert taken >= (150 if sender != "gauge" else 145)


@EVERY_SENDER
@pytest.mark.parametrize("events", ["all", "messages"])
def test_c_finds_the_same(path: Path, sender: str, events: Any) -> None:
    material, dice = material_of(path, sender), Random(sender)
    process = process_of(path, COptions(events=events))
    greatest = module_at(path).PROTOCOL.sender(sender).frame.greatest
    steps: list[Step] = []
    for _ in range(200):
        frame = dice.choice(material.frames)
        data = damaged(dice.choice(list(DAMAGES)), frame, material, dice)
        if dice.random() < 0.5:
            data = frame
        if dice.random() < 0.05:
            data = dice.choice((b"\x01", material.marks[:1], frame)) * (2 * greatest) + frame
        steps.append(("feed" if dice.random() < 0.5 else "push", data))
        if dice.random() < 0.8:
            steps.append(("flush",))
    check_events(process, module_at(path), sender, [*steps, ("flush",)])


@EVERY_SENDER
def test_both_engines_find_the_same(path: Path, sender: str) -> None:
    material, dice = material_of(path, sender), Random(sender)
    fast, slow = (module_at(path).Decoder(sender, engine=name) for name in ("fast", "construct"))
    for _ in range(150):
        wrong = damaged(dice.choice(list(DAMAGES)), dice.choice(material.frames), material, dice)
        burst = wrong * dice.randrange(1, 4) + dice.choice((b"", dice.choice(material.frames)))
        pieces = (burst[:3], burst[3:]) if dice.random() < 0.5 else (burst,)
        found = [event for piece in pieces for event in fast.feed(piece)] + fast.idle()
        assert found == slow.feed(burst) + slow.idle()


# --- what is planned and told ---------------------------------------------------------------------


def test_the_plan_has_the_silence_and_one_byte_more() -> None:
    plan = protocol_of(IDLE).sender("station").plan
    assert plan.end_rule is EndRule.IDLE
    assert plan.frame.silence is not None
    assert plan.frame.silence.seconds == Fraction(35, 9600)  # 3.5 characters of ten bits.
    assert (plan.greatest, plan.given_up_at) == (68, 69)
    assert plan.rescans and not plan.takes_whole
    meter = protocol_of(SILENCES).sender("meter").plan.frame.silence
    assert meter is not None and meter.seconds == Fraction(77, 2 * 19200)  # Eleven, with parity.
    assert (meter.text, meter.microseconds) == ("2.01 ms", 2006)


def test_check_says_what_ends_a_frame() -> None:
    text = run("check", str(IDLE)).output
    assert "at any byte from which sizes and checksum are right up to the silence" in text
    assert "after 3.65 ms of silence, and nowhere else" in text
    assert "in step from the next silence on" in text
    rate = protocol_of(SILENCES).sender("probe").framing.messages[0].per_second
    assert rate == 1 / (Fraction(11, 19200) + Fraction(1, 100))  # A byte, and the silence.


def test_the_reference_says_it() -> None:
    text = page(protocol_of(SILENCES), "silences.md")
    assert "After 2.01 ms of silence, and nowhere else." in text
    assert "The longest gap inside of a frame is 2 ms." in text


def test_generated_code_has_the_time() -> None:
    module: Any = module_at(IDLE)
    assert module.PROTOCOL.sender("station").frame.silence == 35 / 9600
    words = " ".join(module.__doc__.split())
    assert "Frames of station end after 3.65 ms of silence: call `Decoder.idle` then." in words


# --- captures -------------------------------------------------------------------------------------


@pytest.mark.parametrize("engine", ["native", "python"])
def test_a_capture_has_one_silence_at_its_end(
    tmp_path: Path, engine: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("numpy")
    from protogen.capture import NoSilenceWarning, columns, engines

    monkeypatch.setattr(engines, "_warned", set())
    path = tmp_path / "line.bin"
    path.write_bytes(PING + WIND)
    with pytest.warns(NoSilenceWarning, match="only a silence ends a frame of station"):
        tables = columns(path, IDLE, sender="station", engine=engine)
    assert tables.messages["wind"]["direction"].tolist() == [192]
    assert len(tables.messages["ping"]["offset"]) == 0


@pytest.mark.filterwarnings("default:only a silence")
def test_convert_says_that_a_capture_has_one_silence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("numpy")
    from protogen.capture import engines

    monkeypatch.setattr(engines, "_warned", set())
    path = tmp_path / "line.bin"
    path.write_bytes(WIND)
    result = run("convert", str(IDLE), str(path), "--to", "csv", "--output", str(tmp_path / "out"))
    assert "warning: only a silence ends a frame of station" in result.stderr


# --- several forms, and both ends -----------------------------------------------------------------

FORMS = """
protocol: demo
endpoints: {one: One, two: Two}
max_frame: 64
forms:
  short:
    frame:
      start: {literal: 2, unprotected: stands_in_data}
      id: {type: uint8, id: true}
      payload: {}
      sum: {type: uint8, algorithm: sum-8, covers: id..payload}
      end: {idle: 4 ms}
  long:
    from: one
    frame:
      start: {literal: 3, unprotected: stands_in_data}
      id: {type: uint16, id: true, byte_order: little}
      payload: {}
      sum: {type: uint8, algorithm: sum-8, covers: id..payload}
      end: {idle: 4 ms}
messages:
  first: {id: 1, from: one, fields: {a: uint8}}
  second: {id: 9, from: two, forms: short, fields: {a: uint8}}
decisions:
  stands_in_data: {question: What of data?, document: No., choice: Look on., because: Rare.}
"""


def test_a_silence_ends_frames_of_each_form_and_of_both_ends(tmp_path: Path) -> None:
    path = tmp_path / "demo.yaml"
    path.write_text(FORMS, encoding="utf-8")
    decoder = module_of(load(path)).Decoder()
    for wire in ("02 01 05 06", "03 01 00 05 06", "02 09 07 10"):  # Sums of 1 and 5, of 9 and 7.
        assert decoder.feed(bytes.fromhex(wire)) == []
        assert brief(decoder.idle()) == [("message", wire)]
    decoder.feed(bytes.fromhex("02 03 03 01 00 05 06"))
    found = [("invalid", "02"), ("invalid", "03"), ("message", "03 01 00 05 06")]
    assert brief(decoder.idle()) == found


def test_ends_of_different_kinds_take_decoders_of_their_own() -> None:
    with pytest.raises(ValueError, match="found in different ways: name the sender"):
        module_at(SILENCES).Decoder()
