"""Meanings of fields' values: ranges, names, physical values, JSON, and strict encoding."""

import json
import math
import struct
from collections import ChainMap
from dataclasses import dataclass, field, replace
from enum import KEEP, IntFlag
from fractions import Fraction
from typing import Any

import handwritten_matty as matty
import handwritten_rn1 as rn1
import numpy
import pytest
from hypothesis import given
from hypothesis import strategies as st

from protogen.runtime import api as rt
from protogen.runtime import constructs as c


class Colour(rt.OpenEnum):
    RED = 1
    GREEN = 2


class Bits(rt.Flags):
    LOW = 1
    HIGH = 8


@dataclass(slots=True, kw_only=True)
class Point(rt.Record):
    x: int
    y: int = 5

    FORMAT = c.Struct("x" / c.Int(8, signed=True), "y" / c.Int(8))
    RULES = (("x", rt.IntegerRule(8, signed=True)), ("y", rt.IntegerRule(8, greatest=9)))


@dataclass(slots=True, kw_only=True)
class Everything(rt.Message):
    """A field of every kind."""

    colour: Colour | int = Colour.RED
    shade: Colour | int = Colour.RED
    bits: Bits | int = 0
    on: bool = False
    fixed: int = 7
    near: int = 0
    ratio: float = 0.0
    wide: float = 0.0
    name: str = ""
    code: bytes = b"\0\0"
    point: Point = field(default_factory=lambda: Point(x=0))
    count: int = 0
    points: list[Point] = field(default_factory=list)
    label: str = ""
    token: bytes = b""
    kind: int = 0
    choice: Point | int | bytes | None = None

    near_mm = rt.PhysicalOrNone("near")
    ratio_m = rt.Physical("ratio")
    high_bits = rt.BitRange("near", 4, 6)
    colour_bits = rt.EnumRange("near", 0, 1, Colour)

    NAME = "everything"
    SENDERS = ("a",)
    IDENTITY = (1,)
    SIZES = rt.Sizes(27, 1000)
    FORMAT = c.Struct(
        "colour" / c.Int(8),
        "shade" / c.Closed(c.Int(8), Colour),
        "bits" / c.Int(8),
        "on" / c.Flag01,
        "fixed" / c.Fixed(c.Int(8), 7),
        "near" / c.Int(8),
        "ratio" / c.Float(32),
        "wide" / c.Float(64),
        "name" / c.Latin1(3),
        "code" / c.Octets(2),
        "point" / Point.FORMAT,
        "count" / c.Int(8),
        "points" / c.Counted("count", Point.FORMAT),
        "label" / c.Latin1("count"),
        "token" / c.Octets("count"),
        "kind" / c.Int(8),
        "choice" / c.Cases("kind", {0: c.Pass, 1: Point.FORMAT, 2: c.Int(8)}, c.OctetsFill(4)),
    )
    RULES = (
        ("colour", rt.IntegerRule(8, named=Colour)),
        ("shade", rt.IntegerRule(8, named=Colour, closed=True)),
        ("bits", rt.IntegerRule(8, named=Bits)),
        ("on", rt.BoolRule()),
        ("fixed", rt.IntegerRule(8, const=7)),
        (
            "near",
            rt.IntegerRule(
                8,
                least=10,
                greatest=100,
                special={"no_reading": 255, "blocked": 254},
                scale=Fraction(1, 4),
                offset=Fraction(-1),
                unit="mm",
            ),
        ),
        ("ratio", rt.FloatRule(32, least=Fraction(-10), scale=Fraction(1, 2), unit="m")),
        ("wide", rt.FloatRule(64, const=None)),
        ("name", rt.TextRule(3)),
        ("code", rt.OctetsRule(2)),
        ("point", rt.StructRule(Point)),
        ("count", rt.IntegerRule(8)),
        ("points", rt.ArrayRule(rt.StructRule(Point), count="count")),
        ("label", rt.TextRule("count")),
        ("token", rt.OctetsRule("count")),
        ("kind", rt.IntegerRule(8)),
        (
            "choice",
            rt.SwitchRule(
                "kind",
                {0: None, 1: rt.StructRule(Point), 2: rt.IntegerRule(8)},
                rest=rt.OctetsRule(greatest=4),
            ),
        ),
    )


