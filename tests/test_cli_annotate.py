"""Frames taken apart: every byte is shown once, and what it is shown as is right.

Expected rows are written by hand from the schemas.
"""

from __future__ import annotations

from functools import cache

import pytest
from cli_support import ROOT, SINK, compiled
from hypothesis import given
from hypothesis import strategies as st

from protogen.compiler import compile_file
from protogen.model.protocol import Protocol
from protogen.model.reading.annotate import Row, annotate


@cache
def schema(name: str) -> Protocol:
    protocol = compile_file(ROOT / "schemas" / f"{name}.yaml").protocol
    assert protocol is not None
    return protocol


def rows(protocol: Protocol, sender: str, text: str) -> list[Row]:
    data = bytes.fromhex(text)
    found = annotate(protocol, sender, data)
    assert b"".join(row.wire for row in found) == data
    assert [row.offset for row in found] == offsets(found)
    return list(found)


def offsets(found: tuple[Row, ...]) -> list[int]:
    sizes = [len(row.wire) for row in found]
    return [sum(sizes[:index]) for index in range(len(sizes))]


def lines(found: list[Row]) -> list[str]:
    """Return wire bytes, path, value and meaning of each row in one text."""
    texts = []
    for row in found:
        value = "" if row.value is None else row.value
        texts.append(f"{row.wire.hex()} {row.path} {value} {row.meaning} {row.fault}".strip())
    return [" ".join(text.split()) for text in texts]


def test_frame_with_stuffing() -> None:
    frame = "1B02 03 65 00 0D 0BA41B0005 FFFFFFFA 0000001A 00 AE 1B03"
    assert lines(rows(schema("rflex"), "flex", frame)) == [
        "1b02 start",
        "03 class 3",
        "65 number 101",
        "00 subclass 0 joystick_data",
        "0d length 13 bytes of payload",
        "0ba41b0005 timestamp 195304197",
        "fffffffa horizontal -6",
        "0000001a vertical 26",
        "00 buttons 0",
        "ae checksum 174 xor-8 of payload",
        "1b03 end",
    ]


def test_unstuffed_bytes_stand_beside_those_on_the_wire() -> None:
    frame = "1B02 03 65 00 0D 0BA41B0005 FFFFFFFA 0000001A 00 AE 1B03"
    timestamp = rows(schema("rflex"), "flex", frame)[5]
    assert timestamp.wire.hex() == "0ba41b0005"
    assert timestamp.bytes.hex() == "0ba41b05"
    assert timestamp.type == "uint32 big"


def test_seven_bit_numbers_special_values_and_flags() -> None:
    # Status 3; distances 0 (no datapoint), 5008 mm = 0x1390 = 0x27 * 128 + 0x10, then zeros.
    found = rows(schema("rn1"), "brain", "84 03 0000 1027" + "0000" * 358)
    assert lines(found)[:4] == [
        "84 start 132 lidar",
        "03 status 3 initialized|speed_in_spec",
        "0000 distances[0] 0 no_datapoint",
        "1027 distances[1] 5008 5008 mm",
    ]
    assert len(found) == 362


def test_base16() -> None:
    # 12.50 V = 1250 = 0x04E2, 300 mA = 0x012C, -0.5 degrees = -50 = 0xFFCE; 8 bytes in all.
    frame = b"b080104E2012CFFCEe"
    assert lines(rows(schema("uherobot"), "board", frame.hex())) == [
        "62 begin",
        "3038 length 8 bytes of length, type, payload",
        "3031 type 1 status",
        "30344532 voltage 1250 12.5 V",
        "30313243 current 300 300 mA",
        "46464345 temperature -50 -0.5 degC",
        "65 end",
    ]


def test_checksum_that_is_absent_without_data() -> None:
    assert lines(rows(schema("dagny"), "host", "430A"))[-1] == "0a end"


