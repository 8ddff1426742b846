"""Ways in which a receiver finds frames: worked out by hand from the documents and compared."""

from __future__ import annotations

from fractions import Fraction

import pytest
from passes_support import (
    HEAD,
    codes_of,
    compile_text,
    framing_of,
    message_framing,
    repository_protocol,
)

from protogen.model.framing import AfterEnd, Anywhere, End, Framing, StartLiteral, StartSet
from protogen.model.sizes import SizeSet


def framing(protocol: str, sender: str) -> Framing:
    return repository_protocol(protocol).sender(sender).framing


def every_byte(first: int, last: int) -> tuple[bytes, ...]:
    return tuple(bytes((byte,)) for byte in range(first, last + 1))


def around(protocol: str, sender: str) -> tuple[int, int]:
    """Bytes in front of the payload, and behind it without the end."""
    plan = repository_protocol(protocol).sender(sender).plan
    return plan.head_size, plan.tail_size


class TestRn1:
    """A byte 80..FE starts a message, 7-bit bytes follow; the host ends its commands with FF."""

    def test_a_start_byte_is_no_data_byte(self) -> None:
        for sender in ("host", "brain"):
            start = framing("rn1", sender).start
            assert start == StartSet(words=every_byte(0x80, 0xFE), protected=True)
            assert framing("rn1", sender).seven_bit
            assert framing("rn1", sender).self_synchronising

    def test_only_the_host_ends_its_frames(self) -> None:
        assert framing("rn1", "host").end == End(bytes=b"\xff", protected=True)
        assert framing("rn1", "brain").end is None
        assert not framing("rn1", "host").cut_ambiguous

    def test_sizes(self) -> None:
        # move_manual is the shortest command: start, speed, arc, stop.
        # The longest is maintenance with a baud rate: start, three magic bytes, the operation, a
        # uint16 in three bytes, stop.
        host = framing("rn1", "host")
        assert (*around("rn1", "host"), host.least, host.greatest) == (1, 0, 4, 9)
        # facing: start, five bytes. lidar: start, status, 360 distances of two bytes.
        brain = framing("rn1", "brain")
        assert (*around("rn1", "brain"), brain.greatest) == (1, 0, 1 + 1 + 720)

    def test_rate(self) -> None:
        # 115200 baud, ten bit times a byte: 11520 bytes per second.
        lidar = message_framing(framing("rn1", "brain"), "lidar")
        assert lidar.per_second == Fraction(11520, 722)


class TestUherobot:
    """Base16 between b and e; the length counts itself, the type and the payload: 2..255."""

    @pytest.mark.parametrize("sender", ["daemon", "board"])
    def test_hex_digits_are_neither_delimiter(self, sender: str) -> None:
        found = framing("uherobot", sender)
        assert found.start == StartLiteral(bytes=b"b", protected=True)
        assert found.end == End(bytes=b"e", protected=True)
        assert found.self_synchronising

    def test_sizes(self) -> None:
        # Up to 255 bytes of two digits between two delimiters.
        found = framing("uherobot", "board")
        assert found.greatest == 1 + 2 * 255 + 1
        assert found.payload == SizeSet.between(0, 253)
        # b, length and type, and a payload of three values of two bytes, e.
        status = message_framing(found, "status")
        assert (status.least, status.greatest) == (18, 18)
        # Before the encoding: b, length, type in front of the payload; four bytes are no payload.
        assert (*around("uherobot", "board"), found.overhead) == (3, 0, SizeSet.exactly(4))


class TestDagny:
    """ID, data, XOR unless there is no data, newline; nothing keeps newlines out of the data."""

    @pytest.mark.parametrize("sender", ["host", "robot"])
    def test_a_frame_starts_behind_an_end_that_data_can_hold(self, sender: str) -> None:
        found = framing("dagny", sender)
        assert found.start == AfterEnd()
        assert found.end == End(bytes=b"\n", protected=False)
        assert found.cut_ambiguous
        assert not found.self_synchronising
        assert "the end can occur in the data" in found.why_synchronising

    def test_sizes(self) -> None:
        # ID and newline; ID, one byte of data, XOR, newline.
        host = framing("dagny", "host")
        assert host.least == 2
        assert message_framing(host, "motor").greatest == 4
        # The XOR is absent without data.
        assert host.overhead == SizeSet.between(2, 3)
        assert around("dagny", "host") == (1, 1)