def good(**values: Any) -> Everything:
    return Everything(**{"near": 20, **values})


def error(record: rt.Message, strict: bool = True) -> rt.EncodeError:
    with pytest.raises(rt.EncodeError) as caught:
        record.to_payload(strict)
    return caught.value


def test_a_payload_is_computed_by_hand() -> None:
    message = good(
        colour=Colour.GREEN, bits=9, on=True, ratio=1.0, name="ab", point=Point(x=-1, y=2), count=1,
        points=[Point(x=3)], label="!", token=b"?", kind=2, choice=6,
    )  # fmt: skip
    wire = bytes.fromhex(
        "02 01 09 01 07 14 0000803F 0000000000000000 616200 0000 FF02 01 0305 21 3F 02 06"
    )
    assert message.to_payload() == wire
    assert Everything.from_payload(wire) == message


class Indexed:
    """Values that Python takes for an integer."""

    def __index__(self) -> int:
        return 1


@pytest.mark.parametrize("one", [True, Colour.RED, numpy.int8(1), numpy.uint64(1), Indexed()])
def test_whatever_python_takes_for_an_integer_is_one(one: Any) -> None:
    def of_ones(one: Any) -> Everything:
        point = Point(x=one, y=one)
        counted = good(count=one, points=[point], label="!", token=b"?")
        return replace(counted, colour=one, bits=one, point=point, kind=one, choice=point)

    message, plain = of_ones(one), of_ones(1)
    assert message.violations() == plain.violations()
    assert message.to_payload() == plain.to_payload()
    assert message.to_dict() == plain.to_dict()
    frame = matty.encode(matty.Go(speed=one, steer=one), counter=one)
    assert frame == matty.encode(matty.Go(speed=1, steer=1), counter=1)


def test_numbers_of_numpy_are_in_range_or_refused() -> None:
    refused = error(good(near=numpy.uint16(65000)))
    assert (refused.path, refused.problem) == ("near", "65000 is not in 0..255")
    assert error(good(near=numpy.int8(9))).problem.startswith("9 is not in 10..100")
    assert error(good(near=numpy.float64(20))).problem.startswith("must be an integer")
    assert error(good(near=numpy.bool_(True))).problem.startswith("must be an integer")


