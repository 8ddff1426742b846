"""Meanings of values: ranges, units, types, and the tables of names."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from markdown_pages import layout, page, table_of
from models import (
    CHAR,
    SINT14,
    UINT8,
    UINT8_ENUM,
    UINT16,
    about,
    fields,
    flags_type,
    message,
    protocol,
)

from protogen.model.expressions import named
from protogen.model.meanings import BitField, Enum, Flags, NamedBit, NamedValue
from protogen.model.origin import About, Source
from protogen.model.sizes import SizeSet
from protogen.model.types import (
    Array,
    Case,
    Fill,
    Fixed,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
)
from protogen.targets.markdown.text.words import (
    bounds,
    hex_number,
    listed,
    number,
    plural,
    rate,
    sentence,
    size_text,
)


def one_field(kind: Any, **more: Any) -> dict[str, str]:
    """The row of a message's only field."""
    return layout(protocol(message("m", 1, ("f", kind, more))))[2]


@pytest.mark.parametrize(
    ("kind", "more", "expected"),
    [
        (UINT8, {}, "0..255"),
        (Integer(bits=32), {}, "0..2^32-1"),
        (Integer(bits=32, signed=True), {}, "-2^31..2^31-1"),
        (UINT8, {"greatest": Fraction(4), "least": Fraction(1), "ranged": True}, "1..4"),
        (UINT8, {"const": 66}, "always `0x42`"),
        (UINT8, {"default": 5}, "0..255; default `5`"),
        (UINT8, {"special": (NamedValue(name="none", value=0),)}, "0..255; `0` none"),
        (SINT14, {"scale": Fraction(1, 16)}, "-8192..8191 (-512..511.9375)"),
        (SINT14, {"scale": Fraction(-1), "unit": "m"}, "-8192..8191 (-8191..8192 m)"),
        (UINT8_ENUM, {}, "`0` idle, `2` auto"),
        (UINT8_ENUM, {"const": 2}, "always `2` auto"),
        (CHAR, {}, ""),
        (CHAR, {"const": ord("A")}, "always 'A' `0x41`"),
        (
            Integer(bits=8, flags=Flags(name="f", bits=(NamedBit(name="on", bit=3),))),
            {},
            "bit 3 on",
        ),
        (Text(extent=Fixed(count=2)), {"const": "a|"}, "always 'a\\|'"),
        (Octets(extent=Fixed(count=2)), {"const": b"\x01\xff"}, "always `01 FF`"),
        (Octets(extent=Fixed(count=0)), {"const": b""}, "always no bytes"),
        (Array(element=UINT8, extent=Fixed(count=2)), {"const": (1, 16)}, "always `1`, `0x10`"),
        (Float(bits=32), {}, ""),
        (Float(bits=32), {"default": 0.5}, "default `0.5`"),
        (Float(bits=64), {"least": Fraction(0)}, "0.."),
    ],
)
def test_range_says_which_values_are_allowed(kind, more, expected):
    assert one_field(kind, **more).get("Range", "") == expected


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ({"unit": "mm"}, "mm"),
        ({"unit": "deg", "scale": Fraction(1, 16)}, "deg, raw / 16"),
        ({"unit": "cm", "scale": Fraction(2)}, "cm, raw x 2"),
        ({"scale": Fraction(3, 8)}, "raw x 0.375"),
        ({"scale": Fraction(2, 3)}, "raw x 2/3"),
        ({"unit": "K", "offset": Fraction(-40)}, "K, raw - 40"),
        ({"unit": "V", "scale": Fraction(1, 10), "offset": Fraction(5, 2)}, "V, raw / 10 + 2.5"),
        ({"unit": "a|b"}, "a\\|b"),
    ],
)
def test_unit_says_how_the_physical_value_follows(more, expected):
    assert one_field(UINT8, **more)["Unit"] == expected


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        (Integer(bits=7, byte_bits=7), "`uint7`"),
        (Integer(bits=8, role="byte"), "`byte`"),
        (Integer(bits=8, role="bool"), "`bool`"),
        (Float(bits=64, byte_order="big"), "`float64` BE"),
        (Octets(extent=Fixed(count=4)), "`bytes`"),
        (
            Array(element=UINT16, extent=Fill(greatest=1)),
            "`uint16` LE to the end, at most 1 element",
        ),
        (Struct(name="s", fields=fields(("a", UINT8))), "struct"),
    ],
)
def test_type_is_named_as_in_a_schema(kind, expected):
    assert one_field(kind)["Type"] == expected