class TestRflex:
    """1B 02 ... 1B 03; inside, 1B becomes 1B 00 and 7C becomes 7C 1B 01."""

    @pytest.mark.parametrize("sender", ["linux", "flex"])
    def test_stuffing_keeps_both_delimiters_out(self, sender: str) -> None:
        found = framing("rflex", sender)
        assert found.start == StartLiteral(bytes=b"\x1b\x02", protected=True)
        assert found.end == End(bytes=b"\x1b\x03", protected=True)
        assert found.self_synchronising

    @pytest.mark.parametrize("sender", ["linux", "flex"])
    def test_greatest_frame(self, sender: str) -> None:
        # Two delimiters of two bytes; class, number, subclass, 255 bytes of contents and the
        # checksum can each be 7C, which takes three. The length is FF then, which takes one.
        found = framing("rflex", sender)
        assert found.greatest == 2 + 3 * (3 + 255 + 1) + 1 + 2
        # Delimiter and four bytes in front of the contents, the checksum behind.
        assert around("rflex", sender) == (6, 1)
        assert found.overhead == SizeSet.exactly(9)

    def test_a_message_is_stuffed_where_its_bytes_are_not_known(self) -> None:
        # Request for the status: class 01, subclass and length are known; the number and the
        # checksum (of nothing) are counted at their worst, as is the length, whose bytes the
        # analysis does not take apart.
        least = message_framing(framing("rflex", "linux"), "request_system_status").least
        assert least == 2 + 4 + 0 + 1 + 2


class TestMatty:
    """55, length of counter, command and arguments (2..123), counter, command, arguments, sum."""

    @pytest.mark.parametrize("sender", ["pc", "esp"])
    def test_the_escape_keeps_55_out(self, sender: str) -> None:
        found = framing("matty", sender)
        assert found.start == StartLiteral(bytes=b"\x55", protected=True)
        assert found.end is None
        assert found.self_synchronising

    @pytest.mark.parametrize("sender", ["pc", "esp"])
    def test_sizes(self, sender: str) -> None:
        # Counter, command, 121 arguments and sum can all be escaped; 55 and the length 7B are not.
        found = framing("matty", sender)
        assert found.greatest == 1 + 1 + 2 * (1 + 1 + 121 + 1)
        assert found.least == 5
        assert found.payload == SizeSet.between(0, 121)
        assert around("matty", sender) == (4, 1)


MESSAGE = "messages: {gyro: {id: 1, from: robot, fields: {angle: uint16}}}\n"
LENGTH_AND_CRC = """\
  id: {type: uint8, id: true}
  length: {type: uint16, counts: payload, range: [0, 1000]}
  payload: {}
  check: {type: uint16, algorithm: CRC-16/XMODEM, covers: id..payload}
"""
DECISION = "decisions: {accepted: {question: Q, document: D, choice: C, because: B}}\n"


