"""Examples: their bytes, cut into what they mean."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from markdown_pages import example_rows, page, tables
from models import (
    CHAR,
    SINT14,
    UINT8,
    UINT8_ENUM,
    UINT16,
    UINT16_BIG,
    about,
    base16_frame,
    example,
    fields,
    flags_type,
    message,
    protocol,
    rflex_frame,
    robbus_frame,
    simple_frame,
    switch_message,
)

from protogen.copying import replace
from protogen.model.expressions import named
from protogen.model.frame import Frame
from protogen.model.meanings import BitField, NamedValue
from protogen.model.messages import Contradiction
from protogen.model.parts import LiteralPart
from protogen.model.transparency import Cobs, Transparency
from protogen.model.types import Array, Counted, Fill, Fixed, Float, Integer, Octets, Struct, Text


def test_example_is_cut_into_parts_and_fields():
    speed = ("speed", UINT16, {"unit": "mm/s", "scale": Fraction(1, 10)})
    shown = example("fast", "AA 07 E8 03 02 0D 0A", about=about("Fast.", "9"))
    made = protocol(message("go", 7, speed, ("mode", UINT8_ENUM), examples=(shown,)))
    assert example_rows(made) == [
        ("0", "`AA`", "`start`", "", "Fixed."),
        ("1", "`07`", "`id`", "`0x07`", "`go`"),
        ("2..3", "`E8 03`", "`speed`", "`1000`", "100 mm/s"),
        ("4", "`02`", "`mode`", "`2`", "`auto`"),
        ("5..6", "`0D 0A`", "`end`", "", "Fixed."),
    ]
    text = page(made)
    assert '#### <a id="example-go-fast"></a>Example fast\n\nFast. (line 9)\n' in text
    assert "```text\nAA 07 E8 03 02 0D 0A\n```" in text


def test_stuffed_example_shows_both_forms():
    # Robbus: 0x55 is sent as 56 AA; the checksum is 0 - (04 + 01 + 47 + 55 + 00) = 5F.
    shown = example("e", "55 04 01 47 56 AA 00 5F")
    made = protocol(message("go", 0x47, ("v", UINT16), examples=(shown,)), frame=robbus_frame())
    assert example_rows(made) == [
        ("0", "`55`", "", "`sync`", "", "Fixed."),
        ("1", "`04`", "", "`length`", "`4`", "Length."),
        ("2", "`01`", "", "`counter`", "`1`", "Counter."),
        ("3", "`47`", "", "`command`", "'G' `0x47`", "`go`"),
        ("4..6", "`56 AA 00`", "`55 00`", "`v`", "`85`", ""),
        ("7", "`5F`", "", "`crc`", "`0x5F`", "Checksum."),
    ]


def test_base16_example_shows_digits_and_bytes():
    shown = example("e", b"b060300000000e".hex())
    made = protocol(
        message("test", 3, ("a", UINT16_BIG), ("b", UINT16_BIG), examples=(shown,)),
        frame=base16_frame(),
    )
    assert example_rows(made)[3] == ("5..8", "`30 30 30 30`", "`00 00`", "`a`", "`0`", "")
    assert "62 30 36 30 33 30 30 30 30 30 30 30 30 65  b060300000000e\n" in page(made)


def test_substituted_and_cobs_examples():
    shown = example("e", "1B 02 01 FF 02 02 7C 1B 01 1B 00 67 1B 03")
    made = protocol(
        message("m", (1, 2), ("a", UINT8), ("b", UINT8), examples=(shown,)), frame=rflex_frame()
    )
    assert example_rows(made)[5:7] == [
        ("6..8", "`7C 1B 01`", "`7C`", "`a`", "`124`", ""),
        ("9..10", "`1B 00`", "`1B`", "`b`", "`27`", ""),
    ]
    cobs = Frame(
        parts=(*simple_frame().parts[1:3], LiteralPart(name="zero", bytes=b"\0")),
        transparency=Transparency(first="id", last="payload", encoding=Cobs()),
    )
    # COBS of 05 00 07 is 02 05 02 07.
    made = protocol(
        message("m", 5, ("a", UINT16_BIG), examples=(example("e", "02 05 02 07 00"),)), frame=cobs
    )
    assert [row[:5] for row in example_rows(made)] == [
        ("0", "`02`", "", "", ""),
        ("1", "`05`", "", "`id`", "`0x05`"),
        ("2..3", "`02 07`", "`00 07`", "`a`", "`7`"),
        ("4", "`00`", "", "`zero`", ""),
    ]


def test_example_of_some_parts_only():
    shown = example(
        "e", "01 FF 02 01 09", covers=("class_id", "number", "subclass", "length", "payload")
    )
    made = protocol(message("m", (1, 2), ("a", UINT8), examples=(shown,)), frame=rflex_frame())
    assert [row[2] for row in example_rows(made)] == [
        "`class_id`",
        "`number`",
        "`subclass`",
        "`length`",
        "`a`",
    ]
    assert "Bytes of `class_id` to `payload`." in page(made)
    alone = example("e", "09", covers=("payload",))
    made = protocol(message("m", (1, 2), ("a", UINT8), examples=(alone,)), frame=rflex_frame())
    assert "Bytes of `payload`." in page(made)


def payload_rows(data: str, *pairs: Any) -> list[tuple[str, ...]]:
    """The annotated payload of a message with these fields."""
    shown = example("e", data, covers=("payload",))
    return [row[1:] for row in example_rows(protocol(message("m", 1, *pairs, examples=(shown,))))]


def test_examples_of_every_type():
    point = Struct(name="p", fields=fields(("x", UINT8), ("y", UINT8, {"unit": "mm"})))
    rows = payload_rows(
        "C3 F5 48 40 02 61 62 00 00 DE AD 03 04 05 06",
        ("pi", Float(bits=32), {"unit": "rad"}),
        ("n", UINT8),
        ("text", Text(extent=Fixed(count=4))),
        (
            "raw",
            Octets(extent=Counted(by=named("n"), least=0, greatest=9)),
            {"about": about("Bytes.")},
        ),
        ("points", Array(element=point, extent=Fill(greatest=9))),
    )
    assert rows == [
        ("`C3 F5 48 40`", "`pi`", "`3.140000104904175`", "rad"),
        ("`02`", "`n`", "`2`", ""),
        ("`61 62 00 00`", "`text`", "'ab'", ""),
        ("`DE AD`", "`raw`", "", "Bytes."),
        ("`03 04`", "`points[0]`", "x `3`, y `4` (4 mm)", ""),
        ("`05 06`", "`points[1]`", "x `5`, y `6` (6 mm)", ""),
    ]


def test_examples_of_long_arrays_are_cut_short():
    rows = payload_rows("01 00 " * 20, ("a", Array(element=UINT16, extent=Fixed(count=20))))
    cut = "`01 00 01 00 01 00 01 00 01 00 01 00` ... `01 00`"
    assert rows == [(cut, "`a`", ", ".join(["`1`"] * 8 + ["..."]))]
    pair = Struct(name="p", fields=fields(("x", UINT8), ("s", Text(extent=Fixed(count=1)))))
    rows = payload_rows("01 41" * 33, ("a", Array(element=pair, extent=Fixed(count=33))))
    assert rows[0][1:] == ("`a`", "33 elements.")
    few = payload_rows("01 41", ("a", Array(element=pair, extent=Fixed(count=1))))
    assert [row[1] for row in few] == ["`a[0].x`", "`a[0].s`"]


def test_examples_of_long_arrays_of_varying_elements():
    word = Struct(
        name="w",
        fields=fields(
            ("n", UINT8), ("t", Text(extent=Counted(by=named("n"), least=0, greatest=1)))
        ),
    )
    rows = payload_rows("00" * 40, ("a", Array(element=word, extent=Fixed(count=40))))
    assert rows[0][1:] == ("`a`", "40 elements.")


def test_examples_of_floats_and_seven_bit_numbers():
    rows = payload_rows(
        "7B 7F 00 00 00 7C 03 3F 80 00 00",
        ("x", SINT14),
        ("f", Float(bits=32, byte_bits=7)),
        ("g", Array(element=Float(bits=32, byte_order="big"), extent=Fixed(count=1))),
    )
    assert [row[2] for row in rows] == ["`-5`", "`1.0`", "`1.0`"]


def test_examples_follow_the_switch():
    made = switch_message()
    shown = [
        example(name, data, covers=("payload",))
        for name, data in (
            ("baud", "41 00 01"),
            ("kill", "51"),
            ("seven", "07 09"),
            ("rest", "08 AB"),
        )
    ]
    text = page(protocol(replace(made, examples=tuple(shown))))
    rows = [row for rows in tables(text) if rows[0][0] == "Byte" for row in rows[2:]]
    assert [row[2] for row in rows if row[2] != "`op`"] == ["`argument.rate`", *["`argument`"] * 2]
    assert "Raw bytes, as no case has this value." in text


def test_examples_say_what_numbers_mean():
    bits = Integer(
        bits=8,
        bit_fields=(
            BitField(name="level", low=0, high=3),
            BitField(name="gear", low=4, high=5, enum=UINT8_ENUM.enum),
        ),
    )
    flags = flags_type()
    rows = payload_rows(
        "23 81 00 00 00 05 FF 41",
        ("bits", bits),
        ("set", flags),
        ("clear", flags),
        ("mode", UINT8_ENUM),
        ("echo", UINT8, {"special": (NamedValue(name="none", value=255),), "unit": "mm"}),
        ("letter", CHAR, {"about": about("A letter.")}),
    )
    assert [row[-2:] for row in rows] == [
        ("`35`", "`level` 3, `gear` 2 auto"),
        ("`129`", "`led_0`, `led_7`"),
        ("`0`", "no flag"),
        ("`5`", "no name"),
        ("`255`", "`none`"),
        ("'A' `0x41`", "A letter."),
    ]


def test_bytes_that_do_not_fit_are_shown_as_such():
    rows = payload_rows("01 02", ("a", UINT16), ("b", UINT16))
    assert rows == [
        ("`01 02`", "`a`", "`513`", ""),
        ("", "`b`", "", "**Missing bytes: 2.**"),
    ]
    rows = payload_rows("01 02 03", ("a", UINT16), ("b", UINT16, {"about": about("B.")}))
    assert rows[-1] == ("`03`", "`b`", "", "B. **Missing bytes: 1.**")
    rows = payload_rows("01 02", ("a", UINT8))
    assert rows[-1] == ("`02`", "`payload`", "", "Payload. **Nothing is due here.**")
    rows = payload_rows("FF FF", ("a", SINT14))
    assert rows == [("`FF FF`", "`a`", "**Has a byte of more than 7 bits.**")]


def test_values_that_do_not_fit_are_shown_in_their_list():
    made = Array(element=SINT14, extent=Fixed(count=3))
    assert payload_rows("01 00 80 80 02 00", ("a", made)) == [
        ("`01 00 80 80 02 00`", "`a`", "`1`, ?, `2`", "**Has a byte of more than 7 bits.**")
    ]


def test_arrays_in_arrays():
    row = Struct(name="r", fields=fields(("v", Array(element=UINT8, extent=Fixed(count=2)))))
    rows = payload_rows(
        "01 02 03 04 41 42",
        ("r", Array(element=row, extent=Fixed(count=2))),
        (
            "s",
            Array(
                element=Struct(
                    name="t", fields=fields(("u", UINT8), ("t", Text(extent=Fixed(count=1))))
                ),
                extent=Fixed(count=1),
            ),
        ),
    )
    assert rows == [
        ("`01 02`", "`r[0].v`", "`1`, `2`"),
        ("`03 04`", "`r[1].v`", "`3`, `4`"),
        ("`41`", "`s[0].u`", "`65`"),
        ("`42`", "`s[0].t`", "'B'"),
    ]


def test_physical_values_of_floats():
    rows = payload_rows(
        "3F C0 00 00 3F C0 00 00",
        ("a", Float(bits=32, byte_order="big"), {"unit": "V", "scale": Fraction(1, 2)}),
        ("b", Float(bits=32, byte_order="big"), {"about": about("A ratio.")}),
    )
    assert [row[2:] for row in rows] == [("`1.5`", "0.75 V"), ("`1.5`", "A ratio.")]


def bad_robbus_rows(data: str) -> list[tuple[str, ...]]:
    shown = example("e", data)
    made = protocol(message("m", 0x47, ("a", UINT8), examples=(shown,)), frame=robbus_frame())
    return example_rows(made)


def test_frames_that_are_none_are_shown_as_far_as_they_look_like_one():
    assert bad_robbus_rows("AA") == [
        ("0", "`AA`", "`sync`", "Fixed. **Must be 55.**"),
        ("", "", "`length`", "Length. **Missing bytes: 1.**"),
    ]
    assert bad_robbus_rows("55 03 01 47 09 5F")[-1][-1] == "Checksum. **`crc` is 5f, not ac.**"
    stuffed = bad_robbus_rows("55 04 01 47 56 00 5F")
    assert stuffed[3][:3] == ("3", "`47`", "`command`")
    assert stuffed[-1][1] == "`56 00 5F`"
    assert stuffed[-1][-1].startswith("**56 00 is ")


def test_example_without_bytes_has_no_table():
    made = protocol(message("m", 1, examples=(example("e", "", covers=("payload",)),)))
    assert not [rows for rows in tables(page(made)) if rows[0][0] == "Byte"]


def test_example_of_another_identity_is_read_as_its_message():
    shown = example("e", "AA 09 05 0D 0A")
    made = protocol(message("go", 7, ("speed", UINT8), examples=(shown,)))
    assert [row[2] for row in example_rows(made)] == ["`start`", "`id`", "`speed`", "`end`"]


def test_long_examples_are_cut():
    shown = example("e", "00" * 600, covers=("payload",))
    made = message("m", 1, ("a", Octets(extent=Fill(greatest=600))), examples=(shown,))
    assert "... 600 bytes in all" in page(protocol(made))


@pytest.mark.parametrize(
    ("contradiction", "expected"),
    [
        (
            Contradiction(fails="values", why="A slip", reads={"a": 9}),
            "Its bytes hold other values than the document gives. "
            "The schema reads `a` as `9`. A slip.",
        ),
        (Contradiction(fails="unknown", why="Gone."), "No message has its identity. Gone."),
        (
            Contradiction(fails="length", why="12 < 13"),
            "A receiver rejects it (length). 12 &lt; 13.",
        ),
    ],
)
def test_contradictions_are_explained(contradiction, expected):
    shown = example("odd", "AA 01 09 0D 0A", contradicts=contradiction)
    made = protocol(message("m", 1, ("a", UINT8), examples=(shown,)))
    assert f"**Contradicts this reference.** {expected}\n" in page(made)
    fidelity = page(made, "fidelity.md")
    assert "- **Contradicts:** [m, odd](tiny.md#example-m-odd): " in fidelity
    assert "- **Examples:** 0 verified, 1 contradict\n" in fidelity
