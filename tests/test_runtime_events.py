"""Events of streams that are written by hand, byte by byte."""

from binascii import crc_hqx
from typing import Any

import handwritten_framings as framings
import handwritten_matty as matty
import handwritten_rn1 as rn1
import pytest

from protogen.runtime import api as rt

Shown = list[tuple[int, int, str]]


def show(events: list[Any]) -> Shown:
    """Offset, size, and the message's name, `unknown` or the reason."""
    return [(event.offset, event.size, what(event)) for event in events]


def what(event: Any) -> str:
    if event.kind == "message":
        return str(event.message.NAME)
    return "unknown" if event.kind == "unknown" else str(event.reason)


def decode(sender: Any, wire: str) -> Shown:
    decoder = rt.Decoder(sender)
    return show([*decoder.feed(bytes.fromhex(wire)), *decoder.flush()])


# Robbus: 55, then escaped: length, counter, letter, arguments, and what makes the sum 0.
ACK = "55 02 01 41 BC"


@pytest.mark.parametrize(
    ("wire", "expected"),
    [
        (ACK, [(0, 5, "ack")]),
        (f"00 FF {ACK} 00", [(0, 2, "noise"), (2, 5, "ack"), (7, 1, "noise")]),
        (f"55 {ACK}", [(0, 1, "truncated"), (1, 5, "ack")]),
        (f"55 02 01 {ACK}", [(0, 3, "truncated"), (3, 5, "ack")]),
        # 56 00: only 56 AA and 56 A9 stand for a byte. What is left is no start.
        (f"55 02 56 00 41 {ACK}", [(0, 4, "stuffing"), (4, 1, "noise"), (5, 5, "ack")]),
        (f"55 02 56 {ACK}", [(0, 3, "truncated"), (3, 5, "ack")]),
        ("55 01", [(0, 2, "length")]),
        ("55 7C", [(0, 2, "length")]),
        ("55 02 01 41 BD", [(0, 5, "checksum")]),
        # An acknowledgement with one byte of data: 03 + 01 + 41 + 00 = 45.
        ("55 03 01 41 00 BB", [(0, 6, "size")]),
        # The letter Z: 02 + 01 + 5A = 5D.
        ("55 02 01 5A A3", [(0, 5, "unknown")]),
        ("55 02 01", [(0, 3, "truncated")]),
        # Length 22: the frame would go on, but the input ends.
        (f"{ACK} 55 14 01 49 00", [(0, 5, "ack"), (5, 5, "truncated")]),
        ("", []),
    ],
)
def test_robbus(wire: str, expected: Shown) -> None:
    assert decode(matty.ESP_SENDER, wire) == expected


# Behind the start only bytes up to 7F; gyro has seven of them, the low seven bits first.
GYRO = "80 01 7B 7F 00 00 2C 06"


@pytest.mark.parametrize(
    ("wire", "expected"),
    [
        (GYRO, [(0, 8, "gyro")]),
        (f"{GYRO} 00 05 {GYRO}", [(0, 8, "gyro"), (8, 2, "noise"), (10, 8, "gyro")]),
        (f"80 01 {GYRO}", [(0, 2, "truncated"), (2, 8, "gyro")]),
        (f"80 01 FF 00 {GYRO}", [(0, 3, "encoding"), (3, 1, "noise"), (4, 8, "gyro")]),
        # Nothing tells how long an unknown message is but the next start, or the end of input.
        (f"90 01 02 {GYRO}", [(0, 3, "unknown"), (3, 8, "gyro")]),
        ("90 91 01", [(0, 1, "unknown"), (1, 2, "unknown")]),
        ("90" + " 00" * 721, [(0, 722, "length")]),
        ("90" + " 00" * 720, [(0, 721, "unknown")]),
        ("00" * 1500, [(0, 722, "noise"), (722, 722, "noise"), (1444, 56, "noise")]),
        ("00" * 722 + GYRO, [(0, 722, "noise"), (722, 8, "gyro")]),
    ],
)
def test_rn1_from_the_brain(wire: str, expected: Shown) -> None:
    assert decode(rn1.BRAIN_SENDER, wire) == expected


