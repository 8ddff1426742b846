"""The pieces of construct: bytes by hand, strict both ways, and no byte lost."""

import copy
import io
import math
import pickle
import struct
from collections.abc import Callable
from typing import Any

import construct
import pytest
from hypothesis import given
from hypothesis import strategies as st

from protogen.runtime import constructs as c


def build_error(format: Any, value: Any) -> c.PayloadError:
    with pytest.raises(c.PayloadError) as caught:
        format.build(value)
    return caught.value


def parse_error(format: Any, wire: str) -> c.PayloadError:
    with pytest.raises(c.PayloadError) as caught:
        c.Whole(format).parse(bytes.fromhex(wire))
    return caught.value


POINT = c.Struct("x" / c.Int(16, signed=True), "y" / c.Int(16, signed=True, order="big"))
READING = c.Struct("sonar" / c.Int(8), "range" / c.Int(16, order="big"))


@pytest.mark.parametrize(
    ("format", "value", "wire"),
    [
        (c.Int(8), 200, "C8"),
        (c.Int(8, signed=True), -2, "FE"),
        (c.Int(16, signed=True, order="big"), -2, "FF FE"),
        (c.Int(32), 0x01020304, "04 03 02 01"),
        (c.Int(64, order="big"), 1, "00 00 00 00 00 00 00 01"),
        (c.Int(24, order="big"), 0x010203, "01 02 03"),
        (c.Int(12, signed=True), -1, "FF 0F"),
        (c.SevenBit(14, signed=True), -5, "7B 7F"),
        (c.SevenBit(14, order="big"), 0x0123, "02 23"),
        (c.Flag01, True, "01"),
        (c.Flag01, False, "00"),
        (c.Float(32, order="big"), 1.0, "3F 80 00 00"),
        (c.Float(64), -2.0, "00 00 00 00 00 00 00 C0"),
        # 3F800000 is 0011 1111100 0000000 0000000 0000000 in groups of seven bits.
        (c.SevenBitFloat(32, order="big"), 1.0, "03 7C 00 00 00"),
        (c.SevenBitFloat(64), 0.0, "00 00 00 00 00 00 00 00 00 00"),
        (c.Fixed(c.Int(8), 0x42), 0x42, "42"),
        (c.Closed(c.Int(8), {1, 2}), 2, "02"),
        (c.Octets(3), b"abc", "61 62 63"),
        (c.OctetsFill(3), b"ab", "61 62"),
        (c.Latin1(4), "ab", "61 62 00 00"),
        (c.Latin1(2), "\xe9\x01", "E9 01"),
        (c.Latin1(3), "\0a", "00 61 00"),
        (c.Latin1Fill(), "a\0", "61 00"),
        (c.Counted(2, c.Int(8)), [1, 2], "01 02"),
        (c.Fill(c.Int(16), 2), [1, 2], "01 00 02 00"),
        (c.Fill(READING), [], ""),
        (POINT, {"x": -2, "y": 3}, "FE FF 00 03"),
    ],
)
def test_values_lie_on_the_wire_as_computed_by_hand(format: Any, value: Any, wire: str) -> None:
    data = bytes.fromhex(wire)
    assert format.build(value) == data
    parsed = c.Whole(format).parse(data)
    if isinstance(value, dict):
        parsed = {name: parsed[name] for name in value}
    assert parsed == value


