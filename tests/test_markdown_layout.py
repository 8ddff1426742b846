"""Places of bytes: the tables and diagrams of frames and messages."""

from __future__ import annotations

from typing import Any

import pytest
from markdown_pages import diagrams, layout, page, places, table_of, tables
from models import (
    SINT14,
    UINT8,
    UINT16,
    UINT16_BIG,
    base16_frame,
    dagny_frame,
    fields,
    framing,
    message,
    protocol,
    rflex_frame,
    robbus_frame,
    sender,
    simple_frame,
    switch_message,
    tiny_protocol,
)

from protogen.copying import replace
from protogen.model.checksums import find_algorithm
from protogen.model.expressions import named
from protogen.model.frame import Frame
from protogen.model.parts import ChecksumPart, LiteralPart
from protogen.model.protocol import Protocol
from protogen.model.sizes import SizeSet
from protogen.model.transparency import Cobs, Transparency
from protogen.model.types import Array, Case, Counted, Fill, Fixed, Octets, Struct, Switch, Text
from protogen.targets.markdown.frames.layout import has_further_codes


def test_message_table_counts_bytes_of_the_frame_and_of_the_payload():
    made = protocol(message("pose", 7, ("x", UINT16), ("flag", UINT8), ("y", UINT16_BIG)))
    assert places(made) == [
        ("start", "0", ""),
        ("id", "1", ""),
        ("x", "2..3", "0..1"),
        ("flag", "4", "2"),
        ("y", "5..6", "3..4"),
        ("end", "7..8", ""),
    ]
    rows = {row["Name"]: row for row in layout(made)}
    assert rows["`x`"]["Type"] == "`uint16` LE"
    assert rows["`y`"]["Type"] == "`uint16` BE"
    assert rows["`flag`"]["Type"] == "`uint8`"
    assert rows["`id`"]["Range"] == "`0x07`"
    assert rows["`end`"]["Range"] == "`0D 0A`"


def test_base16_positions_count_characters_on_the_wire():
    made = protocol(message("pose", 1, ("x", UINT16_BIG), ("y", UINT8)), frame=base16_frame())
    assert places(made) == [
        ("begin", "0", ""),
        ("length", "1..2", ""),
        ("type", "3..4", ""),
        ("x", "5..8", "0..1"),
        ("y", "9..10", "2"),
        ("end", "11", ""),
    ]
    assert layout(made)[1]["Range"] == "`0x05`"
    assert "on the wire, where an encoded byte takes two" in page(made)


def test_base16_positions_of_varying_fields():
    points = Array(element=UINT16_BIG, extent=Fill(greatest=9))
    made = protocol(message("m", 1, ("a", UINT8), ("p", points)), frame=base16_frame())
    assert places(made)[3:] == [
        ("a", "5..6", "0"),
        ("p", "from 7", "from 1"),
        ("p[i]", "7..10 + 4i", "1..2 + 2i"),
        ("end", "last", ""),
    ]


def test_stuffed_positions_count_the_unstuffed_frame():
    made = protocol(message("go", ord("G"), ("speed", UINT16)), frame=robbus_frame())
    assert places(made)[-3:] == [("command", "3", ""), ("speed", "4..5", "0..1"), ("crc", "6", "")]
    assert "every stuffed byte in front moves a byte" in page(made)
    assert layout(made)[3]["Range"] == "'G' `0x47`"


def test_positions_behind_a_varying_payload_count_from_the_end():
    text = Text(extent=Fill(greatest=9))
    made = protocol(message("log", 1, ("level", UINT8), ("text", text)))
    assert places(made)[2:] == [
        ("level", "2", "0"),
        ("text", "from 3", "from 1"),
        ("end", "last - 1 to last", ""),
    ]
    assert layout(made)[3]["Type"] == "`ascii` to the end, at most 9 bytes"