@pytest.mark.parametrize(
    ("wire", "expected"),
    [
        ("80 40 3F FF", [(0, 4, "move_manual")]),
        ("80 40 FF", [(0, 3, "size")]),
        ("80 40 3F 00 FF", [(0, 4, "size"), (4, 1, "noise")]),
        ("80 40 81 FF", [(0, 2, "truncated"), (2, 2, "size")]),
        ("90 01 FF", [(0, 3, "unknown")]),
        ("90 01 80 40 3F FF", [(0, 2, "truncated"), (2, 4, "move_manual")]),
        ("FF FF", [(0, 2, "noise")]),
        ("FE 42 11 7A 52 FF", [(0, 6, "maintenance")]),
        ("FE 42 11 7A 52 00 FF", [(0, 7, "size")]),
        ("FE 42 11 7B 52 FF", [(0, 6, "value")]),
        ("FE 42 11 7A 41 5E 01 04 FF", [(0, 9, "value")]),
        ("FE 42 11 7A 05 01 02 FF", [(0, 8, "maintenance")]),
        ("FE 42 11 FF", [(0, 4, "size")]),
        ("FE 42 11 7A 05 00 00 00 00", [(0, 9, "size")]),
        ("91" + " 00" * 7 + "FF", [(0, 9, "unknown")]),
        ("91" + " 00" * 8 + "FF", [(0, 9, "length"), (9, 1, "noise")]),
    ],
)
def test_rn1_from_the_host(wire: str, expected: Shown) -> None:
    assert decode(rn1.HOST_SENDER, wire) == expected


# 1B 02, then stuffed: class, number, subclass, length, contents, their XOR; then 1B 03.
EMPTY = "1B 02 01 FF 1B 00 00 00 1B 03"


@pytest.mark.parametrize(
    ("wire", "expected"),
    [
        (EMPTY, [(0, 10, "empty")]),
        ("1B 02 01 FF 02 03 05 FF 1F E5 1B 03", [(0, 12, "pair")]),
        # 7C is sent as 7C 1B 01, also in the checksum.
        ("1B 02 02 7C 1B 01 01 01 7C 1B 01 7C 1B 01 1B 03", [(0, 16, "blob")]),
        (f"1B 02 01 FF {EMPTY}", [(0, 4, "truncated"), (4, 10, "empty")]),
        (f"1B {EMPTY}", [(0, 1, "noise"), (1, 10, "empty")]),
        ("1B 02 01 FF 1B 01", [(0, 6, "stuffing")]),
        ("1B 02 01 FF 1B 00 0A", [(0, 7, "length")]),
        # The end comes too early, or something else stands where it is due.
        ("1B 02 01 FF 1B 00 01 00 1B 03", [(0, 10, "length")]),
        ("1B 02 01 FF 1B 00 00 00 00 1B 03", [(0, 9, "length"), (9, 2, "noise")]),
        ("1B 02 01 FF 1B 00 00 00 1B 00", [(0, 10, "length")]),
        ("1B 02 01 FF 1B 00 00 01 1B 03", [(0, 10, "checksum")]),
        ("1B 02 09 FF 09 00 00 1B 03", [(0, 9, "unknown")]),
        # A number that is not below 100 in the closed first field: 64 ^ 00 ^ 00 = 64.
        ("1B 02 01 FF 02 03 64 00 00 64 1B 03", [(0, 12, "value")]),
        # 2000 in 13 bits with sign has a bit in the padding: 05 ^ 00 ^ 20 = 25.
        ("1B 02 01 FF 02 03 05 00 20 25 1B 03", [(0, 12, "value")]),
        ("1B 02 7C 1B 03", [(0, 5, "stuffing")]),
        ("1B 02 01 1B 03", [(0, 5, "truncated")]),
        ("1B", [(0, 1, "noise")]),
    ],
)
def test_rflex(wire: str, expected: Shown) -> None:
    assert decode(framings.rflex(), wire) == expected