def test_cases_lists_and_texts() -> None:
    # The payload is 2 points, a count of 1, a level, a text of 2 characters, two more bytes.
    payload = "FF 03 01 04 01 0010 61620000 AABB"
    frame = f"1B02 4C FF 0D {payload} 1A 1B03"
    assert lines(rows(compiled(SINK), "pc", frame))[4:13] == [
        "ff points[0].x -1",
        "03 points[0].y 3 3 mm",
        "01 points[1].x 1",
        "04 points[1].y 4 4 mm",
        "01 size 1",
        "0010 levels[0] 16",
        "61620000 name ab",
        "aabb rest",
        "1a check 26 xor-8 of kind, number, length, payload check is 1a, not 44",
    ]


@pytest.mark.parametrize(
    ("payload", "expected"),
    [
        ("00", ["00 what 0 nothing"]),
        ("01 0102", ["01 what 1 speed", "0102 value.value 258"]),
        ("02 616263 05", ["02 what 2 word", "616263 value.text abc", "05 value.more 5"]),
        ("09 AABB", ["09 what 9 a value without a name", "aabb value"]),
    ],
)
def test_switch(payload: str, expected: list[str]) -> None:
    size = len(bytes.fromhex(payload))
    found = rows(compiled(SINK), "board", f"1B02 43 FF {size:02X} {payload} 00 1B03")
    assert lines(found)[4:-2] == expected


def test_numbers_of_every_kind() -> None:
    payload = "07 02 05A0 81 C5 4E 01 3FC00000 030201"
    found = rows(compiled(SINK), "pc", f"1B02 4E FF 0F {payload} 00 1B03")
    assert lines(found)[4:-2] == [
        "07 mode 7 run",
        "02 strict_mode 2 high",
        "05a0 angle 1440 90 deg",
        "81 flags 129 ready|wet",
        "c5 control 197 {speed=5, gear=rear}",
        "4e letter 78 'N'",
        "01 on_line 1 true",
        "3fc00000 ratio 1.5 0.75 V",
        "030201 odd 66051",
    ]


def test_values_that_can_not_be() -> None:
    payload = "09 05 7FFF C0 3F 07 02 7F800000 000000"
    found = rows(compiled(SINK), "pc", f"1B02 4E FF 0F {payload} 00 1B03")
    assert lines(found)[4:-2] == [
        "09 mode 9 a value without a name",
        "05 strict_mode 5 a value without a name is none of the values that there are",
        "7fff angle 32767 missing",
        "c0 flags 192 wet|0x40",
        "3f control 63 {speed=63, gear=0}",
        "07 letter 7",
        "02 on_line the bits above the lowest 1 have to be zero",
        "7f800000 ratio inf inf V",
        "000000 odd 0 must be 66051",
    ]


def test_empty_payload() -> None:
    assert lines(rows(compiled(SINK), "pc", "1B02 45 FF 00 BA 1B03"))[4] == "payload empty"


def test_unknown_identity() -> None:
    found = rows(compiled(SINK), "pc", "1B02 5A FF 02 AABB 00 1B03")
    assert lines(found)[1] == "5a kind 90 'Z' no message has this identity"
    assert lines(found)[4] == "aabb payload"


def test_frame_that_is_cut() -> None:
    found = rows(schema("matty"), "pc", "55 06 01 47 F4")
    assert found[-1].cut
    assert found[-1].fault == "missing bytes: 1"


def test_wrong_literal_and_surplus() -> None:
    found = rows(schema("rn1"), "host", "80 01 02 FE")
    assert lines(found)[-1] == "fe stop must be FF"
    found = rows(schema("rn1"), "brain", "A0 01 0000 0000 11 22")
    assert lines(found)[-1] == "1122 payload nothing is due here"


def test_bad_stuffing() -> None:
    found = rows(schema("rflex"), "flex", "1B02 03 65 1B55 00 0D AE 1B03")
    assert found[3].fault.startswith("1B 55 is no sequence")
    assert found[3].wire.hex() == "1b55000dae"
    assert found[4].wire.hex() == "1b03"