def test_positions_behind_a_varying_field_count_from_its_end():
    points = Array(element=UINT8, extent=Counted(by=named("n"), least=0, greatest=255))
    made = protocol(message("m", 1, ("n", UINT8), ("p", points), ("q", UINT8), ("r", UINT16)))
    assert places(made)[3:] == [
        ("p", "from 3", "from 1"),
        ("p[i]", "3 + i", "1 + i"),
        ("q", "", "end of p"),
        ("r", "", "end of p + 1..2"),
        ("end", "last - 1 to last", ""),
    ]
    assert layout(made)[3]["Type"] == "`uint8` x `n`"


def test_arrays_show_where_each_element_is():
    ranges = Array(element=SINT14, extent=Fixed(count=360))
    point = Struct(name="point", fields=fields(("x", UINT8), ("y", UINT16)))
    grid = Array(element=Array(element=point, extent=Fixed(count=2)), extent=Fixed(count=3))
    made = protocol(message("scan", 1, ("ranges", ranges), ("grid", grid)))
    assert places(made)[2:-1] == [
        ("ranges", "2..721", "0..719"),
        ("ranges[i]", "2..3 + 2i", "0..1 + 2i"),
        ("grid", "722..739", "720..737"),
        ("grid[i]", "722..727 + 6i", "720..725 + 6i"),
        ("grid[i][i].x", "722 + 6i + 3j", "720 + 6i + 3j"),
        ("grid[i][i].y", "723..724 + 6i + 3j", "721..722 + 6i + 3j"),
    ]


def test_arrays_of_varying_elements_count_from_their_start():
    word = Struct(
        name="word",
        fields=fields(
            ("n", UINT8), ("text", Octets(extent=Counted(by=named("n"), least=0, greatest=9)))
        ),
    )
    made = protocol(message("words", 1, ("w", Array(element=word, extent=Fixed(count=2)))))
    assert places(made)[3:-1] == [
        ("w[i].n", "", "start of w[i]"),
        ("w[i].text", "", "from start of w[i] + 1"),
    ]


def test_switches_show_every_case_with_its_place():
    rows = layout(protocol(switch_message()))
    shown = [(row["Name"], row["Frame byte"], row["Size"], row["Type"]) for row in rows[3:-1]]
    assert shown == [
        ("`argument`", "from 3", "0 to 4", "depends on `op`"),
        ("`argument` if `op` is `0x41` baud", "3..4", "2", "struct"),
        ("`argument.rate`", "3..4", "2", "`uint16` LE"),
        ("`argument` if `op` is `0x51` kill", "", "0", "nothing"),
        ("`argument` if `op` is `7`", "3", "1", "`uint8`"),
        ("`argument` otherwise", "from 3", "0 to 4", "raw bytes to the end, at most 4 bytes"),
    ]
    strict = replace(switch_message().fields[1].type, rest=None)
    made = protocol(message("m", 1, ("op", UINT8), ("argument", strict)))
    assert layout(made)[-2]["Type"] == "invalid"


def test_a_case_of_a_single_type_is_one_row():
    case = Case(value=1, name="ang", type=Struct(name="s", fields=fields(("value", SINT14))))
    switch = Switch(selector=named("op"), cases=(case,), rest=None)
    rows = layout(protocol(message("m", 1, ("op", UINT8), ("argument", switch))))
    assert [(row["Name"], row["Type"]) for row in rows[3:5]] == [
        ("`argument`", "depends on `op`"),
        ("`argument` if `op` is `1` ang", "`sint14` LE"),
    ]
    assert "argument.value" not in str(rows)


def test_the_length_of_a_varying_message_has_the_range_of_the_message():
    varying = message("m", 0x47, ("a", UINT16), ("t", Text(extent=Fill(greatest=9))))
    rows = {row["Name"]: row for row in layout(protocol(varying, frame=robbus_frame()))}
    # Counter, command and 2 to 11 bytes.
    assert rows["`length`"]["Range"] == "4..13"