@pytest.mark.parametrize(
    ("wire", "expected"),
    [
        (b"b0201e", [(0, 6, "empty")]),
        (b"b0201b0201e", [(0, 5, "truncated"), (5, 6, "empty")]),
        (b"b02 01e", [(0, 4, "encoding"), (4, 3, "noise")]),
        (b"b02a1e", [(0, 4, "encoding"), (4, 2, "noise")]),
        (b"b020e", [(0, 5, "encoding")]),
        (b"b01e", [(0, 3, "length"), (3, 1, "noise")]),
        (b"b02010e", [(0, 6, "length"), (6, 1, "noise")]),
        (b"b0301e", [(0, 6, "length")]),
        (b"be", [(0, 2, "truncated")]),
        (b"b0209e", [(0, 6, "unknown")]),
        (b"b0503412Ae", [(0, 10, "length")]),
        (b"b0403412Ae", [(0, 10, "blob")]),
    ],
)
def test_uherobot(wire: bytes, expected: Shown) -> None:
    assert decode(framings.uherobot(), wire.hex()) == expected


# Dagny: id, data, XOR of both unless there is no data, 0A. An `empty` is 01, a `blob` 03.
@pytest.mark.parametrize(
    ("wire", "expected"),
    [
        ("01 0A 01 0A", [(0, 2, "empty"), (2, 2, "empty")]),
        ("03 61 62 00 0A", [(0, 5, "blob")]),
        ("0A 0A 01 0A", [(0, 1, "noise"), (1, 1, "noise"), (2, 2, "empty")]),
        # The size that the identity gives beats an end in the data: 02 ^ 05 ^ 0A ^ 00 = 0D.
        ("02 05 0A 00 0D 0A", [(0, 6, "pair")]),
        ("02 05 0A 00 0D 00 01 0A", [(0, 3, "size"), (3, 5, "checksum")]),
        # Where no size is known, the first end decides.
        ("03 0A 05 0A", [(0, 2, "blob"), (2, 2, "unknown")]),
        ("03 61 0A 01 0A", [(0, 3, "truncated"), (3, 2, "empty")]),
        ("03 61 62 01 0A 01 0A", [(0, 5, "checksum"), (5, 2, "empty")]),
        ("01 00 0A 01 0A", [(0, 2, "size"), (2, 1, "noise"), (3, 2, "empty")]),
        ("09 61 68 0A", [(0, 4, "unknown")]),
        ("01", [(0, 1, "truncated")]),
    ],
)
def test_dagny(wire: str, expected: Shown) -> None:
    assert decode(framings.dagny(), wire) == expected


def test_dagny_goes_on_behind_an_end_in_the_middle_of_what_failed() -> None:
    # A `pair` that is cut: its fixed size reaches into the next frame.
    assert decode(framings.dagny(), "02 05 0A 01 0A 01 0A") == [
        (0, 3, "size"),
        (3, 2, "empty"),
        (5, 2, "empty"),
    ]


def crc(data: str) -> str:
    """CRC-16/IBM-3740, low byte first."""
    return crc_hqx(bytes.fromhex(data), 0xFFFF).to_bytes(2, "little").hex(" ")


UBX_EMPTY = f"B5 62 01 00 00 {crc('01 00 00')}"


@pytest.mark.parametrize(
    ("wire", "expected"),
    [
        (UBX_EMPTY, [(0, 7, "empty")]),
        # A false start whose length covers the frame behind it is given up and scanned again.
        (f"B5 62 03 06 00 {UBX_EMPTY} 00 00",
         [(0, 5, "checksum"), (5, 7, "empty"), (12, 2, "noise")]),
        (f"B5 62 03 06 00 {UBX_EMPTY}", [(0, 5, "truncated"), (5, 7, "empty")]),
        (f"B5 {UBX_EMPTY}", [(0, 1, "noise"), (1, 7, "empty")]),
        (f"B5 62 B5 62 {UBX_EMPTY}", [(0, 2, "length"), (2, 2, "length"), (4, 7, "empty")]),
        ("B5 62 03 FF FF 00", [(0, 5, "length"), (5, 1, "noise")]),
    ],
)  # fmt: skip
def test_ubx(wire: str, expected: Shown) -> None:
    assert decode(framings.ubx(), wire) == expected