def test_meaning_has_doc_and_source_and_says_what_is_unknown():
    assert (
        one_field(UINT8, about=about("Speed of it.", "62"))["Meaning"] == "Speed of it. (line 62)"
    )
    assert one_field(UINT8, about=about("", "61-65"))["Meaning"] == "Lines 61-65."
    source = Source(document="x.pdf", revision="3", section="2.1", url="https://a.b/c", note="old")
    assert one_field(UINT8, about=About(doc="A", source=source))["Meaning"] == (
        "A. (x.pdf, revision 3, section 2.1, old, <https://a.b/c>)"
    )
    commit = About(source=Source(document="a/b.c", revision="0123456789abcdef0123" * 2))
    assert one_field(UINT8, about=commit)["Meaning"] == "a/b.c, revision 0123456789."
    spoiled = About(source=Source(url="https://a.b/> <b>"))
    assert one_field(UINT8, about=spoiled)["Meaning"] == "https://a.b/&gt; &lt;b&gt;."
    unknown = one_field(UINT8, unknown=True)
    assert unknown["Meaning"] == "Unknown: the document does not say what it is."


def test_flags_with_meanings_have_a_table():
    made = protocol(message("m", 1, ("f", flags_type())))
    assert "[bit 0 led_0, bit 7 led_7](#message-m-f)" in page(made)
    assert '<a id="message-m-f"></a>**`f`**: Bits without a name are kept as they are.' in page(
        made
    )
    assert table_of(made, "Bit") == [
        {"Bit": "`0`", "Mask": "`0x0001`", "Name": "`led_0`", "Meaning": "Lamp."},
        {"Bit": "`7`", "Mask": "`0x0080`", "Name": "`led_7`", "Meaning": "Lamp."},
    ]


def test_long_enums_have_a_table():
    values = tuple(NamedValue(name=f"v{number}", value=number) for number in range(60, 66))
    kind = Integer(bits=8, role="char", enum=Enum(name="e", values=values, closed=True))
    made = protocol(message("m", 1, ("f", kind)))
    assert "[6 values](#message-m-f)" in page(made)
    assert "**`f`**: Any other value is invalid." in page(made)
    rows = table_of(made, "Raw")
    assert list(rows[5].values()) == ["`65`", "`0x41`", "'A'", "`v65`"]
    assert rows[1][""] == "'='"


def test_negative_values_show_their_bits():
    values = (NamedValue(name="left", value=-1, about=about("To the left.")),)
    kind = Integer(bits=16, signed=True, enum=Enum(name="e", values=values))
    rows = table_of(protocol(message("m", 1, ("f", kind))), "Raw")
    assert list(rows[0].values()) == ["`-1`", "`0xFFFF`", "`left`", "To the left."]


def test_bit_ranges_have_a_table():
    gear = Enum(
        name="gear", values=(NamedValue(name="low", value=0), NamedValue(name="up", value=1))
    )
    long = Enum(name="long", values=(NamedValue(name="x", value=0, about=about("What x is.")),))
    kind = Integer(
        bits=16,
        bit_fields=(
            BitField(name="level", low=0, high=3),
            BitField(name="gear", low=4, high=4, enum=gear, about=about("Gear.")),
            BitField(name="state", low=8, high=15, enum=long),
        ),
    )
    made = protocol(message("m", 1, ("f", kind)))
    assert layout(made)[2]["Range"] == "[bit ranges](#message-m-f)"
    shown = [tuple(row.values()) for row in table_of(made, "Bits")]
    assert shown == [
        ("`3..0`", "`0x000F`", "`level`", "0..15", ""),
        ("`4`", "`0x0010`", "`gear`", "`0` low, `1` up", "Gear."),
        ("`15..8`", "`0xFF00`", "`state`", "[`0` x](#message-m-f-state)", ""),
    ]
    assert 'id="message-m-f-state"' in page(made)