@pytest.mark.parametrize(
    ("values", "path", "says"),
    [
        ({"colour": 256}, "colour", "not in 0..255"),
        ({"colour": "red"}, "colour", "must be an integer"),
        ({"colour": 1.0}, "colour", "must be an integer, not 1.0"),
        ({"colour": None}, "colour", "must be an integer, not None"),
        ({"shade": 3}, "shade", "RED = 1, GREEN = 2"),
        ({"on": 2}, "on", "false or true"),
        ({"on": numpy.array([0, 1])}, "on", "false or true"),
        ({"on": 1.0}, "on", "false or true, not 1.0"),
        ({"on": numpy.float32(0)}, "on", "false or true"),
        ({"on": Fraction(1)}, "on", "false or true"),
        ({"fixed": 8}, "fixed", "must be 7"),
        ({"near": 9}, "near", "9 is not in 10..100"),
        ({"ratio": -11.0}, "ratio", "not in -10.."),
        ({"ratio": math.nan}, "ratio", "not in -10.."),
        ({"ratio": 1e39}, "ratio", "too large for 32 bits"),
        ({"ratio": 10**400}, "ratio", "an integer that is too large"),
        ({"wide": -(10**400)}, "wide", "an integer that is too large"),
        ({"ratio": "1"}, "ratio", "must be a number"),
        ({"ratio": True}, "ratio", "must be a number"),
        ({"ratio": numpy.float32(-11)}, "ratio", "not in -10.."),
        ({"ratio": numpy.float64(1e39)}, "ratio", "too large for 32 bits"),
        ({"name": "abcd"}, "name", "at most 3"),
        ({"name": "a\0"}, "name", "NUL"),
        ({"name": 5}, "name", "must be text"),
        ({"name": "\u0151"}, "name", "must be ASCII"),
        ({"name": "a\xe9"}, "name", "characters up to U+007F; 'é', character 2 of 2, is none"),
        ({"name": "\x80"}, "name", "must be ASCII"),
        ({"code": b"a"}, "code", "exactly 2 bytes"),
        ({"code": memoryview(b"abcd").cast("H")}, "code", "exactly 2 bytes, not 4"),
        ({"code": "ab"}, "code", "must be bytes"),
        ({"point": {"x": 1}}, "point", "must be a Point"),
        ({"point": Point(x=200)}, "point.x", "not in -128..127"),
        ({"point": Point(x=0, y=10)}, "point.y", "not in ..9"),
        ({"count": 2, "points": [Point(x=0)]}, "points", "exactly 2 elements, as count says"),
        ({"count": 1, "points": [Point(x=0, y=10)]}, "points[0].y", "not in ..9"),
        ({"count": 1, "points": [1]}, "points[0]", "must be a Point"),
        ({"points": 5}, "points", "must be a list"),
        ({"label": "x"}, "label", "exactly 0 characters"),
        ({"token": b"x"}, "token", "exactly 0 bytes"),
        ({"choice": 1}, "choice", "must be None"),
        ({"kind": 1, "choice": 1}, "choice", "must be a Point"),
        ({"kind": 1, "choice": Point(x=0, y=10)}, "choice.y", "not in ..9"),
        ({"kind": 3, "choice": b"12345"}, "choice", "at most 4"),
    ],
)
def test_strict_encoding_names_the_field_and_what_is_allowed(
    values: dict[str, Any], path: str, says: str
) -> None:
    found = error(good(**values))
    assert found.path == path
    assert says in found.problem
    assert str(found).startswith(path)


@pytest.mark.parametrize(
    "values",
    [
        {"near": 9},
        {"near": 255},
        {"ratio": -11.0},
        {"name": "\xe9\xff"},
        {"point": Point(x=0, y=10)},
    ],
)
def test_lenient_encoding_takes_what_fits_the_wire(values: dict[str, Any]) -> None:
    payload = good(**values).to_payload(strict=False)
    assert Everything.from_payload(payload) == good(**values)


@pytest.mark.parametrize(
    ("values", "path"),
    [
        ({"fixed": 8}, "fixed"),
        ({"shade": 3}, "shade"),
        ({"colour": 256}, "colour"),
        ({"name": "\u0151"}, "name"),
    ],
)
def test_lenient_encoding_refuses_what_no_decoder_would_accept(
    values: dict[str, Any], path: str
) -> None:
    assert error(good(**values), strict=False).path == path


def test_lenient_encoding_takes_nul_for_padding() -> None:
    payload = good(name="a\0").to_payload(strict=False)
    assert payload == good(name="a").to_payload()
    assert good(name="a\0").violations()[0].path == "name"


def test_floats_of_numpy_are_numbers() -> None:
    message = good(ratio=numpy.float32(1.5), wide=numpy.int16(-2))
    assert message.to_payload() == good(ratio=1.5, wide=-2.0).to_payload()
    assert message.to_dict() == good(ratio=1.5, wide=-2.0).to_dict()


@pytest.mark.parametrize("values", [{"colour": 77}, {"bits": 0xF0}, {"near": 255}])
def test_values_without_a_name_and_special_values_are_sent(values: dict[str, Any]) -> None:
    assert Everything.from_payload(good(**values).to_payload()) == good(**values)


