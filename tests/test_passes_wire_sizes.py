"""Bytes on the wire, stuffing included, worked out by hand."""

from __future__ import annotations

from binascii import crc_hqx

import pytest
from passes_support import HEAD, framing_of, message_framing

from protogen.model.sizes import SizeSet


def sizes(frame: str, fields: str, identity: int = 1) -> tuple[int, int]:
    """The least and the greatest frame of a message with these fields."""
    message = f"messages: {{gyro: {{id: {identity}, from: robot, fields: {{{fields}}}}}}}\n"
    item = message_framing(framing_of(HEAD + frame + message), "gyro")
    return item.least, item.greatest


SLIP = """\
frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}
transparency: slip
"""


def test_without_stuffing_a_frame_is_the_sum_of_its_parts() -> None:
    frame = """\
frame:
  sync: {literal: {hex: AA 55 01}, unprotected: accepted}
  id: {type: uint8, id: true}
  length: {type: uint16, counts: payload, range: [0, 300]}
  payload: {}
  check: {type: uint32, algorithm: CRC-32/ISO-HDLC, covers: id..payload}
decisions: {accepted: {question: Q, document: D, choice: C, because: B}}
"""
    # 3 + 1 + 2 + payload + 4
    assert sizes(frame, "a: uint32, b: float64") == (22, 22)
    assert sizes(frame, "a: {type: bytes, size: fill}") == (10, 310)


@pytest.mark.parametrize(
    ("identity", "expected"),
    [
        # identity, two bytes of payload that take one or two each, end
        (0x01, (1 + 2 + 1, 1 + 4 + 1)),
        # An identity that is an end or an escape takes two bytes in every frame.
        (0xC0, (2 + 2 + 1, 2 + 4 + 1)),
        (0xDB, (2 + 2 + 1, 2 + 4 + 1)),
    ],
)
def test_the_identity_of_a_message_is_stuffed_as_it_is(
    identity: int, expected: tuple[int, int]
) -> None:
    assert sizes(SLIP, "angle: uint16", identity) == expected


def test_an_identity_of_two_bytes_is_stuffed_byte_by_byte() -> None:
    frame = SLIP.replace("uint8", "uint16")
    # 0xC0DB: both of its bytes take two.
    assert sizes(frame, "", 0xC0DB) == (4 + 1, 4 + 1)


def test_base16_takes_two_digits_a_byte() -> None:
    frame = """\
frame:
  begin: {literal: {text: b}}
  id: {type: uint8, id: true}
  payload: {}
  end: {literal: {text: e}}
transparency: {encoding: base16-upper}
"""
    # b, two digits of the identity, two for each of 1 + 2 * n bytes, e
    fields = "points: {type: uint8, range: [0, 3]}, angles: {type: uint16, count: points}"
    assert sizes(frame, fields) == (1 + 2 + 2 + 1, 1 + 2 + 2 * 7 + 1)


def test_a_part_outside_of_the_transparency_is_not_stuffed() -> None:
    frame = """\
frame:
  id: {type: uint8, id: true, range: [0, 9]}
  length: {type: uint8, counts: payload}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: payload}
transparency: {preset: slip, covers: payload}
"""
    assert sizes(frame, "angle: uint16") == (2 + 2 + 1, 2 + 4 + 1)


def test_a_checksum_that_is_absent_without_payload() -> None:
    frame = """\
frame:
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint16, algorithm: CRC-16/XMODEM, covers: id..payload, when: payload}
  end: {literal: 0xC0}
transparency: slip
"""
    assert sizes(frame, "") == (2, 2)
    # identity, payload, two bytes of CRC, end; payload and CRC can be stuffed
    contents = [bytes((1, value)) for value in range(256)]
    frames = [data + crc_hqx(data, 0).to_bytes(2, "little") for data in contents]
    stuffed = [1 + len(data) + sum(byte in b"\xc0\xdb" for byte in data) for data in frames]
    assert sizes(frame, "a: uint8") == (min(stuffed), max(stuffed))
    assert sizes(frame, "a: {type: bytes, size: {fill: true, max: 1}}") == (2, max(stuffed))