def test_a_checksum_that_an_empty_payload_lacks():
    bare = message("stop", ord("S"))
    full = message("drive", ord("D"), ("speed", UINT8))
    either = message("any", ord("A"), ("data", Octets(extent=Fill(greatest=3))), unspecified=True)
    framed = [protocol(item, frame=dagny_frame()) for item in (bare, full, either)]
    assert places(framed[0]) == [("id", "0", ""), ("end", "1", "")]
    assert places(framed[1])[2:] == [("checksum", "2", ""), ("end", "3", "")]
    assert places(framed[2])[2:] == [("checksum", "", ""), ("end", "last", "")]
    assert [row["Size"] for row in layout(framed[2])] == ["1", "0 to 3", "0 or 1", "1"]
    assert "does not say what the payload holds" in page(framed[2])


def test_frame_table_shows_parts_with_values_and_meaning():
    made = protocol(message("m", (2, 7), ("f", UINT8)), frame=rflex_frame())
    rows = table_of(made, "Frame byte")
    shown = [(row["Frame byte"], row["Part"], row["Value"]) for row in rows]
    assert shown == [
        ("0..1", "`start`", "`1B 02`"),
        ("2", "`class_id`", "`0x00`..`0xFF`"),
        ("3", "`number`", "0..255"),
        ("4", "`subclass`", "`0x00`..`0xFF`"),
        ("5", "`length`", "0..255"),
        ("from 6", "`payload`", ""),
        ("last - 2", "`checksum`", ""),
        ("last - 1 to last", "`end`", "`1B 03`"),
    ]
    meanings = [row["Meaning"] for row in rows]
    assert meanings[2] == "The sender gives it. `0xFF` by default."
    assert meanings[4] == "Number of bytes of `payload`."
    assert meanings[6] == "Checksum over `payload`: the XOR of all bytes."


def test_frame_properties_are_told():
    text = page(tiny_protocol())
    assert "- **Start:** By the literal AA." in text
    assert "- **Self-synchronising:** No. 0xAA can also occur inside a frame." in text
    assert "- **Frame size:** 5 bytes on the wire." in text
    assert "- **Overhead:** 4 bytes besides the payload" in text
    assert "- **Single-byte errors that go unnoticed:** Any change of a payload byte." in text
    assert "- **Ambiguity:** None" in text


def two_senders(**other: Any) -> Protocol:
    first, second = message("a", 1, ("f", UINT8)), message("b", 1, senders=("mcu",))
    pair = [("pc", first), ("mcu", second)]
    senders = tuple(sender(name, simple_frame(), framing([item]), [item]) for name, item in pair)
    changed = replace(senders[1], framing=replace(senders[1].framing, **other))
    return protocol(first, second, senders=(senders[0], changed))


def test_senders_with_one_frame_share_its_description():
    text = page(two_senders(undetected=(), self_synchronising=True, cut_ambiguous=True))
    assert "### Frames from `pc` and `mcu`" in text
    assert "From `pc`: 5 bytes on the wire. From `mcu`: 4 bytes on the wire." in text
    assert "unnoticed:** From `pc`: Any change of a payload byte. From `mcu`: None." in text
    assert "From `mcu`: A receiver would cut frames with some values elsewhere" in text


def test_messages_of_several_senders_are_explained_once():
    shared = message("a", 1, ("f", UINT8), senders=("pc", "mcu"))
    frames = (simple_frame(), robbus_frame())
    senders = tuple(
        sender(name, frame, framing([shared], size), [shared])
        for name, frame, size in zip(("pc", "mcu"), frames, (4, 5), strict=True)
    )
    text = page(protocol(shared, senders=senders))
    assert text.count('<a id="message-a"></a>') == 1
    assert text.count("[a](#message-a)") == 2
    assert "From `pc` · 5 bytes on the wire · 2304 a second · From `mcu` · 6 bytes" in text
    assert "\nFrom `pc`:\n" in text
    assert "From `mcu`: Frame bytes count from 0 in the unstuffed frame" in text


