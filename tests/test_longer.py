"""Payloads longer than their message: what receivers leave, and what changes of them do."""

from __future__ import annotations

from typing import Any

import pytest
from c_engine import process_of
from compiled import ROOT, module_at
from passes_support import compile_text

from protogen.evolution.findings import findings
from protogen.model.protocol import Protocol
from protogen.model.reading.annotate import annotate
from protogen.runtime.errors import DecodeError
from protogen.targets.c.options import EVENTS, COptions, Events

STATION = ROOT / "tests" / "framings" / "longer.yaml"
ENGINES = ["fast", "construct"]
CUT = "{longer: cut}"
BOTH = "{trailing_zeros: trimmed, longer: cut}"
LONGER = bytes.fromhex("D5 06 01 07 C0 00 DB FE 01 D5 69 97")
"""Wind with two bytes behind it."""


@pytest.mark.parametrize("engine", ENGINES)
def test_an_event_has_the_whole_frame_and_the_known_fields(engine: str) -> None:
    module: Any = module_at(STATION)
    (event,) = module.Decoder("station", engine).feed(LONGER)
    assert event.raw == LONGER
    assert event.payload == bytes.fromhex("C0 00 DB FE")
    assert event.message == module.Wind(direction=192, speed=-293)
    line = event.as_json()
    assert line["raw"] == LONGER.hex()
    assert module.PROTOCOL.encode_line(line) == LONGER


@pytest.mark.parametrize("events", EVENTS)
def test_a_receiver_of_one_message_takes_its_longer_ones(events: Events) -> None:
    process = process_of(STATION, COptions(only=("wind",), events=events))
    [[event]] = process.do(process.calls.events("station", [("feed", LONGER)]))
    assert (event.message, event.payload) == ("wind", bytes.fromhex("C0 00 DB FE"))
    (same,) = process.module.Decoder("station").feed(LONGER)
    assert same.message == process.module.Wind(direction=192, speed=-293)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_encoder_writes_what_it_knows(engine: str) -> None:
    module: Any = module_at(STATION)
    message = module.decode(LONGER, engine=engine)
    frame = module.encode(message, engine=engine, number=1)
    assert frame == bytes.fromhex("D5 04 01 07 C0 00 DB FE B5 B6")


@pytest.mark.parametrize("engine", ENGINES)
def test_a_size_that_varies_is_as_it_says(engine: str) -> None:
    module: Any = module_at(STATION)
    longer = bytes.fromhex("D5 04 05 09 02 61 62 63 85 38")
    (event,) = module.Decoder("station", engine).feed(longer)
    assert (event.raw, event.payload) == (longer, b"\2ab")
    assert event.message == module.Name(size=2, text="ab")
    assert module.PROTOCOL.encode_line(event.as_json()) == longer
    with pytest.raises(DecodeError) as caught:
        module.decode(bytes.fromhex("D5 04 05 09 04 61 62 63 1F 73"), engine=engine)
    assert caught.value.reason == "size"


@pytest.mark.parametrize(
    ("frame", "left"),
    [(LONGER, "01 D5"), (bytes.fromhex("D5 04 05 09 02 61 62 63 85 38"), "63")],
)
def test_what_is_left_is_no_fault(frame: bytes, left: str) -> None:
    rows = annotate(_protocol(STATION.read_text("utf-8")), "station", frame)
    assert not any(row.fault for row in rows)
    assert [row.meaning for row in rows if row.bytes == bytes.fromhex(left)] == [
        "left, as what is behind the known fields is"
    ]


# --- examples -----------------------------------------------------------------------------------

NEWER = """\
protocol: newer
endpoints: {a: A}
byte_order: big
frame:
  start:   {literal: 0x7E}
  length:  {type: uint8, counts: payload}
  number:  {type: uint8, counter: true}
  payload: PAYLOAD
  sum:     {type: uint8, algorithm: sum-8, covers: length..payload}
transparency: {covers: length..sum, encoding: base16-upper, lenient: true}
messages:
  level:
    from: a
    fields: {level: uint8, angle: uint16}
    examples:
      newer: {frame: {hex: HEX}, values: {level: 5, angle: 258}}
"""


def _problems(payload: str, digits: str) -> list[str]:
    """What is wrong with an example whose unstuffed bytes, but for the sum, have these digits."""
    total = sum(bytes.fromhex(digits)) & 0xFF
    frame = b"~" + f"{digits}{total:02X}".encode()
    text = NEWER.replace("PAYLOAD", payload).replace("HEX", frame.hex())
    return [problem.code for problem in compile_text(text, examples=True).problems]


@pytest.mark.parametrize("payload", [CUT, BOTH])
@pytest.mark.parametrize("digits", ["0301050102", "040105010209", "05010501020009"])
def test_an_example_may_be_the_frame_of_a_newer_sender(payload: str, digits: str) -> None:
    assert _problems(payload, digits) == []