COBS = """\
frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0}}
transparency: {encoding: cobs}
"""


@pytest.mark.parametrize("size", [0, 1, 100, 252])
def test_cobs_takes_one_code_byte_for_short_frames(size: int) -> None:
    # code byte, identity, payload, zero
    expected = 1 + 1 + size + 1
    assert sizes(COBS, f"data: {{type: bytes, size: {size}}}") == (expected, expected)


@pytest.mark.parametrize(
    ("size", "codes"),
    [
        # With the identity: 255, 508 and 509 bytes, a code byte for each 254 that are begun.
        (254, 2),
        (507, 2),
        (508, 3),
    ],
)
def test_cobs_takes_a_code_byte_for_each_254_bytes_at_worst(size: int, codes: int) -> None:
    least, greatest = sizes(COBS, f"data: {{type: bytes, size: {size}}}")
    # With zeros in the right places one code byte is enough.
    assert least <= codes + 1 + size + 1
    assert greatest >= codes + 1 + size + 1
    # No bound is more than one byte too careful.
    assert greatest <= codes + 1 + size + 2


def test_seven_bit_numbers_take_a_byte_for_each_seven_bits() -> None:
    frame = """\
byte_bits: 7
frame: {start: {type: byte, id: true, range: [0x80, 0xFE]}, payload: {}}
"""
    # start; uint7: 1, uint8: 2, uint14: 2, uint16: 3, float32: 5, uint64: 10
    fields = "a: uint7, b: uint8, c: uint14, d: uint16, e: float32, f: uint64"
    assert sizes(frame, fields, 0x80) == (1 + 23, 1 + 23)


def test_a_switch_takes_what_its_cases_take_or_the_rest() -> None:
    fields = (
        "kind: {type: uint8, range: [0, 2]}, "
        "value: {switch: kind, cases: {0: {fields: {}}, 1: uint8, 2: uint32}}"
    )
    # identity and end; the kind; nothing, one or four bytes; the kind and a value can be stuffed
    assert sizes(SLIP, fields)[0] == 3
    assert sizes(SLIP, fields)[1] >= 1 + 2 + 8 + 1
    without_end = """\
frame: {start: {type: byte, id: true, range: [0x80, 0xFE]}, payload: {}}
byte_bits: 7
"""
    # start; uint8 in two bytes of seven bits; nothing, two or five bytes
    assert sizes(without_end, fields, 0x80) == (3, 3 + 5)


def test_overhead_counts_no_stuffing() -> None:
    text = HEAD + SLIP + "messages: {gyro: {id: 1, from: robot, fields: {a: uint8}}}\n"
    assert framing_of(text).overhead == SizeSet.exactly(2)


def test_only_what_is_written_as_digits_takes_twice_the_bytes() -> None:
    frame = """\
frame:
  sync: {literal: {text: z}}
  id: {type: uint8, id: true}
  length: {type: uint8, counts: payload}
  payload: {}
transparency: {encoding: base16-upper, covers: id..id}
decisions: {accepted: {question: Q, document: D, choice: C, because: B}}
""".replace("{text: z}", "{text: z}, unprotected: accepted")
    # sync 1, identity 2, length 1, payload 1 to 4: any of these numbers, not every other one.
    assert sizes(frame, "n: {type: uint8, range: [0, 3]}, a: {type: uint8, count: n}") == (5, 8)


def test_a_text_without_a_byte_says_nothing_of_other_payloads() -> None:
    """Frames of an unknown identity have payloads that nobody knows, as their length says."""
    frame = """\
frame:
  id: {type: uint8, id: true}
  length: {type: uint8, counts: payload, range: [0, 9]}
  payload: {}
  end: {literal: 0xC0}
transparency: slip
"""
    text = 'a: {type: ascii, size: 0, code: {bits: 7}, const: ""}'
    message = f"messages: {{gyro: {{id: 1, from: robot, fields: {{{text}}}}}}}\n"
    found = framing_of(HEAD + frame + message)
    assert (found.least, found.greatest) == (3, 3 + 1 + 2 * 9)  # An identity of C0 takes two bytes.
