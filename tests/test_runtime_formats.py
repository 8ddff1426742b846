"""`FORMAT` in the hands of a user of construct: embedded, compiled, copied, from files and streams.

`test_runtime_constructs.py` says what the single pieces do.
"""

from __future__ import annotations

import copy
import io
import pickle
from collections import UserDict
from pathlib import Path
from types import MappingProxyType
from typing import Any

import construct
import pytest
from compiled import SCHEMAS, module_at, name_of, protocol_of
from hypothesis import given
from hypothesis import strategies as st

from protogen.runtime import api as rt
from protogen.runtime import constructs as c

POINT = c.Struct("x" / c.Int(16, signed=True), "y" / c.SevenBit(14, order="big"))
WIRE = bytes.fromhex("FE FF 01 02")
VALUES_OF_WIRE = {"x": -2, "y": 0x82}


# --- those of the schemas -------------------------------------------------------------------------


@pytest.mark.parametrize("path", SCHEMAS, ids=name_of)
@given(data=st.data())
def test_what_a_format_parses_it_builds_compiled_or_not(path: Path, data: Any) -> None:
    described = data.draw(st.sampled_from(protocol_of(path).messages))
    message = module_at(path).MESSAGES[described.name]
    least, greatest = message.SIZES.least, message.SIZES.greatest
    wire = data.draw(st.binary(min_size=least, max_size=min(greatest, least + 40)))
    wire = bytes(byte & 0x7F for byte in wire) if data.draw(st.booleans()) else wire
    compiled = message.FORMAT.compile()
    try:
        parsed = c.Whole(message.FORMAT).parse(wire)
    except c.PayloadError as error:
        assert 0 <= error.offset <= len(wire)
        return
    assert repr(compiled.parse(wire)) == repr(parsed)
    built = message.FORMAT.build(parsed)
    assert compiled.build(parsed) == built
    if described.plan.has_one_spelling:
        assert built == wire or "nan" in repr(parsed)  # Python makes signalling ones quiet.
    assert repr(c.Whole(message.FORMAT).parse(built)) == repr(parsed)


def test_a_float_is_no_integer() -> None:
    assert POINT.build({"x": 1, "y": 1})
    for values in ({"x": 1.0, "y": 1}, {"x": 1, "y": 1.0}):
        with pytest.raises(c.PayloadError):
            POINT.build(values)


@pytest.mark.parametrize("mapping", [dict, c.Container, UserDict, MappingProxyType])
def test_any_mapping_is_built(mapping: Any) -> None:
    assert POINT.build(mapping(VALUES_OF_WIRE)) == WIRE
    with pytest.raises(c.PayloadError, match="y: the value is missing"):
        POINT.build(mapping({"x": 1}))
    with pytest.raises(c.PayloadError, match="z: there is no such field"):
        POINT.build(mapping({**VALUES_OF_WIRE, "z": 1}))


# --- as construct's own Struct --------------------------------------------------------------------


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
    assert repr(format.parse(kind(wire))) == repr(format.parse(wire))


def test_the_container_is_construct_s() -> None:
    parsed = POINT.parse(WIRE)
    own = construct.Struct(*POINT.subcons).parse(WIRE)
    assert type(parsed) is type(own) is construct.Container
    assert parsed == own == VALUES_OF_WIRE
    assert list(parsed) == list(own)
    assert parsed.x == -2
    assert repr(parsed) == repr(own)
    assert str(parsed) == str(own)


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
        assert set(seen) == {5}
        seen.clear()


class Doubled(c.Struct):
    """Reads other values, and writes others."""

    def _parse(self, stream: Any, context: Any, path: str) -> Any:
        return {"x": 2 * super()._parse(stream, context, path)["x"]}

    def build(self, obj: Any, **contextkw: Any) -> bytes:
        return 2 * bytes(super().build(obj, **contextkw))


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
        assert c.Struct("x" / Odd(rt.Number(8))).parse(b"\2").x == 3


def test_fields_may_have_one_name() -> None:
    format = c.Struct("a" / c.Int(8), "a" / c.Int(8))
    assert format.parse(b"\1\2") == {"a": 2}
    assert format.build({"a": 3}) == b"\3\3"


@pytest.mark.parametrize("number", [c.Float(32), c.Float(64, "big"), c.SevenBitFloat(32)])
def test_copies_of_floats_read_and_build_the_same(number: Any) -> None:
    wire = number.build(-1.5)
    for other in (copy.deepcopy(number), pickle.loads(pickle.dumps(number))):
        assert other.parse(wire) == -1.5
        assert other.build(-1.5) == wire


def test_copies_are_formats_of_their_own() -> None:
    for other in (copy.copy(POINT), copy.deepcopy(POINT), pickle.loads(pickle.dumps(POINT))):
        assert other is not POINT
        assert other.parse(WIRE) == VALUES_OF_WIRE
        assert other.build(VALUES_OF_WIRE) == WIRE
        assert other.sizeof() == 4


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
