"""Which wrong bytes go unnoticed, said in sentences."""

from __future__ import annotations

import pytest
from passes_support import HEAD, framing_of, repository_protocol

DECISION = "decisions: {accepted: {question: Q, document: D, choice: C, because: B}}\n"
ONE = "messages: {gyro: {id: 1, from: robot, fields: {angle: uint16}}}\n"
TWO_ALIKE = """\
messages:
  gyro: {id: 1, from: robot, fields: {angle: uint16}}
  sonar: {id: 2, from: robot, fields: {range: uint16}}
"""
TWO_SIZES = """\
messages:
  gyro: {id: 1, from: robot, fields: {angle: uint16}}
  sonar: {id: 2, from: robot, fields: {range: uint32}}
"""


VARYING = """\
messages:
  log: {id: 1, from: robot, fields: {data: {type: bytes, size: {fill: true, max: 9}}}}
"""


def framed(parts: str, messages: str = ONE, more: str = "") -> tuple[str, ...]:
    start = "frame:\n  sync: {literal: 0xAA, unprotected: accepted}\n"
    return framing_of(HEAD + start + parts + more + DECISION + messages).undetected


def checked(algorithm: str, covers: str, bits: int = 8) -> str:
    return (
        "  id: {type: uint8, id: true}\n"
        "  length: {type: uint8, counts: payload}\n"
        "  number: {type: uint8}\n"
        "  payload: {}\n"
        f"  check: {{type: uint{bits}, algorithm: {algorithm}, covers: {covers}}}\n"
    )


@pytest.mark.parametrize(
    ("algorithm", "bits"),
    [("xor-8", 8), ("sum-8", 8), ("sum-8/negated", 8), ("CRC-8/SMBUS", 8), ("CRC-16/XMODEM", 16)],
)
def test_a_checksum_over_everything_sees_every_wrong_byte(algorithm: str, bits: int) -> None:
    assert framed(checked(algorithm, "id..payload", bits), TWO_ALIKE) == ()


def test_a_part_that_no_checksum_covers_is_named() -> None:
    (sentence,) = framed(checked("xor-8", "[id, length, payload]"))
    assert sentence == "a wrong `number`: no checksum covers it"


def test_a_length_that_no_checksum_covers_may_pass_by_chance() -> None:
    (sentence,) = framed(checked("xor-8", "[id, number, payload]"), VARYING)
    assert "`length`" in sentence
    assert "happen to check" in sentence


def test_a_wrong_length_moves_where_the_checksum_is_read() -> None:
    # AA 01 04 xx .. with the length 6 for 4: the checksum is then found two bytes further on.
    (sentence,) = framed(checked("xor-8", "id..payload"), VARYING)
    assert sentence == (
        "a wrong `length`, which moves where `check` is read, where the bytes there happen to check"
    )


def test_a_message_of_one_size_shows_a_wrong_length() -> None:
    assert framed(checked("xor-8", "[id, number, payload]"), ONE) == ()
    assert framed(checked("xor-8", "id..payload"), TWO_SIZES) == ()


def test_a_checksum_of_the_header_shows_a_wrong_length() -> None:
    parts = (
        "  id: {type: uint8, id: true}\n  length: {type: uint8, counts: payload}\n"
        "  head: {type: uint8, algorithm: xor-8, covers: [id, length]}\n  payload: {}\n"
        "  check: {type: uint8, algorithm: xor-8, covers: [payload]}\n"
    )
    assert framed(parts, VARYING) == ()


def test_a_wrong_length_without_any_checksum() -> None:
    parts = (
        "  id: {type: uint8, id: true}\n  length: {type: uint8, counts: payload}\n  payload: {}\n"
    )
    assert "a wrong `length`: nothing checks it" in framed(parts, VARYING)


def test_a_length_of_0_does_without_a_checksum() -> None:
    parts = checked("xor-8", "id..payload").replace("covers", "when: payload, covers")
    assert any("that there is no payload" in sentence for sentence in framed(parts, VARYING))


def test_a_wrong_identity_or_count_moves_the_checksum_as_well() -> None:
    parts = (
        "  id: {type: uint8, id: true}\n  payload: {}\n"
        "  check: {type: uint16, algorithm: CRC-16/KERMIT, covers: [id, payload]}\n"
    )
    (sentence,) = framed(parts, TWO_SIZES)
    assert sentence.startswith("a wrong byte that moves where `check` is read")
    assert framed(parts, TWO_ALIKE) == ()


ENDED = (
    "frame:\n  id: {type: uint8, id: true}\n  payload: {}\n"
    "  check: {type: uint8, algorithm: ALGORITHM, covers: [id, payload]}\n"
    "  end: {literal: 0x0A, unprotected: accepted}\n"
)


def ended(algorithm: str, messages: str = VARYING) -> str:
    text = HEAD + ENDED.replace("ALGORITHM", algorithm) + DECISION + messages
    if algorithm.startswith("CRC-16"):
        text = text.replace("check: {type: uint8", "check: {type: uint16, byte_order: big")
    return "\n".join(framing_of(text).undetected)