@pytest.mark.parametrize(
    ("payload", "digits", "code"),
    [
        (CUT, "040106010209", "PG160"),  # Another value.
        (CUT, "04010501020a", "PG161"),  # A digit of the stuffing.
        (BOTH, "05010501020900", "PG161"),  # A zero that encoders leave out.
        ("{}", "040105010209", "PG160"),
    ],
)
def test_an_example_of_a_newer_sender_is_right_otherwise(
    payload: str, digits: str, code: str
) -> None:
    assert _problems(payload, digits) == [code]


# --- changes ------------------------------------------------------------------------------------

LINK = """\
protocol: demo
endpoints: {board: Sensor board}
byte_order: little
frame:
  start:   {literal: 0xAA}
  length:  {type: uint8, counts: payload, range: [0, 12]}
  kind:    {type: uint8, id: true}
  payload: PAYLOAD
  crc:     {type: uint16, algorithm: CRC-16/KERMIT, covers: [kind, payload]}
transparency:
  covers: length..crc
  escape: {byte: 0xAB, of: [0xA5, 0xAA, 0xAB], transform: {xor: 0x20}}
messages:
  reading: {id: 1, from: board, fields: FIELDS}
"""


def _protocol(text: str) -> Protocol:
    compilation = compile_text(text)
    assert compilation.protocol is not None, compilation.problems
    return compilation.protocol


def _changes(payload: str, before: str, after: str) -> set[tuple[str, str, str, str]]:
    text = LINK.replace("PAYLOAD", payload)
    old, new = (_protocol(text.replace("FIELDS", fields)) for fields in (before, after))
    return {
        (finding.change.rule, finding.change.place, finding.affected, str(finding.harm))
        for finding in findings(old, new)[1]
    }


@pytest.mark.parametrize(
    "extra",
    [
        "float32",
        "{type: ascii, size: 3}",
        "{type: uint16, count: 2}",
        "{type: uint8, values: {off: 0, on: 1}, closed: true}",
        "{fields: {a: uint8, b: sint16}}",
    ],
)
def test_a_field_at_the_end_that_may_be_zero_breaks_nobody(extra: str) -> None:
    found = _changes(BOTH, "{value: uint16}", f"{{value: uint16, extra: {extra}}}")
    assert found == {("field-appended", "reading.extra", "nobody", "nothing")}


@pytest.mark.parametrize(
    "extra",
    [
        "{type: uint8, const: 7}",
        "{type: uint8, values: {on: 1}, closed: true}",
        "{type: uint8, digits: base10}",
    ],
)
def test_a_field_that_can_not_be_zero_is_refused_in_old_frames(extra: str) -> None:
    found = _changes(BOTH, "{value: uint16}", f"{{value: uint16, extra: {extra}}}")
    assert found == {("field-added", "reading.extra", "new receiver of old frames", "rejected")}


def test_without_zeros_that_are_left_out_old_frames_lack_the_field() -> None:
    found = _changes(CUT, "{value: uint16}", "{value: uint16, extra: uint8}")
    assert found == {("field-added", "reading.extra", "new receiver of old frames", "rejected")}


TEXT = "{name: {type: ascii, until: {byte: 0, max: 4}}}"


def test_a_field_behind_one_whose_size_varies_breaks_nobody_if_it_may_be_left_out() -> None:
    found = _changes(CUT, TEXT, TEXT[:-1] + ", extra: {type: uint16, optional: true}}")
    assert found == {("field-appended", "reading.extra", "nobody", "nothing")}


def test_a_field_behind_one_whose_size_varies_lacks_in_old_frames() -> None:
    found = _changes(CUT, TEXT, TEXT[:-1] + ", extra: uint16}")
    assert found == {("field-added", "reading.extra", "new receiver of old frames", "rejected")}


def test_a_field_in_front_is_misread() -> None:
    found = _changes(BOTH, "{value: uint16}", "{extra: uint8, value: uint16}")
    assert ("field-moved", "reading.value", "both", "misread") in found
    assert not any(rule == "field-appended" for rule, *_ in found)


def test_more_than_old_receivers_have_room_for_is_rejected() -> None:
    """Their length says 12 at most."""
    old = LINK.replace("PAYLOAD", BOTH).replace("FIELDS", "{value: uint16}")
    fields = "{value: uint16, extra: {type: bytes, size: 11}}"
    new = old.replace("{value: uint16}", fields).replace("[0, 12]", "[0, 20]")
    found = findings(_protocol(old), _protocol(new))[1]
    harm = {(item.change.rule, item.affected, str(item.harm)) for item in found}
    assert ("field-added", "old receiver of new frames", "rejected") in harm


def test_a_field_that_is_gone_is_lost() -> None:
    found = _changes(BOTH, "{value: uint16, extra: uint8}", "{value: uint16}")
    assert found == {("field-deleted", "reading.extra", "new receiver of old frames", "lost")}