@pytest.mark.parametrize(
    ("format", "wire", "reason", "path", "offset"),
    [
        (POINT, "FE FF 00", "size", "y", 2),
        (POINT, "FE FF 00 03 00", "size", "", 4),
        (c.Struct("a" / c.Int(12)), "FF FF", "value", "a", 0),
        (c.Struct("a" / c.Int(8), "b" / c.SevenBit(14)), "00 01 80", "encoding", "b", 1),
        (c.Struct("a" / c.SevenBit(16)), "01 80 00", "encoding", "a", 0),
        (c.Struct("a" / c.Int(24)), "01 02", "size", "a", 0),
        (c.Struct("a" / c.Flag01), "02", "value", "a", 0),
        (c.Struct("a" / c.SevenBitFloat(32)), "00 00 00 00 10", "value", "a", 0),
        (c.Struct("a" / c.Int(8), "b" / c.Fixed(c.Int(8), 7)), "00 08", "value", "b", 1),
        (c.Struct("a" / c.Closed(c.Int(8), {1, 2})), "03", "value", "a", 0),
        (c.Struct("a" / c.Octets(3, seven_bit=True)), "00 01 FF", "encoding", "a", 2),
        (c.Struct("a" / c.OctetsFill(2)), "00 01 02", "size", "a", 2),
        (c.Struct("a" / c.OctetsFill(seven_bit=True)), "00 80", "encoding", "a", 1),
        (c.Struct("a" / c.Latin1(2, seven_bit=True)), "41 C1", "encoding", "a", 1),
        (c.Struct("a" / c.Counted(2, POINT)), "00 00 00 00 00", "size", "a[1].x", 4),
        (c.Struct("a" / c.Fill(READING)), "01 00 02 03", "size", "a[1].range", 4),
        (c.Struct("a" / c.Fill(c.Int(8), 2)), "01 02 03", "size", "a", 2),
        (c.Struct("a" / c.Fill(c.Pass)), "01", "size", "a[0]", 0),
        (c.Struct("k" / c.Int(8), "v" / c.Cases("k", {1: c.Int(8)})), "02 00", "value", "v", 1),
    ],
)
def test_what_does_not_parse_says_where_and_why(
    format: Any, wire: str, reason: str, path: str, offset: int
) -> None:
    error = parse_error(format, wire)
    assert (error.reason, error.path, error.offset) == (reason, path, offset)


@pytest.mark.parametrize(
    ("format", "value", "reason", "path"),
    [
        (POINT, {"x": 40000, "y": 0}, "value", "x"),
        (POINT, {"x": 0}, "value", "y"),
        (POINT, {"x": 0, "y": 0, "z": 0}, "value", "z"),
        (POINT, 5, "value", ""),
        (c.Struct("a" / c.Int(12)), {"a": 4096}, "value", "a"),
        (c.Struct("a" / c.Int(12)), {"a": "x"}, "value", "a"),
        (c.Struct("a" / c.Int(16)), {"a": 1.5}, "value", "a"),
        (c.Struct("a" / c.Flag01), {"a": 2}, "value", "a"),
        (c.Struct("a" / c.Float(32)), {"a": 1e300}, "value", "a"),
        (c.Struct("a" / c.SevenBitFloat(32)), {"a": 1e300}, "value", "a"),
        (c.Struct("a" / c.Fixed(c.Int(8), 7)), {"a": 8}, "value", "a"),
        (c.Struct("a" / c.Closed(c.Int(8), {1})), {"a": 8}, "value", "a"),
        (c.Struct("a" / c.Closed(c.Int(8), {1})), {"a": [1]}, "value", "a"),
        (c.Struct("a" / c.Octets(2)), {"a": b"x"}, "size", "a"),
        (c.Struct("a" / c.Octets(2)), {"a": "xy"}, "value", "a"),
        (c.Struct("a" / c.Octets(2, seven_bit=True)), {"a": b"x\x80"}, "encoding", "a"),
        (c.Struct("a" / c.OctetsFill(1)), {"a": b"xy"}, "size", "a"),
        (c.Struct("a" / c.Latin1(2)), {"a": "x\0"}, "value", "a"),
        (c.Struct("a" / c.Latin1(2)), {"a": "xyz"}, "size", "a"),
        (c.Struct("a" / c.Latin1(2)), {"a": "\u0100"}, "value", "a"),
        (c.Struct("a" / c.Latin1Fill()), {"a": 5}, "value", "a"),
        (c.Struct("a" / c.Counted(2, c.Int(8))), {"a": [1]}, "size", "a"),
        (c.Struct("a" / c.Counted(2, c.Int(8))), {"a": 5}, "value", "a"),
        (c.Struct("a" / c.Counted(2, c.Int(8))), {"a": b"ab"}, "value", "a"),
        (c.Struct("a" / c.Counted(2, c.Int(8))), {"a": [1, 256]}, "value", "a[1]"),
        (c.Struct("a" / c.Fill(c.Int(8), 2)), {"a": [1, 2, 3]}, "size", "a"),
        (c.Struct("a" / c.Fill(c.Int(8), 2)), {"a": [1, -1]}, "value", "a[1]"),
    ],
)
def test_what_can_not_be_built_says_where_and_why(
    format: Any, value: Any, reason: str, path: str
) -> None:
    error = build_error(format, value)
    assert (error.reason, error.path) == (reason, path)


