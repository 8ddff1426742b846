"""Fused structs: whatever a `FORMAT` does directly, construct does too in its own way."""

from __future__ import annotations

import copy
import io
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import construct
import pytest
from compiled import DOCUMENTS, ROOT, SCHEMAS, module_at, name_of
from hypothesis import given, settings
from hypothesis import strategies as st
from two_ways import check_building, check_parsing, outcome, shown, spoilt

from protogen.runtime import constructs as c
from protogen.runtime.fused import direct
from protogen.runtime.number import Number
from protogen.runtime.pairs import pair_tables

# --- drawn declarations ---------------------------------------------------------------------------

ORDERS = st.sampled_from(["little", "big"])
BITS = st.integers(1, 64)
INTEGERS = st.one_of(
    st.builds(c.Int, st.sampled_from([8, 16, 32, 64]), st.booleans(), ORDERS),
    st.builds(c.Int, BITS, st.booleans(), ORDERS),
    st.builds(c.SevenBit, st.integers(1, 14) | BITS, st.booleans(), ORDERS),
)
SIZES = st.sampled_from([32, 64])
SMALL = st.integers(0, 4)
VALUES = st.one_of(
    INTEGERS,
    INTEGERS,
    st.just(c.Flag01),
    st.builds(c.Float, SIZES, ORDERS),
    st.builds(c.SevenBitFloat, SIZES, ORDERS),
    st.builds(c.Closed, INTEGERS, st.frozensets(st.integers(-2, 5)).map({0}.union)),
    st.builds(c.Octets, SMALL, st.booleans()),
    st.builds(c.Latin1, SMALL, st.booleans()),
)
CONSTANTS = st.sampled_from(
    [
        c.Fixed(c.Int(8), 0),
        c.Fixed(c.SevenBit(16), 0),
        c.Fixed(c.Flag01, False),
        c.Fixed(c.Octets(2), b"\0\0"),
        c.Fixed(c.Counted(3, c.SevenBit(8)), [0, 0, 0]),
        c.Fixed(c.Counted(2, c.Int(16, order="big")), [0, 0]),
        c.Fixed(c.Latin1(3), ""),
        c.Fixed(c.Int(8), 1),
        c.Fixed(c.SevenBit(14, signed=True), -1),
        c.Fixed(c.Flag01, True),
        c.Fixed(c.Int(8), True),
        c.Fixed(c.Latin1(2), "a"),
        c.Fixed(c.Counted(2, c.SevenBit(7)), [1, 2]),
        c.Fixed(c.Closed(c.Int(8), {1, 2}), 2),
        c.Closed(c.Fixed(c.Int(8), 1), {1}),
        c.Fixed(c.Float(32), 1.0),
    ]
)
ENDS = st.one_of(
    st.builds(c.OctetsFill, st.none() | SMALL, st.booleans()),
    st.builds(c.Latin1Fill, st.none() | SMALL, st.booleans()),
)


@st.composite
def structs(draw: Any, outside: tuple[str, ...] = (), depth: int = 2) -> Any:
    """A struct whose counts may be fields in front of it, or of the struct around it."""
    fields: list[Any] = []
    integers = list(outside)
    for number in range(draw(st.integers(0, 7 - 2 * (2 - depth)))):
        # A field inside may be called like one outside, which then is not seen any more.
        name = draw(st.sampled_from([f"f{number}", f"f{number}", f"g{depth}{number}"]))
        if any(field.name == name for field in fields):
            continue
        kind = draw(st.sampled_from(["value", "value", "count", "more", "constant", "counted"]))
        if kind == "count":
            fields.append(name / draw(st.sampled_from([c.Int(8), c.SevenBit(7), c.Int(2)])))
            integers.append(name)
            continue
        fields.append(name / draw(pieces(kind, tuple(integers), depth)))
    if draw(st.booleans()):
        fields.append("end" / draw(ends(tuple(integers), depth)))
    return c.Struct(*fields)


def pieces(kind: str, integers: tuple[str, ...], depth: int) -> Any:
    if kind == "constant":
        return CONSTANTS
    if kind == "value" or not (depth or integers):
        return VALUES
    inner = structs(integers, depth - 1) if depth else VALUES
    if kind == "more" or not integers:
        return st.one_of(inner, st.builds(c.Counted, SMALL, VALUES | inner | CONSTANTS))
    names = st.sampled_from(integers)
    counts = names | st.builds(c.Count, names, st.integers(0, 1), st.integers(2, 4))
    return st.one_of(
        st.builds(c.Octets, counts, st.booleans()),
        st.builds(c.Latin1, counts, st.booleans()),
        st.builds(c.Counted, counts, VALUES | inner),
    )