def test_violations_list_what_a_decoder_kept() -> None:
    message = good(
        colour=77, bits=0xF1, near=9, count=1, points=[Point(x=0, y=10)], label="\xe9", token=b"b",
        kind=1, choice=Point(x=0, y=11),
    )  # fmt: skip
    kept = Everything.from_payload(message.to_payload(strict=False))
    assert [(found.path, found.forbidden) for found in kept.violations()] == [
        ("colour", False),
        ("bits", False),
        ("near", True),
        ("points[0].y", True),
        ("label", True),
        ("choice.y", True),
    ]
    assert str(kept.violations()[1]) == "bits: bits 0xf0 have no name"
    assert good().violations() == []


def test_violations_end_at_a_value_that_does_not_fit() -> None:
    message = good(colour=77, count=999, label="x")
    assert [found.path for found in message.violations()] == ["colour", "count"]


def test_physical_values_are_the_nearest_ones() -> None:
    message = good()
    assert message.near_mm == 4.0  # 20 / 4 - 1
    message.near_mm = 5.13  # (5.13 + 1) * 4 = 24.52
    assert message.near == 25
    message.near_mm = 5.125  # exactly between 24 and 25: the even one
    assert message.near == 24
    message.ratio_m = 1.5
    assert message.ratio == 3.0
    assert message.ratio_m == 1.5
    rule = dict(Everything.RULES)["near"]
    assert isinstance(rule, rt.IntegerRule)
    assert rule.physical(21) == Fraction(17, 4)


def test_special_values_have_no_physical_value() -> None:
    message = good(near=255)
    assert message.near_mm is None
    with pytest.raises(ValueError, match="no_reading, blocked"):
        message.near_mm = None
    lidar = rt.IntegerRule(14, special={"no_datapoint": 0})
    assert lidar.nearest(None) == 0


@pytest.mark.parametrize("raw", [-0.0, math.inf, -math.inf, math.nan, 0.1, 3.4028234663852886e38])
@pytest.mark.parametrize("scale", [Fraction(1), Fraction(-1, 2), Fraction(1, 4)])
def test_a_float_is_the_same_after_its_physical_value_was_set(raw: float, scale: Fraction) -> None:
    rule = rt.FloatRule(32, scale=scale)
    again = rule.nearest(rule.physical(raw))
    assert struct.pack("<d", again) == struct.pack("<d", raw)


def test_physical_values_are_numbers_that_the_bits_can_hold() -> None:
    message = good()
    for value in (math.nan, math.inf):
        with pytest.raises(ValueError, match="no physical value"):
            message.near_mm = value
    for wrong in ("1e99999999", "5", b"5", [5], True):
        with pytest.raises(ValueError, match="must be a number"):
            message.near_mm = wrong  # type: ignore[assignment]
        with pytest.raises(ValueError, match="must be a number"):
            message.ratio_m = wrong  # type: ignore[assignment]
    with pytest.raises(ValueError, match=r"63 is not in -1 mm\.\.62\.75 mm"):  # 255 / 4 - 1
        message.near_mm = 63
    with pytest.raises(ValueError, match="too large for 32 bits"):
        message.ratio_m = 1e39
    with pytest.raises(ValueError, match="too large for 64 bits"):
        rt.FloatRule(64, scale=Fraction(1, 10)).nearest(1e308)
    message.near_mm = numpy.int64(62)  # (62 + 1) * 4
    message.ratio_m = numpy.float32(1.5)
    assert (message.near, message.ratio) == (252, 3.0)