def test_ubx_waits_for_a_start_that_may_run_over_the_end_of_what_failed() -> None:
    # The wrong checksum ends with B5, which may begin the next frame.
    decoder = rt.Decoder(framings.ubx())
    assert show(decoder.feed(bytes.fromhex("B5 62 01 00 00 00 B5"))) == []
    rest = bytes.fromhex(UBX_EMPTY)[1:]
    assert show(decoder.feed(rest)) == [(0, 6, "checksum"), (6, 7, "empty")]


# SLIP: C0, then stuffed: id, data, their XOR; then C0. An `empty` is C0 01 01 C0.
@pytest.mark.parametrize(
    ("wire", "expected"),
    [
        ("C0 01 01 C0 C0 01 01 C0", [(0, 4, "empty"), (4, 4, "empty")]),
        ("C0 C0 01 01 C0", [(0, 1, "noise"), (1, 4, "empty")]),
        ("C0 05 00 C0 01 01 C0", [(0, 3, "checksum"), (3, 4, "empty")]),
        ("C0 DB 00 C0 01 01 C0", [(0, 3, "stuffing"), (3, 4, "empty")]),
        # DB DC stands for C0: 03 ^ C0 = C3.
        ("C0 03 DB DC C3 C0", [(0, 6, "blob")]),
        ("C0 03 DB C0 01 01 C0", [(0, 3, "stuffing"), (3, 4, "empty")]),
        ("C0", [(0, 1, "truncated")]),
    ],
)
def test_slip(wire: str, expected: Shown) -> None:
    assert decode(framings.slip_both_ends(), wire) == expected


COBS_EMPTY = f"04 01 {crc('01')} 00"  # No zero in id and CRC: one group.


@pytest.mark.parametrize(
    ("wire", "expected"),
    [
        (COBS_EMPTY, [(0, 5, "empty")]),
        (f"{COBS_EMPTY} 00 {COBS_EMPTY}", [(0, 5, "empty"), (5, 1, "noise"), (6, 5, "empty")]),
        (f"05 01 00 {COBS_EMPTY}", [(0, 3, "encoding"), (3, 5, "empty")]),
        ("02 01", [(0, 2, "truncated")]),
    ],
)
def test_cobs(wire: str, expected: Shown) -> None:
    assert decode(framings.cobs_end_only(), wire) == expected


@pytest.mark.parametrize(
    ("wire", "expected"),
    [
        # Length 2, id 3, payload 7C 01: a lenient receiver lets 7C pass when no 1B follows.
        ("AA 02 03 7C 01 7E", [(0, 6, "blob")]),
        ("AA 02 03 7C 1B 01 01 7E", [(0, 8, "blob")]),
        # Whether 7C is all of the payload is only known from a byte that is then one too many.
        ("AA 01 03 7C 7F", [(0, 5, "length")]),
        ("AA 01 03 7C 1B 01 7F", [(0, 7, "blob")]),
        ("AA 01 03 1B 1B", [(0, 5, "length")]),
    ],
)
def test_lenient_stuffing(wire: str, expected: Shown) -> None:
    assert decode(framings.lenient_by_size(), wire) == expected


def test_without_a_start_every_byte_may_be_one_and_failures_are_noise() -> None:
    frame = f"00 01 {crc('00 01')}"  # Length 0, id 1.
    assert decode(framings.anywhere_length(), f"05 06 {frame} FF {frame}") == [
        (0, 2, "noise"),
        (2, 4, "empty"),
        (6, 1, "noise"),
        (7, 4, "empty"),
    ]
    assert decode(framings.anywhere_length(), "FF" * 30) == [
        (0, 13, "noise"),
        (13, 13, "noise"),
        (26, 4, "noise"),
    ]