@pytest.mark.parametrize(
    ("algorithm", "expected"),
    [
        ("sum-8", "the sum of all bytes modulo 256"),
        ("sum-8/negated", "what brings the sum of all bytes to 0 modulo 256"),
        ("fletcher-16", "Fletcher-16, both sums modulo 255"),
        (
            "CRC-16/KERMIT",
            "CRC-16/KERMIT (width 16, poly 0x1021, init 0x0000, xorout 0x0000, refin true, "
            "refout true)",
        ),
    ],
)
def test_checksums_are_explained(algorithm, expected):
    spec = find_algorithm(algorithm)
    assert spec is not None
    checksum = ChecksumPart(
        name="crc", type=UINT16, algorithm=spec, covers=("id", "payload"), over_wire=True
    )
    parts = (*simple_frame().parts[:3], checksum)
    rows = table_of(protocol(message("m", 1), frame=Frame(parts=parts)), "Frame byte")
    wire = "Checksum over `id` and `payload`, as they are on the wire: "
    assert rows[3]["Meaning"] == f"{wire}{expected}."


def test_checksums_that_start_elsewhere_say_so():
    spec = find_algorithm("xor-8")
    assert spec is not None
    checksum = ChecksumPart(
        name="crc", type=UINT8, algorithm=replace(spec, init=0xAA), covers=("payload",)
    )
    made = protocol(message("m", 1), frame=Frame(parts=(*simple_frame().parts[:3], checksum)))
    assert "the XOR of all bytes, starting from 0xAA." in page(made)


def test_transparency_is_told_in_words_and_as_a_table():
    escaped = page(protocol(message("m", 1), frame=robbus_frame()))
    assert (
        "In `length` to `crc`, these bytes are sent as `56` followed by the byte with all its bits "
        "inverted." in escaped
    )
    assert tables(escaped)[1][2:] == [["`55`", "`56 AA`"], ["`56`", "`56 A9`"]]
    replaced = page(protocol(message("m", (1, 2)), frame=rflex_frame()))
    assert "In `class_id` to `checksum`, these bytes are replaced on the wire." in replaced
    assert tables(replaced)[1][2:] == [["`1B`", "`1B 00`"], ["`7C`", "`7C 1B 01`"]]
    hexed = page(protocol(message("m", 1), frame=base16_frame()))
    assert "travels as two upper-case hex digits, the high one first." in hexed


def with_transparency(**more: Any) -> Frame:
    frame = robbus_frame()
    assert frame.transparency is not None
    return replace(frame, transparency=replace(frame.transparency, **more))


@pytest.mark.parametrize(
    ("xor", "expected"),
    [(0, "the byte as it is (HDLC)."), (0x20, "the byte XOR `0x20` (HDLC).")],
)
def test_escapes_say_what_becomes_of_the_byte(xor, expected):
    encoding = robbus_frame().transparency.encoding
    frame = with_transparency(encoding=replace(encoding, xor=xor), preset="hdlc")
    assert expected in page(protocol(message("m", 1), frame=frame))


def test_lenient_cobs_of_one_part():
    frame = with_transparency(
        first="payload", last="payload", encoding=Cobs(), preset="cobs", lenient=True
    )
    text = page(protocol(message("m", 1), frame=frame))
    assert "`payload` is COBS-encoded as a whole, so that it holds no zero byte." in text
    assert "also accept" in text


def cobs_frame() -> Frame:
    parts = (*simple_frame().parts[1:3], LiteralPart(name="zero", bytes=b"\0"))
    return Frame(
        parts=parts, transparency=Transparency(first="id", last="payload", encoding=Cobs())
    )