class TestOtherShapes:
    def test_sync_length_and_crc_without_stuffing(self) -> None:
        """The shape of UBX, SBP and MAVLink: a false start is given up when the CRC fails."""
        start = "frame:\n  sync: {literal: {hex: B5 62}, unprotected: accepted}\n"
        found = framing_of(HEAD + start + LENGTH_AND_CRC + DECISION + MESSAGE)
        assert found.start == StartLiteral(bytes=b"\xb5\x62", protected=False)
        assert found.end is None
        assert not found.self_synchronising
        assert "told from true ones by size and checksum" in found.why_synchronising
        # sync, id, length, up to 1000 bytes, CRC
        assert found.greatest == 2 + 1 + 2 + 1000 + 2
        assert found.finds_end == "`length` gives the size"

    def test_without_any_literal_sizes_and_checksum_tell(self) -> None:
        found = framing_of(HEAD + "frame:\n" + LENGTH_AND_CRC + MESSAGE)
        assert found.start == Anywhere()
        assert found.finds_start == "at any byte from which sizes and checksum are right"

    def test_cobs_ends_at_zero(self) -> None:
        frame = (
            "frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0}}\n"
            "transparency: {encoding: cobs}\n"
        )
        found = framing_of(HEAD + frame + MESSAGE)
        assert found.start == AfterEnd()
        assert found.end == End(bytes=b"\0", protected=True)
        # Three bytes take one code byte, then the zero.
        assert (found.least, found.greatest) == (5, 5)

    @pytest.mark.parametrize(
        ("preset", "flag", "worst"),
        [
            # C0 and DB, 7E and 7D take two bytes each; the flags are not stuffed.
            ("slip", 0xC0, 1 + 1 + 2 * 2 + 1),
            ("hdlc", 0x7E, 1 + 1 + 2 * 2 + 1),
        ],
    )
    def test_flags_at_both_ends(self, preset: str, flag: int, worst: int) -> None:
        frame = (
            f"frame: {{start: {{literal: {flag}}}, id: {{type: uint8, id: true}}, payload: {{}}, "
            f"end: {{literal: {flag}}}}}\ntransparency: {preset}\n"
        )
        found = framing_of(HEAD + frame + MESSAGE)
        assert found.start == StartLiteral(bytes=bytes([flag]), protected=True)
        assert found.end == End(bytes=bytes([flag]), protected=True)
        # The identity 1 is never stuffed.
        item = message_framing(found, "gyro")
        assert (item.least, item.greatest) == (1 + 1 + 2 + 1, worst)

    def test_a_length_behind_a_start_set(self) -> None:
        frame = (
            "byte_bits: 7\n"
            "frame:\n"
            "  start: {type: byte, id: true, range: [0xF0, 0xF7]}\n"
            "  length: {type: uint7, counts: payload}\n"
            "  payload: {}\n"
        )
        messages = "messages: {gyro: {id: 0xF1, from: robot, fields: {angle: uint14}}}\n"
        found = framing_of(HEAD + frame + messages)
        assert found.start == StartSet(words=every_byte(0xF0, 0xF7), protected=True)
        assert found.payload == SizeSet.between(0, 127)
        assert (found.least, found.greatest) == (4, 2 + 127)

    def test_a_whole_byte_in_the_payload_can_be_a_start(self) -> None:
        frame = (
            "byte_bits: 7\n"
            "frame:\n"
            "  start: {type: byte, id: true, range: [0xF0, 0xF7]}\n"
            "  length: {type: uint7, counts: payload}\n"
            "  payload: {}\n"
            "  check: {type: uint7, algorithm: CRC-7/MMC, covers: start..payload}\n"
        )
        messages = "messages: {gyro: {id: 0xF1, from: robot, fields: {raw: byte}}}\n"
        found = framing_of(HEAD + frame + messages)
        assert found.start == StartSet(words=every_byte(0xF0, 0xF7), protected=False)
        assert not found.seven_bit

    def test_what_the_payload_may_hold_is_searched_in_structs_arrays_and_switches(self) -> None:
        frame = (
            "byte_bits: 7\n"
            "frame:\n"
            "  start: {type: byte, id: true, range: [0x80, 0xFE]}\n"
            "  payload: {}\n"
            "  stop: {literal: 0xFF}\n"
        )
        for field in (
            "{fields: {inner: byte}}",
            "{type: byte, count: 2}",
            "{switch: kind, cases: {1: byte, 2: uint7}}",
        ):
            messages = (
                f"messages: {{gyro: {{id: 0x80, from: robot, "
                f"fields: {{kind: uint7, raw: {field}}}}}}}\n"
            )
            compiled = compile_text(HEAD + frame + messages)
            assert codes_of(compiled) == ["PG142"], field

    def test_one_frame_of_several_senders_is_reported_once(self) -> None:
        frame = "frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 10}}\n"
        messages = "messages: {a: {id: 1, from: robot}, b: {id: 1, from: host}}\n"
        assert codes_of(compile_text(HEAD + frame + messages)) == ["PG142"]

    def test_messages_of_one_size_end_by_their_identity(self) -> None:
        frame = (
            "byte_bits: 7\nframe:\n"
            "  start: {type: byte, id: true, range: [0x80, 0xFE]}\n  payload: {}\n"
        )
        fixed = "messages: {gyro: {id: 0x80, from: robot, fields: {angle: uint14}}}\n"
        assert framing_of(HEAD + frame + fixed).finds_end.startswith("the identity gives the size")
        counted = (
            "messages: {gyro: {id: 0x80, from: robot, "
            "fields: {points: uint7, angles: {type: uint14, count: points}}}}\n"
        )
        found = framing_of(HEAD + frame + counted)
        assert found.finds_end.startswith("identity and fields give the size")
        # start, the count, up to 127 numbers of two bytes
        assert (found.least, found.greatest) == (2, 1 + 1 + 254)


class TestRates:
    @pytest.mark.parametrize(
        ("link", "bits"),
        [
            # start bit, data bits, parity bit, stop bits
            ("{baud: 9600}", 1 + 8 + 0 + 1),
            ("{baud: 9600, parity: even}", 1 + 8 + 1 + 1),
            ("{baud: 9600, data_bits: 7, parity: odd, stop_bits: 2}", 1 + 7 + 1 + 2),
        ],
    )
    def test_follow_from_the_bits_of_a_byte(self, link: str, bits: int) -> None:
        text = HEAD + f"link: {link}\nframe:\n" + LENGTH_AND_CRC + MESSAGE
        # id, length, angle, CRC: 7 bytes
        assert framing_of(text).messages[0].per_second == Fraction(9600, bits * 7)

    def test_are_not_known_without_a_baud_rate(self) -> None:
        assert (
            framing_of(HEAD + "frame:\n" + LENGTH_AND_CRC + MESSAGE).messages[0].per_second is None
        )


def test_an_endpoint_that_sends_nothing_needs_no_byte_order_of_its_own() -> None:
    head = "protocol: p\nendpoints: {a: A, b: B}\nbyte_order: {a: little}\n"
    stuffing = "transparency: {a: slip}\n"
    frame = (
        "frame:\n  id: {type: uint16, id: true}\n  payload: {}\n"
        "  sum: {type: uint16, algorithm: fletcher-16, covers: id..payload}\n"
        "  end: {literal: 0xC0}\n"
    )
    assert not codes_of(compile_text(head + stuffing + frame + "messages: {m: {id: 1, from: a}}\n"))