@dataclass(slots=True, kw_only=True)
class Scan(rt.Record):
    angles: list[int]
    ways: list[int]

    angles_deg = rt.PhysicalList("angles")
    ways_m = rt.PhysicalListOrNone("ways")

    FORMAT = c.Struct("angles" / c.Counted(2, c.Int(8)), "ways" / c.Counted(2, c.Int(8)))
    RULES = (
        ("angles", rt.ArrayRule(rt.IntegerRule(8, scale=Fraction(1, 2)), count=2)),
        (
            "ways",
            rt.ArrayRule(rt.IntegerRule(8, scale=Fraction(1, 10), special={"none": 0}), count=2),
        ),
    )


def test_arrays_have_lists_of_physical_values() -> None:
    scan = Scan(angles=[1, 2], ways=[0, 5])
    assert scan.angles_deg == [0.5, 1.0]
    assert scan.ways_m == [None, 0.5]
    scan.angles_deg = [3.0, 0.0]
    scan.ways_m = [1.0, None]
    assert scan == Scan(angles=[6, 0], ways=[10, 0])
    for wrong in (3.0, None, "34"):
        with pytest.raises(ValueError, match="must be a list of numbers"):
            scan.angles_deg = wrong  # type: ignore[assignment]


def test_bit_ranges_read_and_write_some_bits() -> None:
    message = good(near=0b0101_0001)
    assert message.high_bits == 0b101
    assert message.colour_bits is Colour.RED
    message.high_bits = 0b010
    message.colour_bits = Colour.GREEN
    assert message.near == 0b0010_0010
    with pytest.raises(ValueError, match=r"8 is not in 0\.\.7"):
        message.high_bits = 8


@pytest.mark.parametrize("wrong", [1.5, None, "1"])
def test_bit_ranges_are_integers(wrong: Any) -> None:
    message = good(near=0b0101_0001)
    for name in ("high_bits", "colour_bits"):
        with pytest.raises(ValueError, match="must be an integer"):
            setattr(message, name, wrong)
    assert message.near == 0b0101_0001


def test_properties_of_the_class_tell_of_themselves() -> None:
    assert isinstance(Everything.near_mm, rt.PhysicalOrNone)
    assert isinstance(Everything.colour_bits, rt.EnumRange)


# --- JSON -----------------------------------------------------------------------------------------


def test_json_has_raw_numbers_and_hexadecimal_text() -> None:
    message = good(
        colour=Colour.GREEN, bits=Bits.HIGH, on=1, ratio=math.nan, wide=-math.inf, name="a",
        code=b"\xab\xcd", count=1, points=[Point(x=-3)], label="x", token=b"y", kind=7,
        choice=b"\xff",
    )  # fmt: skip
    shown = json.loads(json.dumps(message.to_dict(), allow_nan=False))
    assert shown["colour"] == 2
    assert shown["bits"] == 8
    assert shown["on"] is True
    assert (shown["ratio"], shown["wide"]) == ("nan", "-inf")
    assert shown["code"] == "abcd"
    assert shown["points"] == [{"x": -3, "y": 5}]
    assert shown["choice"] == "ff"
    again = Everything.from_dict(shown)
    assert again.to_dict() == message.to_dict()


def test_names_may_stand_for_numbers() -> None:
    message = Everything.from_dict(
        {"colour": "green", "bits": ["low", "high"], "near": "blocked", "points": []}
    )
    assert (message.colour, message.bits, message.near) == (Colour.GREEN, 9, 254)


def test_fields_with_a_default_may_be_left_out() -> None:
    assert Everything.from_dict({}) == Everything()
    assert Everything.from_dict({"point": {"x": 1}}).point == Point(x=1, y=5)


