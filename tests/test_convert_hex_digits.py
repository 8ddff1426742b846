"""Messy hex: every way in which people paste bytes, and where a mistake is."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protogen.convert.inputs.hex_digits import HexError, HexReader, parse_hex

GOOD = [
    ("", ""),
    (" \n\t ", ""),
    ("1B 02 0a", "1b020a"),
    ("1b020A", "1b020a"),
    ("0x1B, 0x02, 0xA", "1b020a"),
    ("0X1b02", "1b02"),
    (r"\x1b\x02", "1b02"),
    (r"\x1B \X02", "1b02"),
    ("1B:02:0a", "1b020a"),
    ("1B;02", "1b02"),
    ("0x1B0x02", "1b02"),
    ("# a capture\n1B 02  # start\n\n03", "1b0203"),
    ("1B\r\n02\r\n", "1b02"),
    ("# only a comment", ""),
]


@pytest.mark.parametrize(("text", "expected"), GOOD)
def test_good_text(text: str, expected: str) -> None:
    assert parse_hex(text).hex() == expected


@pytest.mark.parametrize(
    ("text", "line", "column", "message"),
    [
        ("1B 0G", 1, 5, "`G` is no hex digit and no separator"),
        ("1B\n  O2", 2, 3, "`O` is no hex digit and no separator"),
        ("1B 02 3", 1, 7, "`3` has an odd number of hex digits"),
        ("1B 023 04", 1, 4, "`023` has an odd number of hex digits"),
        (r"1B \x", 1, 4, r"`\` is no hex digit and no separator"),
        ("1B 0x", 1, 5, "`x` is no hex digit and no separator"),
        ("# comment\n\n1B zz", 3, 4, "`z` is no hex digit and no separator"),
        ("1B 5X", 1, 5, "`X` is no hex digit and no separator"),
        ("0x123", 1, 1, "`0x123` has an odd number of hex digits"),
        ("héx", 1, 1, "`h` is no hex digit and no separator"),
    ],
)
def test_mistake_is_placed(text: str, line: int, column: int, message: str) -> None:
    with pytest.raises(HexError) as caught:
        parse_hex(text)
    assert str(caught.value) == f"line {line}, column {column}: {message}"
    assert (caught.value.line, caught.value.column) == (line, column)


def outcome(pieces: list[str]) -> object:
    reader = HexReader()
    try:
        return b"".join(map(reader.feed, pieces)) + reader.finish()
    except HexError as error:
        return str(error)


@given(st.text(alphabet="01aF xX\\,:;#\n\tg", max_size=40), st.integers(1, 5))
def test_cuts_change_nothing(text: str, width: int) -> None:
    pieces = [text[start : start + width] for start in range(0, len(text), width)]
    assert outcome(pieces) == outcome([text])


@given(st.binary(max_size=80), st.sampled_from(["", " ", ", ", ":", "\n", " # x\n"]))
def test_any_bytes_in_any_separator(data: bytes, separator: str) -> None:
    assert parse_hex(separator.join(f"{byte:02X}" for byte in data)) == data


def test_long_run_without_separator_is_not_held_back() -> None:
    reader = HexReader()
    assert len(reader.feed("1B" * 40_000)) == 40_000


def test_place_is_right_after_many_pieces() -> None:
    reader = HexReader()
    for _ in range(10):
        reader.feed("1B 02\n")
    with pytest.raises(HexError, match="line 11, column 4"):
        reader.feed("1B ??")