def test_cobs_positions_are_those_of_the_wire():
    made = protocol(message("m", 5, ("a", UINT16), ("b", UINT8)), frame=cobs_frame())
    assert places(made) == [
        ("COBS code", "0", ""),
        ("id", "1", ""),
        ("a", "2..3", "0..1"),
        ("b", "4", "2"),
        ("zero", "5", ""),
    ]
    text = page(made)
    assert diagrams(text)[1][:2] == ['0: "0 COBS code"', '1: "1 id"']
    frame_rows = table_of(made, "Frame byte")
    assert [(row["Frame byte"], row["Part"]) for row in frame_rows][:2] == [
        ("0", "COBS code"),
        ("1", "`id`"),
    ]
    assert "with the first COBS code byte." in text
    assert "each zero is replaced by how many bytes on the next one is" in text
    assert "unstuffed frame" not in text


@pytest.mark.parametrize(("size", "expected"), [(253, False), (254, True)])
def test_a_long_cobs_region_can_have_further_code_bytes(size, expected):
    payload = SizeSet.exactly(size)
    assert has_further_codes(cobs_frame(), payload) is expected
    made = protocol(message("m", 5, ("a", Octets(extent=Fixed(count=size)))), frame=cobs_frame())
    sender = replace(made.senders[0], framing=replace(made.senders[0].framing, payload=payload))
    text = page(replace(made, senders=(sender,)))
    assert ("a further code byte moves what follows a byte on" in text) is expected


def test_diagrams_show_positions_and_draw_long_fields_as_one_block():
    ranges = Array(element=SINT14, extent=Fixed(count=360))
    made = protocol(message("scan", 1, ("status", UINT8), ("ranges", ranges), ("crc", UINT16)))
    assert diagrams(page(made))[1] == [
        '0: "0 start AA"',
        '1: "1 id"',
        '2: "2 status"',
        '3-7: "3..722 ranges"',
        '8-9: "723..724 crc"',
        '10-11: "725..726 end 0D 0A"',
    ]


def test_diagram_of_a_frame_with_open_payload():
    made = protocol(message("m", 1, ("f", UINT8)))
    assert diagrams(page(made))[0] == [
        '0: "0 start AA"',
        '1: "1 id"',
        '2-7: "from 2 payload (0 to 251 bytes)"',
        '8-9: "end 0D 0A"',
    ]


def test_messages_of_varying_size_have_no_diagram():
    made = protocol(message("m", 1, ("f", Text(extent=Fill(greatest=3)))))
    assert len(diagrams(page(made))) == 1


def test_long_labels_are_cut():
    made = protocol(message("m", 1, ("a_name_that_does_not_fit", UINT8)))
    assert diagrams(page(made))[1][2] == '2: "2 a_name_that_d…"'


def test_what_fills_a_region_ends_where_it_does():
    value = Struct(name="s", fields=fields(("a", UINT8), ("b", Octets(extent=Fill(greatest=9)))))
    cases = (
        Case(value=1, name="case_1", type=value),
        Case(
            value=None,
            name="else",
            type=Struct(name="t", fields=fields(("x", UINT16), ("y", UINT16))),
        ),
    )
    switch = Switch(selector=named("op"), cases=cases, rest=None)
    made = message("m", 1, ("op", UINT8), ("argument", switch), ("z", UINT8))
    op, argument, last = made.fields
    made = replace(made, fields=(op, replace(argument, region=Fixed(count=4)), last))
    rows = [(row["Name"], row["Size"], row["Type"]) for row in layout(protocol(made))]
    assert rows[3:9] == [
        ("`argument`", "4", "depends on `op`, in 4 bytes"),
        ("`argument` if `op` is `1`", "4", "struct"),
        ("`argument.a`", "1", "`uint8`"),
        ("`argument.b`", "0 to 4", "`bytes` to the end of 4 bytes, at most 9 bytes"),
        ("`argument` otherwise", "4", "struct"),
        ("`argument.x`", "2", "`uint16` LE"),
    ]