def ends(integers: tuple[str, ...], depth: int) -> Any:
    elements = VALUES | structs(integers, depth - 1) if depth else VALUES
    return ENDS | st.builds(c.Fill, elements, st.none() | SMALL)


SMALL_BYTES = st.sampled_from([0, 0, 0, 0, 0, 0, 1, 2, 3, 65, 127])
MOSTLY_ZERO = st.lists(SMALL_BYTES, max_size=60).map(bytes)
WIRES = st.one_of(
    MOSTLY_ZERO,
    MOSTLY_ZERO.map(lambda data: data.ljust(200, b"\0")),
    st.binary(max_size=40),
    st.binary(max_size=40).map(lambda data: bytes(byte & 0x7F for byte in data)),
)


@settings(max_examples=4 * settings().max_examples)
@given(format=structs(), wires=st.lists(WIRES, min_size=1, max_size=4), data=st.data())
def test_a_drawn_struct_does_what_construct_does(format: Any, wires: Any, data: Any) -> None:
    for wire in wires:
        check_both(format, wire, data)
        check_both(format, mended(format, wire, data), data)


def mended(format: Any, wire: bytes, data: Any) -> bytes:
    """The bytes with a few changes after which they are more likely those of some values."""
    for _ in range(10):
        try:
            c.Struct.parse(format, wire)
        except c.PayloadError as error:
            place = error.offset
            if error.missing:
                wire += bytes(error.missing)
            elif error.reason == "size":
                wire = wire[:place]
            elif error.reason == "encoding":
                wire = wire[:place] + bytes((wire[place] & 0x7F,)) + wire[place + 1 :]
            else:
                due = data.draw(st.sampled_from([b"\1", b"\0\0\0\0", b"a", b"\2", b"\1\2"]))
                wire = wire[:place] + due + wire[place + len(due) :]
        except (TypeError, ValueError):
            break  # What counts is no integer, which no schema can say.
    return wire


def check_both(format: Any, wire: bytes, data: Any) -> None:
    check_parsing(format, wire)
    try:
        values = format.parse(wire)
    except (construct.ConstructError, TypeError, ValueError):
        return
    built = check_building(format, values)
    assert check_building(format, plain(values)) == built
    if is_fused(format):
        assert shown(direct(format, "parse", never)(wire)) == shown(values)
        if built[0] is bytes:
            assert shown(direct(format, "build", never)(plain(values))) == built
    for part in (wire[:-1], wire + b"\1"):
        check_parsing(format, part)
    for _ in range(3):
        check_building(format, data.draw(spoilt(plain(values))))
        check_building(format, data.draw(spoilt(values)))


def is_fused(format: Any) -> bool:
    return direct(format, "parse", never) is not never


def never(*_: Any) -> Any:
    raise AssertionError("construct is asked about what is plainly in order")


def plain(values: Any) -> Any:
    """Containers as what they are derived from, as an encoder gives them."""
    if isinstance(values, dict):
        return {name: plain(item) for name, item in values.items()}
    return [plain(item) for item in values] if isinstance(values, list) else values


# --- those of the schemas -------------------------------------------------------------------------


@pytest.mark.parametrize("path", SCHEMAS, ids=name_of)
@given(data=st.data())
def test_a_format_does_what_construct_does(path: Path, data: Any) -> None:
    message = data.draw(st.sampled_from(list(module_at(path).MESSAGES.values())))
    least, greatest = message.SIZES.least, message.SIZES.greatest
    some = st.binary(min_size=least, max_size=min(greatest, least + 40))
    wire = data.draw(some | st.binary(min_size=max(least - 2, 0), max_size=greatest + 2))
    check_both(message.FORMAT, wire, data)
    check_both(message.FORMAT, bytes(byte & 0x7F for byte in wire), data)


def test_all_messages_are_fused_but_those_with_cases() -> None:
    messages = [message for path in DOCUMENTS for message in module_at(path).MESSAGES.values()]
    others = {message.NAME for message in messages if not is_fused(message.FORMAT)}
    with_cases = {
        message.NAME
        for message in messages
        if any(isinstance(item.subcon, c.Cases) for item in message.FORMAT.subcons)
    }
    assert others == with_cases
    assert len(messages) > 4 * len(others) > 0


def test_a_float_is_no_integer_though_it_is_found_where_one_is() -> None:
    """1.0 is found in a dictionary where 1 is."""
    assert POINT.build({"x": 1, "y": 1})
    for values in ({"x": 1.0, "y": 1}, {"x": 1, "y": 1.0}):
        with pytest.raises(c.PayloadError):
            POINT.build(values)