@pytest.mark.parametrize(
    ("data", "path", "says"),
    [
        ({"color": 1}, "color", "there are: colour"),
        ({"point": {"y": 1}}, "point.x", "missing"),
        ({"point": 5}, "point", "mapping"),
        ({"points": [{"x": 1, "z": 2}]}, "points[0].z", "no such field"),
        ({"points": {}}, "points", "list"),
        ({"colour": "blue"}, "colour", "red, green"),
        ({"near": "far"}, "near", "no_reading, blocked"),
        ({"count": [1]}, "count", "integer"),
        ({"colour": 1.5}, "colour", "integer"),
        ({"ratio": "x"}, "ratio", "nan, inf or -inf"),
        ({"ratio": True}, "ratio", "number"),
        ({"wide": 10**400}, "wide", "too large"),
        ({"name": 5}, "name", "text"),
        ({"code": "xy"}, "code", "hexadecimal"),
        ({"code": 5}, "code", "hexadecimal"),
        ({"kind": 0, "choice": 5}, "choice", "null"),
    ],
)
def test_json_of_another_kind_is_refused(data: Any, path: str, says: str) -> None:
    with pytest.raises(rt.EncodeError) as caught:
        Everything.from_dict(data)
    assert caught.value.path == path
    assert says in caught.value.problem


def test_a_struct_alone_can_be_shown_and_read() -> None:
    assert Point.from_dict({"x": 2}).to_dict() == {"x": 2, "y": 5}
    with pytest.raises(rt.EncodeError, match="must be a mapping"):
        Point.from_dict(5)  # type: ignore[arg-type]


@dataclass(slots=True, kw_only=True)
class Fussy(rt.Message):
    """Constants of every kind, and a switch that has to have a case."""

    flag: bool = True
    level: float = 0.5
    text: str = "ab"
    data: bytes = b"xy"
    kind: int = 1
    choice: int = 2
    rest: list[int] = field(default_factory=list)

    NAME = "fussy"
    SENDERS = ("a",)
    IDENTITY = ()
    SIZES = rt.Sizes(11, 13)
    FORMAT = c.Struct(
        "flag" / c.Fixed(c.Flag01, True),
        "level" / c.Fixed(c.Float(32), 0.5),
        "text" / c.Fixed(c.Latin1(2), "ab"),
        "data" / c.Fixed(c.Octets(2), b"xy"),
        "kind" / c.Int(8),
        "choice" / c.Cases("kind", {1: c.Int(8)}),
        "rest" / c.Fill(c.Int(8), 2),
    )
    RULES = (
        ("flag", rt.BoolRule(const=True)),
        ("level", rt.FloatRule(32, const=0.5, greatest=Fraction(1))),
        ("text", rt.TextRule(2, const="ab")),
        ("data", rt.OctetsRule(2, const=b"xy")),
        ("kind", rt.IntegerRule(8)),
        ("choice", rt.SwitchRule("kind", {1: rt.IntegerRule(8)})),
        ("rest", rt.ArrayRule(rt.IntegerRule(8), greatest=2)),
    )


@pytest.mark.parametrize(
    ("values", "path"),
    [
        ({"flag": False}, "flag"),
        ({"level": 0.25}, "level"),
        ({"text": "ac"}, "text"),
        ({"data": b"xz"}, "data"),
        ({"kind": 2}, "choice"),
        ({"rest": [1, 2, 3]}, "rest"),
    ],
)
def test_constants_and_missing_cases_are_refused_either_way(
    values: dict[str, Any], path: str
) -> None:
    assert error(Fussy(**values)).path == path
    assert error(Fussy(**values), strict=False).path == path
    assert [found.path for found in Fussy(**values).violations()] == [path]


def test_a_constant_array_is_checked() -> None:
    broken = rn1.Maintenance(magic=[1, 2, 3], operation=0x51, argument=None)
    assert error(broken).path == "magic"


def test_a_payload_of_another_size_is_no_message() -> None:
    with pytest.raises(rt.DecodeError) as caught:
        matty.Go.from_payload(b"\0\0\0")
    assert (caught.value.reason, caught.value.offset) == ("size", 3)
    assert "go has 4 bytes of payload, not 3" in str(caught.value)
    with pytest.raises(rt.DecodeError) as caught:
        Fussy.from_payload(bytes.fromhex("01 0000003F 6162 7879 02 00"))
    assert (caught.value.reason, caught.value.offset, caught.value.path) == ("value", 10, "choice")