def test_a_message_that_says_itself_where_it_ends_is_delivered_with_its_last_byte() -> None:
    # Start 10 20, id 4; one item 0x0123, kind 1 with its constant 7; XOR of id and payload.
    payload = "01 23 01 01 07"
    checksum = f"{0x04 ^ 0x01 ^ 0x23 ^ 0x01 ^ 0x01 ^ 0x07:02X}"
    decoder = rt.Decoder(framings.next_start_ends())
    assert decoder.feed(bytes.fromhex(f"10 20 04 {payload}")) == []
    (event,) = decoder.feed(bytes.fromhex(checksum))
    assert show([event]) == [(0, 9, "tally")]
    assert isinstance(event, rt.MessageEvent)
    assert event.message.items == [0x123]


@pytest.mark.parametrize(
    ("wire", "expected"),
    [
        ("10 20 04 05", [(0, 4, "value")]),  # The count is closed: below 4.
        ("10 20 04 00 01 08", [(0, 6, "value")]),  # The constant is 7.
        ("10 20 04 00 02", [(0, 5, "value")]),  # There is no case 2.
        ("10 20 04 01 00 05", [(0, 6, "value")]),  # The item has 10 bits.
        ("10 20 04 01", [(0, 4, "truncated")]),
        # Nothing protects the start, so it ends an unknown message only behind its identity: here
        # the identity is 10, the payload 20, and the checksum 10 ^ 20.
        ("10 20 10 20 30 10 20", [(0, 5, "unknown"), (5, 2, "truncated")]),
    ],
)
def test_a_message_that_says_itself_where_it_ends_fails_early(wire: str, expected: Shown) -> None:
    assert decode(framings.next_start_ends(), wire) == expected


@pytest.mark.parametrize(
    ("sender", "wire", "early"),
    [
        (matty.ESP_SENDER, "55 01", True),
        (matty.ESP_SENDER, "55 02 56 00", True),
        (matty.ESP_SENDER, "00 01 02", False),
        (rn1.BRAIN_SENDER, GYRO, True),
        (rn1.HOST_SENDER, "80 40 3F 00", True),
        (framings.rflex(), "1B 02 01 FF 1B 00 0A", True),
    ],
)
def test_a_candidate_fails_with_the_byte_that_proves_it(
    sender: Any, wire: str, early: bool
) -> None:
    *before, last = bytes.fromhex(wire)
    decoder = rt.Decoder(sender)
    assert decoder.feed(bytes(before)) == []
    assert bool(decoder.feed(bytes((last,)))) is early


def test_events_show_parts_values_and_bytes() -> None:
    decoder = matty.Decoder("esp")
    (event,) = decoder.feed(bytes.fromhex(ACK))
    assert isinstance(event, matty.MessageEvent)
    assert event.message == matty.Ack()
    assert event.parts == matty.Parts(counter=1, command=0x41)
    assert (event.sender, event.payload, event.raw) == ("esp", b"", bytes.fromhex(ACK))
    (event,) = decoder.feed(bytes.fromhex("55 03 01 5A 07 9B"))
    assert isinstance(event, matty.UnknownEvent)
    assert (event.offset, event.payload, event.parts.command) == (5, b"\x07", 0x5A)
    (event,) = decoder.feed(bytes.fromhex("55 02 01 41 BD"))
    assert isinstance(event, matty.InvalidEvent)
    assert event.problem == "crc is bd, not bc"
    assert event == matty.InvalidEvent(11, bytes.fromhex("55 02 01 41 BD"), "esp", "checksum")


def test_pending_bytes_are_counted() -> None:
    decoder = matty.Decoder("esp")
    decoder.feed(b"\x00\x55\x02")
    assert decoder.pending == 2
    decoder.flush()
    assert decoder.pending == 0