@pytest.mark.parametrize("signed", [False, True])
@pytest.mark.parametrize("bits", range(8, 15))
def test_pairs_are_looked_up_as_their_numbers_are(bits: int, signed: bool) -> None:
    number = Number(bits, signed, seven_bit=True)
    read, write = pair_tables(bits, signed)
    for value in range(number.least, number.greatest + 1):
        assert read[write[value]] == value
    assert len(read) == len(write) == 1 << bits
    for value in (number.least, -1, 0, 1, 64, 127, 128, number.greatest):
        if number.least <= value <= number.greatest:
            assert write[value].to_bytes(2, "little") == number.encode(value)


# --- what is left to construct --------------------------------------------------------------------

POINT = c.Struct("x" / c.Int(16, signed=True), "y" / c.SevenBit(14, order="big"))
WIRE = bytes.fromhex("FE FF 01 02")
VALUES_OF_WIRE = {"x": -2, "y": 0x82}


def test_context_keywords_are_construct_s() -> None:
    counted = c.Struct("items" / c.Counted("count", c.Int(8)))
    assert counted.parse(b"\1\2\3", count=2)["items"] == [1, 2]
    assert counted.build({"items": [1, 2]}, count=2) == b"\1\2"
    assert POINT.parse(WIRE, anything=1)._io.tell() == 4
    assert POINT.build(VALUES_OF_WIRE, anything=1) == WIRE
    assert POINT.parse_stream(io.BytesIO(WIRE), anything=1) == VALUES_OF_WIRE


def test_arguments_may_be_named() -> None:
    assert POINT.parse(data=WIRE) == VALUES_OF_WIRE
    assert POINT.parse_stream(stream=io.BytesIO(WIRE)) == VALUES_OF_WIRE
    assert POINT.build(obj=VALUES_OF_WIRE) == WIRE


@pytest.mark.parametrize("kind", [bytearray, memoryview, lambda data: memoryview(data).cast("H")])
@pytest.mark.parametrize(
    "format",
    [POINT, c.Struct("all" / c.OctetsFill()), c.Struct("n" / c.Int(8), "t" / c.Latin1("n"))],
    ids=["fixed", "fill", "counted"],
)
def test_any_buffer_is_parsed(format: Any, kind: Any) -> None:
    wire = bytes.fromhex("02 41 01 02")
    due = shown(format.parse(wire))
    assert shown(format.parse(kind(wire))) == due == outcome(c.Struct.parse, format, kind(wire))


@pytest.mark.parametrize("data", [None, "text", 5, [1, 2], memoryview(b"abcdefgh")[::2]])
@pytest.mark.parametrize("format", [POINT, c.Struct(), c.Struct("all" / c.OctetsFill())])
def test_what_is_no_buffer_is_what_it_is_to_construct(format: Any, data: Any) -> None:
    assert outcome(format.parse, data) == outcome(c.Struct.parse, format, data)


def test_the_container_is_construct_s_but_for_the_stream() -> None:
    parsed = POINT.parse(WIRE)
    own = construct.Struct(*POINT.subcons).parse(WIRE)
    assert type(parsed) is type(own) is construct.Container
    assert parsed == own == VALUES_OF_WIRE
    assert list(parsed) == [name for name in own if name != "_io"] == ["x", "y"]
    assert parsed.x == -2
    assert repr(parsed) == repr(own)
    assert str(parsed) == str(own)
    assert list(POINT.compile().parse(WIRE)) == list(parsed)


def test_what_construct_has_parsed_is_built_directly_all_the_same() -> None:
    parsed = c.Struct.parse(POINT, WIRE)
    assert "_io" in parsed
    assert direct(POINT, "build", never)(parsed) == WIRE


@pytest.mark.parametrize("subject", [POINT * "a point", "p" / POINT, "p" / (POINT * "a point")])
def test_embedded_it_does_what_construct_does(subject: Any) -> None:
    assert subject.parse(WIRE) == VALUES_OF_WIRE
    assert subject.build(VALUES_OF_WIRE) == WIRE
    assert subject.sizeof() == POINT.sizeof() == 4
    assert subject.compile().parse(WIRE) == VALUES_OF_WIRE
    assert construct.GreedyRange(subject).parse(2 * WIRE + b"\0") == 2 * [VALUES_OF_WIRE]
    assert construct.Array(2, subject).build(2 * [VALUES_OF_WIRE]) == 2 * WIRE
    outer = construct.Struct("size" / construct.Byte, "point" / POINT, construct.Terminated)
    assert outer.parse(b"\4" + WIRE).point == VALUES_OF_WIRE
    assert outer.build({"size": 4, "point": VALUES_OF_WIRE}) == b"\4" + WIRE
    assert (POINT + construct.Struct("z" / construct.Byte)).parse(WIRE + b"\7").z == 7
    assert construct.RawCopy(subject).parse(WIRE).data == WIRE


