"""Integers on the wire, and the enums and flags that stand for them."""

import copy
import json
import pickle

import handwritten_matty as matty
import pytest
from hypothesis import given
from hypothesis import strategies as st

from protogen.runtime import api as rt
from protogen.runtime.errors import ByteError
from protogen.runtime.payload.number import ByteOrder
from protogen.runtime.payload.pairs import pair_values

Mode = matty.RobotMode
Status = matty.StatusStatus


@pytest.mark.parametrize(
    ("number", "value", "wire"),
    [
        (rt.Number(8), 0xA5, "A5"),
        (rt.Number(16, order="little"), 0x1234, "34 12"),
        (rt.Number(16, order="big"), 0x1234, "12 34"),
        (rt.Number(12, order="big"), 0xABC, "0A BC"),
        (rt.Number(14, signed=True, order="little"), -1, "FF 3F"),
        (rt.Number(24, signed=True, order="big"), -2, "FF FF FE"),
        (rt.Number(7, seven_bit=True), 127, "7F"),
        (rt.Number(7, signed=True, seven_bit=True), -64, "40"),
        (rt.Number(14, signed=True, order="little", seven_bit=True), -5, "7B 7F"),
        (rt.Number(14, signed=True, order="big", seven_bit=True), -5, "7F 7B"),
        # C0DE is 11 0000001 1011110 in groups of seven bits.
        (rt.Number(16, order="little", seven_bit=True), 0xC0DE, "5E 01 03"),
        (rt.Number(64, signed=True, order="little"), -(2**63), "00 00 00 00 00 00 00 80"),
        (rt.Number(1), 1, "01"),
    ],
)
def test_numbers_lie_on_the_wire_as_computed_by_hand(
    number: rt.Number, value: int, wire: str
) -> None:
    assert number.encode(value) == bytes.fromhex(wire)
    assert number.decode(bytes.fromhex(wire)) == value
    assert number.size == len(bytes.fromhex(wire))


@given(
    bits=st.integers(1, 64),
    signed=st.booleans(),
    order=st.sampled_from(["little", "big"]),
    seven_bit=st.booleans(),
    data=st.data(),
)
def test_every_accepted_number_encodes_to_its_bytes(
    bits: int, signed: bool, order: ByteOrder, seven_bit: bool, data: st.DataObject
) -> None:
    number = rt.Number(bits, signed, order, seven_bit)
    value = data.draw(
        st.sampled_from([number.least, number.greatest])
        | st.integers(number.least, number.greatest)
    )
    assert number.decode(number.encode(value)) == value
    wire = data.draw(st.binary(min_size=number.size, max_size=number.size))
    try:
        found = number.decode(wire)
    except ByteError:
        return
    assert number.encode(found) == wire


@pytest.mark.parametrize(
    ("number", "wire", "reason"),
    [
        (rt.Number(12, order="big"), "1A BC", "value"),
        (rt.Number(14, signed=True, order="little"), "FF FF", "value"),
        (rt.Number(16, order="little", seven_bit=True), "00 00 04", "value"),
        (rt.Number(14, seven_bit=True), "00 80", "encoding"),
    ],
)
def test_padding_and_top_bits_have_to_be_zero(number: rt.Number, wire: str, reason: str) -> None:
    with pytest.raises(ByteError) as caught:
        number.decode(bytes.fromhex(wire))
    assert caught.value.reason == reason


@pytest.mark.parametrize("value", [-1, 256])
def test_a_number_out_of_its_bits_is_refused(value: int) -> None:
    with pytest.raises(ValueError, match=r"is not in 0\.\.255"):
        rt.Number(8).encode(value)


def test_an_open_enum_keeps_values_without_a_name() -> None:
    unknown = Mode(7)
    assert unknown == 7
    assert unknown is not Mode.IDLE
    assert hash(unknown) == hash(7)
    assert {unknown: "x"}[Mode(7)] == "x"
    assert (unknown.name, unknown.is_known) == ("UNKNOWN_7", False)
    assert repr(unknown) == "<RobotMode.UNKNOWN_7: 7>"
    assert json.dumps(unknown) == "7"
    assert len(Mode) == 3


def test_a_known_value_is_its_member() -> None:
    assert Mode(1) is Mode.REMOTE
    assert Mode.REMOTE.is_known
    with pytest.raises(ValueError, match="not a valid"):
        Mode("remote")  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [Mode(1), Mode(200), Status(0x01), Status(0xFF), Status(0x40)])
def test_enums_and_flags_can_be_copied_and_pickled(value: int) -> None:
    for found in (copy.deepcopy(value), pickle.loads(pickle.dumps(value))):
        assert found == value
        assert type(found) is type(value)


def test_flags_keep_bits_without_a_name() -> None:
    status = Status(0xC1)
    assert status == 0xC1
    assert Status.RUNNING in status
    assert status.unknown == 0x40
    assert status & ~Status.RUNNING == 0x41
    assert Status(0).unknown == 0
    assert matty.StatusStatus(0x1FF).unknown == 0x140


@pytest.mark.parametrize("signed", [False, True])
@pytest.mark.parametrize("bits", range(8, 15))
def test_the_table_of_two_bytes_is_that_of_the_numbers(bits: int, signed: bool) -> None:
    number = rt.Number(bits, signed, "little", seven_bit=True)

    def decoded(code: int) -> int | None:
        try:
            return number.decode(code.to_bytes(2, "little"))
        except ByteError:
            return None

    assert pair_values(bits, signed) == tuple(map(decoded, range(1 << 15)))