def test_high_bit_in_a_seven_bit_payload() -> None:
    found = rows(schema("rn1"), "brain", "A0 81 0000 0000")
    assert found[1].fault == "has a byte of more than 7 bits"


def test_only_some_parts() -> None:
    data = bytes.fromhex("05FF0307 0899592E 40 0001")
    found = annotate(
        schema("rflex"),
        "flex",
        data,
        covers=("class", "number", "subclass", "length", "payload"),
    )
    assert b"".join(row.wire for row in found) == data
    assert [row.path for row in found][:4] == ["class", "number", "subclass", "length"]
    assert not any(row.fault for row in found)


def test_payload_of_a_given_message() -> None:
    protocol = compiled(COBS)
    found = annotate(protocol, "pc", b"\7\1", covers=("payload",), message=protocol.message("two"))
    assert lines(list(found)) == ["07 x 7", "01 y 1"]
    found = annotate(protocol, "pc", bytes.fromhex("0409070100"), message=protocol.message("two"))
    assert lines(list(found))[2:4] == ["07 x 7", "01 y 1"]


def test_rows_know_what_they_show() -> None:
    protocol = compiled(COBS)
    sender = protocol.sender("pc")
    found = rows(protocol, "pc", "0401070900")
    x, y = sender.messages[0].fields
    kind, _, end = sender.frame.parts
    assert [row.subject for row in found] == [None, kind, x, y, end]
    assert [row.value_type for row in found] == [
        None,
        sender.frame.identity[0].type,
        x.type,
        y.type,
        None,
    ]


def test_unknown_sender() -> None:
    with pytest.raises(KeyError):
        annotate(schema("rn1"), "nobody", b"")


COBS = """\
protocol: cobs
endpoints: {pc: Computer}
frame:
  id: {type: uint8, id: true}
  payload: {}
  end: {literal: 0}
transparency: {covers: id..payload, encoding: cobs}
messages:
  two: {id: 1, from: pc, fields: {x: uint8, y: uint8}}
"""


def test_the_first_cobs_code_byte_stands_alone_the_others_for_zeros() -> None:
    # 01 00 05 in COBS: 02 01 | 02 05.
    assert lines(rows(compiled(COBS), "pc", "0201 0205 00")) == [
        "02 COBS: the next zero or the end is 2 bytes on",
        "01 id 1 two",
        "02 x 0",
        "05 y 5",
        "00 end",
    ]


def test_cobs_of_nothing() -> None:
    assert lines(rows(compiled(COBS), "pc", "01 00"))[-2:] == ["id missing bytes: 1", "00"]


def test_cobs_groups_without_a_zero() -> None:
    schema = COBS.replace("y: uint8", "y: {type: bytes, size: 260}")
    data = b"\xff\x01" + b"\x07" * 253 + b"\x09" + b"\x07" * 8 + b"\0"
    found = rows(compiled(schema), "pc", data.hex())
    assert lines(found)[0] == "ff COBS: 254 bytes without a zero"
    # The code byte inside a field stays with it.
    assert (len(found[3].wire), found[3].bytes) == (261, b"\x07" * 260)


@pytest.mark.parametrize("text", ["05 00", "00", "05", "05 01 02 00", "05 00 01 00", "01 01 00"])
def test_cobs_that_is_cut_or_holds_a_zero_is_shown_whole(text: str) -> None:
    assert rows(compiled(COBS), "pc", text)


ANY_SENDER = [
    (name, sender.name)
    for name in ("rn1", "uherobot", "dagny", "rflex", "matty")
    for sender in schema(name).senders
]


@pytest.mark.parametrize(("name", "sender"), ANY_SENDER)
@given(data=st.binary(max_size=60))
def test_any_bytes_are_shown_once_each(name: str, sender: str, data: bytes) -> None:
    rows(schema(name), sender, data.hex())