@pytest.mark.parametrize(
    "again", [copy.copy, copy.deepcopy, lambda error: pickle.loads(pickle.dumps(error))]
)
def test_an_error_may_be_copied_and_sent_to_another_process(again: Any) -> None:
    error = build_error(c.Struct("a" / c.Counted(2, c.Int(8))), {"a": [1, 256]})
    other = again(error)
    assert type(other) is c.PayloadError
    assert (str(other), other.args, vars(other)) == (str(error), error.args, vars(error))


LIST = c.Struct(
    "count" / c.Int(8),
    "size" / c.Int(8),
    "items" / c.Counted("count", c.Struct("name" / c.Latin1("size"), "data" / c.Octets("size"))),
)


def test_counts_and_sizes_come_from_fields_in_front_also_of_the_struct_around() -> None:
    wire = bytes.fromhex("02 01 41 01 42 02")
    value = {
        "count": 2,
        "size": 1,
        "items": [{"name": "A", "data": b"\1"}, {"name": "B", "data": b"\2"}],
    }
    assert LIST.build(value) == wire
    assert LIST.parse(wire)["items"][1]["name"] == "B"
    assert build_error(LIST, {**value, "count": 3}).path == "items"
    assert build_error(LIST, {**value, "size": 2}).path == "items[0].name"


def test_a_count_without_a_field_in_front_is_an_error_with_its_path() -> None:
    assert parse_error(c.Struct("items" / c.Counted("count", c.Int(8))), "00").path == "items"


CHOICE = c.Struct(
    "kind" / c.Int(8),
    "value" / c.Cases("kind", {0: c.Pass, 1: c.Int(16)}, rest=c.OctetsFill(3)),
)


def test_a_case_is_chosen_by_the_field_in_front() -> None:
    assert CHOICE.build({"kind": 0, "value": None}) == b"\0"
    assert CHOICE.build({"kind": 1, "value": 2}) == b"\1\2\0"
    assert CHOICE.build({"kind": 9, "value": b"abc"}) == b"\x09abc"
    assert c.Whole(CHOICE).parse(b"\0")["value"] is None
    assert CHOICE.parse(b"\x09ab")["value"] == b"ab"
    assert parse_error(CHOICE, "00 00").reason == "size"


def test_a_switch_of_constants_and_nothing_needs_no_value() -> None:
    constants = c.Struct("kind" / c.Int(8), "value" / c.Cases("kind", {0: c.Pass}))
    assert constants.build({"kind": 0}) == b"\0"


def test_a_constant_needs_no_value() -> None:
    magic = c.Struct("magic" / c.Fixed(c.Counted(3, c.SevenBit(7)), [0x42, 0x11, 0x7A]))
    assert magic.build({}) == b"\x42\x11\x7a"
    assert magic.build(None) == b"\x42\x11\x7a"
    assert magic.parse(b"\x42\x11\x7a")["magic"] == [0x42, 0x11, 0x7A]
    assert parse_error(magic, "42 11 7B").reason == "value"


@pytest.mark.parametrize(
    ("format", "size"),
    [
        (POINT, 4),
        (c.SevenBit(15), 3),
        (c.Counted(3, POINT), 12),
        (c.Octets(5), 5),
        (c.Latin1(6), 6),
        (c.Float(64), 8),
        (c.Fixed(c.Int(8), 1), 1),
        (c.Cases("x", {0: c.Int(8), 1: c.Flag01}), 1),
        (c.Whole(POINT), 4),
    ],
)
def test_fixed_sizes_are_known(format: Any, size: int) -> None:
    assert format.sizeof() == size


@pytest.mark.parametrize(
    "format",
    [
        c.Fill(c.Int(8)),
        c.OctetsFill(),
        c.Octets("n"),
        c.Counted("n", c.Int(8)),
        c.Cases("x", {0: c.Int(8), 1: c.Int(16)}),
        c.Cases("x", {0: c.Int(8)}, rest=c.OctetsFill()),
    ],
)
def test_other_sizes_are_not(format: Any) -> None:
    with pytest.raises(construct.SizeofError):
        format.sizeof()


def test_pieces_can_be_embedded_in_plain_construct_declarations() -> None:
    outer = construct.Struct(
        "magic" / construct.Const(b"LOG"), "points" / construct.Array(2, POINT)
    )
    wire = b"LOG" + bytes.fromhex("01 00 00 02 03 00 00 04")
    parsed = outer.parse(wire)
    assert [point.x for point in parsed.points] == [1, 3]
    assert outer.build(parsed) == wire
    assert construct.Prefixed(construct.Byte, POINT).build({"x": 1, "y": 2}) == b"\4\1\0\0\2"


