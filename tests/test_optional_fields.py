"""Fields at the end of a message that may be left out: values, readings, and changes of them."""

from __future__ import annotations

from typing import Any

import pytest
from compiled import ROOT, module_at, protocol_of
from passes_support import compile_text

from protogen.capture.layout import message_record
from protogen.evolution.findings import findings
from protogen.model.protocol import Protocol
from protogen.model.reading.annotate import annotate
from protogen.runtime.errors import EncodeError

TAIL = ROOT / "tests" / "framings" / "optional_tail.yaml"
ENGINES = ["fast", "construct"]


@pytest.fixture(scope="module")
def tail() -> Any:
    return module_at(TAIL)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_value_behind_one_that_is_left_out_is_an_error(tail: Any, engine: str) -> None:
    reading = tail.Reading(pressure=1, status=3)
    with pytest.raises(EncodeError) as caught:
        tail.encode(reading, engine=engine)
    assert caught.value.path == "status"
    assert "temperature in front of it is left out" in str(caught.value)
    assert [item.path for item in reading.violations()] == ["status"]


def test_what_is_left_out_is_null_and_may_be_missing_in_json(tail: Any) -> None:
    reading = tail.Reading(pressure=1)
    shown = {"pressure": 1, "temperature": None, "status": None, "mode": None}
    assert reading.to_dict() == shown
    assert tail.Reading.from_dict(shown) == tail.Reading.from_dict({"pressure": 1}) == reading
    assert reading.temperature_degc is None


def test_a_value_out_of_its_range_is_an_error_where_it_is_there(tail: Any) -> None:
    with pytest.raises(EncodeError, match="mode"):
        tail.encode(tail.Reading(pressure=1, temperature=2, status=3, mode=9))


def test_c_has_a_member_in_front_that_says_whether_it_is_there() -> None:
    protocol = protocol_of(TAIL)
    message = next(item for item in protocol.messages if item.name == "reading")
    columns = message_record(message).columns
    assert [(item.name, item.role) for item in columns[:3]] == [
        ("pressure", "field"),
        ("has_temperature", "presence"),
        ("temperature", "field"),
    ]


def test_a_dump_shows_the_fields_that_are_there() -> None:
    rows = annotate(protocol_of(TAIL), "sensor", bytes.fromhex("7E 04 01 34 12 9C FF AD"))
    assert not any(row.fault for row in rows)
    assert [row.path for row in rows][3:-1] == ["pressure", "temperature"]


def test_a_dump_shows_where_a_payload_ends_inside_of_a_field() -> None:
    rows = annotate(protocol_of(TAIL), "sensor", bytes.fromhex("7E 03 01 34 12 9C 5A"))
    assert [row.path for row in rows if row.cut] == ["temperature"]


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
  other: {id: 2, from: board, fields: {value: uint8}}
"""
SPEED = "speed: {type: uint8, optional: true}"


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


def test_old_receivers_refuse_what_new_senders_add() -> None:
    found = _changes("{}", "{value: uint16}", f"{{value: uint16, {SPEED}}}")
    assert found == {("field-added", "reading.speed", "old receiver of new frames", "rejected")}


@pytest.mark.parametrize("before", ["{value: uint16}", f"{{value: uint16, {SPEED}}}"])
def test_old_receivers_that_cut_take_what_new_senders_add(before: str) -> None:
    after = f"{before[:-1]}, more: {{optional: true, fields: {{a: uint8, b: uint16}}}}}}"
    found = _changes("{longer: cut}", before, after)
    assert found == {("field-appended", "reading.more", "nobody", "nothing")}


def test_what_is_always_there_from_now_on_lacks_in_old_frames() -> None:
    found = _changes("{}", f"{{value: uint16, {SPEED}}}", "{value: uint16, speed: uint8}")
    assert found == {("field-presence", "reading.speed", "new receiver of old frames", "rejected")}


def test_what_may_be_left_out_from_now_on_lacks_in_new_frames() -> None:
    found = _changes("{}", "{value: uint16, speed: uint8}", f"{{value: uint16, {SPEED}}}")
    assert found == {("field-presence", "reading.speed", "old receiver of new frames", "rejected")}