@given(data=st.binary(max_size=60), start=st.sampled_from(["1B024E", "1B024C", "1B0243"]))
def test_any_bytes_behind_a_start_are_shown_once_each(data: bytes, start: str) -> None:
    for sender in ("pc", "board"):
        rows(compiled(SINK), sender, start + data.hex())


CHECKED = """\
protocol: checked
endpoints: {{pc: Computer}}
byte_order: big
frame:
  id: {{type: uint8, id: true, range: [1, 1]}}
  payload: {{}}
  check: {{type: {type}, algorithm: {algorithm}, covers: id..payload}}
messages:
  one: {{id: 1, from: pc, fields: {{x: uint8}}}}
"""


@pytest.mark.parametrize(
    ("type", "algorithm", "right"),
    [
        ("uint8", "xor-8", "03"),
        ("uint8", "sum-8", "03"),
        ("uint8", "sum-8/negated", "FD"),
        ("uint16", "fletcher-16", "0403"),  # running sums 1 and 3; 1 + 3 = 4
        ("uint8", "CRC-8/SMBUS", "1B"),
    ],
)
def test_checksums(type: str, algorithm: str, right: str) -> None:
    protocol = compiled(CHECKED.format(type=type, algorithm=algorithm))
    assert rows(protocol, "pc", f"01 02 {right}")[-1].fault == ""
    wrong = rows(protocol, "pc", f"01 02 {'00' * (len(right) // 2)}")[-1]
    zeros, due = bytes(len(right) // 2).hex(" "), bytes.fromhex(right).hex(" ")
    assert wrong.fault == f"check is {zeros}, not {due}"


def test_checksum_of_parts_that_are_not_shown() -> None:
    protocol = compiled(SINK)
    found = annotate(protocol, "pc", b"\x01\x02", covers=("payload", "check"))
    assert [row.path for row in found] == ["payload", "check"]
    assert found[1].meaning == "xor-8 of kind, number, length, payload"
    assert not found[1].fault


def test_overloads_are_told_apart_by_size() -> None:
    # dagny: P with one byte is `power`, without any it is `power_down`.
    assert "power_down" in lines(rows(schema("dagny"), "host", "500A"))[0]
    found = rows(schema("dagny"), "host", "50 01 51 0A")
    assert found[1].path != "payload"


CONSTANTS = """\
protocol: constants
endpoints: {pc: Computer}
frame:
  id: {type: uint8, id: true, range: [1, 1]}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: payload}
messages:
  one:
    id: 1
    from: pc
    fields:
      word: {type: ascii, size: 2, const: ab}
      mark: {type: bytes, size: 2, const: {hex: 01FF}}
      pair: {type: uint8, count: 2, const: [3, 4]}
"""


def test_constants() -> None:
    good = rows(compiled(CONSTANTS), "pc", "01 6162 01FF 0304 FA")
    assert [row.fault for row in good] == [""] * 6
    bad = rows(compiled(CONSTANTS), "pc", "01 6163 01FE 0305 FA")
    assert [row.fault for row in bad][1:5] == ['must be "ab"', "must be 01 FF", "", "must be 4"]


SEVEN_BIT_LENGTH = """\
protocol: seven
endpoints: {pc: Computer}
byte_bits: 7
byte_order: big
frame:
  id: {type: uint7, id: true, range: [1, 1]}
  length: {type: uint14, counts: [payload]}
  payload: {}
messages:
  one: {id: 1, from: pc, fields: {x: uint7}}
"""


def test_part_of_seven_bit_bytes() -> None:
    protocol = compiled(SEVEN_BIT_LENGTH)
    assert lines(rows(protocol, "pc", "01 0001 05")) == [
        "01 id 1 one",
        "0001 length 1 bytes of payload",
        "05 x 5",
    ]
    bad = rows(protocol, "pc", "01 0081 05")
    assert bad[1].fault == "81 has its most significant bit set"
    assert bad[1].value is None