@pytest.mark.parametrize(
    ("sizes", "shown", "inside", "outside"),
    [
        (rt.Sizes(4, 4), "4", [4], [3, 5]),
        (rt.Sizes(8, 59, 3), "8..59 in steps of 3", [8, 11, 59], [9, 62]),
        (rt.Sizes(0, 3), "0..3", [0, 3], [4]),
    ],
)
def test_sizes_admit_what_a_payload_can_have(
    sizes: rt.Sizes, shown: str, inside: list[int], outside: list[int]
) -> None:
    assert str(sizes) == shown
    assert all(size in sizes for size in inside)
    assert not any(size in sizes for size in outside)


# --- any values ---------------------------------------------------------------------------------


def points() -> st.SearchStrategy[Point]:
    return st.builds(Point, x=st.integers(-128, 127), y=st.integers(0, 9))


@st.composite
def everything(draw: st.DrawFn, last: str = "\x7f") -> Everything:
    """Values that strict encoding takes; its texts have characters up to `last`."""
    count = draw(st.integers(0, 3))
    characters = st.characters(max_codepoint=ord(last))
    kind = draw(st.integers(0, 4))
    choices: dict[int, st.SearchStrategy[Any]] = {
        0: st.none(),
        1: points(),
        2: st.integers(0, 255),
    }
    return Everything(
        colour=draw(st.integers(0, 255)),
        shade=draw(st.sampled_from(Colour)),
        bits=draw(st.integers(0, 255)),
        on=draw(st.booleans()),
        near=draw(st.integers(10, 100) | st.just(255)),
        ratio=draw(st.floats(min_value=-10, width=32, allow_nan=False)),
        wide=draw(st.floats(allow_nan=False)),
        name=draw(st.text(characters, max_size=3).filter(lambda text: not text.endswith("\0"))),
        code=draw(st.binary(min_size=2, max_size=2)),
        point=draw(points()),
        count=count,
        points=draw(st.lists(points(), min_size=count, max_size=count)),
        label=draw(st.text(characters, min_size=count, max_size=count)),
        token=draw(st.binary(min_size=count, max_size=count)),
        kind=kind,
        choice=draw(choices.get(kind, st.binary(max_size=4))),
    )


@given(everything())
def test_values_survive_the_wire_and_json(message: Everything) -> None:
    payload = message.to_payload()
    assert len(payload) in Everything.SIZES
    assert Everything.from_payload(payload) == message
    assert Everything.from_dict(json.loads(json.dumps(message.to_dict()))) == message


@given(everything(last="\xff"))
def test_texts_of_any_bytes_survive_lenient_encoding(message: Everything) -> None:
    assert Everything.from_payload(message.to_payload(strict=False)) == message
    listed = {found.path for found in message.violations() if found.forbidden}
    assert listed == {name for name in ("name", "label") if not getattr(message, name).isascii()}


def test_a_scope_is_made_for_each_struct() -> None:
    rule = rt.TextRule("size")
    assert rule.to_wire("ab", ChainMap({}, {"size": 2}), strict=True) == "ab"


def test_not_all_sets_of_flags_are_kept() -> None:
    """A stream of flags of 32 bits, most of them without a name, must not fill the memory."""

    class State(rt.Flags):
        ON = 1
        HOT = 1 << 31

    for number in range(10_000):
        state = State(number << 1 | 1 << 31)
        assert state == number << 1 | 1 << 31
        assert State.HOT in state
        assert state.unknown == number << 1
    plain = IntFlag("plain", {"ON": 1, "HOT": 1 << 31}, boundary=KEEP)
    is_remembered = plain(6) is plain(6)  # By none of the first versions of 3.11.
    assert len(State._value2member_map_) == (4096 if is_remembered else 2)
    assert State(1) is State.ON
    assert State(1 << 31) is State.HOT
