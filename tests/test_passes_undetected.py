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
    (sentence,) = framed(checked("xor-8", "[id, number, payload]"))
    assert "`length`" in sentence
    assert "happen to check" in sentence


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
    assert framed(parts) == ("a wrong byte in the payload: nothing checks it",)


def test_fletcher_takes_00_for_ff() -> None:
    # Sums modulo 255: 00 and FF are the same to it.
    (sentence,) = framed(checked("fletcher-16", "id..payload", 16))
    assert "fletcher-16 does not see them" in sentence


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
    assert "still a hex digit" in said("uherobot", "board")
    # rflex: the checksum covers the contents only.
    for part in ("class_id", "number", "subclass"):
        assert f"`{part}`" in said("rflex", "flex")
    assert "payload" not in said("rflex", "flex")
    # matty: the sum covers everything behind the start.
    assert "`" not in said("matty", "pc")