def test_hooks_are_called() -> None:
    seen: list[Any] = []
    hooked = c.Struct("a" / c.Int(8))
    hooked.parsed = lambda value, _: seen.append(value.a)
    for format in (
        c.Struct("a" / c.Int(8) * (lambda value, _: seen.append(value))),
        hooked,
        c.Struct("inner" / hooked),
        c.Struct("several" / c.Counted(1, hooked)),
    ):
        format.parse(b"\5")
        count = len(seen)
        c.Struct.parse(format, b"\5")
        assert len(seen) == 2 * count > 0
        seen.clear()


class Doubled(c.Struct):
    """Reads other values, and writes others."""

    def _parse(self, stream: Any, context: Any, path: str) -> Any:
        return {"x": 2 * super()._parse(stream, context, path)["x"]}

    def build(self, obj: Any, **contextkw: Any) -> bytes:
        return 2 * super().build(obj, **contextkw)


class Odd(type(c.Int(8))):  # type: ignore[misc]
    """A number that is read in its own way."""

    def _parse(self, stream: Any, context: Any, path: str) -> Any:
        return super()._parse(stream, context, path) | 1


def test_derived_classes_do_it_in_their_own_way() -> None:
    doubled = Doubled("x" / c.Int(8))
    for _ in range(2):
        assert doubled.parse(b"\2") == {"x": 4}
        assert doubled.parse_stream(io.BytesIO(b"\2")) == {"x": 4}
        assert doubled.build({"x": 2}) == b"\2\2"
        assert c.Struct("inner" / doubled).parse(b"\2").inner == {"x": 4}
        assert c.Struct("x" / Odd("B", "little")).parse(b"\2").x == 3


@pytest.mark.parametrize("name", ["_x", "two words", "class", "ﬁ", ""])
def test_names_that_are_no_plain_ones_are_construct_s(name: str) -> None:
    format = c.Struct(name / c.Int(8), "b" / c.Int(8))
    assert not is_fused(format)
    assert outcome(format.parse, b"\1\2") == outcome(c.Struct.parse, format, b"\1\2")
    assert format.parse(b"\1\2").b == 2


def test_fields_of_one_name_are_construct_s() -> None:
    format = c.Struct("a" / c.Int(8), "a" / c.Int(8))
    assert format.parse(b"\1\2") == {"a": 2}
    assert format.build({"a": 3}) == b"\3\3"


def test_copies_are_formats_of_their_own() -> None:
    assert POINT.parse(WIRE) == VALUES_OF_WIRE
    assert POINT.build(VALUES_OF_WIRE) == WIRE
    for other in (copy.copy(POINT), copy.deepcopy(POINT), pickle.loads(pickle.dumps(POINT))):
        assert other.parse(WIRE) == VALUES_OF_WIRE
        assert other.build(VALUES_OF_WIRE) == WIRE
        assert other.sizeof() == 4
        assert other.parse is not POINT.parse


def test_files_and_streams_stand_behind_what_was_read(tmp_path: Path) -> None:
    path = tmp_path / "points"
    path.write_bytes(2 * WIRE + b"\xff\xff\xff\xff")
    with path.open("rb") as file:
        for _ in range(2):
            assert POINT.parse_stream(file) == VALUES_OF_WIRE
        with pytest.raises(c.PayloadError) as caught:
            POINT.parse_stream(file)
        assert (caught.value.path, caught.value.offset) == ("y", 10)
    assert POINT.parse_file(path) == VALUES_OF_WIRE
    POINT.build_file(VALUES_OF_WIRE, path)
    assert path.read_bytes() == WIRE


class Slow(io.BytesIO):
    """A stream that gives less than it is asked for."""

    def read(self, size: int | None = -1) -> bytes:
        return super().read(min(size or 0, 1))


def test_other_streams_are_construct_s() -> None:
    stream = Slow(WIRE)
    due = outcome(c.Struct.parse_stream, POINT, Slow(WIRE))
    assert outcome(POINT.parse_stream, stream) == due
    rest = c.Struct("all" / c.OctetsFill())
    assert rest.parse_stream(io.BytesIO(WIRE)).all == WIRE


def test_a_module_is_imported_without_it() -> None:
    code = "import sys, generated.python.rn1; sys.exit('protogen.runtime.fused' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT)