@pytest.mark.parametrize(
    ("algorithm", "words"),
    [
        ("xor-8", "a wrong end of 00 joins two frames"),
        ("sum-8/negated", "a wrong end of 00 joins two frames"),
        ("CRC-8/SMBUS", "a wrong end of 00 joins two frames"),
        ("CRC-16/XMODEM", "a wrong end of 00 joins two frames"),
        ("sum-8", "a wrong end of one value, another for each frame, joins two"),
    ],
)
def test_a_wrong_end_joins_two_frames(algorithm: str, words: str) -> None:
    assert words in ended(algorithm)


def test_a_wrong_end_that_joins_nothing() -> None:
    # What a frame leaves in the register is then not what the next one starts from.
    assert "joins" not in ended("CRC-16/IBM-3740")
    assert "joins" not in ended("xor-8", ONE)


def test_a_protected_end_can_be_damaged_as_well() -> None:
    text = HEAD + ENDED.replace("ALGORITHM", "xor-8").replace(", unprotected: accepted", "")
    text = text.replace("0x0A", "0xC0") + "transparency: slip\n" + VARYING
    assert "a wrong end of 00 joins" in "\n".join(framing_of(text).undetected)
    cobs = text.replace("0xC0", "0").replace("slip", "{encoding: cobs}")
    assert "a wrong end of 01 joins" in "\n".join(framing_of(cobs).undetected)


def test_a_false_start_in_a_frame_that_nothing_checks() -> None:
    parts = "  id: {type: uint8, id: true}\n  payload: {}\n"
    assert any("makes AA, the start" in sentence for sentence in framed(parts))


def test_behind_a_length_that_is_wrong_no_end_stands() -> None:
    parts = checked("xor-8", "[id, number, payload]")
    assert framed(parts + "  end: {literal: 0xBB, unprotected: accepted}\n") == ()


def test_a_wrong_identity_is_a_message_of_the_same_size() -> None:
    parts = checked("xor-8", "length..payload")
    (sentence,) = framed(parts, TWO_ALIKE)
    assert sentence == "a wrong `id` that makes it another message of the same size"
    assert framed(parts, ONE) == ()
    assert framed(parts, TWO_SIZES) == ()


def test_without_a_checksum_nothing_checks_the_payload() -> None:
    parts = (
        "  id: {type: uint8, id: true}\n  length: {type: uint8, counts: payload}\n  payload: {}\n"
        "  end: {literal: 0xBB, unprotected: accepted}\n"
    )
    assert framed(parts)[0] == "a wrong byte in the payload: nothing checks it"


def test_fletcher_takes_00_for_ff() -> None:
    # Sums modulo 255: 00 and FF are the same to it.
    (sentence,) = framed(checked("fletcher-16", "id..payload", 16))
    assert "fletcher-16 does not see them" in sentence
    # Modulo 256 they are not.
    assert framed(checked("fletcher-16/256", "id..payload", 16)) == ()


@pytest.mark.parametrize(
    "parameters",
    [
        # Four bits have 16 values for 256 bytes.
        "{width: 4, poly: 0x3}",
        # Without the lowest bit the polynomial is divisible by x.
        "{width: 8, poly: 0x06}",
    ],
)
def test_a_weak_crc_is_named(parameters: str) -> None:
    bits = 4 if "width: 4" in parameters else 8
    (sentence,) = framed(checked(parameters, "id..payload", bits))
    assert "`check`" in sentence


@pytest.mark.parametrize(
    ("transparency", "words"),
    [
        ("{encoding: cobs}", "a wrong COBS code byte"),
        ("slip", "makes or breaks a stuffed sequence"),
        ("{encoding: base16-upper}", ""),
    ],
)
def test_stuffing_makes_several_wrong_bytes_of_one(transparency: str, words: str) -> None:
    frame = (
        "frame:\n  id: {type: uint8, id: true}\n  payload: {}\n"
        "  check: {type: uint8, algorithm: xor-8, covers: id..payload}\n"
        "  end: {literal: END}\n"
    )
    end = {"slip": "0xC0", "{encoding: cobs}": "0"}.get(transparency, "{text: e}")
    text = HEAD + frame.replace("END", end) + f"transparency: {transparency}\n" + ONE
    found = framing_of(text).undetected
    assert len(found) == bool(words)
    assert words in "".join(found)


def test_the_documents() -> None:
    def said(protocol: str, sender: str) -> str:
        return "\n".join(repository_protocol(protocol).sender(sender).framing.undetected)

    # rn1 and uherobot have no checksum at all.
    assert "payload" in said("rn1", "brain")
    assert "makes a start, 80 to FE" in said("rn1", "brain")
    assert "a wrong end of 00 joins" in said("dagny", "host")
    assert "still a hex digit" in said("uherobot", "board")
    # rflex: the checksum covers the contents only.
    for part in ("class", "number", "subclass"):
        assert f"`{part}`" in said("rflex", "flex")
    assert "payload" not in said("rflex", "flex")
    # matty: the sum covers everything behind the start.
    assert "`" not in said("matty", "pc")