def test_special_values_with_meanings_have_a_table():
    special = (NamedValue(name="no_echo", value=0xFFFF, about=about("Nothing came back.")),)
    made = protocol(message("m", 1, ("f", UINT16, {"special": special, "unit": "mm"})))
    assert "0..65535; [`0xFFFF` no_echo](#message-m-f--special)" in page(made)
    assert table_of(made, "Raw")[0]["Meaning"] == "Nothing came back."


def test_types_that_several_fields_use_are_explained_once():
    kind = flags_type()
    assert kind.flags is not None
    made = protocol(
        message("m", 1, ("f", kind), ("g", UINT8)),
        message("n", 2, ("h", Array(element=kind, extent=Fixed(count=2)))),
        flags=(kind.flags,),
    )
    text = page(made)
    assert text.count("(#type-leds)") == 2
    assert text.count('<a id="type-leds"></a>') == 1
    assert "[types](#types)" in text


def test_cases_with_fields_of_one_name_have_tables_of_their_own():
    def case(value: int) -> Case:
        bits = (NamedBit(name="on", bit=0, about=about(f"Case {value}.")),)
        kind = Integer(bits=8, flags=Flags(name=f"flags_{value}", bits=bits))
        inner = Struct(name=f"s{value}", fields=fields(("state", kind)))
        return Case(value=value, name=f"case_{value}", type=inner)

    switch = Switch(selector=named("op"), cases=(case(1), case(2)), rest=None)
    text = page(protocol(message("m", 1, ("op", UINT8), ("argument", switch))))
    assert "(#message-m-argument-case_1-state)" in text
    assert "(#message-m-argument-case_2-state)" in text


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("0", "0"),
        ("-3", "-3"),
        ("1/16", "0.0625"),
        ("-1/20", "-0.05"),
        ("100", "100"),
        ("1/3", "1/3"),
        ("-7/6", "-7/6"),
        ("123456789/1000", "123456.789"),
    ],
)
def test_numbers_are_exact(value, expected):
    assert number(Fraction(value)) == expected


@given(st.fractions())
def test_numbers_read_back_exactly(value):
    assert Fraction(number(value)) == value


@given(st.integers(-(2**70), 2**70), st.integers(-(2**70), 2**70))
def test_bounds_read_back_exactly(least, greatest):
    def read(text: str) -> int:
        power = re.fullmatch(r"(-?)2\^(\d+)(-1)?", text)
        if power is None:
            return int(text)
        return (-1 if power[1] else 1) * 2 ** int(power[2]) - bool(power[3])

    texts = bounds(Fraction(least), Fraction(greatest)).split("..")
    assert [read(text) for text in texts] == [least, greatest]


def test_bounds_of_wide_types_are_powers_of_two():
    assert bounds(Fraction(-(2**63)), Fraction(2**63 - 1)) == "-2^63..2^63-1"
    assert bounds(Fraction(0), Fraction(2**16)) == "0..65536"
    assert bounds(None, Fraction(1, 2)) == "..0.5"


@pytest.mark.parametrize(
    ("sizes", "expected"),
    [
        (SizeSet.exactly(1), "1 byte"),
        (SizeSet.exactly(0), "0 bytes"),
        (SizeSet(0, 1, 1), "0 or 1 bytes"),
        (SizeSet(2, 5, 3), "2 or 5 bytes"),
        (SizeSet(2, 9, 1), "2 to 9 bytes"),
        (SizeSet(8, 59, 3), "8 to 59 bytes in steps of 3"),
    ],
)
def test_sizes_in_words(sizes, expected):
    assert plural(sizes, "byte") == expected
    assert size_text(sizes) == re.sub(r" bytes?", "", expected)


def test_small_words():
    assert rate(Fraction(11520, 7)) == "1645"
    assert rate(Fraction(59, 10)) == "5.9"
    assert rate(Fraction(1, 30)) == "0"
    assert listed(["a"]) == "a"
    assert listed(["a", "b", "c"]) == "a, b and c"
    assert sentence("What?") == "What?"
    assert hex_number(-1, 7) == "0x7F"