def test_pieces_can_be_compiled_by_construct() -> None:
    compiled = POINT.compile()
    assert compiled.parse(bytes.fromhex("FE FF 00 03")).x == -2


def test_errors_are_those_of_construct() -> None:
    with pytest.raises(construct.ConstructError, match=r"byte 2, y: needs 2 bytes"):
        POINT.parse(b"\0\0\0")


def test_a_prefix_is_measured_or_says_what_is_missing() -> None:
    wire = LIST.build({"count": 1, "size": 1, "items": [{"name": "A", "data": b"\1"}]})
    for size in range(len(wire)):
        with pytest.raises(c.PayloadError) as caught:
            c.prefix_size(LIST, wire[:size], {})
        assert caught.value.missing > 0
    assert c.prefix_size(LIST, wire + b"more", {}) == len(wire)


_NESTED = c.Struct(
    "n" / c.Int(8),
    "rows"
    / c.Counted(
        "n",
        c.Struct(
            "k" / c.Int(8),
            "name" / c.Latin1Until(0, 3),
            "numbers" / c.Counted("k", c.Int(16)),
            "box" / c.Region("k", c.Struct("all" / c.Fill(c.Int(8)))),
            "more" / c.When("k", c.Octets(2)),
        ),
    ),
    "chain" / c.UpToLast(c.Struct("last" / c.Int(8), "pair" / c.Counted(2, c.Flag01)), "last", 3),
)


def _verdict(measure: Callable[..., int], *arguments: Any) -> tuple[Any, ...]:
    try:
        return (measure(*arguments),)
    except c.PayloadError as error:
        return error.reason, error.path, error.offset, error.problem, error.missing


@given(st.lists(st.lists(st.integers(0, 3) | st.integers(0, 255), min_size=1, max_size=9)))
def test_a_measurer_says_of_bytes_that_come_in_what_is_said_of_all_at_once(
    chunks: list[list[int]],
) -> None:
    measurer, wire = c.Measurer(_NESTED, {}), b""
    for chunk in map(bytes, chunks):
        wire += chunk
        whole = _verdict(c.prefix_size, _NESTED, wire, {})
        assert _verdict(measurer.take, chunk) == whole
        if whole[-1:] == (0,) or len(whole) == 1:
            break  # What is more is no part of it.
    assert measurer.taken == len(wire)


class _Seen(c.Piece):
    """A byte, which is counted."""

    times = 0

    def _parse(self, stream: io.BytesIO, context: Any, path: str) -> int:
        self.times += 1
        return int(c.Int(8)._parse(stream, context, path))


@pytest.mark.parametrize(
    "array_of", [lambda item: c.Counted(500, item), lambda item: c.UpToLast(item, "last", 500)]
)
def test_a_measurer_reads_an_element_again_only_where_it_was_cut(array_of: Any) -> None:
    seen = _Seen()
    measurer = c.Measurer(c.Struct("all" / array_of(c.Struct("last" / seen))), {})
    sizes = [_verdict(measurer.take, bytes((index == 499,)))[-1] for index in range(500)]
    assert sizes == [1] * 499 + [500]
    assert seen.times == 2 * 500 - 1  # Behind each byte but the last, one was tried in vain.


def test_a_float_keeps_the_payload_of_a_quiet_nan() -> None:
    wire = struct.pack("<Q", 0x7FF8_0000_DEAD_BEEF)
    assert math.isnan(c.Float(64).parse(wire))
    assert c.Float(64).build(c.Float(64).parse(wire)) == wire


FORMATS = [
    POINT,
    LIST,
    CHOICE,
    c.Struct("a" / c.SevenBit(10, signed=True), "b" / c.Latin1(3), "c" / c.Fill(READING)),
    c.Struct("a" / c.Flag01, "b" / c.Int(9, order="big"), "c" / c.Latin1Fill(seven_bit=True)),
    c.Struct("a" / c.SevenBitFloat(32), "b" / c.OctetsFill(2)),
]


@pytest.mark.parametrize("format", FORMATS)
@given(data=st.data())
def test_what_parses_builds_the_same_bytes(format: Any, data: st.DataObject) -> None:
    few = st.lists(st.sampled_from([0, 1, 2, 3, 65]), max_size=9).map(bytes)
    wire = data.draw(few | st.binary(max_size=9))
    stream = io.BytesIO(wire)
    try:
        parsed = c.Whole(format).parse_stream(stream)
    except c.PayloadError as error:
        assert 0 <= error.offset <= len(wire)
        return
    assert format.build(parsed) == wire
